"""Curves approximated by few straight segments."""

import itertools
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Values = NDArray[np.float64]
# m/s, greatest error of the segments; their mean error, two thirds of it, is 6e-8 s over 100 m.
CURVE_TOLERANCE = 0.002
FINER = 0.1  # share of the tolerance that the sampling of a curve takes
MOST_PARTS = 4096  # samples of one interval between knots


def approximate_by_segments(
    curve: Callable[[Values], Values], knots: Values, tolerance: float
) -> tuple[Values, Values]:
    """Approximate a curve by straight segments; returns their ends."""
    parts = [_sampled(curve, low, high, FINER * tolerance) for low, high in itertools.pairwise(knots)]
    places = np.concatenate([*(part[:-1] for part in parts), knots[-1:]])
    values = curve(places)
    kept = thin_polyline(places, values, (1.0 - FINER) * tolerance)
    return places[kept], values[kept]


def _sampled(curve: Callable[[Values], Values], low: float, high: float, tolerance: float) -> Values:
    """Divide an interval into equal parts, so many that their chords stay within the tolerance."""
    parts = 1
    while True:
        ends = np.linspace(low, high, parts + 1)
        within = np.linspace(low, high, 8 * parts + 1)
        error = float(np.abs(np.interp(within, ends, curve(ends)) - curve(within)).max())
        if error <= tolerance or parts >= MOST_PARTS:
            return ends
        # The error of a chord falls as the square of its length.
        parts = min(max(parts + 1, int(np.ceil(parts * np.sqrt(error / tolerance)))), MOST_PARTS)


def thin_polyline(places: Values, values: Values, tolerance: float) -> NDArray[np.int64]:
    """Choose points; the segments between them pass all others within the tolerance (Douglas and Peucker 1973)."""
    kept = np.zeros(places.size, dtype=bool)
    kept[[0, -1]] = True
    pending = [(0, places.size - 1)]
    while pending:
        first, last = pending.pop()
        inner = slice(first + 1, last)
        chord = np.interp(places[inner], places[[first, last]], values[[first, last]])
        away = np.abs(values[inner] - chord)
        if away.size and away.max() > tolerance:
            worst = first + 1 + int(away.argmax())
            kept[worst] = True
            pending += [(first, worst), (worst, last)]
    return np.flatnonzero(kept)


def approximate_pchip(places: Values, values: Values, tolerance: float) -> tuple[Values, Values]:
    """Approximate the PCHIP curve through points, which does not overshoot as a spline does, by straight segments."""
    from scipy.interpolate import PchipInterpolator  # lazy: SciPy takes longer to import than a scene to read

    return approximate_by_segments(PchipInterpolator(places, values), places, tolerance)
