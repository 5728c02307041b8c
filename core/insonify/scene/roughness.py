"""Roughness of real beds as their surveys describe it: spectra, an autocorrelation, a cascade."""

from __future__ import annotations

from itertools import pairwise
from typing import Annotated, Literal

from pydantic import Discriminator, Tag, field_validator

from insonify.scene.base import Choice, FilePath, kind_of, parameter
from insonify.scene.made import Made, MadeAnywhere, crest_heading, rms_height


class PowerLaw(MadeAnywhere):
    """Roughness W(K) = w₂ (h₀K)^−γ₂ with h₀ = 1 cm, as measured over sediments (APL-UW TR 9407, II.A)."""

    kind: Literal["power_law"] = "power_law"
    strength: float = parameter(
        0.0044,
        unit="cm⁴",
        description="spectral strength w₂ (fine sand 0.003, medium sand 0.0044, sandy gravel 0.013)",
        ge=0.0,
        le=100.0,
        slider=(1e-4, 0.1),
        log=True,
    )
    exponent: float = parameter(3.25, description="spectral exponent γ₂", gt=2.0, lt=4.0, slider=(2.4, 3.9))


class VonKarman(MadeAnywhere):
    """Lineated roughness that levels off at long waves (Goff and Jordan 1988)."""

    kind: Literal["von_karman"] = "von_karman"
    rms: float = rms_height()
    across: float = parameter(
        5.0,
        unit="m",
        description="wavelength across the crests beyond which the spectrum levels off, 2π/k_n",
        gt=0.0,
        le=1e6,
        slider=(0.5, 100.0),
        log=True,
    )
    along: float = parameter(
        15.0,
        unit="m",
        description="wavelength along the crests beyond which it levels off, 2π/k_s",
        gt=0.0,
        le=1e6,
        slider=(0.5, 100.0),
        log=True,
    )
    heading: float = crest_heading()
    hurst: float = parameter(
        0.8, description="exponent ν; the fractal dimension is 3 − ν", gt=0.0, le=3.0, slider=(0.1, 1.0)
    )


class Cascade(Made):
    """A multifractal: lognormal flux, cascading from the period down, integrated fractionally.

    Structure functions scale as ζ(q) = qH − C₁(q² − q) (Schertzer and Lovejoy 1987, α = 2).
    """

    kind: Literal["cascade"] = "cascade"
    rms: float = rms_height()
    intermittency: float = parameter(
        0.15, description="codimension C₁ of the mean flux; 0 is no multifractal", ge=0.0, le=1.0, slider=(0.0, 0.5)
    )
    hurst: float = parameter(
        0.7, description="order H of the fractional integration", gt=0.0, le=2.0, slider=(0.1, 1.0)
    )


class Exponential(Choice):
    """exp(−lag / length)."""

    kind: Literal["exponential"] = "exponential"
    length: float = parameter(
        1.0, unit="m", description="lag at which 1/e is left", gt=0.0, le=1e5, slider=(0.2, 20.0), log=True
    )


class Gaussian(Choice):
    """exp(−lag² / length²)."""

    kind: Literal["gaussian"] = "gaussian"
    length: float = parameter(
        1.0, unit="m", description="lag at which 1/e is left", gt=0.0, le=1e5, slider=(0.2, 20.0), log=True
    )


def _check_table(points: tuple[tuple[float, float], ...]) -> tuple[tuple[float, float], ...]:
    lags = [lag for lag, _ in points]
    if lags[0] != 0.0 or points[0][1] != 1.0:
        raise ValueError(f"must start at [0, 1], for heights correlate fully with themselves, not at {list(points[0])}")
    if any(after <= before for before, after in pairwise(lags)):
        raise ValueError("must have lags that grow from point to point; sort them")
    return points


class Table(Choice):
    """Straight lines between given points, 0 beyond the last."""

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


class TableFile(Choice):
    """Straight lines between the points of a file, 0 beyond the last."""

    kind: Literal["file"] = "file"
    path: FilePath = parameter(description="CSV with a column lag (m) and one autocorrelation, from 0, 1", min_length=1)


Correlation = Annotated[
    Annotated[Exponential, Tag("exponential")]
    | Annotated[Gaussian, Tag("gaussian")]
    | Annotated[Table, Tag("table")]
    | Annotated[TableFile, Tag("file")],
    Discriminator(lambda value: kind_of(value, "exponential")),
]


class Autocorrelated(MadeAnywhere):
    """Roughness of a given autocorrelation, the same in every direction (Wiener–Khinchin)."""

    kind: Literal["autocorrelation"] = "autocorrelation"
    rms: float = rms_height()
    function: Correlation = parameter(Exponential(), description="autocorrelation of the heights over the lag")
