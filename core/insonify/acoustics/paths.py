"""Rays and caustics of a declared water, in degrees below the horizontal, depths and ground ranges."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from insonify.acoustics.rays import ALONG_STATIONS, find_shadows, follow_paths, join_points, list_rows
from insonify.acoustics.water import make_sound_speed_field
from insonify.arrays import Booleans, Dataset, Floats, Integers
from insonify.kernels.common.types import Water as LaidWater
from insonify.kernels.refraction.eigenray_search import ANGLE, BOTTOMS, COSINE, GRAZED, SINE, TIME, TOPS, TUBE, TURNS
from insonify.kernels.refraction.ray_paths import CAUSTIC_COLUMNS, ON_BED, RayLimits, RayPoints, trace_caustics
from insonify.scene import SceneError
from insonify.scene.water import WaterKind

ENDS = ("range", "bottom", "surface", "nowhere", "trapped")  # by the codes of `kernels.refraction.ray_paths`
POINTS = 201  # points of a path when no ranges are given


def ray_paths(
    water: WaterKind,
    source_depth: float,
    angles: ArrayLike,
    *,
    max_range: float,
    bottom: float | None = None,
    ranges: ArrayLike | None = None,
) -> Dataset:
    """Trace rays through water.

    Parameters
    ----------
    water : WaterKind
        A scene's water of any kind. Through a section rays run along its line, from distance 0 onwards.
    source_depth : float
        Metres.
    angles : array_like
        Of launch, in degrees below the horizontal; negative ones go up.
    max_range : float
        Ground range at which rays end, in metres.
    bottom : float, optional
        Depth of a level bed at which rays end, in metres; there is none when left out.
    ranges : array_like, optional
        Ground ranges at which points are wanted, ascending, in metres; evenly laid when left out.

    Returns
    -------
    xarray.Dataset
        Dimensions ``ray`` and ``point``, NaN beyond a ray's last point. A ray that meets the bed, or a sea surface
        that is not declared to reflect it, ends there, in a point of its own. Variables: ``range`` and ``depth`` in
        metres, ``time`` in seconds, ``tube`` (distance across the ray per launch angle, m/rad; it changes its sign at
        a caustic), ``hit`` (whether this is where the ray meets the bed) and ``grazing`` (direction, degrees below the
        horizontal). ``capped`` tells that the tube is unsure: the ray met a kink of the profile at grazing. By ray,
        ``end`` is one of "range", "bottom", "surface", "nowhere" (it gets no farther in range) and "trapped".

    Raises
    ------
    SceneError
        If a number makes no sense or a cast cannot be read.
    """
    laid, launch, limits = _prepare_paths(water, source_depth, angles, max_range, bottom)
    wanted = _ranges(ranges, max_range)
    points, ends = follow_paths(laid, -float(source_depth), -np.radians(launch), wanted, limits)
    return _as_paths(launch, points, ends)


def eigenrays(
    water: WaterKind,
    source_depth: float,
    target_range: float,
    target_depth: float,
    *,
    bottom: float | None = None,
    reflections: int = 0,
) -> Dataset:
    """Find the rays that join two points.

    Parameters
    ----------
    water : WaterKind
        A scene's water of any kind; through a section rays run along its line, from distance 0 onwards.
    source_depth : float
        Metres.
    target_range : float
        Ground range between the two points, in metres.
    target_depth : float
        Metres.
    bottom : float, optional
        Depth of a level bed, in metres; there is none when left out.
    reflections : int
        How often a ray may be reflected by the bed and the sea surface, together.

    Returns
    -------
    xarray.Dataset
        Dimension ``eigenray``, by launch angle; empty in a shadow zone. ``angle`` and ``arrival`` in degrees below the
        horizontal, ``time`` in seconds, ``tube`` as in `ray_paths`, ``intensity`` over that at 1 m (nothing lost but
        by spreading; infinite on a caustic), ``turns`` in the water, reflections ``by_surface`` and ``by_bottom``,
        ``capped`` as in `ray_paths`.

    Raises
    ------
    SceneError
        If a number makes no sense or a cast cannot be read.
    """
    laid = _below_surface(water)
    _check_depths(source_depth, bottom)
    _check_depths(target_depth, bottom, "target_depth")
    lowest = 0.0 if laid.station.size == 1 else 1e-6
    _check("target_range", target_range, target_range >= lowest, f"give a length of at least {lowest:g}")
    _check("reflections", reflections, reflections >= 0, "give 0 or more")
    rows = join_points(
        laid, -float(source_depth), -float(target_depth), target_range, _height_of(bottom), 0.0, reflections
    )
    return _as_eigenrays(rows[::-1], target_range)


def shadow_zones(
    water: WaterKind, source_depth: float, depth: float, *, max_range: float, bottom: float | None = None
) -> Floats:
    """Find the shadow zones: ground ranges at which no direct ray reaches a depth.

    Parameters
    ----------
    water : WaterKind
        A scene's water of any kind but a section.
    source_depth, depth : float
        Metres.
    max_range : float
        Greatest ground range of the search, in metres.
    bottom : float, optional
        Depth of a level bed at which rays end, in metres; there is none when left out.

    Returns
    -------
    (n, 2) float64
        Beginning and end of each shadow in metres, ascending. Over the bed the first begins at the limiting range.

    Raises
    ------
    SceneError
        If a number makes no sense, a cast cannot be read, or the water is a section.
    """
    laid = _below_surface(water)
    if laid.station.size > 1:
        raise SceneError("water.kind: 'section' has no shadow zones in closed form; look at its ray_paths")
    _check("max_range", max_range, max_range > 0.0, "give a length above 0")
    _check_depths(source_depth, bottom)
    _check_depths(depth, bottom, "depth")
    return find_shadows(laid, -float(source_depth), -float(depth), _height_of(bottom), 0.0, max_range)


def caustics(
    water: WaterKind, source_depth: float, angles: ArrayLike, *, max_range: float, bottom: float | None = None
) -> Dataset:
    """Find the points at which rays touch caustics, where the ray tube has no width.

    Parameters
    ----------
    water, source_depth, angles, max_range, bottom
        As in `ray_paths`.

    Returns
    -------
    xarray.Dataset
        Dimension ``caustic``, by the order of the angles: ``angle`` of launch in degrees below the horizontal,
        ``range`` and ``depth`` in metres, ``time`` in seconds. In a profile of many fine layers rays that turn touch
        many: its kinks focus them as a smooth profile would not.

    Raises
    ------
    SceneError
        If a number makes no sense or a cast cannot be read.
    """
    import xarray as xr

    laid, launch, limits = _prepare_paths(water, source_depth, angles, max_range, bottom)
    start = laid, ALONG_STATIONS, -float(source_depth), -np.radians(launch)
    found = list_rows(lambda rows: trace_caustics(*start, limits, rows), CAUSTIC_COLUMNS)
    return xr.Dataset(
        {
            "angle": ("caustic", launch[found[:, 0].astype(np.int64)], {"units": "degree"}),
            "range": ("caustic", found[:, 1], {"units": "m"}),
            "depth": ("caustic", 0.0 - found[:, 2], {"units": "m"}),
            "time": ("caustic", found[:, 3], {"units": "s"}),
        }
    )


def airy_pressure(
    frequency: float, times: tuple[ArrayLike, ArrayLike], amplitudes: tuple[ArrayLike, ArrayLike]
) -> Floats:
    """Sound pressure near a caustic from the ray that has touched it and the one that has not; finite on it."""
    from scipy.special import airy

    first, second = np.asarray(amplitudes[0], dtype=np.float64), np.asarray(amplitudes[1], dtype=np.float64)
    apart = 2.0 * np.pi * frequency * (np.asarray(times[1], dtype=np.float64) - np.asarray(times[0], dtype=np.float64))
    rho = np.cbrt(0.75 * apart) ** 2
    value, slope, _, _ = airy(-rho)
    with np.errstate(divide="ignore", invalid="ignore"):
        together, against = (first + second) * rho**0.25 * value, (first - second) * rho**-0.25 * slope
    return np.asarray(np.sqrt(np.pi) * np.hypot(together, against))


def _prepare_paths(
    water: WaterKind, source_depth: float, angles: ArrayLike, max_range: float, bottom: float | None
) -> tuple[LaidWater, Floats, RayLimits]:
    """Check parameters of `ray_paths` and return the packed water, the launch angles and the limits of rays."""
    launch = np.atleast_1d(np.asarray(angles, dtype=np.float64))
    if launch.ndim != 1:
        raise SceneError(f"angles: has {launch.ndim} dimensions; give a one-dimensional array")
    if not (np.abs(launch) <= 90.0).all():
        raise SceneError(f"angles: {_first(launch, np.abs(launch) <= 90.0)} must lie between -90 and 90 degrees")
    _check("max_range", max_range, max_range > 0.0, "give a length above 0")
    _check_depths(source_depth, bottom)
    return (
        _below_surface(water),
        launch,
        RayLimits(float(max_range), _height_of(bottom), 0.0, False, water.surface.reflects),
    )


def _as_paths(launch: Floats, points: RayPoints, ends: Integers) -> Dataset:
    """Dataset of ray paths, with as many points as the longest has."""
    import xarray as xr

    there = np.isfinite(points.x)
    last = np.arange(there.shape[1]) == there.sum(axis=1, keepdims=True) - 1
    dims = ("ray", "point")
    variables: dict[str, Any] = {
        "range": (dims, points.x, {"units": "m"}),
        "depth": (dims, 0.0 - points.z, {"units": "m"}),
        "time": (dims, points.time, {"units": "s"}),
        "tube": (dims, points.q, {"units": "m/rad"}),
        "hit": (dims, last & (ends == ON_BED)[:, None]),
        "grazing": (dims, _downwards(points.cosine, points.sine), {"units": "degree"}),
        "capped": (dims, points.grazed),
        "end": ("ray", np.array(ENDS)[ends]),
    }
    dataset = xr.Dataset(variables, coords={"angle": ("ray", launch, {"units": "degree"})})
    return dataset.isel(point=slice(0, max(int(there.any(axis=0).sum()), 1)))


def _as_eigenrays(rows: Floats, target_range: float) -> Dataset:
    """Dataset of the eigenrays between two points."""
    import xarray as xr

    launch = -rows[:, ANGLE]
    # x/cosθ0 is the horizontal width of the ray tube; for a vertical ray both widths are equal.
    wide = np.abs(rows[:, TUBE]) if target_range == 0.0 else target_range / np.cos(launch)
    with np.errstate(divide="ignore"):
        intensity = 1.0 / (wide * np.abs(rows[:, TUBE]))
    variables: dict[str, Any] = {
        "angle": np.degrees(launch),
        "arrival": _downwards(rows[:, COSINE], rows[:, SINE]),
        "time": rows[:, TIME],
        "tube": rows[:, TUBE],
        "intensity": intensity,
        "turns": rows[:, TURNS].astype(int),
        "by_surface": rows[:, TOPS].astype(int),
        "by_bottom": rows[:, BOTTOMS].astype(int),
        "capped": rows[:, GRAZED] > 0.0,
    }
    units = {"angle": "degree", "arrival": "degree", "time": "s", "tube": "m/rad"}
    attributes = {name: {"units": unit} for name, unit in units.items()}
    return xr.Dataset({name: ("eigenray", values, attributes.get(name)) for name, values in variables.items()})


def _below_surface(water: WaterKind) -> LaidWater:
    """Water packed for the kernels, with heights above the sea surface; bent even where its speed is the same."""
    return make_sound_speed_field(water).pack(0.0, 1500.0)


def _height_of(bottom: float | None) -> float:
    """Height of a bed above the sea surface, m; minus infinity if there is none."""
    return -math.inf if bottom is None else -float(bottom)


def _downwards(cosine: Floats, sine: Floats) -> Floats:
    """Direction in degrees below the horizontal."""
    return np.degrees(np.arctan2(0.0 - sine, cosine))


def _ranges(ranges: ArrayLike | None, max_range: float) -> Floats:
    """Ground ranges at which points are wanted, checked, m."""
    if ranges is None:
        return np.linspace(0.0, max_range, POINTS)
    wanted = np.atleast_1d(np.asarray(ranges, dtype=np.float64))
    inside = (wanted >= 0.0) & (wanted <= max_range)
    if not inside.all():
        raise SceneError(f"ranges: {_first(wanted, inside)} must lie between 0 and max_range, {max_range:g} m")
    if (np.diff(wanted) <= 0.0).any():
        raise SceneError("ranges: must increase; sort them and remove duplicates")
    return wanted


def _first(values: Floats, good: Booleans) -> str:
    return f"{values[~good][0]:g}"


def _check(name: str, value: float, good: bool, remedy: str) -> None:
    if not (good and math.isfinite(value)):
        raise SceneError(f"{name}: {value:g} is not valid; {remedy}")


def _check_depths(depth: float, bottom: float | None, name: str = "source_depth") -> None:
    """Raise an error for a point outside the water."""
    _check(name, depth, depth >= 0.0, "give metres below the sea surface")
    if bottom is not None:
        _check("bottom", bottom, bottom > 0.0, "give metres below the sea surface")
        _check(name, depth, depth <= bottom, f"the bed is at {bottom:g} m")
