"""Visibility along a profile: which segments rise above one running horizon, and how much energy they send back.

Every pass touches few arrays, so that the compiler can use its vector units.

Theory: docs/theory/sweep.md.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import DTypeLike, NDArray

from insonify.compiler.jit import inlined_uncounted
from insonify.kernels.beam.knot_weights import weigh_knots
from insonify.kernels.beam.pattern_samples import FINE_SINE, SampleRoom
from insonify.kernels.bed.grid import is_oblique
from insonify.kernels.bed.profile import WORD, padded_count
from insonify.kernels.common.range_bins import FIXED_POINT
from insonify.kernels.common.scattering import incidence_powers, scatter_segments
from insonify.kernels.common.types import LIGHT
from insonify.kernels.sweep.bed_stretches import FINE
from insonify.kernels.sweep.segment_densities import fit_densities

NADIR = -1e30  # slope of a ray straight down


class SegmentEchoes(NamedTuple):
    """Echoes of one profile's segments, before they are spread over range bins; one entry a knot, or a segment."""

    r: NDArray[np.float64]  # slant range of the knots, m
    launch: NDArray[np.float32]  # tan of the launch angle above the horizontal, knots
    horizon: NDArray[np.float32]  # greatest launch slope so far, knots
    weight: NDArray[np.float32]  # weight of the plane there, knots
    cos_squared: NDArray[np.float32]  # of the incidence, segments
    scale: NDArray[np.float32]  # what turns a scattering strength into energy per bin, segments
    energy: NDArray[np.float32]  # per bin in fixed-point units, of segments visible whole
    cut: NDArray[np.bool_]  # marks of segments visible in part, or too long for one density
    marked: NDArray[np.int32]  # indices of marked segments
    change: NDArray[np.float32]  # relative change of the density of energy from end to end, segments of oblique planes
    place: NDArray[np.int32]  # bin of a knot
    early: NDArray[np.int64]  # step of the density at a knot: what that bin takes
    late: NDArray[np.int64]  # and what the next bin takes
    third: NDArray[np.int64]  # of oblique planes, what the bin after that takes
    fourth: NDArray[np.int64]  # and the one after
    beyond: NDArray[np.bool_]  # marks of segments of oblique planes over three borders or more
    even: NDArray[np.int64]  # difference arrays of oblique planes, of every other knot; cleared between planes
    odd: NDArray[np.int64]


def empty_segment_echoes(capacity: int, bins: int, dtype: DTypeLike = np.float32) -> SegmentEchoes:
    """Make room for the echoes of profiles."""
    launch, horizon, weight, cos_squared, scale, energy, change = np.zeros((7, capacity), dtype)
    r, (place, marked) = np.zeros(capacity), np.zeros((2, capacity), np.int32)
    cut, beyond = np.zeros(capacity + WORD, np.bool_), np.zeros(capacity + WORD, np.bool_)
    early, late, third, fourth = np.zeros((4, capacity), np.int64)
    even, odd = np.zeros((2, bins + 4), np.int64)
    return SegmentEchoes(
        r, launch, horizon, weight, cos_squared, scale, energy, cut, marked, change, place, early, late, third, fourth,
        beyond, even, odd,
    )  # fmt: skip


@inlined_uncounted
def find_visible_echoes(profile, count, plane, arrays, sector, hidden_from, hidden_to, echoes):
    """Find which segments of a profile are visible whole, their energy, and which must be cut first."""
    x, z, area, knots = profile.x, profile.z, profile.area, padded_count(count)
    slant_ranges(knots, x, z, echoes.r)
    launch_slopes(knots, x, z, echoes.launch)
    running_horizon(count, echoes.launch, echoes.horizon)
    _measure_segments(knots, profile, echoes, arrays.law, arrays.bin_length)
    if sector.bent:
        _measure_incidence(knots, profile.facing, area, echoes.r, echoes.cos_squared)
    if sector.angle > 0.0 or sector.tabulated or sector.bent:
        # Padding past the last knot may hold any number, which must not index a pattern's table.
        x = x[: count if sector.tabulated else knots]
        weigh_knots(x, z, echoes.r, sector, arrays.pattern, arrays.law, FINE_SINE, sample_room(echoes), echoes.weight)
        if sector.bent:
            _apply_gain(knots, profile.gain, echoes.weight)
        _apply_weights(knots, echoes.weight, echoes.scale)
    cos_squared, scale, table = echoes.cos_squared, echoes.scale, arrays.reflectivity
    scatter_segments(knots, profile.material, table, arrays.bed.mapped, arrays.law, cos_squared, scale, echoes.energy)
    if is_oblique(plane.ex, plane.ey):
        reflectors = profile.material, table, arrays.bed.mapped
        incidence_powers(knots, reflectors, arrays.law, cos_squared, scale, echoes.energy, echoes.change)
        fit_densities(knots, profile, plane, arrays.law, echoes.r, echoes.change)
    _mark_cut(knots, echoes.launch, echoes.horizon, area, hidden_from, hidden_to, echoes.cut, echoes.energy)
    echoes.energy[count - 1] = 0.0


