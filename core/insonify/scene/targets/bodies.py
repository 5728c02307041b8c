"""Spheres, boxes and cones."""

from typing import Annotated

import numpy as np
from pydantic import Field

from insonify.scene.base import metres, parameter
from insonify.scene.targets import LEAST, Posed
from insonify.scene.targets.shape import Shape, ball, block, frustum

Edge = Annotated[float, Field(ge=LEAST, le=1000.0)]


class Sphere(Posed, kind="sphere", rank=2):
    """A sphere, which looks the same at any attitude."""

    radius: float = metres(0.5, "radius of the sphere", (0.05, 2.0), least=LEAST, most=100.0)

    def shape(self) -> Shape:
        """Return one ball."""
        return Shape((ball(self.radius),))

    @property
    def idle_fields(self) -> frozenset[str]:
        """Heading, pitch and roll, and the gap if z is given."""
        return super().idle_fields | {"heading", "pitch", "roll"}


class Box(Posed, kind="box", rank=3):
    """A block; its centre is at half its length, width and height."""

    size: tuple[Edge, Edge, Edge] = parameter(
        (2.0, 1.0, 1.0),
        "[length, width, height], each from 1 mm to 1000 m; the length runs along the heading",
        "m",
        slider=(0.05, 10.0),
        log=True,
    )

    @property
    def sizes(self) -> dict[str, tuple[str, ...]]:
        """All sides; width and height; the height."""
        length, *across = (f"size.{side}" for side in range(3))
        return {"resize": (length, *across), "thicken": tuple(across), "raise": tuple(across[1:])}

    def shape(self) -> Shape:
        """Twelve triangles."""
        return Shape(triangles=block(self.size), closed=True)


class Cone(Posed, kind="cone", rank=4):
    """A cone, apex up when level; its centre is at half its height."""

    radius: float = metres(0.5, "radius of the base", (0.05, 2.0), least=LEAST, most=100.0)
    height: float = metres(1.0, "from the base to the apex", (0.05, 5.0), least=LEAST, most=1000.0)

    @property
    def sizes(self) -> dict[str, tuple[str, ...]]:
        """Radius and height; the height."""
        return super().sizes | {"thicken": ("height",)}

    def shape(self) -> Shape:
        """Return a frustum that ends in a point."""
        up = np.array([0.0, 0.0, self.height / 2.0])
        return Shape((frustum(-up, up, self.radius, 0.0),))
