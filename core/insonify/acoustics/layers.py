"""Sound speed of waters of every kind: a polyline over depth, or a lattice over depth and distance along a line."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from insonify.scene.water import WaterKind

Values = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class SoundSpeedField:
    """Speed of sound, linear between its points (in a section over triangles) and constant beyond them."""

    depth: Values  # (n,) metres, increasing
    # (m,) metres along a level line through the scene's (0, 0), increasing; one for water that is everywhere the
    # same.
    distance: Values
    speed: Values  # (m, n) m/s
    heading: float = 0.0  # heading of that line, radians counter-clockwise from +x

    @property
    def axis(self) -> tuple[float, float]:
        """Level unit vector along the line."""
        return math.cos(self.heading), math.sin(self.heading)

    def speed_at(self, x: ArrayLike, y: ArrayLike, depth: ArrayLike) -> Values:
        """Speed of sound at places of the scene, in m/s."""
        cos, sin = self.axis
        along, below = np.broadcast_arrays(np.asarray(x) * cos + np.asarray(y) * sin, np.asarray(depth))
        if self.distance.size == 1:
            return np.asarray(np.interp(below, self.depth, self.speed[0]))
        if self.depth.size == 1:
            return np.asarray(np.interp(along, self.distance, self.speed[:, 0]))
        i, onwards = _within(self.distance, along)
        j, downwards = _within(self.depth, below)
        # As in the ray tracer: each cell is two triangles, split along the diagonal with the smaller change of speed.
        top, bottom, top_next, bottom_next = (self.speed[i + m, j + k] for m, k in ((0, 0), (0, 1), (1, 0), (1, 1)))
        rising = np.abs(top_next - bottom) <= np.abs(bottom_next - top)
        upper = downwards < np.where(rising, 1.0 - onwards, onwards)
        over = np.where(upper, top_next - top, bottom_next - bottom)
        down = np.where(upper == rising, bottom - top, bottom_next - top_next)
        corner = np.where(upper, top + over * onwards, bottom + over * onwards)
        return np.asarray(corner + down * np.where(upper, downwards, downwards - 1.0))


def _within(places: Values, wanted: Values) -> tuple[NDArray[np.int64], Values]:
    """Find the interval that holds each value and the fraction of it below the value, 0 or 1 outside all intervals."""
    piece = np.clip(np.searchsorted(places, wanted, side="right") - 1, 0, places.size - 2)
    return piece, np.clip((wanted - places[piece]) / (places[piece + 1] - places[piece]), 0.0, 1.0)


def make_sound_speed_field(water: WaterKind) -> SoundSpeedField:
    """Sound speed of a declared water."""
    return _kept_field(water, water.version)


@lru_cache(maxsize=16)
def _kept_field(water: WaterKind, version: tuple[int, int] | None) -> SoundSpeedField:
    del version  # only part of the key: a changed file is read again
    depth, speed, distance, heading = water.sound_speeds()
    return SoundSpeedField(depth, distance, speed, heading)
