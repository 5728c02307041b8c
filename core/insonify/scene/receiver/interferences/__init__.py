"""Interference of other sonars, one file a kind."""

from __future__ import annotations

from typing import NamedTuple

from insonify.scene.base import Choice
from insonify.scene.kinds import Family

INTERFERENCES = Family("interferences", "insonify.scene.receiver.interferences")


class ForeignPings(NamedTuple):
    """Pings of another sonar as they arrive: level (dB re 1 µPa or the source), rate (Hz) and duration (s)."""

    level: float
    rate: float
    duration: float


class InterferenceKind(Choice):
    """Pings of another sonar that are received."""

    family = INTERFERENCES

    @property
    def pings(self) -> ForeignPings | None:
        """Pings as they arrive; None where there is no other sonar."""
        return None
