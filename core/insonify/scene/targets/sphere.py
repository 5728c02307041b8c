"""Spheres."""

from __future__ import annotations

from typing import Literal

from insonify.scene.base import length
from insonify.scene.targets import LEAST, Posed
from insonify.scene.targets.shape import Shape, ball


class Sphere(Posed):
    """A sphere, which looks the same at any attitude."""

    rank = 2
    kind: Literal["sphere"] = "sphere"
    radius: float = length(0.5, "radius of the sphere", (0.05, 2.0), least=LEAST, most=100.0)

    def shape(self) -> Shape:
        """Return one ball."""
        return Shape((ball(self.radius),))

    @property
    def idle_fields(self) -> frozenset[str]:
        """Heading, pitch and roll, and the gap if z is given."""
        return super().idle_fields | {"heading", "pitch", "roll"}
