"""Single segments of the bed: what the horizon and targets leave visible of them, and the echo of their stretches.

Theory: docs/theory/sweep.md.
"""

import math
from typing import NamedTuple

import numpy as np

from insonify.compiler.jit import inlined, inlined_uncounted, kernel, kernel_uncounted
from insonify.kernels.common.range_bins import FIXED_POINT, spread_energy
from insonify.kernels.common.scattering import backscatter_strength
from insonify.kernels.common.types import LIGHT
from insonify.kernels.targets.occlusion import is_hidden, next_visible

FINE = 0.02  # length, as a share of its range, up to which the energy of a part spreads evenly over its bins
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


@inlined_uncounted
def load_segment(i, x, z, slope, area, facing, material, weights, table, sector):
    """Load segment i of a profile."""
    row, rise = material[i], slope[i]
    at_nadir, rate, offset = 1.0, 0.0, z[i] - rise * x[i]
    if sector.angle > 0.0 or sector.tabulated or sector.bent:
        rate = (np.float64(weights[i + 1]) - weights[i]) / (x[i + 1] - x[i])
        at_nadir = weights[i] - rate * x[i]
    away = facing[i] if sector.bent else offset
    return BedSegment(offset, rise, area[i], away, at_nadir, rate, table[row, 0], table[row, 1], table[row, 2])


@inlined_uncounted
def visible_from(segment, x_from, x_to, launch, horizon):
    """Ground range from which a segment rises above the horizon: offset / x + slope = horizon."""
    if horizon > launch:
        return min(max(segment.offset / (horizon - segment.slope), x_from), x_to)
    return x_from


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
    foot = nearest_ground_range(segment, x_from, x_to)
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
    spread_energy(bins, near * per_bin, far * per_bin, energy * FIXED_POINT)


@inlined
def slant_range(segment, x):
    """Slant range of a segment at a ground range."""
    z = segment.offset + segment.slope * x
    return math.sqrt(x * x + z * z)


@kernel_uncounted
def deposit_visible_stretches(segment, x_from, x_to, occlusion, law, bin_length, bins):
    """Spread the echo of a bed segment, less the parts that targets hide, over the range bins."""
    if is_hidden(occlusion, segment, x_from, x_to):
        return
    low, high = launch_angle(segment, x_from), launch_angle(segment, x_to)
    while low < high:
        opened, closed, start, stop = next_stretch(occlusion, segment, low, high, x_from, x_to)
        if opened >= high:
            return
        deposit_partial_segment(segment, start, stop, law, bin_length, bins)
        low, x_from = closed, stop


@inlined_uncounted
def next_stretch(occlusion, segment, low, high, x_from, x_to):
    """Launch angles and ground ranges between which targets leave the next stretch of a segment visible."""
    # The search runs from the launch angle ``low`` at ``x_from`` to ``high`` at ``x_to``; targets hide what lies before
    # the stretch. A stretch that begins at ``high`` does not exist.
    opened, closed = next_visible(occlusion, segment, low, high)
    start = x_from if opened <= low else x_to
    if low < opened < high:
        start = min(max(ground_range_at(segment, opened), x_from), x_to)
    stop = x_to if closed >= high else min(ground_range_at(segment, closed), x_to)
    return opened, closed, start, stop


@inlined_uncounted
def launch_angle(segment, x):
    """Launch angle to a segment at a ground range."""
    return math.atan2(segment.offset + segment.slope * x, x)


@inlined_uncounted
def ground_range_at(segment, angle):
    """Ground range at which a launch angle meets a segment's line."""
    return segment.offset / (math.tan(angle) - segment.slope)


@inlined
def nearest_ground_range(segment, x_from, x_to):
    """Ground range at which a stretch of a segment comes nearest: slant range falls towards it and grows beyond."""
    return min(max(-segment.slope * segment.offset / (1.0 + segment.slope * segment.slope), x_from), x_to)


@inlined
def ground_range_at_slant(segment, r, outward):
    """Ground range at which a segment's line has a slant range, beyond the foot of its perpendicular or before it."""
    tilt = 1.0 + segment.slope * segment.slope
    foot = -segment.slope * segment.offset / tilt
    nearest_squared = segment.offset * segment.offset / tilt
    away = math.sqrt(max(r * r - nearest_squared, 0.0) / tilt)
    return foot + away if outward else foot - away
