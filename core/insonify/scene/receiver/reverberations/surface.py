"""Surface reverberation."""

from __future__ import annotations

from typing import Literal

from insonify.scene.base import parameter
from insonify.scene.receiver.reverberations import ReverberationKind


def surface_strength() -> float:
    """Declare the backscattering strength of the sea surface."""
    return parameter(
        -30.0,
        unit="dB",
        description="backscattering strength of a square metre of the sea surface",
        ge=-200.0,
        le=10.0,
        slider=(-60.0, 0.0),
    )


class SurfaceReverberation(ReverberationKind):
    """Surface reverberation: the sea surface echoes."""

    rank = 30
    kind: Literal["surface"] = "surface"
    surface_strength: float = surface_strength()

    @property
    def of_surface(self) -> float:
        """Backscattering strength of a square metre of the sea surface, in dB."""
        return self.surface_strength
