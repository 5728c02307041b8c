"""One of several values."""

from __future__ import annotations

from itertools import accumulate
from typing import Any, Literal

from pydantic import model_validator

from insonify.scene.base import parameter
from insonify.surveys.distributions import DistributionKind, Drawn


class OneOf(DistributionKind):
    """One of several values: numbers, names or tables."""

    rank = 40
    kind: Literal["choice"] = "choice"
    of: tuple[Drawn, ...] = parameter(description="the values, which may hold distributions", min_length=1)
    weights: tuple[float, ...] = parameter((), "how often each is drawn, in any unit; equally if left out")

    @model_validator(mode="after")
    def _a_weight_each(self) -> OneOf:
        if self.weights and len(self.weights) != len(self.of):
            raise ValueError(f"weights: there are {len(self.weights)} for {len(self.of)} values; give one for each")
        if self.weights and (min(self.weights) < 0.0 or sum(self.weights) == 0.0):
            raise ValueError("weights: must be 0 or more, and not all 0")
        return self

    def quantile(self, share: float) -> Any:
        """Return the first value up to which the weights add up to a share of all."""
        reached = list(accumulate(self.weights or [1.0] * len(self.of)))
        return self.of[sum(weight <= share * reached[-1] for weight in reached)]
