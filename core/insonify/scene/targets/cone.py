"""Cones."""

from __future__ import annotations

from typing import Literal

import numpy as np

from insonify.scene.base import parameter
from insonify.scene.targets import LEAST, Posed
from insonify.scene.targets.shape import Shape, frustum


class Cone(Posed):
    """A cone, apex up when level; its centre is at half its height."""

    rank = 4
    kind: Literal["cone"] = "cone"
    radius: float = parameter(
        0.5, unit="m", description="radius of the base", ge=LEAST, le=100.0, slider=(0.05, 2.0), log=True
    )
    height: float = parameter(
        1.0, unit="m", description="from the base to the apex", ge=LEAST, le=1000.0, slider=(0.05, 5.0), log=True
    )

    def shape(self) -> Shape:
        """Return a frustum that ends in a point."""
        up = np.array([0.0, 0.0, self.height / 2.0])
        return Shape((frustum(-up, up, self.radius, 0.0),))
