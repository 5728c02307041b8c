"""Fractal relief: filtered noise with spectral peaks."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import field_validator, model_validator

from insonify.scene.base import parameter
from insonify.scene.reliefs.random_relief import ExtendableRelief, rms_height

Peak = tuple[float, float]


class Fractal(ExtendableRelief):
    """Filtered noise with spectral peaks: Models 1 to 3 of the paper."""

    rank = 20
    kind: Literal["fractal"] = "fractal"
    beta: float | None = parameter(
        None,
        description="amplitude exponent of the spectrum; larger is smoother (1.4 if left out)",
        ge=0.0,
        lt=5.0,
        slider=(0.0, 3.0),
    )
    beta_x: float | None = parameter(
        None, description="exponent along the first axis (Model 3)", ge=0.0, lt=5.0, slider=(0.0, 3.0)
    )
    beta_y: float | None = parameter(
        None, description="exponent along the second axis (Model 3)", ge=0.0, lt=5.0, slider=(0.0, 3.0)
    )
    peaks: tuple[Peak, ...] = parameter(
        ((0.0, 0.0),),
        unit="cycles/period",
        description="spectral peaks [fx, fy]",
        min_length=1,
        max_length=16,
        slider=(-64.0, 64.0),
    )
    rms: float = rms_height()
    quadrants: Literal[1, 4] = parameter(1, description="put each peak in one quadrant, or mirror it into all four")
    combine: Literal["rms", "max"] = parameter("rms", description="how overlapping peaks combine")
    decay: Literal["isotropic", "separable", "rotated", "elliptic"] = parameter(
        "isotropic", description="shape of the decay away from a peak (the last three need beta_x and beta_y)"
    )
    clamp: Literal["hard", "soft"] = parameter("hard", description="how the spectrum levels off at its peaks")
    coefficients: Literal["phase", "gaussian"] = parameter(
        "phase", description="random phases alone (exact spectrum), or Gaussian coefficients"
    )

    @field_validator("peaks", mode="before")
    @classmethod
    def _one_pair(cls, peaks: Any) -> Any:
        is_pair = isinstance(peaks, (list, tuple)) and len(peaks) == 2 and not isinstance(peaks[0], (list, tuple))
        return [peaks] if is_pair else peaks

    @model_validator(mode="after")
    def _exponents_agree(self) -> Fractal:
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
    def _endless_ground_can_be_strewn(self) -> Fractal:
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
