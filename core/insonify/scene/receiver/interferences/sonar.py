"""Interference of one other sonar."""

from __future__ import annotations

from typing import Literal

from insonify.scene.base import parameter
from insonify.scene.receiver.interferences import ForeignPings, InterferenceKind


class OtherSonar(InterferenceKind):
    """Another sonar that pings at a rate of its own: its pings cross the record as slanting rows of dashes."""

    rank = 20
    kind: Literal["sonar"] = "sonar"
    level: float = parameter(
        -60.0,
        unit="dB",
        description="level of its pings as received, dB re the source at 1 m, or re 1 µPa with a source level",
        ge=-300.0,
        le=250.0,
        slider=(-120.0, 180.0),
    )
    ping_rate: float = parameter(
        7.3, unit="Hz", description="its pings per second", ge=1e-3, le=1e4, slider=(0.5, 50.0), log=True
    )
    duration: float = parameter(
        1e-3, unit="s", description="duration of each of its pings", gt=0.0, le=10.0, slider=(1e-5, 1e-2), log=True
    )

    @property
    def pings(self) -> ForeignPings:
        """Pings as they arrive."""
        return ForeignPings(self.level, self.ping_rate, self.duration)
