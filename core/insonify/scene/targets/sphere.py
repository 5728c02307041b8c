"""Spheres."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Literal

from insonify.scene.base import parameter
from insonify.scene.targets.base import LEAST, Posed
from insonify.scene.targets.shape import Shape, ball
from insonify.scene.targets.sides import FRONT, Side, Sight


class Sphere(Posed):
    """A ball; it takes the attitude that all targets take, and looks alike in any."""

    rank = 2
    combed = 0.09
    kind: Literal["sphere"] = "sphere"
    radius: float = parameter(0.5, unit="m", description="radius", ge=LEAST, le=100.0, slider=(0.05, 2.0), log=True)

    def shape(self) -> Shape:
        """Return one ball."""
        return Shape((ball(self.radius),))

    @property
    def idle_fields(self) -> frozenset[str]:
        """Heading, pitch and roll, and the gap where z is given."""
        return super().idle_fields | {"heading", "pitch", "roll"}

    def sides(self, sight: Sight) -> Iterator[Side]:
        """Yield the diffuse front and the glint in its middle."""
        of, radius = self.material.reflectivity, self.radius
        yield Side(2.0 / 3.0 * math.pi * radius**2 * of.diffuse, 2.0 * radius, radius * FRONT, 0.5 * radius)
        # cosⁿ 2α falls as exp(−2nα²) about the place that faces the sonar.
        lobe = 0.25 * math.pi * radius**2 * of.specular * (of.shininess + 2.0) / of.shininess
        yield Side(lobe, min(2.5 * radius / math.sqrt(of.shininess), 2.0 * radius), 0.0, 0.0)
