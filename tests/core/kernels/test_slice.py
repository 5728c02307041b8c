"""Slices of the bed: every knot on it, at any azimuth, on any grid."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import naive
from beds import bed_of, rough
from insonify.compiler.jit import kernel
from insonify.kernels.bed.profile import AT_ONCE, Profile, empty_profile, profile_capacity
from insonify.kernels.bed.slice import slice_bed
from insonify.kernels.common.types import plain_pattern
from insonify.packing.scene_arrays import make_limits

REACH = 20.0
SPACING = 0.5
AXES = [0.0, 0.5 * math.pi, math.pi, -0.5 * math.pi, 0.25 * math.pi, -0.75 * math.pi]
LIMITS = make_limits([(1.0, 1.0, 40.0)], plain_pattern(), 0.05)
WHOLE = LIMITS._replace(misplaced=math.inf)  # nothing is divided


@kernel
def cut(bed, limits, x, y, z, ex, ey, reach, profile):
    return slice_bed(bed, limits, x, y, z, ex, ey, reach, profile)


def slice_of(bed, x, y, z, azimuth, reach=REACH, limits=LIMITS):
    """Knots x, z and the segments' slope and area."""
    ex, ey = (0.0 if abs(c) < 1e-12 else c for c in (math.cos(azimuth), math.sin(azimuth)))
    profile = empty_profile(profile_capacity(reach, bed.spacing))
    count = cut(bed, limits, x, y, z, ex, ey, reach, profile)
    knots, segments = slice(count), slice(max(count - 1, 0))
    slope, area = (column[segments].astype(float) for column in (profile.slope, profile.area))
    return (ex, ey), profile.x[knots], profile.z[knots], slope, area, profile.material[segments]


azimuths = st.floats(-math.pi, math.pi) | st.sampled_from(AXES) | st.floats(1e-9, 1e-3)
places = st.floats(-30.0, 30.0) | st.integers(-20, 20).map(lambda k: k * SPACING)


@settings(max_examples=150, deadline=None, derandomize=True)
@given(azimuth=azimuths, x=places, y=places, periodic=st.booleans(), seed=st.integers(0, 3))
def test_knots_lie_on_the_bed_and_segments_within_its_cells(azimuth, x, y, periodic, seed):
    bed = bed_of(rough(40, 36, 0.3, seed), SPACING, x0=-9.0, y0=-10.0, periodic=periodic)
    (ex, ey), r, z, slope, area, _ = slice_of(bed, x, y, 7.0, azimuth)
    if r.size == 0:
        assert not periodic
        return
    assert (np.diff(r) > 0.0).all()
    if periodic:
        assert r[0] == 0.0
        assert r[-1] == pytest.approx(REACH, abs=1e-6)
    height = naive.heights(bed, x + r * ex, y + r * ey) - 7.0
    inside = np.isfinite(height)
    # Rounding may put the two ends of a clipped plane a hair outside.
    assert (~inside).sum() <= 2
    np.testing.assert_allclose(z[inside], height[inside], atol=2e-6)
    np.testing.assert_allclose(slope, np.diff(z) / np.diff(r), rtol=1e-5, atol=1e-5)
    middle = 0.5 * (r[1:] + r[:-1])
    gx, gy = naive.gradients(bed, x + middle * ex, y + middle * ey)
    wanted = 1.0 + gx**2 + gy**2
    # A plane along a grid line belongs to either of two cells.
    u, v = (x + middle * ex + 9.0) / SPACING, (y + middle * ey + 10.0) / SPACING
    clear = np.minimum(abs(u - np.round(u)), abs(v - np.round(v))) > 2e-3
    clear &= np.isfinite(wanted)
    np.testing.assert_allclose(area[clear], wanted[clear], rtol=5e-3)


def test_knots_are_where_the_plane_crosses_either_family_of_lines():
    bed = bed_of(rough(40, 40, 0.3), 1.0, periodic=True)
    x, y, azimuth = 0.3, 0.4, math.atan2(3.0, 4.0)
    _, r, *_ = slice_of(bed, x, y, 5.0, azimuth, reach=10.0, limits=WHOLE)
    crossings = [(k - x) / 0.8 for k in range(1, 9)] + [(k - y) / 0.6 for k in range(1, 7)]
    expected = sorted([0.0, 10.0, *(c for c in crossings if c < 10.0)])
    merged = [a for a, b in zip(expected, [*expected[1:], math.inf]) if b - a > 1e-5]
    np.testing.assert_allclose(r, merged, atol=1e-5)


@pytest.mark.parametrize("azimuth", [0.0, 0.5 * math.pi, 0.6])
def test_divided_segments_keep_the_knots_of_the_cells_and_the_cell_between_them(azimuth):
    bed = bed_of(rough(40, 40, 0.3), SPACING, periodic=True)
    _, whole, *_ = slice_of(bed, 0.3, 0.4, 5.0, azimuth, limits=WHOLE)
    counts = []
    for misplaced in (0.1, 0.01, 0.001):
        _, r, *_ = slice_of(bed, 0.3, 0.4, 5.0, azimuth, limits=LIMITS._replace(misplaced=misplaced))
        assert np.isin(whole, r).all()
        counts.append(r.size)
    assert whole.size < counts[0] < counts[1] < counts[2]


def test_where_there_is_no_room_segments_get_fewer_parts():
    bed = bed_of(rough(40, 40, 3.0), SPACING, periodic=True)
    crowded = empty_profile(400)
    limits = LIMITS._replace(misplaced=1e-6)
    count = cut(bed, limits, 0.3, 0.4, 5.0, 0.8, 0.6, REACH, crowded)
    assert 57 < count <= 400
    assert (np.diff(crowded.x[:count]) > 0.0).all()


