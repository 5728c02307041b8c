"""Shapes of targets: balls, frustums and triangles, which can be turned, moved and measured."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from insonify.arrays import Floats

Triple = tuple[float, float, float]
# Corners of a block as ±1, and the two triangles of each side, counter-clockwise from outside.
_CORNERS = np.array([[x, y, z] for z in (-1.0, 1.0) for y in (-1.0, 1.0) for x in (-1.0, 1.0)])
_SIDES = np.array(
    [[0, 2, 3], [0, 3, 1], [4, 5, 7], [4, 7, 6], [0, 1, 5], [0, 5, 4], [2, 6, 7], [2, 7, 3], [0, 4, 6], [0, 6, 2],
     [1, 3, 7], [1, 7, 5]]
)  # fmt: skip


class Solid(NamedTuple):
    """A ball, or a frustum: a cylinder, a cone or a part of one."""

    start: Floats  # (3,) centre of the ball, middle of the frustum's first end
    axis: Floats  # (3,) unit vector towards the last end, 0 for a ball
    length: float  # along the axis, 0 for a ball
    radius: float  # of the ball or of the frustum's first end
    taper: float = 0.0  # growth of the radius per metre along the axis

    @property
    def is_ball(self) -> bool:
        """Whether it is a ball."""
        return self.length == 0.0

    def ends(self) -> Iterator[tuple[Floats, float]]:
        """Middle and radius of each end."""
        yield self.start, self.radius
        if not self.is_ball:
            yield self.start + self.length * self.axis, self.radius + self.taper * self.length

    def across(self, direction: Floats) -> float:
        """Extent of a rim of radius 1 along a unit vector: the sine of the angle between vector and axis."""
        return math.sqrt(max(1.0 - float(self.axis @ direction) ** 2, 0.0))

    @property
    def lowest(self) -> float:
        """Height of the lowest point."""
        down = 1.0 if self.is_ball else math.hypot(self.axis[0], self.axis[1])
        return min(float(middle[2]) - radius * down for middle, radius in self.ends())


class Outline(NamedTuple):
    """Bounding box and number of triangles of a shape."""

    solids: tuple[Solid, ...] = ()
    half: Triple = (0.0, 0.0, 0.0)  # m, half the sides of the box about the origin that contains the triangles
    triangles: int = 0  # their number

    @property
    def radius(self) -> float:
        """Radius of a ball about the origin that contains the shape."""
        ends = ((solid, middle, radius) for solid in self.solids for middle, radius in solid.ends())
        return max(math.hypot(*self.half), *(_farthest(*end) for end in ends), 0.0)

    def extent(self, direction: Sequence[float]) -> float:
        """Greatest extent of the shape from the origin along a unit vector."""
        way = np.asarray(direction)
        reach = [sum(half * abs(part) for half, part in zip(self.half, direction))]
        for solid in self.solids:
            reach += [abs(float(middle @ way)) + radius * solid.across(way) for middle, radius in solid.ends()]
        return max(reach)


class Shape(NamedTuple):
    """Shape of a target: balls and frustums, triangles, or both."""

    solids: tuple[Solid, ...] = ()
    triangles: Floats = np.zeros((0, 3, 3))  # corners, counter-clockwise from outside
    closed: bool = False  # whether the triangles bound bodies, so that their backs are never seen from outside

    @property
    def lowest(self) -> float:
        """Height of the lowest point."""
        lowest = [solid.lowest for solid in self.solids]
        return min(lowest + ([float(self.triangles[..., 2].min())] if len(self.triangles) else []))

    @property
    def outline(self) -> Outline:
        """Measures of the shape."""
        if not len(self.triangles):
            return Outline(self.solids)
        x, y, z = np.abs(self.triangles).max(axis=(0, 1)).tolist()
        return Outline(self.solids, (x, y, z), len(self.triangles))

    def turned(self, rotation: Floats) -> Shape:
        """Turn the shape about the origin, by a (3, 3) matrix."""
        solids = (s._replace(start=rotation @ s.start, axis=rotation @ s.axis) for s in self.solids)
        return self._replace(solids=tuple(solids), triangles=self.triangles @ rotation.T)

    def moved(self, by: Floats) -> Shape:
        """Move the shape."""
        solids = (s._replace(start=s.start + by) for s in self.solids)
        return self._replace(solids=tuple(solids), triangles=self.triangles + by)


def exact_cos(degrees: float) -> float:
    """Cosine that is exactly 0 or ±1 on the axes, so that bodies aligned with the grid remain aligned."""
    quarter = degrees / 90.0
    return (1.0, 0.0, -1.0, 0.0)[int(quarter) % 4] if quarter == int(quarter) else math.cos(math.radians(degrees))


def rotation_matrix(heading: float, pitch: float, roll: float) -> Floats:
    """Matrix (3, 3) of a turn by heading about z, then by pitch and roll, each in degrees about the turned axes."""
    (ch, sh), (cp, sp), (cr, sr) = ((exact_cos(a), exact_cos(a - 90.0)) for a in (heading, pitch, roll))
    about_z = np.array([[ch, -sh, 0.0], [sh, ch, 0.0], [0.0, 0.0, 1.0]])
    bow_up = np.array([[cp, 0.0, -sp], [0.0, 1.0, 0.0], [sp, 0.0, cp]])
    port_up = np.array([[1.0, 0.0, 0.0], [0.0, cr, -sr], [0.0, sr, cr]])
    return about_z @ bow_up @ port_up


def ball(radius: float, centre: Floats | None = None) -> Solid:
    """Return a sphere."""
    return Solid(np.zeros(3) if centre is None else centre, np.zeros(3), 0.0, radius)


def frustum(first: Floats, last: Floats, radius: float, last_radius: float) -> Solid:
    """Return a cylinder, a cone or a part of one, between the middles of its ends."""
    length = float(np.linalg.norm(last - first))
    return Solid(first, (last - first) / length, length, radius, (last_radius - radius) / length)


def block(size: Triple) -> Floats:
    """Return the (12, 3, 3) triangles of a block."""
    return np.asarray((0.5 * np.asarray(size) * _CORNERS)[_SIDES])


def _farthest(solid: Solid, middle: Floats, radius: float) -> float:
    """Distance from the origin to the farthest point of an end's rim, or of a ball."""
    if solid.is_ball:
        return math.hypot(*middle) + radius
    along = float(middle @ solid.axis)
    return math.hypot(along, math.hypot(*(middle - along * solid.axis)) + radius)
