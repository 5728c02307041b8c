"""Several reliefs on one bed."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import model_validator

from insonify.scene.base import parameter
from insonify.scene.kinds import KindOf
from insonify.scene.materials import MaterialMap
from insonify.scene.reliefs import RELIEFS, ReliefKind
from insonify.scene.reliefs.random_relief import RandomRelief


class SumOfReliefs(ReliefKind):
    """Several reliefs on one bed, independent of one another."""

    rank = 80
    kind: Literal["sum"] = "sum"
    of: tuple[Annotated[RandomRelief, KindOf(RELIEFS, RandomRelief, default="fractal")], ...] = parameter(
        description="the reliefs; all repeat after the same period, or none does", min_length=1, max_length=16
    )

    @model_validator(mode="after")
    def _parts_repeat_together(self) -> SumOfReliefs:
        first = self.of[0]
        for part in self.of[1:]:
            if part.period != first.period:
                raise ValueError(
                    f"of repeats after {first.period:g} m in one part and after {part.period:g} m in another; "
                    "give all the same period"
                )
            if part.endless != first.endless:
                raise ValueError("of is endless in one part and repeats in another; give all the same extent")
        return self

    @property
    def parts(self) -> tuple[RandomRelief, ...]:
        """The reliefs."""
        return self.of

    def check(self, spacing: float, material: MaterialMap) -> None:
        """Refuse what any of the reliefs refuses."""
        for part in self.of:
            part.check(spacing, material)
