"""Normally distributed numbers, cut off at bounds."""

from __future__ import annotations

from statistics import NormalDist
from typing import Literal

from pydantic import model_validator

from insonify.scene.base import parameter
from insonify.surveys.distributions import DistributionKind


class Normal(DistributionKind):
    """Normally distributed numbers; those beyond the bounds are not drawn."""

    rank = 30
    kind: Literal["normal"] = "normal"
    mean: float = parameter(description="mean before the cut")
    deviation: float = parameter(description="standard deviation before the cut", gt=0.0)
    low: float | None = parameter(None, "least value, none when left out")
    high: float | None = parameter(None, "greatest value, none when left out")

    @model_validator(mode="after")
    def _within_bounds(self) -> Normal:
        low, high = self._shares
        if high - low < 1e-9:
            raise ValueError(
                f"low and high leave next to nothing of a mean of {self.mean:g} and a deviation of "
                f"{self.deviation:g}; move them apart"
            )
        return self

    @property
    def _shares(self) -> tuple[float, float]:
        """Shares of the whole distribution below the bounds."""
        whole = NormalDist(self.mean, self.deviation)
        return 0.0 if self.low is None else whole.cdf(self.low), 1.0 if self.high is None else whole.cdf(self.high)

    def quantile(self, share: float) -> float:
        """Return the number below which a share of what lies between the bounds lies."""
        low, high = self._shares
        within = min(max(low + share * (high - low), 1e-300), 1.0 - 1e-16)
        return NormalDist(self.mean, self.deviation).inv_cdf(within)
