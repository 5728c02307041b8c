"""Fractal relief: filtered noise with spectral peaks.

Theory: docs/theory/fractal-beds.md.
"""

import math
from collections import Counter
from typing import Any, Literal, Self

import numpy as np
from pydantic import field_validator, model_validator

from insonify.arrays import Complexes, Floats
from insonify.scene.base import parameter
from insonify.scene.seabed.materials import MaterialMap
from insonify.scene.seabed.reliefs.random_relief import ExtendableRelief, rms_height
from insonify.scene.seabed.reliefs.spectrum import Band, PeriodicWaves

Peak = tuple[float, float]
HIGHEST_PEAK = 0.9  # share of the Nyquist frequency, on endless ground


class Fractal(ExtendableRelief, kind="fractal", rank=20):
    """Filtered noise with spectral peaks: Models 1 to 3 of the paper."""

    levels_off = True
    beta: float | None = parameter(
        None,
        "amplitude exponent of the spectrum; larger is smoother (1.4 if left out)",
        ge=0.0,
        lt=5.0,
        slider=(0.0, 3.0),
    )
    beta_x: float | None = parameter(None, "exponent along the first axis (Model 3)", ge=0.0, lt=5.0, slider=(0.0, 3.0))
    beta_y: float | None = parameter(
        None, "exponent along the second axis (Model 3)", ge=0.0, lt=5.0, slider=(0.0, 3.0)
    )
    peaks: tuple[Peak, ...] = parameter(
        ((0.0, 0.0),), "spectral peaks [fx, fy]", "cycles/period", min_length=1, max_length=16, slider=(-64.0, 64.0)
    )
    rms: float = rms_height()
    quadrants: Literal[1, 4] = parameter(1, "quadrants of each peak: one, or mirrored into all four", rare=True)
    combine: Literal["rms", "max"] = parameter("rms", "how overlapping peaks combine", rare=True)
    decay: Literal["isotropic", "separable", "rotated", "elliptic"] = parameter(
        "isotropic", "shape of the decay away from a peak (the last three need beta_x and beta_y)", rare=True
    )
    clamp: Literal["hard", "soft"] = parameter("hard", "how the spectrum levels off at its peaks", rare=True)
    coefficients: Literal["phase", "gaussian"] = parameter(
        "phase", "random phases only (exact spectrum), or Gaussian coefficients", rare=True
    )

    @field_validator("peaks", mode="before")
    @classmethod
    def _one_pair(cls, peaks: Any) -> Any:
        is_pair = isinstance(peaks, (list, tuple)) and len(peaks) == 2 and not isinstance(peaks[0], (list, tuple))
        return [peaks] if is_pair else peaks

    @model_validator(mode="after")
    def _exponents_agree(self) -> Self:
        if (self.beta_x is None) != (self.beta_y is None):
            raise ValueError("beta_x and beta_y come together; give both or neither")
        if self.beta is not None and self.beta_x is not None:
            raise ValueError("give beta, or beta_x with beta_y, not both")
        if self.decay != "isotropic" and self.beta_x is None:
            raise ValueError(f'decay "{self.decay}" needs beta_x and beta_y; add them or use decay = "isotropic"')
        if self.decay == "isotropic" and self.beta_x is not None:
            raise ValueError('beta_x and beta_y need decay = "separable", "rotated" or "elliptic"')
        return self

    @model_validator(mode="after")
    def _endless_spectrum_is_smooth(self) -> Self:
        if not self.endless:
            return self
        if self.clamp != "soft" or self.coefficients != "gaussian":
            raise ValueError(
                f'extent "endless" levels off softly and is Gaussian, not of clamp "{self.clamp}" and coefficients '
                f'"{self.coefficients}"; set clamp = "soft" and coefficients = "gaussian"'
            )
        if self.decay not in ("isotropic", "elliptic") or self.combine != "rms":
            raise ValueError(
                f'extent "endless" adds up peaks that fall off smoothly, not decay "{self.decay}" and combine '
                f'"{self.combine}"; set decay = "isotropic" or "elliptic" and combine = "rms", or extent = "periodic"'
            )
        return self

    @property
    def exponents(self) -> tuple[float, float]:
        """Exponents along the two axes; equal for an isotropic decay."""
        if self.beta_x is not None and self.beta_y is not None:
            return self.beta_x, self.beta_y
        beta = 1.4 if self.beta is None else self.beta
        return beta, beta

    @property
    def idle_fields(self) -> frozenset[str]:
        """Names of the fields without effect: the exponents of the other decays."""
        return super().idle_fields | ({"beta_x", "beta_y"} if self.decay == "isotropic" else {"beta"})

    def value_in_force(self, field: str, frequency: float | None = None) -> float | None:
        """Exponent that applies where it is left out."""
        return self.exponents[1 if field == "beta_y" else 0]

    @property
    def half_plane_peaks(self) -> list[Peak]:
        """Peaks in cycles per period, without their images through zero frequency."""
        if self.quadrants == 1:
            return list(self.peaks)
        return [place for x, y in self.peaks for place in ((x, y), (x, -y))]

    def heights(self, waves: PeriodicWaves, reference: PeriodicWaves) -> Floats:
        """Heights of filtered noise; every grid is scaled by the factor of the reference."""
        # Grids of different shape thus agree in the waves they share; one finer than the reference has a slightly
        # higher rms, a coarser one a lower one.
        made = self.filtered_noise(waves)
        power = reference.variance(made if reference is waves else self.filtered_noise(reference))
        if power == 0.0:
            return np.zeros(waves.shape)
        made *= self.rms / math.sqrt(power)
        return waves.field(made)

    def filtered_noise(self, waves: PeriodicWaves) -> Complexes:
        """Coefficients of the waves before they are scaled to the rms."""
        return waves.filtered(
            lambda fx, fy: np.sqrt(power_spectrum(self, fx, fy)), gaussian=self.coefficients == "gaussian"
        )

    def bands(self) -> tuple[Band, ...]:
        """Return one band for each peak and its mirror image."""
        return tuple(self._band_about(peak) for peak in self.half_plane_peaks)

    def _band_about(self, peak: tuple[float, float]) -> Band:
        period = self.period

        def density(fx: Floats, fy: Floats) -> Floats:
            return decay_about(self, fx * period + peak[0], fy * period + peak[1], peak)

        if peak == (0.0, 0.0):  # its own image
            return Band(lambda fx, fy: 2.0 * density(fx, fy), 1.0 / period)
        return Band(density, 1.0 / period, (peak[0] / period, peak[1] / period))

    def check(self, spacing: float, material: MaterialMap) -> None:
        """Check that the grid resolves the peaks."""
        super().check(spacing, material)
        cells = self.period / spacing
        nyquist = HIGHEST_PEAK * cells / 2 if self.endless else round(cells) / 2
        if any(max(abs(fx), abs(fy)) > 0 and max(abs(fx), abs(fy)) >= nyquist for fx, fy in self.peaks):
            what = f"{HIGHEST_PEAK:g} of the Nyquist frequency," if self.endless else "the Nyquist frequency of"
            raise ValueError(
                f"relief.peaks {[list(peak) for peak in self.peaks]} reach {what} {nyquist:g} "
                f"cycles per period; keep below it or reduce spacing {spacing:g} m"
            )


