"""Waters given by their properties at depths."""

from __future__ import annotations

import itertools
from typing import Annotated, Literal

from pydantic import Field, field_validator

from insonify.scene.base import parameter
from insonify.scene.water import WaterKind

# A summer thermocline, for waters that are chosen before their numbers are known.
DEPTHS = (0.0, 8.0, 16.0, 60.0)
SPEEDS = (1520.0, 1519.0, 1501.0, 1500.0)
MOST = 10_000  # points of a profile
Interpolation = Literal["linear", "pchip"]
Equation = Literal["paper", "mackenzie", "teos10"]


Depth = Annotated[float, Field(ge=0.0, le=12000.0)]


Speed = Annotated[float, Field(ge=1300.0, le=1700.0)]


class LayeredWater(WaterKind):
    """Water whose properties are given at depths and constant above the first and below the last."""

    depth: tuple[Depth, ...] = parameter(
        DEPTHS, unit="m", description="depths at which the water is known, downwards", slider=(0.0, 100.0)
    )

    @field_validator("depth")
    @classmethod
    def _goes_downwards(cls, depth: tuple[float, ...]) -> tuple[float, ...]:
        check_order("depth", depth, "water of one speed is kind 'uniform'")
        return depth


def check_order(what: str, places: tuple[float, ...], instead: str) -> None:
    """Raise an error for places that do not increase, between which nothing can be interpolated."""
    if not 2 <= len(places) <= MOST:
        raise ValueError(f"must have from 2 to {MOST} points, not {len(places)}; {instead}")
    for before, after in itertools.pairwise(places):
        if after <= before:
            fault = f"has {before:g} m twice" if after == before else f"goes from {before:g} back to {after:g} m"
            raise ValueError(f"is no {what} to go along: it {fault}; sort it upwards, each number once")


def check_length(what: str, count: int, depth: tuple[float, ...]) -> None:
    """Raise an error for a column without exactly one value for each depth."""
    if count != len(depth):
        numbers = f"{count} number{'s' * (count != 1)}"
        raise ValueError(f"{what} has {numbers} for {len(depth)} depths; give one for each depth")
