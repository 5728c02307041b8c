"""Shapes of targets about their own centre, and how they are turned, moved and measured."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.kernels.common.types import FRUSTUM, SPHERE

Vector = NDArray[np.float64]
# Corners of a block as ±1, and the two triangles of each side, counter-clockwise from outside.
_CORNERS = np.array([[x, y, z] for z in (-1.0, 1.0) for y in (-1.0, 1.0) for x in (-1.0, 1.0)])
_SIDES = np.array(
    [[0, 2, 3], [0, 3, 1], [4, 5, 7], [4, 7, 6], [0, 1, 5], [0, 5, 4], [2, 6, 7], [2, 7, 3], [0, 4, 6], [0, 6, 2],
     [1, 3, 7], [1, 7, 5]]
)  # fmt: skip


class Solid(NamedTuple):
    """One analytic body, as a row of insonify.kernels.common.types.Solids`."""

    shape: int
    start: Vector  # (3,)
    axis: Vector  # (3,)
    length: float
    radius: float
    taper: float = 0.0

    @property
    def lowest(self) -> float:
        """Height of the lowest point."""
        if self.shape == SPHERE:
            return float(self.start[2]) - self.radius
        # The rim of an end reaches down by its radius times the sine of the axis' angle from the vertical.
        down = math.hypot(self.axis[0], self.axis[1])
        last = float(self.start[2] + self.length * self.axis[2])
        return min(float(self.start[2]) - self.radius * down, last - (self.radius + self.taper * self.length) * down)


class Shape(NamedTuple):
    """What a target is made of: analytic bodies, or triangles."""

    solids: tuple[Solid, ...] = ()
    triangles: NDArray[np.float64] = np.zeros((0, 3, 3))  # counter-clockwise from outside

    @property
    def lowest(self) -> float:
        """Height of the lowest point."""
        lowest = [solid.lowest for solid in self.solids]
        return min(lowest + ([float(self.triangles[..., 2].min())] if len(self.triangles) else []))

    def turned(self, rotation: NDArray[np.float64]) -> Shape:
        """Turn the shape about the origin, by a (3, 3) matrix."""
        solids = (s._replace(start=rotation @ s.start, axis=rotation @ s.axis) for s in self.solids)
        return Shape(tuple(solids), self.triangles @ rotation.T)

    def moved(self, by: Vector) -> Shape:
        """Move the shape."""
        return Shape(tuple(s._replace(start=s.start + by) for s in self.solids), self.triangles + by)


def ball(radius: float, centre: Vector | None = None) -> Solid:
    """Return a sphere."""
    return Solid(SPHERE, np.zeros(3) if centre is None else centre, np.zeros(3), 0.0, radius)


def frustum(first: Vector, last: Vector, radius: float, last_radius: float) -> Solid:
    """Return a cylinder, a cone or a part of one, between the middles of its ends."""
    length = float(np.linalg.norm(last - first))
    return Solid(FRUSTUM, first, (last - first) / length, length, radius, (last_radius - radius) / length)


def block(size: tuple[float, float, float]) -> NDArray[np.float64]:
    """Return the (12, 3, 3) triangles of a block."""
    return np.asarray((0.5 * np.asarray(size) * _CORNERS)[_SIDES])