@inlined_uncounted
def sample_room(echoes):
    """Work space for the samples of a pattern, in the memory of arrays that are filled only afterwards."""
    early, late, third = echoes.early.view(np.float64), echoes.late.view(np.float64), echoes.third.view(np.float64)
    return SampleRoom(echoes.place, early, late, third, echoes.fourth.view(np.float64))


@inlined_uncounted
def slant_ranges(count, x, z, r):
    """Slant range of each knot."""
    for i in range(count):
        r[i] = math.sqrt(x[i] * x[i] + z[i] * z[i])


@inlined_uncounted
def launch_slopes(count, x, z, launch):
    """Launch slope of each knot, z / x."""
    real = launch.dtype.type
    for i in range(count):
        launch[i] = real(z[i]) / real(x[i])
    if x[0] <= 0.0 and z[0] == z[0]:
        launch[0] = NADIR  # straight down, whatever the knot's height


@inlined_uncounted
def running_horizon(count, launch, horizon):
    """Greatest launch slope up to each knot: along four stretches side by side, each then raised to those before it."""
    # NaN, a hole in the bed, compares false and hides nothing.
    quarter = count // 4
    two, three, four = 2 * quarter, 3 * quarter, 4 * quarter
    a = b = c = d = launch.dtype.type(NADIR)
    for i in range(quarter):
        a = launch[i] if launch[i] > a else a
        b = launch[quarter + i] if launch[quarter + i] > b else b
        c = launch[two + i] if launch[two + i] > c else c
        d = launch[three + i] if launch[three + i] > d else d
        horizon[i], horizon[quarter + i], horizon[two + i], horizon[three + i] = a, b, c, d
    for i in range(four, count):
        d = launch[i] if launch[i] > d else d
        horizon[i] = d
    _raise_horizon(horizon[quarter:two], a)
    _raise_horizon(horizon[two:three], max(a, b))
    _raise_horizon(horizon[three:count], max(a, b, c))


@inlined_uncounted
def _raise_horizon(horizon, least):
    """Raise a stretch of the horizon to the greatest launch slope before it."""
    for i in range(horizon.size):
        horizon[i] = horizon[i] if horizon[i] > least else least


@inlined_uncounted
def _measure_segments(segments, profile, echoes, law, bin_length):
    """Incidence of segments, their energy per unit of strength, and marks of those too long for one density."""
    # The incidence, its cosine squared, is that at the middle, from the height of the segment's line over nadir. Law
    # `light`: a bin takes the radiance itself. Law `sonar`: area over slant range, of a strip 1 m wide. Both are
    # negative where a segment comes nearer outwards. A segment is too long against its range, or near its
    # perpendicular's foot.
    x, z, slope, area, r = profile.x, profile.z, profile.slope, profile.area, echoes.r
    cos_squared, scale, uneven = echoes.cos_squared, echoes.scale, echoes.cut
    real = scale.dtype.type
    one, fine, unit = real(1.0), real(FINE * FINE), real(FIXED_POINT if law == LIGHT else FIXED_POINT * bin_length)
    for i in range(segments):
        run, rise, middle = real(x[i + 1] - x[i]), real(r[i + 1] - r[i]), real(0.5 * (r[i] + r[i + 1]))
        offset, middle_squared = real(z[i] - slope[i] * x[i]), middle * middle
        cos_squared[i] = offset * offset / (middle_squared * area[i])  # docs/theory/sweep.md
        if law == LIGHT:
            scale[i] = unit if rise >= 0 else -unit
        else:
            scale[i] = unit * math.sqrt(area[i]) * run / rise
        length_squared = run * run * (one + slope[i] * slope[i])
        uneven[i] = (length_squared > abs(rise) * middle) | (length_squared > fine * middle_squared)


@inlined_uncounted
def _measure_incidence(segments, facing, area, r, cos_squared):
    """Incidence of segments in water that refracts, its cosine squared at the middle."""
    real = cos_squared.dtype.type
    for i in range(segments):
        middle = real(0.5 * (r[i] + r[i + 1]))
        cos_squared[i] = facing[i] * facing[i] / (middle * middle * area[i])


@inlined_uncounted
def _apply_gain(count, gain, weights):
    """Multiply the weights of knots by the gain of refraction."""
    for i in range(count):
        weights[i] *= gain[i]


@inlined_uncounted
def _apply_weights(segments, weights, scale):
    """Multiply the energy of each segment by the mean weight of its two knots."""
    half = scale.dtype.type(0.5)
    for i in range(segments):
        scale[i] *= half * (weights[i] + weights[i + 1])


@inlined_uncounted
def _mark_cut(segments, launch, horizon, area, hidden_from, hidden_to, cut, energy):
    """Mark visible segments that are uneven, rise above the horizon or may lie behind a target; clear their energy."""
    # Energy is left only to segments visible whole. A hole in the bed has the area NaN, which is unequal to itself.
    real = launch.dtype.type
    hidden_from, hidden_to, nothing = real(hidden_from), real(hidden_to), real(0.0)
    for i in range(segments):
        seen = (launch[i + 1] > horizon[i]) & (area[i] == area[i])
        covered = (launch[i + 1] > hidden_from) & (launch[i] < hidden_to)
        emerges = horizon[i] > launch[i]
        parted = seen & (emerges | covered | cut[i])
        cut[i] = parted
        energy[i] = energy[i] if seen & (not parted) else nothing