@pytest.mark.parametrize("azimuth", AXES)
@pytest.mark.parametrize("place", [(4.0, 6.0), (4.0, 6.2), (4.2, 6.0), (0.0, 0.0), (-4.0, 1000.0)])
def test_a_walk_from_a_knot_or_along_a_line_has_every_node(azimuth, place):
    bed = bed_of(rough(32, 32, 0.3), SPACING, periodic=True)
    _, r, z, *_ = slice_of(bed, *place, 5.0, azimuth)
    assert np.isfinite(z).all()
    diagonal = abs(math.sin(2.0 * azimuth)) > 0.5
    longest = SPACING * (math.sqrt(2.0) if diagonal else 1.0)
    assert np.diff(r).max() <= longest * (1.0 + 1e-6)
    assert r[-1] == pytest.approx(REACH)


def test_turned_by_a_quarter_or_far_from_the_origin_the_slice_is_the_same():
    heights = rough(40, 40, 0.3)
    turned = np.roll(np.rot90(heights, -1), 1, axis=1)  # (x, y) → (−y, x) on a period
    bed, other_bed = (bed_of(z, SPACING, periodic=True) for z in (heights, turned))
    for azimuth in (0.2, 1.1, 2.7):
        one = slice_of(bed, 2.2, 1.3, 5.0, azimuth)
        other = slice_of(other_bed, -1.3, 2.2, 5.0, azimuth + math.pi / 2.0)
        for a, b in zip(one[1:5], other[1:5]):
            np.testing.assert_allclose(a, b, rtol=1e-4, atol=1e-5)
    near, far = (slice_of(bed, 3.2 + k * 20.0, 5.1 - k * 20.0, 5.0, 0.7) for k in (0, 48_000))  # of periods of 20 m
    for a, b in zip(near[1:4], far[1:4]):
        np.testing.assert_allclose(a, b, atol=1e-4)


def test_outside_a_bed_without_period_or_off_its_only_row_there_is_none_and_missing_heights_stay_missing():
    bed = bed_of(np.zeros((11, 11)), 1.0)
    assert slice_of(bed, 20.0, 5.0, 5.0, 0.0)[1].size == 0
    assert slice_of(bed, 20.0, 25.0, 5.0, math.pi)[1].size == 0
    _, r, *_ = slice_of(bed, 20.0, 5.0, 5.0, math.pi)
    assert (r[0], r[-1]) == (pytest.approx(10.0), pytest.approx(20.0))
    _, r, *_ = slice_of(bed, 5.0, 5.0, 5.0, 0.3)
    assert r[-1] == pytest.approx(5.0 / math.cos(0.3))
    heights = np.zeros((21, 21))
    heights[10, 10] = np.nan
    _, r, z, *_ = slice_of(bed_of(heights, 1.0), 2.0, 10.3, 5.0, 0.0)
    np.testing.assert_allclose(r[np.isnan(z)], [8.0], atol=1e-6)
    row = bed_of(np.arange(12.0)[None, :], 1.0)
    _, r, z, slope, *_ = slice_of(row, 2.0, 0.0, 0.0, 0.0)
    np.testing.assert_allclose(r, np.arange(10.0), atol=1e-6)
    np.testing.assert_allclose(z, 2.0 + np.arange(10.0), atol=1e-5)
    np.testing.assert_allclose(slope, 1.0, rtol=1e-5)
    assert slice_of(row, 2.0, 0.0, 0.0, math.pi / 2.0)[1].size == 0
    assert slice_of(row, 2.0, 0.5, 0.0, 0.0)[1].size == 0
    repeated = bed_of(np.arange(12.0)[None, :], 1.0, periodic=True)
    _, r, z, *_ = slice_of(repeated, 2.0, 0.3, 0.0, math.pi / 2.0)
    np.testing.assert_allclose(z, 2.0, atol=1e-6)
    assert r[-1] == REACH


def test_materials_are_those_of_the_cells():
    rng = np.random.default_rng(2)
    materials = rng.integers(0, 4, (24, 20)).astype(np.uint8)
    bed = bed_of(np.zeros((24, 20)), 1.0, periodic=True)._replace(materials=materials, mapped=True)
    for azimuth in (*AXES, 0.3, 2.0, -1.0, -2.2):
        (ex, ey), r, *_, material = slice_of(bed, 3.3, 5.6, 5.0, azimuth)
        middle = 0.5 * (r[1:] + r[:-1])
        cells = np.floor(5.6 + middle * ey).astype(int) % 24, np.floor(3.3 + middle * ex).astype(int) % 20
        assert (material == materials[cells])[np.diff(r) > 1e-4].all()


@settings(max_examples=150, deadline=None, derandomize=True)
@given(azimuth=azimuths, x=places, y=places, reach=st.floats(1e-3, 3.0) | st.just(REACH))
def test_what_passes_leave_past_the_last_knot_stays_within_the_arrays(azimuth, x, y, reach):
    bed = bed_of(rough(40, 36, 0.3, 0), SPACING, periodic=True)
    capacity = profile_capacity(reach, SPACING)
    wider = empty_profile(capacity + 4 * AT_ONCE)
    for array in wider:
        array[capacity:] = 77
    profile = Profile(*(a[:capacity] for a in wider))
    count = cut(bed, LIMITS, x, y, 7.0, math.cos(azimuth), math.sin(azimuth), reach, profile)
    assert count + AT_ONCE <= capacity
    for array in wider:
        assert (array[capacity:] == 77).all()
