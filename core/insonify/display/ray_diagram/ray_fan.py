"""Dense fan of rays, and the cells and stretches of bed that it reaches."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.acoustics.rays import follow_paths
from insonify.kernels.common.types import Water
from insonify.kernels.refraction.ray_paths import AT_SURFACE, ON_BED, RayLimits

Values = NDArray[np.float64]
FIRST = 257  # rays, denser towards the horizontal
MOST = 4000
SEAM = 2e-3  # of the range, by which the bed right under the sonar and between two rays is taken as met
ROUNDS = 40  # of rays put between two that have parted
CELLS = 720  # of depth
WIDE = 12.0  # cells by which neighbours may lie apart
ONE = 1e-12  # rad; rays launched closer than this and apart all the same leave a shadow between them


@dataclass(frozen=True, eq=False)
class RayFan:
    """Heights and tubes of a fan of rays by launch angle and range, and the cells that it reaches."""

    ranges: Values  # (m,) metres
    height: Values  # (n, m) height of each ray in metres and its tube q in m/rad, NaN after its end
    tube: Values
    lit: NDArray[np.bool_]  # (cells, m) where there is a ray or one between two of them, lowest cell first
    dark: Values  # (k, 2) beginning and end of the ranges at which no ray meets the bed, in metres


def trace_fan(water: Water, height: float, limits: RayLimits, columns: int) -> RayFan:
    """Trace a fan of rays in all directions, refined where neighbours diverge."""
    ranges = np.linspace(0.0, limits.x, columns)
    cell = (limits.high - limits.low) / CELLS
    places = np.linspace(-1.0, 1.0, FIRST)
    rays = _trace(water, height, 0.4999 * math.pi * places * np.abs(places), ranges, limits)
    kept, count = [rays], FIRST
    first, last = _taken(rays, slice(None, -1)), _taken(rays, slice(1, None))
    for _ in range(ROUNDS):
        parted = _parted(first, last, WIDE * cell)
        first, last = _taken(first, parted), _taken(last, parted)
        count += first.angle.size
        if first.angle.size == 0 or count > MOST:
            break
        middle = _trace(water, height, 0.5 * (first.angle + last.angle), ranges, limits)
        kept.append(middle)
        first, last = _joined([first, middle]), _joined([middle, last])
    rays = _joined(kept)
    rays = _taken(rays, np.argsort(rays.angle, kind="stable"))
    return RayFan(ranges, rays.height, rays.tube, _lit(rays, limits, cell), _dark(rays, limits.x))


class _Rays(NamedTuple):
    """Rays of a fan with their ends."""

    angle: Values  # (n,) of launch, rad
    height: Values  # (n, m)
    tube: Values  # (n, m)
    last: Values  # (n,) range at which it ends, m
    end: NDArray[np.int64]  # (n,)


def _trace(water: Water, height: float, angles: Values, ranges: Values, limits: RayLimits) -> _Rays:
    points, ends = follow_paths(water, height, angles, ranges, limits)
    # Behind its last range a ray has a point of its own, where it ends.
    beyond = points.x[:, : ranges.size] != ranges
    z, q = points.z[:, : ranges.size], points.q[:, : ranges.size]
    z[beyond], q[beyond] = np.nan, np.nan
    return _Rays(angles, z, q, np.fmax.reduce(points.x, axis=1), ends)


def _taken(rays: _Rays, which: slice | NDArray[Any]) -> _Rays:
    columns: Any = (column[which] for column in rays)
    return _Rays(*columns)


def _joined(parts: list[_Rays]) -> _Rays:
    return _Rays(*(np.concatenate(columns) for columns in zip(*parts)))


def _parted(first: _Rays, last: _Rays, most: float) -> NDArray[np.bool_]:
    """Select neighbours that diverge by more than ``most`` or end differently."""
    with np.errstate(invalid="ignore"):
        far = (np.abs(first.height - last.height) > most).any(axis=1)
    return (far | (first.end != last.end)) & (last.angle - first.angle > ONE)


def _dark(rays: _Rays, reach: float) -> Values:
    """Stretches of range in which no pair of neighbours meets the bed."""
    both = (rays.end[:-1] == ON_BED) & (rays.end[1:] == ON_BED) & (np.diff(rays.angle) > ONE)
    ends = np.sort(np.stack([rays.last[:-1][both], rays.last[1:][both]], axis=1), axis=1)
    ends = ends[np.argsort(ends[:, 0])]
    reached = np.maximum.accumulate(np.append(0.0, ends[:, 1]))
    begins = np.append(ends[:, 0], reach)
    gaps = begins > reached + SEAM * reach
    return np.column_stack([reached[gaps], begins[gaps]])


def _lit(rays: _Rays, limits: RayLimits, cell: float) -> NDArray[np.bool_]:
    """Fill the cells between neighbours; two that end on the bed or at the surface enclose the cells up to it."""
    height, ends = rays.height, rays.end
    first, last = height[:-1], height[1:]
    for code, level in ((ON_BED, limits.low), (AT_SURFACE, limits.high)):
        both = ((ends[:-1] == code) & (ends[1:] == code))[:, None]
        one, other = np.isnan(first), np.isnan(last)
        first = np.where(both & one & ~other, level, first)
        last = np.where(both & other & ~one, level, last)
    between = np.isfinite(first) & np.isfinite(last)
    torn = (np.diff(rays.angle) <= ONE)[:, None] & (np.abs(first - last) > WIDE * cell)
    pair, column = np.nonzero(between & ~torn)
    low, high = np.sort(np.stack([first[pair, column], last[pair, column]]), axis=0)
    columns = height.shape[1]
    begin = np.clip(np.floor((low - limits.low) / cell).astype(np.int64), 0, CELLS - 1)
    end = np.clip(np.ceil((high - limits.low) / cell).astype(np.int64), begin + 1, CELLS)
    size = (CELLS + 1) * columns
    changes = np.bincount(begin * columns + column, minlength=size) - np.bincount(
        end * columns + column, minlength=size
    )
    lit = np.cumsum(changes.reshape(CELLS + 1, columns), axis=0)[:-1] > 0
    lit[:, 0] = True  # by the vertical rays
    return lit
