"""Echoes of the bed, out by one image of the sonar and back by another: of a whole profile, and of single segments.

Every pass touches few arrays, so that the compiler can use its vector units. Segments that both images see whole are
summed here; what is seen in part, is too long for one density or may be land is marked, to be taken one by one.

Theory: docs/theory/multipath.md.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import DTypeLike, NDArray

from insonify.compiler.jit import inlined_uncounted, kernel_uncounted
from insonify.kernels.beam.pattern_samples import SampleRoom
from insonify.kernels.bed.profile import WORD, padded_count
from insonify.kernels.common.contributors import SpreadEcho, contributor_row, open_contributor, spread_echo
from insonify.kernels.common.range_bins import FIXED_POINT, spread_energy
from insonify.kernels.common.scattering import scatter_paired_segments
from insonify.kernels.common.types import LIGHT
from insonify.kernels.multipath.echo_list import SurfaceEcho, list_echo
from insonify.kernels.multipath.image_sources import (
    PATH_COUNT,
    height_delay,
    pair_strength,
    spreading_ratio,
    tilt_delay,
)
from insonify.kernels.sweep.partial_segments import FINE
from insonify.kernels.sweep.segment_densities import deposit_densities

MOST_NEWTON = 40  # steps that find where a segment comes nearest to both images
SAME_PLACE = 1e-10  # share of a stretch below which a step ends the search
MOST_PARTS = 1024


class PairedEchoes(NamedTuple):
    """Echoes of one profile's segments for a pair of images; one entry a knot, or a segment."""

    r: NDArray[np.float64]  # slant range of the echo: half the way by both images, m, knots
    weight: NDArray[np.float32]  # weight of the plane, knots
    cosines: NDArray[np.float32]  # product of both cosines of the incidence, under law `light` their mean, segments
    mirrored: NDArray[np.float32]  # R·V: cosine between one direction, mirrored, and the other, segments
    scale: NDArray[np.float32]  # what turns a scattering strength into energy per bin, segments
    energy: NDArray[np.float32]  # per bin in fixed-point units, of segments that both images see whole
    cut: NDArray[np.bool_]  # marks of segments that must be taken one by one
    marked: NDArray[np.int32]  # indices of marked segments
    place: NDArray[np.int32]  # bin of a knot
    early: NDArray[np.int64]  # step of the density at a knot: what that bin takes
    late: NDArray[np.int64]  # and what the next bin takes
    room: SampleRoom


def empty_paired_echoes(capacity: int, dtype: DTypeLike) -> PairedEchoes:
    """Make room for the echoes of profiles."""
    weight, cosines, mirrored, scale, energy = np.zeros((5, capacity), dtype)
    (marked, place, listed), (early, late) = np.zeros((3, capacity), np.int32), np.zeros((2, capacity), np.int64)
    r, cut, room = np.zeros(capacity), np.zeros(capacity + WORD, np.bool_), SampleRoom(listed, *np.zeros((4, capacity)))
    return PairedEchoes(r, weight, cosines, mirrored, scale, energy, cut, marked, place, early, late, room)


@inlined_uncounted
def deposit_paired_profile(profile, count, one, other, pair, hidden, arrays, sink, echoes):
    """Spread the echoes of segments that both images see whole over the range bins; mark the others they see."""
    knots = padded_count(count)
    r, r_one, r_other = echoes.r, one.r, other.r
    for i in range(knots):
        r[i] = 0.5 * (r_one[i] + r_other[i])
    _measure_pairs(knots, profile, one, pair, echoes)
    material, table, mapped = profile.material, arrays.reflectivity, arrays.bed.mapped
    facing, mirrored, scale, energy = echoes.cosines, echoes.mirrored, echoes.scale, echoes.energy
    scatter_paired_segments(knots, material, table, mapped, pair.law, facing, mirrored, scale, energy)
    rough = pair.rms_height > 0.0 or pair.slope_variance > 0.0
    _mark_parted(knots, profile.area, one, other, pair, hidden, sink.labelling and rough, echoes)
    echoes.energy[count - 1] = 0.0
    if rough:
        facets = arrays.multipath.facets[pair.passes - 1]
        _deposit_on_waves(count, profile.x, one.z, pair, facets, echoes, sink.bins)
        return
    deposit_densities(count, echoes, pair.bin_length, sink.bins)
    if sink.labelling:
        _note_whole_segments(profile, count, one, other, pair, echoes, sink.contributions)