def power_spectrum(fractal: Fractal, fx: Floats, fy: Floats) -> Floats:
    """Squared amplitude A² of the relief's waves, up to one factor."""
    # A real field has the same power at −f as at f, so that every peak has an image at −(fx, fy). Peaks and images that
    # coincide, as at zero frequency, count as often as they occur. Adding 0 turns −0 into 0.
    places = Counter((sign * x + 0.0, sign * y + 0.0) for x, y in fractal.half_plane_peaks for sign in (1.0, -1.0))
    power: Floats = np.zeros(np.broadcast_shapes(fx.shape, fy.shape))
    for place, times in places.items():
        decay = decay_about(fractal, fx, fy, place)
        if fractal.combine == "max":
            np.maximum(power, decay, out=power)
        else:
            power += decay if times == 1 else times * decay
    return power


def decay_about(fractal: Fractal, fx: Floats, fy: Floats, peak: tuple[float, float]) -> Floats:
    """Power of one peak at frequencies in cycles per period, 1 at the peak."""
    dx, dy = fx - peak[0], fy - peak[1]
    beta_x, beta_y = fractal.exponents
    hard = fractal.clamp == "hard"
    if fractal.decay == "isotropic":  # Models 1 and 2: F^−β
        return _level(dx**2 + dy**2, hard) ** -beta_x
    if fractal.decay != "separable":
        # Along and across the direction of the peak from zero frequency.
        length = math.hypot(*peak)
        cosine, sine = (peak[0] / length, peak[1] / length) if length > 0.0 else (1.0, 0.0)
        dx, dy = cosine * dx + sine * dy, cosine * dy - sine * dx
    if fractal.decay == "elliptic":
        return _elliptic(dx, dy, beta_x, beta_y, hard)
    # Model 3: |Δfx|^−βx |Δfy|^−βy, along the axes or, rotated, along the peak's own direction
    return _level(dx**2, hard) ** -beta_x * _level(dy**2, hard) ** -beta_y


def _level(squared: Floats, hard: bool) -> Floats:
    """Squared distance in cycles per period, limited to at least 1 (hard) or increased by 1 (soft)."""
    return np.maximum(squared, 1.0) if hard else 1.0 + squared


def _elliptic(along: Floats, across: Floats, beta_x: float, beta_y: float, hard: bool) -> Floats:
    """Power (|Δ∥|^(2βx/β) + |Δ⊥|^(2βy/β))^−β with β the mean exponent."""
    # It falls with exponent βx along the one axis and βy along the other, is isotropic when they are equal, and has no
    # cross of slowly falling power through the peak.
    beta = 0.5 * (beta_x + beta_y)
    if beta == 0.0:
        return np.ones(np.broadcast_shapes(along.shape, across.shape))
    if hard:
        along, across = np.maximum(np.abs(along), 1.0), np.maximum(np.abs(across), 1.0)
    reach = (along**2) ** (beta_x / beta) + (across**2) ** (beta_y / beta)
    return np.asarray(0.5 * reach if hard else 1.0 + reach) ** -beta
