"""Autocorrelations of heights: of a correlation length, and by points that are declared or read from a file."""

import math
from abc import abstractmethod
from functools import lru_cache

import numpy as np
from pydantic import ValidationError, field_validator

from insonify.arrays import Floats
from insonify.errors import SceneError
from insonify.files import kept_until_changed
from insonify.io.file_access import guarded, read_text
from insonify.scene.base import Family, FilePath, Kind, check_increasing, metres, parameter
from insonify.scene.seabed.reliefs.spectrum import Density

AUTOCORRELATIONS = Family("autocorrelations", "insonify.scene.seabed")
TABLED = 4096  # wave numbers at which a tabulated autocorrelation is transformed
NEGATIVE = 0.1  # greatest share of negative power, which no surface can have and which is set to 0
Points = tuple[tuple[float, float], ...]


class AutocorrelationKind(Kind):
    """Autocorrelation of heights over the lag."""

    family = AUTOCORRELATIONS

    @property
    @abstractmethod
    def feature(self) -> float:
        """Width of the narrowest feature of the spectrum, in cycles per metre."""

    @abstractmethod
    def density(self, variance: float) -> Density:
        """Spectral density of heights of that variance (m²): P(k) = h² 2π ∫ ρ(r) J₀(kr) r dr (Wiener–Khinchin)."""


class LengthAutocorrelation(AutocorrelationKind):
    """Autocorrelation given by its correlation length."""

    length: float = metres(1.0, "lag at which the autocorrelation is 1/e", (0.2, 20.0), most=1e5)

    @property
    def feature(self) -> float:
        """Width of the narrowest feature of the spectrum, in cycles per metre."""
        return 1.0 / (2.0 * math.pi * self.length)

    def squared_phase(self, fx: Floats, fy: Floats) -> Floats:
        """Squared product (k length)² of wave number and length, for waves in cycles per metre."""
        return np.asarray((2.0 * math.pi * self.length) ** 2 * (fx**2 + fy**2))


class ExponentialAutocorrelation(LengthAutocorrelation, kind="exponential", rank=10):
    """Exponential autocorrelation, exp(−lag / length)."""

    def density(self, variance: float) -> Density:
        """Spectral density 2π h² l² (1 + k² l²)^−3/2."""
        return lambda fx, fy: np.asarray(
            variance * 2.0 * math.pi * self.length**2 * (1.0 + self.squared_phase(fx, fy)) ** -1.5
        )


class GaussianAutocorrelation(LengthAutocorrelation, kind="gaussian", rank=20):
    """Gaussian autocorrelation, exp(−lag² / length²)."""

    def density(self, variance: float) -> Density:
        """Spectral density π h² l² exp(−k² l²/4)."""
        return lambda fx, fy: np.asarray(
            variance * math.pi * self.length**2 * np.exp(-0.25 * self.squared_phase(fx, fy))
        )


class LinearAutocorrelation(AutocorrelationKind):
    """Autocorrelation interpolated linearly between points, 0 beyond the last."""

    @abstractmethod
    def tabulated(self) -> Points:
        """Points of lag (m) and autocorrelation."""

    @property
    def feature(self) -> float:
        """Width of the narrowest feature of the spectrum, in cycles per metre, from the last lag."""
        return 0.5 / self.tabulated()[-1][0]

    def density(self, variance: float) -> Density:
        """Spectral density of heights of that variance (m²), by the transform of the points."""
        wave, power = tabulate_spectrum(self.tabulated())

        def density(fx: Floats, fy: Floats) -> Floats:
            # Beyond the table it falls as k⁻³, the mean trend of a function with corners.
            k = 2.0 * math.pi * np.hypot(fx, fy)
            beyond = np.maximum(k / wave[-1], 1.0)
            return np.asarray(variance * np.interp(k, wave, power) * beyond**-3.0)

        return density


