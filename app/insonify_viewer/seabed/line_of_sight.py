"""Where the line of sight through a point of the three-dimensional view meets the bed."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from insonify.terrain import AnyGround

SAMPLES = 4096  # along the line
HALVINGS = 30
CLEAR = 2.0  # m above the highest bed known, and below the lowest, between which the line is looked at

Vector = NDArray[np.float64]


def meet_bed(
    ground: AnyGround, begin: Vector, end: Vector, heights: tuple[float, float]
) -> tuple[float, float, float] | None:
    """Find where a line of sight meets the bed first."""
    way = end - begin
    if way[2] >= 0.0:
        return None
    first, last = ((level - begin[2]) / way[2] for level in (heights[1] + CLEAR, heights[0] - CLEAR))
    first, last = max(first, 0.0), min(last, 1.0)
    if first >= last:
        return None
    share = np.linspace(first, last, SAMPLES)
    below = _above(ground, begin, way, share) <= 0.0  # NaN, where there is no bed, compares false
    if not below.any():
        return None
    k = int(np.argmax(below))
    low, high = share[max(k - 1, 0)], share[k]
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if _above(ground, begin, way, np.array([middle]))[0] <= 0.0 else (middle, high)
    x, y, z = begin + high * way
    return float(x), float(y), float(z)


def _above(ground: AnyGround, begin: Vector, way: Vector, share: Vector) -> Vector:
    """Heights of points of the line above the bed, m."""
    points = begin + np.multiply.outer(share, way)
    return np.asarray(points[:, 2] - ground.height_at_once(points[:, 0], points[:, 1]))
