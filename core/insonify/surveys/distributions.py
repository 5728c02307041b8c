"""Distributions from which a data set draws values: their base class and the kinds that come with the program."""

from abc import abstractmethod
from itertools import accumulate
from statistics import NormalDist
from typing import Annotated, Any, Self

from pydantic import BeforeValidator, TypeAdapter, ValidationError, model_validator

from insonify.scene.base import Family, Kind, KindOf, parameter
from insonify.scene.faults import describe_fault

DISTRIBUTIONS = Family("distributions")
MARK = "draw"  # key of a table that makes it a distribution; many scene fields have kinds of the same names


class DistributionKind(Kind):
    """Distribution of a value of a scene."""

    family = DISTRIBUTIONS

    @abstractmethod
    def quantile(self, share: float) -> Any:
        """Return the value below which a share of all draws lies, 0 < share < 1."""


def _as_distribution(value: Any) -> Any:
    """Read tables with the key ``draw``, also within others, as distributions; the rest is as it is in every scene."""
    if isinstance(value, list | tuple):
        return [_as_distribution(part) for part in value]
    if not (isinstance(value, dict) and MARK in value):
        return {name: _as_distribution(part) for name, part in value.items()} if isinstance(value, dict) else value
    fields = {"kind": value[MARK]} | {name: field for name, field in value.items() if name != MARK}
    kinds = DISTRIBUTIONS.models(DistributionKind)  # type: ignore[type-abstract]  # only the kinds are made
    if fields["kind"] not in kinds:
        raise ValueError(f"draw: {fields['kind']!r} is not a known distribution; choose one of {', '.join(kinds)}")
    try:
        made = TypeAdapter(Annotated[DistributionKind, KindOf(DISTRIBUTIONS)]).validate_python(fields)
    except ValidationError as error:
        raise ValueError(describe_fault(error, kinds[fields["kind"]])) from None
    return made


Drawn = Annotated[Any, BeforeValidator(_as_distribution)]


class BetweenBounds(DistributionKind):
    """Numbers between two bounds."""

    low: float = parameter(description="least value")
    high: float = parameter(description="greatest value")

    @model_validator(mode="after")
    def _in_order(self) -> Self:
        if self.low > self.high:
            raise ValueError(f"low {self.low:.15g} is above high {self.high:.15g}; swap them")
        return self


class Uniform(BetweenBounds, kind="uniform", rank=10):
    """Numbers spread evenly between two bounds."""

    def quantile(self, share: float) -> float:
        """Return the number at a share of the way from the least to the greatest."""
        return self.low + share * (self.high - self.low)


class LogUniform(BetweenBounds, kind="log_uniform", rank=20):
    """Positive numbers with a logarithm spread evenly between two bounds."""

    low: float = parameter(description="least value", gt=0.0)
    high: float = parameter(description="greatest value", gt=0.0)

    def quantile(self, share: float) -> float:
        """Return the number at a share of the ratio of the greatest to the least."""
        return float(self.low * (self.high / self.low) ** share)


class Normal(DistributionKind, kind="normal", rank=30):
    """Normally distributed numbers; those beyond the bounds are not drawn."""

    mean: float = parameter(description="mean before the cut")
    deviation: float = parameter(description="standard deviation before the cut", gt=0.0)
    low: float | None = parameter(None, "least value, none when left out")
    high: float | None = parameter(None, "greatest value, none when left out")

    @model_validator(mode="after")
    def _within_bounds(self) -> Self:
        low, high = self._shares
        if high - low < 1e-9:
            raise ValueError(
                f"almost no value of mean {self.mean:g} and deviation {self.deviation:g} lies between low and "
                "high; move them apart"
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


class OneOf(DistributionKind, kind="choice", rank=40):
    """One of several values: numbers, names or tables."""

    of: tuple[Drawn, ...] = parameter(description="the values, which may themselves be distributions", min_length=1)
    weights: tuple[float, ...] = parameter((), "how often each is drawn, in any unit; equally if left out")

    @model_validator(mode="after")
    def _a_weight_each(self) -> Self:
        if self.weights and len(self.weights) != len(self.of):
            raise ValueError(f"weights: there are {len(self.weights)} for {len(self.of)} values; give one for each")
        if self.weights and (min(self.weights) < 0.0 or sum(self.weights) == 0.0):
            raise ValueError("weights: must be 0 or more, and not all 0")
        return self

    def quantile(self, share: float) -> Any:
        """Return the first value up to which the weights add up to a share of all."""
        reached = list(accumulate(self.weights or [1.0] * len(self.of)))
        return self.of[sum(weight <= share * reached[-1] for weight in reached)]


class Integers(BetweenBounds, kind="integers", rank=50):
    """Whole numbers between two bounds, both included, equally often."""

    low: int = parameter(description="least value")
    high: int = parameter(description="greatest value")

    def quantile(self, share: float) -> int:
        """Return the whole number at a share of the way from the least to the greatest."""
        return self.low + int(share * (self.high - self.low + 1))
