"""Cones."""

from __future__ import annotations

from typing import Literal

import numpy as np

from insonify.scene.base import length
from insonify.scene.targets import LEAST, Posed
from insonify.scene.targets.shape import Shape, frustum


class Cone(Posed):
    """A cone, apex up when level; its centre is at half its height."""

    rank = 4
    kind: Literal["cone"] = "cone"
    radius: float = length(0.5, "radius of the base", (0.05, 2.0), least=LEAST, most=100.0)
    height: float = length(1.0, "from the base to the apex", (0.05, 5.0), least=LEAST, most=1000.0)

    def shape(self) -> Shape:
        """Return a frustum that ends in a point."""
        up = np.array([0.0, 0.0, self.height / 2.0])
        return Shape((frustum(-up, up, self.radius, 0.0),))