@inlined_uncounted
def _measure_pairs(segments, profile, one, pair, echoes):
    """Geometry of the echo of each segment at its middle, and marks of those too long for one density."""
    x, slope, area, z, weight, r = profile.x, profile.slope, profile.area, one.z, echoes.weight, echoes.r
    facing, mirrored, scale, uneven = echoes.cosines, echoes.mirrored, echoes.scale, echoes.cut
    real, light = scale.dtype.type, pair.law == LIGHT
    share = pair.orders * pair.one.share * pair.other.share * FIXED_POINT
    unit, raised = real(share if light else share * pair.bin_length), real(pair.other.height - pair.one.height)
    one_, half, two, nothing, fine = real(1.0), real(0.5), real(2.0), real(0.0), real(FINE * FINE)
    for i in range(segments):
        run, rise, r_middle = real(x[i + 1] - x[i]), real(r[i + 1] - r[i]), real(0.5 * (r[i] + r[i + 1]))
        middle, a = real(0.5 * (x[i] + x[i + 1])), real(0.5 * (z[i] + z[i + 1]))
        b, offset = a - raised, a - slope[i] * middle
        squared, squared_other = middle * middle + a * a, middle * middle + b * b
        per_ranges = one_ / math.sqrt(squared * squared_other)
        per_area = one_ / area[i]
        # docs/theory/multipath.md
        product = offset * (offset - raised) * per_ranges * per_area
        met = (offset < nothing) & (offset < raised)
        mirrored[i] = two * product - (middle * middle + a * b) * per_ranges
        weighed = half * (weight[i] + weight[i + 1]) * unit
        weighed = weighed if met else nothing
        if light:
            cosines = -offset / math.sqrt(squared * area[i]) - (offset - raised) / math.sqrt(squared_other * area[i])
            facing[i] = half * cosines
            scale[i] = weighed if rise >= 0 else -weighed
        else:
            spreading = r_middle * r_middle * per_ranges
            facing[i] = product
            scale[i] = weighed * math.sqrt(area[i]) * run * spreading * spreading / rise
        length_squared = run * run * (one_ + slope[i] * slope[i])
        uneven[i] = (length_squared > abs(rise) * r_middle) | (length_squared > fine * r_middle * r_middle)


@inlined_uncounted
def _mark_parted(segments, area, one, other, pair, hidden, all_parted, echoes):
    """Mark segments seen by both images that must be taken one by one; leave energy only to those seen whole."""
    # Comparisons with NaN, a hole in the bed, are false.
    launch, horizon, launch_other, horizon_other = one.launch, one.horizon, other.launch, other.horizon
    z, r, cut, energy, real = other.z, echoes.r, echoes.cut, echoes.energy, echoes.energy.dtype.type
    from_one, to_one, from_other, to_other = hidden
    reach, sea, nothing = pair.reach, -pair.other.above, real(0.0)
    for i in range(segments):
        seen = (launch[i + 1] > horizon[i]) & (launch_other[i + 1] > horizon_other[i]) & (area[i] == area[i])
        seen &= (r[i] < reach) | (r[i + 1] < reach)
        emerges = (horizon[i] > launch[i]) | (horizon_other[i] > launch_other[i])
        covered = (launch[i + 1] > from_one) & (launch[i] < to_one)
        covered |= (launch_other[i + 1] > from_other) & (launch_other[i] < to_other)
        dry = (z[i] >= sea) | (z[i + 1] >= sea)
        parted = seen & (emerges | covered | dry | cut[i] | all_parted)
        cut[i] = parted
        energy[i] = energy[i] if seen & (not parted) else nothing


@kernel_uncounted
def _note_whole_segments(profile, count, one, other, pair, echoes, contributions):
    """Note every segment that both images see whole; its energy is spread evenly over its slant range."""
    x, slope, area, material, row = profile.x, profile.slope, profile.area, profile.material, -1
    r, z_one, z_other, density, per_bin = echoes.r, one.z, other.z, echoes.energy, 1.0 / pair.bin_length
    own, first_row = contributor_row(contributions, 0), pair.path * (contributions.present.size // PATH_COUNT)
    for i in range(count - 1):
        if density[i] == 0.0:
            continue
        if first_row + material[i] != row:
            row = first_row + material[i]
            open_contributor(contributions, row)
            own = contributor_row(contributions, row)
        near, far = r[i] * per_bin, r[i + 1] * per_bin
        run, middle = (x[i + 1] - x[i]) / (far - near), 0.5 * (x[i] + x[i + 1])
        a, b, half = z_one[i] - slope[i] * x[i], z_other[i] - slope[i] * x[i], slope[i] * middle
        # Sound comes and goes at different incidences, the greater of which counts.
        nearer = max(a / math.hypot(middle, a + half), b / math.hypot(middle, b + half))
        facing = -nearer / math.sqrt(area[i]) * 0.5 * (near + far)
        spread_echo(
            own, SpreadEcho(min(near, far), max(near, far), abs(np.float64(density[i])), x[i] - near * run, run, facing)
        )


@kernel_uncounted
def _deposit_on_waves(count, x, z, pair, facets, echoes, bins):
    """Spread the energies of segments over the range bins, facet by facet of a rough sea."""
    energy, r, raised = echoes.energy, echoes.r, pair.other.height - pair.one.height
    per_bin, share = 1.0 / pair.bin_length, 1.0 / facets.shape[0]
    rms, variance = pair.rms_height, pair.slope_variance
    for i in range(count - 1):
        if energy[i] == 0.0:
            continue
        near, far = min(r[i], r[i + 1]), max(r[i], r[i + 1])
        whole = energy[i] * (r[i + 1] - r[i]) * per_bin * share
        middle, drop = 0.5 * (x[i] + x[i + 1]), -0.5 * (z[i] + z[i + 1])
        r_one, r_other = math.hypot(middle, drop), math.hypot(middle, drop + raised)
        rise = height_delay(pair.one, drop, r_one, rms) + height_delay(pair.other, drop + raised, r_other, rms)
        tilt = tilt_delay(pair.one, drop, r_one, variance) + tilt_delay(pair.other, drop + raised, r_other, variance)
        for f in range(facets.shape[0]):
            start = max(near + rise * facets[f, 0] + tilt * facets[f, 2], 0.0)
            stop = max(far + rise * facets[f, 1] + tilt * facets[f, 3], start)
            spread_energy(bins, start * per_bin, stop * per_bin, whole)


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
