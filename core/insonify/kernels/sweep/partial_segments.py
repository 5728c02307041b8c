"""Echoes of bed segments that are visible in part: cut at the horizon and at targets, split where they come nearest.

Theory: docs/theory/sweep.md.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from insonify.compiler.jit import inlined, kernel
from insonify.kernels.common.range_bins import FIXED_POINT, spread_energy
from insonify.kernels.common.scattering import backscatter_strength
from insonify.kernels.common.types import LIGHT

FINE = 0.02  # longest part, as a share of its range, whose energy spreads evenly over its bins
MOST_PARTS = 4096


class BedSegment(NamedTuple):
    """One segment of the bed: the line z = offset + slope·x in the plane, its tilt and its material."""

    offset: float
    slope: float
    area: float  # 1 + |∇z|²
    facing: float  # -r√area cosα at slant range r and incidence α, m; the offset itself where sound goes straight
    weight: float  # weight of its plane (along-track width, or share of the beam), extrapolated linearly to nadir
    weight_rate: float  # by which that grows per metre of ground range
    diffuse: float
    specular: float
    shininess: float


@kernel
def deposit_partial_segment(segment, x_from, x_to, law, bin_length, bins):
    """Spread the echo of a stretch of a segment over the range bins."""
    near, far = slant_range(segment, x_from), slant_range(segment, x_to)
    tilt = 1.0 + segment.slope * segment.slope
    squared = (x_to - x_from) * (x_to - x_from) * tilt
    if squared <= min(abs(far - near), FINE * FINE * near) * near:
        # Short, and far from the foot of its perpendicular: one even density will do.
        if x_to > x_from:
            _deposit_part(segment, x_from, x_to, near, far, law, bin_length, bins)
        return
    # Slant range falls towards the foot of the perpendicular and grows beyond it.
    foot = min(max(-segment.slope * segment.offset / tilt, x_from), x_to)
    _deposit_monotone(segment, x_from, foot, law, bin_length, bins)
    _deposit_monotone(segment, foot, x_to, law, bin_length, bins)


@kernel
def _deposit_monotone(segment, x_from, x_to, law, bin_length, bins):
    """Deposit a stretch along which slant range grows or falls, in parts short against their range."""
    if x_to <= x_from:
        return
    nearest = max(min(slant_range(segment, x_from), slant_range(segment, x_to)), bin_length)
    length = (x_to - x_from) * math.sqrt(1.0 + segment.slope * segment.slope)
    parts = 1 + int(min(length / (FINE * nearest), MOST_PARTS - 1.0))
    dx = (x_to - x_from) / parts
    near = slant_range(segment, x_from)
    for k in range(parts):
        start = x_from + k * dx
        far = slant_range(segment, start + dx)
        _deposit_part(segment, start, start + dx, near, far, law, bin_length, bins)
        near = far


@inlined
def _deposit_part(segment, x_from, x_to, near, far, law, bin_length, bins):
    """Spread the energy of one part evenly over the slant ranges it spans, ``near`` to ``far``."""
    per_bin, stretch = 1.0 / bin_length, math.sqrt(segment.area)
    x = 0.5 * (x_from + x_to)
    middle = slant_range(segment, x)
    cos_incidence = -segment.facing / (middle * stretch)  # docs/theory/sweep.md
    value = backscatter_strength(cos_incidence, segment.diffuse, segment.specular, segment.shininess, law)
    value *= segment.weight + segment.weight_rate * x
    if law == LIGHT:
        energy = value * abs(far - near) * per_bin
    else:
        energy = value * stretch * (x_to - x_from)
    spread_energy(bins, near * per_bin, far * per_bin, energy * FIXED_POINT, bins.size - 2)


@inlined
def slant_range(segment, x):
    """Slant range of a segment at a ground range."""
    z = segment.offset + segment.slope * x
    return math.sqrt(x * x + z * z)
