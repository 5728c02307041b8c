"""Autocorrelation by points."""

from __future__ import annotations

import math
from functools import lru_cache
from itertools import pairwise
from typing import Literal

import numpy as np
from pydantic import field_validator

from insonify.errors import SceneError
from insonify.scene.base import parameter
from insonify.scene.seabed.autocorrelations import AutocorrelationKind
from insonify.scene.seabed.reliefs.spectrum import Density, Field

TABLED = 4096  # wave numbers at which a tabulated autocorrelation is transformed
NEGATIVE = 0.1  # share of the power that no surface could have and that is left out
Points = tuple[tuple[float, float], ...]


def _check_table(points: tuple[tuple[float, float], ...]) -> tuple[tuple[float, float], ...]:
    lags = [lag for lag, _ in points]
    if lags[0] != 0.0 or points[0][1] != 1.0:
        raise ValueError(f"must start at [0, 1], for heights correlate fully with themselves, not at {list(points[0])}")
    if any(after <= before for before, after in pairwise(lags)):
        raise ValueError("must have lags that grow from point to point; sort them")
    return points


class TabledAutocorrelation(AutocorrelationKind):
    """Autocorrelation by straight lines between given points, 0 beyond the last."""

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

    @property
    def feature(self) -> float:
        """Frequency over which the spectrum changes, from how far the autocorrelation reaches."""
        return feature_of_points(self.points)

    def density(self, variance: float) -> Density:
        """Spectral density of straight lines between the points."""
        return density_of_points(self.points, variance)


def feature_of_points(points: Points) -> float:
    """Frequency over which the spectrum of a tabulated autocorrelation changes, cycles a metre."""
    return 0.5 / points[-1][0]


def density_of_points(points: Points, variance: float) -> Density:
    """Spectral density of straight lines between points of an autocorrelation."""
    wave, power = tabulate_spectrum(points)

    def density(fx: Field, fy: Field) -> Field:
        # Beyond the table it goes on as k⁻³, as that of anything with corners does on the average.
        k = 2.0 * math.pi * np.hypot(fx, fy)
        beyond = np.maximum(k / wave[-1], 1.0)
        return np.asarray(variance * np.interp(k, wave, power) * beyond**-3.0)

    return density


@lru_cache(maxsize=4)
def tabulate_spectrum(points: Points) -> tuple[Field, Field]:
    """Wave numbers, and the transform there of straight lines between points of an autocorrelation."""
    from scipy.special import itj0y0, j0, j1

    lag, value = np.array(points).T
    slope = np.diff(value) / np.diff(lag)
    wave = np.geomspace(1e-3 / lag[-1], 200.0 / np.diff(lag).min(), TABLED)
    # By parts: ∫ρ J₀(kr) r dr = ρ r J₁(kr)/k − ρ' ∫ r J₁(kr) dr / k, and ∫ r J₁(kr) dr = (∫J₀(x)dx / k − r J₀(kr)) / k.
    kr = wave[:, np.newaxis] * lag
    part = (itj0y0(kr)[0] / wave[:, np.newaxis] - lag * j0(kr)) / wave[:, np.newaxis]
    power = 2.0 * math.pi / wave * (value[-1] * lag[-1] * j1(kr[:, -1]) - np.diff(part, axis=1) @ slope)
    # Where a wave is far longer than every lag, the terms cancel; there the power is level.
    level = wave * lag[-1] < 0.05
    power[level] = power[~level][0]
    held = np.gradient(wave) * wave * power
    lost = -held[held < 0.0].sum() / np.abs(held).sum()
    if lost > NEGATIVE:
        raise SceneError(
            f"seabed.relief.function: {100 * lost:.0f} % of the power of this autocorrelation would be negative, as no "
            "surface has it; let it fall more smoothly, steepest at lag 0"
        )
    return wave, np.maximum(power, 0.0)