class TabledAutocorrelation(LinearAutocorrelation, kind="table", rank=30):
    """Autocorrelation interpolated linearly between given points, 0 beyond the last."""

    points: tuple[tuple[float, float], ...] = parameter(
        ((0.0, 1.0), (0.5, 0.5), (1.0, 0.2), (2.0, 0.0)),
        "points [lag in m, autocorrelation] from [0, 1]",
        min_length=2,
        max_length=4096,
    )

    @field_validator("points")
    @classmethod
    def _ordered(cls, points: Points) -> Points:
        if points[0] != (0.0, 1.0):
            raise ValueError(f"must start at [0, 1], full correlation at lag 0, not at {list(points[0])}")
        checked: Points = check_increasing("lag", points)
        return checked

    def tabulated(self) -> Points:
        """Return the declared points."""
        return self.points


@lru_cache(maxsize=4)
def tabulate_spectrum(points: Points) -> tuple[Floats, Floats]:
    """Wave numbers, and the spectrum there of an autocorrelation that is linear between points."""
    from scipy.special import itj0y0, j0, j1  # lazy: SciPy takes longer to import than a scene to read

    lag, value = np.array(points).T
    slope = np.diff(value) / np.diff(lag)
    wave = np.geomspace(1e-3 / lag[-1], 200.0 / np.diff(lag).min(), TABLED)
    # By parts: ∫ρ J₀(kr) r dr = ρ r J₁(kr)/k − ρ' ∫ r J₁(kr) dr / k, and ∫ r J₁(kr) dr = (∫J₀(x)dx / k − r J₀(kr)) / k.
    kr = wave[:, np.newaxis] * lag
    part = (itj0y0(kr)[0] / wave[:, np.newaxis] - lag * j0(kr)) / wave[:, np.newaxis]
    power = 2.0 * math.pi / wave * (value[-1] * lag[-1] * j1(kr[:, -1]) - np.diff(part, axis=1) @ slope)
    # For waves far longer than every lag the terms cancel; there the power is constant.
    level = wave * lag[-1] < 0.05
    power[level] = power[~level][0]
    variance = np.gradient(wave) * wave * power
    lost = -variance[variance < 0.0].sum() / np.abs(variance).sum()
    if lost > NEGATIVE:
        raise SceneError(
            f"seabed.relief.function: {100 * lost:.0f} % of the power of this autocorrelation would be negative, which "
            "no surface can have; let it fall more smoothly, steepest at lag 0"
        )
    return wave, np.maximum(power, 0.0)


class AutocorrelationFile(LinearAutocorrelation, kind="file", rank=40):
    """Autocorrelation interpolated linearly between the points of a file, 0 beyond the last."""

    path: FilePath = parameter(description="CSV with a column lag (m) and one autocorrelation, from 0, 1", min_length=1)

    def tabulated(self) -> Points:
        """Read the points of the file."""
        return read_autocorrelation(self.path)


@kept_until_changed(maxsize=4)
def read_autocorrelation(path: str) -> Points:
    """Read the points of an autocorrelation from a CSV file."""
    with guarded(lambda fault, remedy: _refusal(path, fault), ""):
        rows = np.genfromtxt(read_text(path).splitlines(), delimiter=",", comments="#", dtype=np.float64, ndmin=2)
    # genfromtxt reads a line of names as NaN.
    rows = rows[1:] if len(rows) and np.isnan(rows[0]).all() else rows
    if rows.shape[1] != 2 or not np.isfinite(rows).all():
        raise _refusal(path, "is not two columns of numbers")
    try:
        return TabledAutocorrelation(points=tuple((float(lag), float(value)) for lag, value in rows)).points
    except ValidationError:
        raise _refusal(path, "does not begin at 0, 1 and continue to larger lags") from None


def _refusal(path: str, fault: str) -> SceneError:
    return SceneError(f"seabed.relief.function.path: {path!r} {fault}; give a CSV with a lag in m and a value a line")
