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
from insonify.kernels.common.range_bins import FIXED_POINT, spread_energy
from insonify.kernels.common.scattering import scatter_paired_segments
from insonify.kernels.common.types import LIGHT
from insonify.kernels.sweep.bed_stretches import FINE
from insonify.kernels.sweep.image_paths import path_delays
from insonify.kernels.sweep.segment_densities import deposit_densities
from insonify.kernels.sweep.stretches import note_whole_segments


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
        _measure_incidence(count - 1, profile, one.z, other.z, echoes.mirrored)
        note_whole_segments(
            profile.x, r, profile.range_ratio[:0], material, echoes.mirrored, echoes.energy, count, pair.path,
            pair.bin_length, sink.contributions,
        )  # fmt: skip


@inlined_uncounted
def _measure_pairs(segments, profile, one, pair, echoes):
    """Geometry of the echo of each segment at its middle, and marks of those too long for one density."""
    x, slope, area, z, weight, r = profile.x, profile.slope, profile.area, one.z, echoes.weight, echoes.r
    facing, mirrored, scale, uneven = echoes.cosines, echoes.mirrored, echoes.scale, echoes.cut
    real, light = scale.dtype.type, pair.law == LIGHT
    share = pair.orders * pair.one.share * pair.other.share * FIXED_POINT
    unit, raised = real(share if light else share * pair.bin_length), real(pair.raised)
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


@inlined_uncounted
def _measure_incidence(segments, profile, z_one, z_other, cos_squared):
    """Incidence of segments, its cosine squared at the middle: the greater one of both ways."""
    x, slope, area, nothing = profile.x, profile.slope, profile.area, cos_squared.dtype.type(0.0)
    for i in range(segments):
        middle, a, b = 0.5 * (x[i] + x[i + 1]), z_one[i] - slope[i] * x[i], z_other[i] - slope[i] * x[i]
        half = slope[i] * middle
        nearer = max(a / math.hypot(middle, a + half), b / math.hypot(middle, b + half))
        cos_squared[i] = nearer * nearer / area[i] if nearer < 0.0 else nothing


@kernel_uncounted
def _deposit_on_waves(count, x, z, pair, facets, echoes, bins):
    """Spread the energies of segments over the range bins, facet by facet of a rough sea."""
    energy, r, per_bin, share = echoes.energy, echoes.r, 1.0 / pair.bin_length, 1.0 / facets.shape[0]
    for i in range(count - 1):
        if energy[i] == 0.0:
            continue
        near, far = min(r[i], r[i + 1]), max(r[i], r[i + 1])
        whole = energy[i] * (r[i + 1] - r[i]) * per_bin * share
        middle, drop = 0.5 * (x[i] + x[i + 1]), -0.5 * (z[i] + z[i + 1])
        rise, tilt = path_delays(pair, drop, math.hypot(middle, drop), math.hypot(middle, drop + pair.raised))
        for f in range(facets.shape[0]):
            start = max(near + rise * facets[f, 0] + tilt * facets[f, 2], 0.0)
            stop = max(far + rise * facets[f, 1] + tilt * facets[f, 3], start)
            spread_energy(bins, start * per_bin, stop * per_bin, whole)
