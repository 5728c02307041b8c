"""Whole numbers between two bounds."""

from __future__ import annotations

from typing import Literal

from pydantic import model_validator

from insonify.scene.base import parameter
from insonify.surveys.distributions import DistributionKind


class Integers(DistributionKind):
    """Whole numbers between two bounds, both included, equally often."""

    rank = 50
    kind: Literal["integers"] = "integers"
    low: int = parameter(description="least value")
    high: int = parameter(description="greatest value")

    @model_validator(mode="after")
    def _in_order(self) -> Integers:
        if self.low > self.high:
            raise ValueError(f"low {self.low} is above high {self.high}; exchange them")
        return self

    def quantile(self, share: float) -> int:
        """Return the whole number at a share of the way from the least to the greatest."""
        return self.low + int(share * (self.high - self.low + 1))
