"""Power laws fitted to measurements."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np


class PowerLawFit(NamedTuple):
    """Power law y = scale · x^exponent fitted to points."""

    exponent: float  # slope of the straight line through the logarithms; NaN with fewer than two points
    spread: float  # standard error of the exponent; NaN with fewer than three points
    scale: float  # value of y at x = 1

    def format_exponent(self) -> str:
        """Format the exponent with its standard error; empty where there is none."""
        if math.isnan(self.exponent):
            return ""
        exponent = f"{self.exponent:.2f}".replace("-", "−")
        return exponent + (f" ± {self.spread:.2f}" if math.isfinite(self.spread) else "")


def fit_power_law(x: Sequence[float], y: Sequence[float]) -> PowerLawFit:
    """Fit a power law by least squares in the logarithms."""
    points = np.array([(a, b) for a, b in zip(x, y) if 0.0 < a < math.inf and 0.0 < b < math.inf]).reshape(-1, 2)
    if len(np.unique(points[:, 0])) < 2:
        return PowerLawFit(math.nan, math.nan, math.nan)
    along, up = np.log(points).T
    off, high = along - along.mean(), up - up.mean()
    width = float(off @ off)
    exponent = float(off @ high) / width
    left = high - exponent * off
    spread = math.sqrt(float(left @ left) / (len(points) - 2) / width) if len(points) > 2 else math.nan
    return PowerLawFit(exponent, spread, math.exp(float(up.mean() - exponent * along.mean())))
