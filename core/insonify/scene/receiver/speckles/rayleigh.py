"""Fully developed speckle."""

from __future__ import annotations

from typing import Literal

from insonify.scene.base import parameter
from insonify.scene.receiver.speckles import SpeckleKind


class Rayleigh(SpeckleKind):
    """Fully developed speckle: the intensity of every bin is exponential about its mean."""

    rank = 20
    kind: Literal["rayleigh"] = "rayleigh"
    looks: int = parameter(1, description="independent records averaged", ge=1, le=64, slider=(1, 16), log=True)

    @property
    def independent_records(self) -> int:
        """Number of independent records that are averaged."""
        return self.looks
