"""Lognormal fluctuation."""

from __future__ import annotations

from typing import Literal

from insonify.scene.base import parameter
from insonify.scene.receiver.fluctuations import FluctuationKind, LevelStatistics


class Lognormal(FluctuationKind):
    """Levels of pings that fluctuate slowly, lognormal about the same mean intensity."""

    rank = 20
    kind: Literal["lognormal"] = "lognormal"
    level: float = parameter(
        1.5, unit="dB", description="standard deviation of the level", ge=0.0, le=20.0, slider=(0.0, 6.0)
    )
    correlation_time: float = parameter(
        1.0,
        unit="s",
        description="time after which the correlation is 1/e",
        gt=0.0,
        le=1e6,
        slider=(0.05, 100.0),
        log=True,
    )
    travel_time: float = parameter(
        0.0,
        unit="s",
        description="rms by which the water shifts a ping's echoes in time",
        ge=0.0,
        le=0.01,
        slider=(0.0, 1e-3),
    )

    @property
    def statistics(self) -> LevelStatistics:
        """Distribution of levels and delays."""
        return LevelStatistics(self.level, self.correlation_time, self.travel_time)
