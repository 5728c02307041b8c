"""Distributions from which a data set draws values."""

from abc import abstractmethod
from typing import Annotated, Any

from pydantic import BeforeValidator, TypeAdapter, ValidationError

from insonify.scene.base import Family, Kind, KindOf
from insonify.scene.faults import describe_fault

DISTRIBUTIONS = Family("distributions", "insonify.surveys.distributions")
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
