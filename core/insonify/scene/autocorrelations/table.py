"""Autocorrelation by points."""

from __future__ import annotations

from itertools import pairwise
from typing import Literal

from pydantic import field_validator

from insonify.scene.autocorrelations import AutocorrelationKind
from insonify.scene.base import parameter


def _check_table(points: tuple[tuple[float, float], ...]) -> tuple[tuple[float, float], ...]:
    lags = [lag for lag, _ in points]
    if lags[0] != 0.0 or points[0][1] != 1.0:
        raise ValueError(f"must start at [0, 1], for heights correlate fully with themselves, not at {list(points[0])}")
    if any(after <= before for before, after in pairwise(lags)):
        raise ValueError("must have lags that grow from point to point; sort them")
    return points


class TabledAutocorrelation(AutocorrelationKind):
    """Straight lines between given points, 0 beyond the last."""

    rank = 30
    kind: Literal["table"] = "table"
    points: tuple[tuple[float, float], ...] = parameter(
        ((0.0, 1.0), (0.5, 0.5), (1.0, 0.2), (2.0, 0.0)),
        description="points [lag in m, autocorrelation] from [0, 1]",
        min_length=2,
        max_length=4096,
    )

    @field_validator("points")
    @classmethod
    def _ordered(cls, points: tuple[tuple[float, float], ...]) -> tuple[tuple[float, float], ...]:
        return _check_table(points)
