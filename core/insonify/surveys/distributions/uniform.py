"""Numbers spread evenly between two bounds."""

from __future__ import annotations

from typing import Literal

from pydantic import model_validator

from insonify.scene.base import parameter
from insonify.surveys.distributions import DistributionKind


class Uniform(DistributionKind):
    """Numbers spread evenly between two bounds."""

    rank = 10
    kind: Literal["uniform"] = "uniform"
    low: float = parameter(description="least value")
    high: float = parameter(description="greatest value")

    @model_validator(mode="after")
    def _in_order(self) -> Uniform:
        if self.low > self.high:
            raise ValueError(f"low {self.low:g} is above high {self.high:g}; exchange them")
        return self

    def quantile(self, share: float) -> float:
        """Return the number at a share of the way from the least to the greatest."""
        return self.low + share * (self.high - self.low)
