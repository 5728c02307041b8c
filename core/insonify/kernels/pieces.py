"""Pieces of the bed that are not heard whole: cut at the horizon and at targets, halved where they come nearest."""

from __future__ import annotations

import math

from insonify.kernels.bins import FIXED_POINT, spread
from insonify.kernels.jit import kernel
from insonify.kernels.scatter import strength
from insonify.kernels.types import LIGHT
from insonify.kernels.wedge import beam_share, strip_width

FINE = 0.02  # longest piece, as a share of its range, whose energy spreads evenly over its bins
MOST_PARTS = 4096


@kernel
def deposit_piece(offset, slope, x_from, x_to, gradient_squared, material, wedge, law, bin_length, bins):
    """Put the part of a segment z = offset + slope·x between two ground ranges into the bins."""
    # Slant range falls towards the foot of the perpendicular and grows beyond it.
    foot = -slope * offset / (1.0 + slope * slope)
    if x_from < foot < x_to:
        _monotone(offset, slope, x_from, foot, gradient_squared, material, wedge, law, bin_length, bins)
        _monotone(offset, slope, foot, x_to, gradient_squared, material, wedge, law, bin_length, bins)
    elif x_to > x_from:
        _monotone(offset, slope, x_from, x_to, gradient_squared, material, wedge, law, bin_length, bins)


@kernel
def _monotone(offset, slope, x_from, x_to, gradient_squared, material, wedge, law, bin_length, bins):
    """Deposit a piece along which slant range grows or falls, in parts short against their range."""
    last = bins.size - 2
    area = math.sqrt(1.0 + gradient_squared)
    length = (x_to - x_from) * math.sqrt(1.0 + slope * slope)
    nearest = min(_slant(offset, slope, x_from), _slant(offset, slope, x_to))
    parts = 1 + int(min(length / (FINE * max(nearest, bin_length)), MOST_PARTS - 1.0))
    dx = (x_to - x_from) / parts
    near = _slant(offset, slope, x_from)
    for k in range(parts):
        x = x_from + (k + 0.5) * dx
        middle = _slant(offset, slope, x)
        far = _slant(offset, slope, x_from + (k + 1) * dx)
        value = strength(-offset / (middle * area), material[0], material[1], material[2], law)
        if law == LIGHT:
            energy = value * beam_share(x, middle, wedge) * abs(far - near) / bin_length
        else:
            energy = value * area * strip_width(x, middle, wedge) * dx
        spread(bins, near / bin_length, far / bin_length, energy * FIXED_POINT, last)
        near = far


@kernel
def _slant(offset, slope, x):
    z = offset + slope * x
    return math.sqrt(x * x + z * z)


@kernel
def next_open(low, high, in_front, count, start, stop):
    """Return the first stretch of launch angles in [start, stop] that no cover in front hides; empty if none."""
    moved = True
    while moved and start < stop:
        moved = False
        for k in range(count):
            if in_front[k] and low[k] <= start < high[k]:
                start = high[k]
                moved = True
    if start >= stop:
        return stop, stop
    end = stop
    for k in range(count):
        if in_front[k] and start < low[k] < end:
            end = low[k]
    return start, end
