"""Reverberation of the water and the sea surface."""

from typing import Any, Literal

from insonify.scene.base import Family, Kind, parameter

REVERBERATIONS = Family("reverberations", "insonify.scene.receiver")


class ReverberationKind(Kind):
    """Echoes of the water and its surface."""

    family = REVERBERATIONS

    @property
    def echoes(self) -> bool:
        """Whether the water or its surface echoes."""
        return self.of_volume is not None or self.of_surface is not None

    @property
    def of_volume(self) -> float | None:
        """Backscattering strength of a cubic metre of water, in dB; None where it does not echo."""
        return getattr(self, "volume_strength", None)

    @property
    def of_surface(self) -> float | None:
        """Backscattering strength of a square metre of the sea surface, in dB; None where it does not echo."""
        return getattr(self, "surface_strength", None)


def _volume_strength() -> Any:
    return parameter(
        -70.0, "backscattering strength of a cubic metre of water", "dB", ge=-200.0, le=0.0, slider=(-100.0, -40.0)
    )


def _surface_strength() -> Any:
    return parameter(
        -30.0,
        "backscattering strength of a square metre of the sea surface",
        "dB",
        ge=-200.0,
        le=10.0,
        slider=(-60.0, 0.0),
    )


class NoReverberation(ReverberationKind):
    """No reverberation: only the bed and the targets echo."""

    rank = 10
    kind: Literal["none"] = "none"


class VolumeReverberation(ReverberationKind):
    """Volume reverberation: the water echoes."""

    rank = 20
    kind: Literal["volume"] = "volume"
    volume_strength: float = _volume_strength()


class SurfaceReverberation(ReverberationKind):
    """Surface reverberation: the sea surface echoes."""

    rank = 30
    kind: Literal["surface"] = "surface"
    surface_strength: float = _surface_strength()


class WholeReverberation(ReverberationKind):
    """Volume and surface reverberation."""

    rank = 40
    kind: Literal["both"] = "both"
    volume_strength: float = _volume_strength()
    surface_strength: float = _surface_strength()
