"""Gain by a table."""

from __future__ import annotations

from itertools import pairwise
from typing import Annotated, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, field_validator

from insonify.scene.base import parameter
from insonify.scene.receiver.gains import GainKind, RangeBins

Place = Annotated[float, Field(ge=0.0, le=1e6)]
Gain = Annotated[float, Field(ge=-300.0, le=300.0)]


class TableTvg(GainKind):
    """Time-varied gain by a table, as a recorder's file or curve knob has it; it also amplifies noise."""

    rank = 30
    kind: Literal["table"] = "table"
    stops_at_noise = False
    by: Literal["time", "bin"] = parameter(
        "time", description="what the table counts: seconds after transmission, or bins from 0"
    )
    gains: tuple[tuple[Place, Gain], ...] = parameter(
        ((0.0, 0.0), (0.02, 30.0), (0.06, 50.0)),
        unit="dB",
        slider=(-20.0, 80.0),
        description="pairs [time or bin, gain], ascending; the first and last gains hold beyond",
        min_length=1,
        max_length=100_000,
    )
    interpolation: Literal["linear", "steps"] = parameter(
        "linear", description="straight lines between those gains, or each gain kept until the next"
    )

    @field_validator("gains")
    @classmethod
    def _ascending(cls, gains: tuple[tuple[float, float], ...]) -> tuple[tuple[float, float], ...]:
        if any(after[0] <= before[0] for before, after in pairwise(gains)):
            raise ValueError("must run in order of increasing time or bin; sort the pairs and drop doubles")
        return gains

    def decibels(self, bins: RangeBins, absorption: float) -> NDArray[np.float64]:
        """Gain in dB of the table."""
        del absorption
        at = bins.travel_time if self.by == "time" else bins.number
        places, gains = np.array(self.gains).T
        if self.interpolation == "linear":
            return np.interp(at, places, gains)
        return np.asarray(gains[np.maximum(np.searchsorted(places, at, side="right") - 1, 0)])
