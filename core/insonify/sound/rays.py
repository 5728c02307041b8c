"""Rays through water, as a person asks for them: paths, the rays between two points, and where no sound gets."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from insonify.kernels.cells import Plane
from insonify.kernels.paths import Limits, Points, trace_paths
from insonify.kernels.types import Water

Values = NDArray[np.float64]
ENDS = ("range", "bottom", "surface", "nowhere", "trapped")
POINTS = 201  # along a path, when no ranges are asked for
ALONG_STATIONS = Plane(0.0, 1.0)


def follow_paths(water: Water, height: float, angles: Values, ranges: Values, limits: Limits) -> tuple[Points, Any]:
    """Follow rays along the line of the water's stations.

    Parameters
    ----------
    water : Water
    height : float
        At which they start, at place 0 along that line, in metres.
    angles : (n,) float64
        Of launch, radians above the horizontal.
    ranges : (m,) float64
        Where points are wanted, ascending, in metres.
    limits : Limits

    Returns
    -------
    points : Points
        Of arrays of shape (n, m + 1).
    ends : (n,) int64
        Codes of `kernels.paths`.
    """
    shape = (angles.size, ranges.size + 1)
    x, z, cosine, sine, time, q = (np.full(shape, math.nan) for _ in range(6))
    tops, bottoms = np.zeros(shape, np.int64), np.zeros(shape, np.int64)
    points = Points(x, z, cosine, sine, time, q, np.zeros(shape, np.bool_), tops, bottoms)
    ends = np.zeros(angles.size, np.int64)
    trace_paths(water, ALONG_STATIONS, height, angles, ranges, limits, points, ends)
    return points, ends
