"""Sound speed of waters of every kind: a polyline over depth, or a lattice over depth and distance along a line."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from insonify.scene.waters import WaterKind

Values = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class SoundSpeedField:
    """Speed of sound, linear between its points (in a section over triangles) and constant beyond them.

    Attributes
    ----------
    depth : (n,) float64
        Metres, increasing.
    distance : (m,) float64
        Metres along a level line through the scene's (0, 0), increasing; one for water that is everywhere the same.
    speed : (m, n) float64
        m/s.
    heading : float
        Heading of that line, radians counter-clockwise from +x.
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
    """Sound speed of a declared water.

    Raises
    ------
    SceneError
        If a cast cannot be read or holds an impossible sound speed.
    """
    return _kept_field(water, water.version)


@lru_cache(maxsize=16)
def _kept_field(water: WaterKind, version: tuple[int, int] | None) -> SoundSpeedField:
    del version  # only part of the key: a changed file is read again
    depth, speed, distance, heading = water.sound_speeds()
    return SoundSpeedField(depth, distance, speed, heading)
