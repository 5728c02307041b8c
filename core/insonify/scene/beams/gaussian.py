"""A bell-shaped beam."""

from __future__ import annotations

from typing import Literal

from insonify.scene.base import parameter
from insonify.scene.beams.aimed import AimedBeam


class GaussianBeam(AimedBeam):
    """A bell-shaped beam without sidelobes."""

    rank = 30
    kind: Literal["gaussian"] = "gaussian"
    width: float = parameter(
        1.0, unit="°", description="one-way full beamwidth to -3 dB", ge=1e-3, le=60.0, slider=(0.1, 10.0), log=True
    )
    two_way: bool = parameter(True, description="whether sound passes the beam going and coming, or once")

    @property
    def words(self) -> str:
        """Name of the beam for captions."""
        return self._named(f"gaussian {self.width:g}° {'two' if self.two_way else 'one'}-way")
