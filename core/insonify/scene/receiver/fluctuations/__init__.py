"""Fluctuations of the received level, one file a kind."""

from __future__ import annotations

from typing import NamedTuple

from insonify.scene.base import Choice
from insonify.scene.kinds import Family

FLUCTUATIONS = Family("fluctuations", "insonify.scene.receiver.fluctuations")


class LevelStatistics(NamedTuple):
    """Lognormal levels and normal delays: standard deviations (dB, s) and the time (s) after which 1/e is left."""

    level: float
    correlation_time: float
    travel_time: float


class FluctuationKind(Choice):
    """Variation of the received level from ping to ping."""

    family = FLUCTUATIONS

    @property
    def statistics(self) -> LevelStatistics | None:
        """Distribution of levels and delays; None where pings do not vary."""
        return None
