"""Cones."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Literal

import numpy as np

from insonify.scene.base import parameter
from insonify.scene.targets.base import LEAST, Posed
from insonify.scene.targets.shape import Shape, frustum
from insonify.scene.targets.sides import FRONT, SLIGHT, Side, Sight, disc, dot

AROUND = 12  # lines of a cone that stand for all of it


class Cone(Posed):
    """A cone, apex up when level; its centre is at half its height."""

    rank = 4
    combed = 0.12
    kind: Literal["cone"] = "cone"
    radius: float = parameter(
        0.5, unit="m", description="radius of the base", ge=LEAST, le=100.0, slider=(0.05, 2.0), log=True
    )
    height: float = parameter(
        1.0, unit="m", description="from the base to the apex", ge=LEAST, le=1000.0, slider=(0.05, 5.0), log=True
    )

    def shape(self) -> Shape:
        """One frustum that ends in a point."""
        up = np.array([0.0, 0.0, self.height / 2.0])
        return Shape((frustum(-up, up, self.radius, 0.0),))

    def sides(self, sight: Sight) -> Iterator[Side]:
        """Yield the diffuse mantle, the glint of the line that faces the sonar most, and the base."""
        of, axis, n = self.material.reflectivity, sight.top, self.material.reflectivity.shininess
        slant = math.hypot(self.radius, self.height)
        outwards, upwards = self.height / slant, self.radius / slant
        ahead = min(max(dot(axis, sight.towards), -1.0), 1.0)
        off = math.sqrt(1.0 - ahead * ahead)
        area = math.pi * self.radius * slant
        angles = (2.0 * math.pi * (k + 0.5) / AROUND for k in range(AROUND))
        cosines = (outwards * off * math.cos(angle) + upwards * ahead for angle in angles)
        diffuse = of.diffuse * sum(max(cosine, 0.0) ** 2 for cosine in cosines) / AROUND
        yield Side(diffuse * area, sight.along, sight.half_depth * FRONT, 0.5 * sight.half_depth)
        # Incidence on the line that faces the sonar most, and how far to either hand of it the lobe goes.
        incidence = math.atan2(off, ahead) - math.atan2(outwards, upwards)
        around = min(math.sqrt(0.125 / (math.pi * n * max(outwards * off, SLIGHT))), 1.0)
        lobe = 0.5 * (n + 2.0) * of.specular * math.exp(-2.0 * n * incidence * incidence)
        glint = max(2.5 * self.radius / math.sqrt(n), abs(axis[0]) * self.height)
        yield Side(lobe * area * around, min(glint, sight.along), 0.0, 0.3 * sight.half_depth)
        yield disc(self.radius, of, axis, -ahead)
