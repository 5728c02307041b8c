"""Caustics: points at which rays touch them, and the finite pressure nearby, where ray theory diverges."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from insonify.acoustics.paths import prepare_paths
from insonify.acoustics.rays import ALONG_STATIONS
from insonify.kernels.refraction.caustics import COLUMNS, trace_caustics
from insonify.scene.water import WaterKind

if TYPE_CHECKING:
    import xarray as xr

ROOM = 256


def caustics(
    water: WaterKind, source_depth: float, angles: ArrayLike, *, max_range: float, bottom: float | None = None
) -> xr.Dataset:
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

    laid, launch, limits = prepare_paths(water, source_depth, angles, max_range, bottom)
    room = ROOM
    while True:
        found = np.empty((room, COLUMNS))
        count = trace_caustics(laid, ALONG_STATIONS, -float(source_depth), -np.radians(launch), limits, found)
        if count < room:
            break
        room *= 2
    found = found[:count]
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
) -> NDArray[np.float64]:
    """Sound pressure near a caustic from the ray that has touched it and the one that has not; finite on it."""
    from scipy.special import airy

    first, second = np.asarray(amplitudes[0], dtype=np.float64), np.asarray(amplitudes[1], dtype=np.float64)
    apart = 2.0 * np.pi * frequency * (np.asarray(times[1], dtype=np.float64) - np.asarray(times[0], dtype=np.float64))
    rho = np.cbrt(0.75 * apart) ** 2
    value, slope, _, _ = airy(-rho)
    with np.errstate(divide="ignore", invalid="ignore"):
        together, against = (first + second) * rho**0.25 * value, (first - second) * rho**-0.25 * slope
    return np.asarray(np.sqrt(np.pi) * np.hypot(together, against))
