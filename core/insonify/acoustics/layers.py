"""Sound speed of waters of every kind: a polyline over depth, or a lattice over depth and distance along a line."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from insonify.acoustics.polyline import approximate_by_segments, thin_polyline
from insonify.acoustics.sound_speed import EQUATIONS
from insonify.files import file_version
from insonify.io.sound_speed_casts import Cast, read_cast
from insonify.scene import SceneError
from insonify.scene.waters import WaterKind
from insonify.scene.waters.cast import CastWater
from insonify.scene.waters.hydrography import HydrographyWater
from insonify.scene.waters.profile import ProfileWater
from insonify.scene.waters.uniform import UniformWater

Values = NDArray[np.float64]
# m/s by which straight pieces may miss a curve: two thirds of it, the mean miss of a chord, is 6e-8 s in 100 m.
OF_CURVES = 0.002
OF_CASTS = 0.02  # the same of measured casts, which are no more exact


@dataclass(frozen=True, eq=False)
class SoundSpeedField:
    """Speed of sound, linear between its points (of a section: in the triangles that rays see) and even beyond them.

    Attributes
    ----------
    depth : (n,) float64
        Metres, increasing.
    distance : (m,) float64
        Metres along a level line through the scene's (0, 0), increasing; one for water that is everywhere the same.
    speed : (m, n) float64
        m/s.
    heading : float
        Of that line, radians counter-clockwise from +x.
    """

    depth: Values
    distance: Values
    speed: Values
    heading: float = 0.0

    @property
    def axis(self) -> tuple[float, float]:
        """Level unit vector along the line."""
        return math.cos(self.heading), math.sin(self.heading)

    def speed_at(self, x: ArrayLike, y: ArrayLike, depth: ArrayLike) -> Values:
        """Speed of sound at places of the scene, in m/s.

        Parameters
        ----------
        x, y, depth : array_like
            Local coordinates and depth, in metres; they broadcast together.
        """
        cos, sin = self.axis
        along, below = np.broadcast_arrays(np.asarray(x) * cos + np.asarray(y) * sin, np.asarray(depth))
        if self.distance.size == 1:
            return np.asarray(np.interp(below, self.depth, self.speed[0]))
        if self.depth.size == 1:
            return np.asarray(np.interp(along, self.distance, self.speed[:, 0]))
        i, onwards = _within(self.distance, along)
        j, downwards = _within(self.depth, below)
        # As rays see it: each cell in two triangles, cut along the diagonal on which speed differs less.
        top, bottom, top_next, bottom_next = (self.speed[i + m, j + k] for m, k in ((0, 0), (0, 1), (1, 0), (1, 1)))
        rising = np.abs(top_next - bottom) <= np.abs(bottom_next - top)
        upper = downwards < np.where(rising, 1.0 - onwards, onwards)
        over = np.where(upper, top_next - top, bottom_next - bottom)
        down = np.where(upper == rising, bottom - top, bottom_next - top_next)
        corner = np.where(upper, top + over * onwards, bottom + over * onwards)
        return np.asarray(corner + down * np.where(upper, downwards, downwards - 1.0))


def _within(places: Values, wanted: Values) -> tuple[NDArray[np.int64], Values]:
    """Find the piece between two places, and the share of it that lies behind, 0 or 1 beyond the outermost."""
    piece = np.clip(np.searchsorted(places, wanted, side="right") - 1, 0, places.size - 2)
    return piece, np.clip((wanted - places[piece]) / (places[piece + 1] - places[piece]), 0.0, 1.0)


def make_sound_speed_field(water: WaterKind) -> SoundSpeedField:
    """Sound speed of a declared water.

    Raises
    ------
    SceneError
        If a cast cannot be read or is no water that sound could pass.
    """
    return _kept_layers(water, file_version(water.path) if isinstance(water, CastWater) else None)


@lru_cache(maxsize=16)
def _kept_layers(water: WaterKind, version: tuple[int, int] | None) -> SoundSpeedField:
    del version  # part of the key alone: a file written anew is read anew
    if isinstance(water, UniformWater):
        return _level([0.0], [water.sound_speed])
    if isinstance(water, ProfileWater):
        if water.interpolation == "linear":
            return _level(water.depth, water.sound_speed)
        return _level(*_smooth(np.array(water.depth), np.array(water.sound_speed), OF_CURVES))
    if isinstance(water, HydrographyWater):
        return _level(*_of_hydrography(water))
    if isinstance(water, CastWater):
        return _level(*_of_cast(water))
    return SoundSpeedField(
        np.array(water.depth),  # type: ignore[attr-defined]
        np.array(water.distance),  # type: ignore[attr-defined]
        np.array(water.sound_speed),  # type: ignore[attr-defined]
        math.radians(water.heading),  # type: ignore[attr-defined]
    )


def _level(depth: ArrayLike, speed: ArrayLike) -> SoundSpeedField:
    """Water that is the same everywhere."""
    return SoundSpeedField(
        np.asarray(depth, dtype=np.float64), np.zeros(1), np.asarray(speed, dtype=np.float64)[None, :]
    )


def _smooth(depth: Values, speed: Values, tolerance: float) -> tuple[Values, Values]:
    """Pieces of the curve through the points that keeps to their order of size: PCHIP, for a spline overshoots."""
    from scipy.interpolate import PchipInterpolator

    return approximate_by_segments(PchipInterpolator(depth, speed), depth, tolerance)


def _of_hydrography(water: HydrographyWater) -> tuple[Values, Values]:
    """Pieces of the speed; temperature and salinity are straight between the depths, the speed is not."""
    depth = np.array(water.depth)
    salinity = np.broadcast_to(np.asarray(water.salinity, dtype=np.float64), depth.shape)

    def speed(places: Values) -> Values:
        temperature = np.interp(places, depth, np.array(water.temperature))
        return EQUATIONS[water.equation](temperature, np.interp(places, depth, salinity), places)

    return approximate_by_segments(speed, depth, OF_CURVES)


def _of_cast(water: CastWater) -> tuple[Values, Values]:
    """Measured cast, thinned to few points."""
    cast = read_cast(water.path)
    speed = _speed_of_cast(water, cast)
    if water.interpolation == "pchip" and cast.depth.size > 1:
        return _smooth(cast.depth, speed, OF_CASTS)
    kept = thin_polyline(cast.depth, speed, OF_CASTS)
    return cast.depth[kept], speed[kept]


def _speed_of_cast(water: CastWater, cast: Cast) -> Values:
    """Speed that a cast holds, or an equation's from its temperature and salinity."""
    if cast.sound_speed is not None and water.equation is None:
        speed = cast.sound_speed
    elif cast.temperature is None or cast.salinity is None:
        raise SceneError(
            f"water.equation: {water.equation!r} needs temperature and salinity, which {water.path!r} does not hold; "
            "leave it out to take the cast's own speed"
        )
    else:
        speed = EQUATIONS[water.equation or "teos10"](cast.temperature, cast.salinity, cast.depth)
    wrong = np.flatnonzero(~((speed >= 1300.0) & (speed <= 1700.0)))
    if wrong.size:
        raise SceneError(
            f"water.path: {water.path!r} makes {speed[wrong[0]]:.6g} m/s at {cast.depth[wrong[0]]:.4g} m, no speed of "
            "sound in water (1300 to 1700 m/s); mend or leave out that row"
        )
    return np.asarray(speed)
