"""The sweep: slow twins first, then invariants, then the edges of what there can be."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import naive
from beds import arrays_of, poses_of, rough
from insonify.acoustics.flat_bed import flat_bed_curve
from insonify.kernels.common.types import LIGHT, SONAR
from insonify.scene import edit, load_scene
from insonify.simulation import simulate
from insonify.statistics.record_errors import compare_records
from insonify.tracers import ray_sheets, rays, sweep

FLAT = np.zeros((4, 4))
FAN = math.radians(1.25)
GLOSSY = (0.6, 0.3, 6.0)
# What a sweep of cells four times as long as bins, and brute force of finite samples, may differ by.
NEAR = 0.03


def distance(a, b):
    return np.linalg.norm(np.asarray(a, float) - b) / np.linalg.norm(b)


def quiet(arrays, poses, **options):
    """Trace, and see that nothing is negative or not a number."""
    record = sweep.trace(arrays, poses, **options)
    assert np.isfinite(record).all()
    assert (record >= 0.0).all()
    return record


@settings(max_examples=12, deadline=None, derandomize=True)
@given(
    seed=st.integers(0, 1000),
    x=st.integers(-50, 50).map(lambda k: 0.37 * k + 0.11),  # off the grid's lines, where the bed has no one gradient
    heading=st.floats(-3.2, 3.2) | st.sampled_from([0.0, math.pi / 2.0, math.pi / 4.0]),
    altitude=st.floats(2.5, 10.0),
    law=st.sampled_from([LIGHT, SONAR]),
    bodies=st.booleans(),
)
def test_knife_agrees_with_brute_force(seed, x, heading, altitude, law, bodies):
    solids = [((3.0, 12.0, 0.6), 0.5), ((0.0, -14.0, 0.5), (8.0, -12.0, 0.9), 0.4), ((1.0, 9.0, 4.0), 0.3)]
    arrays = arrays_of(
        rough(64, 64, 0.1, seed), 0.5, periodic=True, bins=100, bin_length=0.25, law=law,
        solids=solids if bodies else (), reflectivity=[GLOSSY],
    )  # fmt: skip
    record = quiet(arrays, poses_of(x, 2.2, altitude, heading))[0]
    twin = naive.naive_ping(arrays, x, 2.2, altitude, heading)
    assert distance(record, twin) < NEAR
    assert record.sum(dtype=float) == pytest.approx(twin.sum(), rel=0.01)


@pytest.mark.parametrize("heading", [0.0, 0.6])
def test_glints_in_coarse_bins_are_weighed_by_their_own_range(heading):
    """By spreading at the centres of bins the records are 1.0 % and 6.9 % off."""
    options = {"reflectivity": [(0.02, 0.8, 50.0)], "bins": 100, "bin_length": 0.4, "spreading": True}
    arrays = arrays_of(rough(256, 256, 0.16, 5), 0.1, periodic=True, **options)
    poses = poses_of([0.0371, 1.0371], 0.0, 8.0, heading)
    twin = np.array([naive.naive_ping(arrays, x, 0.0, 8.0, heading, samples_per_cell=400) for x in poses.x])
    by_rays = rays.trace(arrays, poses, rays=1 << 16)
    by_sheets = ray_sheets.trace(arrays, poses, sheets=1, rays=1 << 14)
    for record, error in ((quiet(arrays, poses), 0.003), (by_rays, 0.006), (by_sheets, 0.006)):
        assert compare_records(arrays, poses, record, twin).beyond < error


@pytest.mark.parametrize("law", [LIGHT, SONAR])
@pytest.mark.parametrize(("width", "error"), [(24.0, 0.03), (60.0, 0.06)])
def test_fan_agrees_with_brute_force(law, width, error):
    # Broad beams keep the error of planes that are fixed while the cone bends, within a few per cent.
    arrays = arrays_of(
        rough(64, 64, 0.15), 0.5, periodic=True, bins=120, bin_length=0.2, half_width=math.radians(width / 2.0),
        solids=[((3.0, 12.0, 0.6), 0.5)], reflectivity=[GLOSSY], law=law,
    )  # fmt: skip
    poses = poses_of(3.05, 2.2, 6.0, 0.1)
    record = quiet(arrays, poses, planes=96)[0]
    azimuths = (np.arange(240) + 0.5) / 240 * math.pi - math.pi / 2
    twin = naive.naive_ping(arrays, 3.05, 2.2, 6.0, 0.1, samples_per_cell=30, azimuths=azimuths)
    assert distance(record, twin) < error
    assert record.sum(dtype=float) == pytest.approx(twin.sum(), rel=0.01)
    assert distance(rays.trace(arrays, poses, rays=1 << 18)[0], twin) < 0.01


@settings(max_examples=12, deadline=None, derandomize=True)
@given(
    seed=st.integers(0, 1000),
    x=st.floats(-20.0, 20.0),
    y=st.floats(-20.0, 20.0),
    heading=st.floats(-3.2, 3.2) | st.sampled_from([0.0, math.pi / 2.0]),
    rms=st.floats(0.0, 0.12),
    law=st.sampled_from([LIGHT, SONAR]),
    half_width=st.sampled_from([0.0, 0.03]),
)
def test_agrees_with_rays_over_any_bed(seed, x, y, heading, rms, law, half_width):
    solids = [((x - 9.0 * math.sin(heading), y + 9.0 * math.cos(heading), 0.8), 0.7)]
    arrays = arrays_of(
        rough(64, 64, rms, seed) if rms else np.zeros((64, 64)), 0.4, periodic=True, bins=150, bin_length=0.2,
        half_width=half_width, law=law, solids=solids, reflectivity=[GLOSSY],
    )  # fmt: skip
    poses = poses_of(x, y, 6.0, heading)
    curve = flat_bed_curve(arrays, 6.0)[38:]
    record = quiet(arrays, poses, planes=32)[0, :, 38:] / curve
    traced = rays.trace(arrays, poses, rays=1 << 15)[0, :, 38:] / curve
    assert distance(record, traced) < NEAR
    assert record.sum() == pytest.approx(traced.sum(), rel=0.01)


@pytest.mark.parametrize("law", [LIGHT, SONAR])
def test_no_energy_is_lost_between_bed_and_bins(law):
    # However the range is cut into bins, the sum over them stays.
    heights = rough(64, 64, 0.2)
    sums = []
    for bins in (1, 3, 40, 1000, 7000):
        arrays = arrays_of(heights, 0.5, periodic=True, law=law, bins=bins, bin_length=35.0 / bins, half_width=FAN)
        record = quiet(arrays, poses_of(3.3, 1.2, 8.0, 0.2))[0].astype(float)
        sums.append(record.sum(axis=1) * (35.0 / bins if law == LIGHT else 1.0))
    np.testing.assert_allclose(sums[1:], [sums[-1]] * 4, rtol=2e-3)
    # No piece is cut finer than a bin, not even under the fish.
    np.testing.assert_allclose(sums[0], sums[-1], rtol=0.01)


@pytest.mark.parametrize("half_width", [0.0, FAN])
@pytest.mark.parametrize("place", [(4.0, 6.0), (4.0, 6.2), (4.2, 6.0)])
@pytest.mark.parametrize("heading", [0.0, math.pi / 2.0, math.pi / 4.0])
def test_exactly_over_a_knot_is_like_beside_it(half_width, place, heading):
    arrays = arrays_of(rough(64, 64, 0.1), 0.5, periodic=True, half_width=half_width)
    x, y = place
    over, beside = quiet(arrays, poses_of([x, x + 3e-4], [y, y + 2e-4], 8.0, heading))
    assert over[:, 170:].any(axis=1).all()
    assert distance(over, beside) < 0.01


@pytest.mark.parametrize("slope", [-0.8, -0.1, 0.3, 2.0])
def test_a_slope_agrees_with_brute_force(slope):
    # Falling away, rising, and steeper than the line of sight.
    y = np.arange(200) * 0.25 - 25.0
    heights = np.tile((slope * y)[:, None], (1, 8))
    arrays = arrays_of(heights, 0.25, x0=-0.875, y0=-25.0, bins=200, bin_length=0.1)
    record = quiet(arrays, poses_of(0.0, 0.0, 5.0))[0]
    twin = naive.naive_ping(arrays, 0.0, 0.0, 5.0, 0.0, samples_per_cell=400)
    assert distance(record, twin) < 0.02
    # Nearest is the foot of the perpendicular, on the falling side, nadir on the other.
    assert min(np.flatnonzero(side)[0] for side in record) == int(5.0 / math.hypot(1.0, slope) / 0.1)


@pytest.mark.parametrize("half_width", [0.0, 0.03])
def test_holes_in_the_bed_return_nothing_and_spoil_nothing(half_width):
    heights = rough(100, 80, 0.05)
    heights[60, 30:40] = np.nan
    heights[20:25, 33] = np.nan
    arrays = arrays_of(heights, 0.2, bins=300, half_width=half_width)
    poses = poses_of(np.linspace(5.0, 9.0, 40), 8.05, 4.0)
    record = quiet(arrays, poses)
    traced = rays.trace(arrays, poses, rays=1 << 14)
    assert distance(record[..., 120:], traced[..., 120:]) < 0.03
    hole = slice(int(math.hypot(3.8, 4.1) / 0.05), int(math.hypot(4.1, 3.9) / 0.05))
    if not half_width:
        assert not record[15:25, 0, hole].any()


@pytest.mark.parametrize(("bins", "pings"), [(1, 1), (1, 5), (7, 1), (300, 0)])
def test_the_smallest_records(bins, pings):
    arrays = arrays_of(rough(16, 16, 0.1), 0.5, periodic=True, bins=bins, bin_length=30.0 / bins, half_width=FAN)
    record = quiet(arrays, poses_of(np.arange(float(pings)), 0.0, 5.0))
    assert record.shape == (pings, 2, bins)
    assert record.any() == (pings > 0)
    assert bins > 1 or (record > 0.0).all()


@pytest.mark.parametrize("shape", [(1, 40), (40, 1), (1, 1), (2, 2)])
def test_grids_of_one_row(shape):
    for periodic in (False, True):
        arrays = arrays_of(np.zeros(shape), 0.5, periodic=periodic, bins=200, half_width=FAN)
        record = quiet(arrays, poses_of([0.0, 0.25, 3.0], [0.0, 0.25, 3.0], 4.0))
    np.testing.assert_allclose(record[1, 0, 100:], flat_bed_curve(arrays, 4.0)[100:], rtol=0.03)  # of the periodic one


def test_nothing_in_the_way_of_a_target_above_a_hole():
    arrays = arrays_of(np.full((40, 40), np.nan), 0.5, solids=[((10.0, 15.0, 2.0), 1.0)], bins=400)
    record = quiet(arrays, poses_of(10.0, 5.0, 4.0))[0]
    heard = np.flatnonzero(record[0]) * 0.05
    assert heard[0] == pytest.approx(math.hypot(10.0, 2.0) - 1.0, abs=0.051)
    assert not record[1].any()


def test_a_fish_in_or_under_the_bed_and_a_squinting_beam_over_a_bed_out_of_reach_hear_nothing():
    assert not quiet(arrays_of(FLAT, periodic=True), poses_of([0.0, 0.0], 0.0, [-1.0, 0.0])).any()
    high = {"sonar.range": 45.0, "seabed.depth": 131.0, "track.altitude": 60.0, "targets": [], "track.pings": 2}
    scene = edit(load_scene("default"), {**high, "sonar.beam": {"kind": "array", "squint": 9.4}})
    assert (simulate(scene, forced={"planes": "4"}).intensity == 0.0).all()
