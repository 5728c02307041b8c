"""Boxes."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Literal

from pydantic import Field

from insonify.scene.base import parameter
from insonify.scene.targets.base import LEAST, Posed
from insonify.scene.targets.shape import Shape, block
from insonify.scene.targets.sides import SLIGHT, Side, Sight, dot, flat_echo

Edge = Annotated[float, Field(ge=LEAST, le=1000.0)]


class Box(Posed):
    """A block; its centre is at half its length, width and height."""

    rank = 3
    combed = 0.065
    kind: Literal["box"] = "box"
    size: tuple[Edge, Edge, Edge] = parameter(
        (2.0, 1.0, 1.0),
        unit="m",
        description="[length, width, height], each from 1 mm to 1000 m; the length runs along the heading",
        slider=(0.05, 10.0),
        log=True,
    )

    def shape(self) -> Shape:
        """Twelve triangles."""
        return Shape(triangles=block(self.size))

    def sides(self, sight: Sight) -> Iterator[Side]:
        """Three flat sides; of two opposite ones the sonar sees one."""
        of, axes = self.material.reflectivity, sight[:3]
        edges = [(side * axis[0], side * axis[1], side * axis[2]) for side, axis in zip(self.size, axes)]
        for k in range(3):
            one, other = edges[k - 2], edges[k - 1]
            ranges, lengths = [dot(edge, sight.towards) for edge in (one, other)], (abs(one[0]), abs(other[0]))
            deep = sum(map(abs, ranges))
            # A line across a parallelogram, of all that it is deep.
            depth = min(abs(ranges[0] * other[0] - ranges[1] * one[0]) / max(*lengths, 1e-9), deep)
            echo = self.size[k - 2] * self.size[k - 1] * flat_echo(of, abs(dot(axes[k], sight.towards)))
            yield Side(echo, max(sum(lengths), SLIGHT), depth, deep - depth)
