"""Waters given by their properties at depths."""

from __future__ import annotations

import itertools
from typing import Annotated, Any, Literal

from pydantic import Field, field_validator

from insonify.scene.base import parameter
from insonify.scene.water import WaterKind

# A summer thermocline, the default of layered waters.
DEPTHS = (0.0, 8.0, 16.0, 60.0)
SPEEDS = (1520.0, 1519.0, 1501.0, 1500.0)
MOST = 10_000  # points of a profile
Interpolation = Literal["linear", "pchip"]
Equation = Literal["paper", "mackenzie", "teos10"]
Depth = Annotated[float, Field(ge=0.0, le=12000.0)]
Speed = Annotated[float, Field(ge=1300.0, le=1700.0)]


class LayeredWater(WaterKind):
    """Water of properties given at depths, constant above the first and below the last."""

    depth: tuple[Depth, ...] = parameter(
        DEPTHS, "depths at which the properties are given, downwards", "m", slider=(0.0, 100.0)
    )

    @field_validator("depth")
    @classmethod
    def _goes_downwards(cls, depth: tuple[float, ...]) -> tuple[float, ...]:
        check_order("depth", depth, "for one sound speed use kind 'uniform'")
        return depth


def interpolation() -> Any:
    """Declare how a sound speed is interpolated between depths."""
    return parameter("linear", "between the depths: straight, or a smooth curve that never overshoots", rare=True)


def check_order(what: str, places: tuple[float, ...], instead: str) -> None:
    """Raise ValueError for places that do not increase."""
    if not 2 <= len(places) <= MOST:
        raise ValueError(f"must have from 2 to {MOST} points, not {len(places)}; {instead}")
    for before, after in itertools.pairwise(places):
        if after <= before:
            fault = f"has {before:g} m twice" if after == before else f"goes from {before:g} back to {after:g} m"
            raise ValueError(f"must increase, but {what} {fault}; sort it upwards, each number once")


def check_length(what: str, count: int, depth: tuple[float, ...]) -> None:
    """Raise ValueError for a column without exactly one value for each depth."""
    if count != len(depth):
        numbers = f"{count} number{'s' * (count != 1)}"
        raise ValueError(f"{what} has {numbers} for {len(depth)} depths; give one for each depth")
