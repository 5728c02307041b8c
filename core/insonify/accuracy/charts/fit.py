"""Power laws through what was measured."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np


class Fit(NamedTuple):
    """A power law, y = scale · x to the exponent.

    Attributes
    ----------
    exponent : float
        Slope of the straight line through the logarithms; NaN with fewer than two points.
    spread : float
        Its standard error; NaN with fewer than three points.
    scale : float
        y at x = 1.
    """

    exponent: float
    spread: float
    scale: float

    def words(self) -> str:
        """Say the exponent with its spread; nothing where there is none."""
        if math.isnan(self.exponent):
            return ""
        exponent = f"{self.exponent:.2f}".replace("-", "−")
        return exponent + (f" ± {self.spread:.2f}" if math.isfinite(self.spread) else "")


def fit_power(x: Sequence[float], y: Sequence[float]) -> Fit:
    """Fit a power law by least squares in the logarithms.

    Parameters
    ----------
    x, y : sequence of float
        Points; those that are not positive and finite do not count.

    Returns
    -------
    Fit
    """
    points = np.array([(a, b) for a, b in zip(x, y) if 0.0 < a < math.inf and 0.0 < b < math.inf]).reshape(-1, 2)
    if len(np.unique(points[:, 0])) < 2:
        return Fit(math.nan, math.nan, math.nan)
    along, up = np.log(points).T
    off, high = along - along.mean(), up - up.mean()
    width = float(off @ off)
    exponent = float(off @ high) / width
    left = high - exponent * off
    spread = math.sqrt(float(left @ left) / (len(points) - 2) / width) if len(points) > 2 else math.nan
    return Fit(exponent, spread, math.exp(float(up.mean() - exponent * along.mean())))
