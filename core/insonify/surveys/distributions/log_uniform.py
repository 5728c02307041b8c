"""Positive numbers with a logarithm spread evenly between two bounds."""

from __future__ import annotations

from typing import Literal

from pydantic import model_validator

from insonify.scene.base import parameter
from insonify.surveys.distributions import DistributionKind


class LogUniform(DistributionKind):
    """Positive numbers with a logarithm spread evenly between two bounds."""

    rank = 20
    kind: Literal["log_uniform"] = "log_uniform"
    low: float = parameter(description="least value", gt=0.0)
    high: float = parameter(description="greatest value", gt=0.0)

    @model_validator(mode="after")
    def _in_order(self) -> LogUniform:
        if self.low > self.high:
            raise ValueError(f"low {self.low:g} is above high {self.high:g}; exchange them")
        return self

    def quantile(self, share: float) -> float:
        """Return the number at a share of the ratio of the greatest to the least."""
        return float(self.low * (self.high / self.low) ** share)
