"""Boxes."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from insonify.scene.base import parameter
from insonify.scene.targets import LEAST, Posed
from insonify.scene.targets.shape import Shape, block

Edge = Annotated[float, Field(ge=LEAST, le=1000.0)]


class Box(Posed):
    """A block; its centre is at half its length, width and height."""

    rank = 3
    kind: Literal["box"] = "box"
    size: tuple[Edge, Edge, Edge] = parameter(
        (2.0, 1.0, 1.0),
        "[length, width, height], each from 1 mm to 1000 m; the length runs along the heading",
        "m",
        slider=(0.05, 10.0),
        log=True,
    )

    def shape(self) -> Shape:
        """Twelve triangles."""
        return Shape(triangles=block(self.size))
