"""A given absorption."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import model_validator

from insonify.scene.base import parameter
from insonify.scene.water.absorptions import AbsorptionKind


class ConstantAbsorption(AbsorptionKind):
    """A given absorption; a bare number of dB/km stands for it."""

    rank = 20
    by_frequency = False
    kind: Literal["constant"] = "constant"
    coefficient: float = parameter(
        30.0, unit="dB/km", description="absorption, one way", ge=0.0, le=1e5, slider=(0.0, 500.0)
    )

    @model_validator(mode="before")
    @classmethod
    def _name_alone(cls, value: Any) -> Any:
        return {"coefficient": value} if isinstance(value, (int, float)) else value

    def decibels_per_km(self, frequency: float, depth: float) -> float:
        """Absorption one way, in dB/km: the given one at every frequency and depth."""
        del frequency, depth
        return self.coefficient
