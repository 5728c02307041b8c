"""Estimate of the spectral exponent of a field from one period of it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from insonify.scene import SceneError
from insonify.terrain.periodic_waves import frequencies

LOWEST = 4.0  # cycles per period; lower frequencies have few waves and are clamped
FEWEST = 16.0  # cycles per period between the lowest and the highest frequency


def amplitude_exponent(heights: NDArray[np.floating]) -> float:
    """Exponent β of the amplitude spectrum f^−β of a field, by maximum likelihood."""
    from scipy.optimize import minimize_scalar

    highest = min(heights.shape) / 2.0
    if highest - LOWEST < FEWEST:
        raise SceneError(
            f"heights: {heights.shape} samples hold too few waves to measure an exponent; "
            f"give at least {2 * int(LOWEST + FEWEST)} a side"
        )
    fx, fy = frequencies((heights.shape[0], heights.shape[1]))
    radius = np.hypot(fx, fy)
    power = np.abs(np.fft.rfft2(heights)) ** 2
    inside = (radius >= LOWEST) & (radius < highest) & (fx > 0)
    log_radius, power = np.log(radius[inside]), power[inside]

    def misfit(exponent: float) -> float:
        return float(np.log((power * np.exp(exponent * log_radius)).mean()) - exponent * log_radius.mean())

    return float(0.5 * minimize_scalar(misfit, bounds=(-0.5, 11.0), method="bounded").x)
