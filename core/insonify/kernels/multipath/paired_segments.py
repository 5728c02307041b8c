"""Echoes of one segment of the bed, out by one image of the sonar and back by another.

Theory: docs/theory/multipath.md.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from insonify.compiler.jit import inlined_uncounted, kernel_uncounted
from insonify.kernels.common.types import LIGHT
from insonify.kernels.multipath.echo_list import SurfaceEcho, list_echo
from insonify.kernels.multipath.image_sources import height_delay, pair_strength, spreading_ratio, tilt_delay
from insonify.kernels.sweep.partial_segments import FINE

MOST_NEWTON = 40  # steps that find where a segment comes nearest to both images
SAME_PLACE = 1e-10  # share of a stretch below which a step ends the search
MOST_PARTS = 1024


class SegmentLine(NamedTuple):
    """A segment's line in the plane, as one image sees it: z = offset + slope · x."""

    offset: float
    slope: float


class PairedSegment(NamedTuple):
    """A segment of the bed by itself, as two images see it."""

    one: SegmentLine
    other: SegmentLine
    area: float  # 1 + |∇z|²
    at_nadir: float  # weight of its plane, extrapolated linearly to nadir
    rate: float  # by which that grows per metre of ground range
    material: int  # row of the reflectivity table
    diffuse: float
    specular: float
    shininess: float


@inlined_uncounted
def echo_range(segment, x):
    """Slant range of the echo of a segment at a ground range: half the way by both images."""
    a, b = segment.one.offset + segment.one.slope * x, segment.other.offset + segment.other.slope * x
    return 0.5 * (math.sqrt(x * x + a * a) + math.sqrt(x * x + b * b))


@inlined_uncounted
def _range_rate(segment, x):
    """Twice the rate at which the slant range of the echo grows with ground range, and how fast that grows."""
    slope = segment.one.slope
    a, b = segment.one.offset + slope * x, segment.other.offset + slope * x
    per_one, per_other = 1.0 / math.sqrt(x * x + a * a), 1.0 / math.sqrt(x * x + b * b)
    rate_one, rate_other = (x + slope * a) * per_one, (x + slope * b) * per_other
    tilt = 1.0 + slope * slope
    growth = (tilt - rate_one * rate_one) * per_one + (tilt - rate_other * rate_other) * per_other
    return rate_one + rate_other, growth


@kernel_uncounted
def list_stretch(segment, pair, x_from, x_to, near, far, echoes, n):
    """List the echo of a stretch of a segment that both images see."""
    if not x_to > x_from:
        return n
    squared = (x_to - x_from) ** 2 * (1.0 + segment.one.slope * segment.one.slope)
    if squared <= min(abs(far - near), FINE * FINE * near) * near:
        return _list_part(segment, pair, x_from, x_to, near, far, echoes, n)
    foot = _nearest_ground_range(segment, x_from, x_to)
    n = _list_monotone(segment, pair, x_from, foot, echoes, n)
    return _list_monotone(segment, pair, foot, x_to, echoes, n)


@kernel_uncounted
def _nearest_ground_range(segment, x_from, x_to):
    """Ground range of the nearest echo of a segment; slant range falls towards it and grows beyond."""
    if _range_rate(segment, x_from)[0] >= 0.0:
        return x_from
    if _range_rate(segment, x_to)[0] <= 0.0:
        return x_to
    low, high, x = x_from, x_to, 0.5 * (x_from + x_to)
    for _ in range(MOST_NEWTON):
        rate, growth = _range_rate(segment, x)
        if rate < 0.0:
            low = x
        else:
            high = x
        nearer = x - rate / growth
        nearer = nearer if low < nearer < high else 0.5 * (low + high)
        if abs(nearer - x) <= SAME_PLACE * (x_to - x_from):
            return nearer
        x = nearer
    return x


@kernel_uncounted
def _list_monotone(segment, pair, x_from, x_to, echoes, n):
    """List a stretch along which slant range grows or falls, in parts short against their range."""
    if not x_to > x_from:
        return n
    near, slope = echo_range(segment, x_from), segment.one.slope
    nearest = max(min(near, echo_range(segment, x_to)), pair.bin_length)
    parts = 1 + int(min((x_to - x_from) * math.sqrt(1.0 + slope * slope) / (FINE * nearest), MOST_PARTS - 1.0))
    dx = (x_to - x_from) / parts
    for k in range(parts):
        start = x_from + k * dx
        far = echo_range(segment, start + dx)
        n = _list_part(segment, pair, start, start + dx, near, far, echoes, n)
        near = far
    return n


@inlined_uncounted
def _list_part(segment, pair, x_from, x_to, near, far, echoes, n):
    """List one part; its energy is spread evenly over the slant ranges that it spans, ``near`` to ``far``."""
    x, stretch, law = 0.5 * (x_from + x_to), math.sqrt(segment.area), pair.law
    a, b = segment.one.offset + segment.one.slope * x, segment.other.offset + segment.other.slope * x
    if -b <= pair.other.above:
        return n  # land
    r_one, r_other = math.sqrt(x * x + a * a), math.sqrt(x * x + b * b)
    cos_one, cos_other = -segment.one.offset / (r_one * stretch), -segment.other.offset / (r_other * stretch)
    mirrored = 2.0 * cos_one * cos_other - (x * x + a * b) / (r_one * r_other)
    value = pair_strength(cos_one, cos_other, mirrored, segment.diffuse, segment.specular, segment.shininess, pair)
    value *= (segment.at_nadir + segment.rate * x) * spreading_ratio(r_one, r_other, law)
    energy = value * abs(far - near) / pair.bin_length if law == LIGHT else value * stretch * (x_to - x_from)
    rms, variance, rise, tilt = pair.rms_height, pair.slope_variance, 0.0, 0.0
    if rms > 0.0 or variance > 0.0:
        rise = height_delay(pair.one, -a, r_one, rms) + height_delay(pair.other, -b, r_other, rms)
        tilt = tilt_delay(pair.one, -a, r_one, variance) + tilt_delay(pair.other, -b, r_other, variance)
    cosine = min(cos_one, cos_other)
    return list_echo(echoes, n, SurfaceEcho(near, far, energy, rise, tilt, x, cosine, segment.material))
