"""Where methods of this kind are known to fail: each test is a trigger and the right behaviour."""

import ast
import math
from pathlib import Path

import numpy as np
import pytest

from beds import arrays_of, poses_of, rough
from insonify import kernels
from insonify.compiler.jit import FAST
from insonify.kernels.common.types import BED, LIGHT, SONAR
from insonify.scene import edit, load_scene
from insonify.simulation import prepare, simulate
from insonify.tracers import rays, sweep

FLAT = np.zeros((4, 4))
FAN = math.radians(1.25)


def flat(**options):
    return arrays_of(FLAT, 0.1, periodic=True, **options)


def test_range_factors_come_after_the_sum():
    bins = 3000
    arrays = arrays_of(FLAT, 0.1, periodic=True, bins=bins, spreading=True, half_width=FAN)
    bare = arrays._replace(range_factor=np.ones(bins))  # weighed within bins all the same
    poses = poses_of(1.0, 1.0, 5.0)
    ours = sweep.trace(arrays, poses)[0, 0].astype(float)
    np.testing.assert_allclose(ours, sweep.trace(bare, poses)[0, 0] * arrays.range_factor, rtol=3e-7)


@pytest.mark.parametrize("law", [LIGHT, SONAR])
@pytest.mark.parametrize("half_width", [0.0, FAN])
def test_what_nothing_touches_is_exactly_zero_and_nothing_is_negative(law, half_width):
    solids = [((k * 3.0, 9.0 + 2.0 * k, 0.8), 0.7) for k in range(8)] + [((-40.0, 20.0, 4.0), (60.0, 20.0, 4.0), 1.5)]
    arrays = arrays_of(
        rough(256, 256, 0.4), 0.2, periodic=True, bins=2000, law=law, half_width=half_width, solids=solids,
        spreading=law == SONAR,
    )  # fmt: skip
    record = sweep.trace(arrays, poses_of(np.arange(40) * 0.6, 0.3, 6.0))
    assert (record >= 0.0).all()
    assert np.isfinite(record).all()
    assert not record[:, :, : int(4.0 / 0.05)].any()
    # Between echoes there are silent bins, and many of them.
    silent = (record[:, 0, 400:] == 0.0).mean()
    assert silent > 0.05


@pytest.mark.parametrize("half_width", [0.0, FAN])
def test_large_coordinates_give_the_record_of_the_same_bed_moved(half_width):
    heights = rough(200, 200, 0.1)
    records = []
    for east, north in ((0.0, 0.0), (1e6, 4e6)):
        ball = ((east + 20.0, north + 30.0, 0.8), 0.7)
        arrays = arrays_of(heights, 0.25, x0=east, y0=north, bins=300, half_width=half_width, solids=[ball])
        records.append(sweep.trace(arrays, poses_of(east + np.arange(20.0, 24.0), north + 20.3, 5.0, 0.1)))
    difference = np.linalg.norm(records[1].astype(float) - records[0]) / np.linalg.norm(records[0])
    assert difference < 1e-3


@pytest.mark.parametrize("method", ["sweep", "rays"])
def test_a_track_that_starts_far_away_on_a_bed_without_end(method):
    changes = {"track.pings": 3, "targets": [], "sonar.beam": "knife", "sonar.pulse": "ideal", "sonar.bins": 300}
    scene = edit(load_scene("default"), changes)
    periods = 10_000  # of 102.4 m
    near, far = (
        simulate(edit(scene, {"track.start": [start, 0.3]}), method=method).intensity.values
        for start in (0.7, 0.7 + 102.4 * periods)
    )
    assert np.linalg.norm(far - near) < (1e-3 if method == "sweep" else 0.02) * np.linalg.norm(near)


def test_rays_at_nodes_and_edges_leak_nowhere():
    arrays = arrays_of(rough(32, 32, 0.3), 0.5, periodic=True)
    z = arrays.bed.heights.astype(float)
    origin = np.array([4.1, 6.3, 9.0])
    nodes = [(i * 0.5, j * 0.5, z[j, i]) for i in range(32) for j in range(32)]
    edges = [(i * 0.5 + 0.25, j * 0.5, 0.5 * (z[j, i] + z[j, (i + 1) % 32])) for i in range(32) for j in range(32)]
    directions = np.array(nodes + edges) - origin
    lengths = np.linalg.norm(directions, axis=1)
    distance, what, _ = rays.cast(arrays, origin, directions)
    assert (what == BED).all()
    assert (distance <= lengths + 1e-5).all()


def test_bodies_that_touch_are_heard_once():
    # Two halves of one pipe, end to end, and one on top of itself: as loud as the pipe alone.
    poses = poses_of(np.linspace(-2.0, 2.0, 21), 0.0, 8.0)
    whole, halves, twice = (
        sweep.trace(flat(solids=bodies, half_width=FAN), poses)
        for bodies in (
            [((-5.0, 12.0, 0.5), (5.0, 12.0, 0.5), 0.5)],
            [((-5.0, 12.0, 0.5), (0.0, 12.0, 0.5), 0.5), ((0.0, 12.0, 0.5), (5.0, 12.0, 0.5), 0.5)],
            [((-5.0, 12.0, 0.5), (5.0, 12.0, 0.5), 0.5)] * 2,
        )
    )
    for other in (halves, twice):
        assert np.linalg.norm(other - whole) < 2e-3 * np.linalg.norm(whole)


def test_a_body_sunk_into_the_bed_is_heard_by_its_top():
    # Half a ball: the bed hides its lower half, and a ball wholly beneath hides nothing.
    half, sunk, bare = (
        sweep.trace(flat(solids=bodies, bins=4000, bin_length=0.01), poses_of(0.0, 0.0, 10.0))[0, 0].astype(float)
        for bodies in ([((0.0, 20.0, 0.0), 1.0)], [((0.0, 20.0, -1.5), 1.0)], [])
    )
    np.testing.assert_allclose(sunk, bare, rtol=0.02, atol=1e-4 * bare.max())
    assert sunk.sum() == pytest.approx(bare.sum(), rel=1e-4)
    reach = math.hypot(20.0, 10.0)
    # Its nearest point is above the bed, and its shadow ends with the ray over its top.
    changed = np.flatnonzero(abs(half - bare) > 0.05 * bare[1900:2300].max())
    assert changed[0] * 0.01 == pytest.approx(reach - 1.0, abs=0.02)
    ends = 10.0 / math.sin(math.atan2(10.0, 20.0) - math.asin(1.0 / reach))
    silent = np.flatnonzero(half[1100:] == 0.0) + 1100
    assert (silent[-1] + 1) * 0.01 == pytest.approx(ends, abs=0.011)


@pytest.mark.parametrize("half_width", [0.0, FAN])
@pytest.mark.parametrize("height", [0.5, 4.0])
def test_a_body_beneath_the_sonar_hides_nadir_on_both_sides(half_width, height):
    arrays = flat(solids=[((0.0, 0.0, height), 0.5)], half_width=half_width)
    port, starboard = sweep.trace(arrays, poses_of(0.0, 0.0, 8.0))[0].astype(float)
    np.testing.assert_allclose(port, starboard, rtol=1e-4, atol=1e-6 * port.max())
    assert np.flatnonzero(port)[0] == pytest.approx((7.5 - height) / 0.05, abs=1.001)
    # The bed begins where the ray past the body lands.
    if not half_width:
        lands = 8.0 / math.cos(math.asin(0.5 / (8.0 - height)))
        between = port[math.ceil((8.0 - height) / 0.05) + 1 : int(lands / 0.05) - 1]
        assert not between.any()
        assert port[int(lands / 0.05) + 1] > 0.0


def test_a_body_behind_or_abreast_of_another_side_changes_nothing():
    bare = sweep.trace(flat(), poses_of(0.0, 0.0, 8.0))[0]
    behind = sweep.trace(flat(solids=[((0.0, -12.0, 1.0), 1.0)]), poses_of(0.0, 0.0, 8.0))[0]
    ahead = sweep.trace(flat(solids=[((30.0, 0.0, 1.0), 1.0)]), poses_of(0.0, 0.0, 8.0))[0]
    np.testing.assert_array_equal(behind[0], bare[0])
    assert not np.array_equal(behind[1], bare[1])
    np.testing.assert_array_equal(ahead, bare)


def test_a_body_beyond_the_range_changes_nothing_and_one_across_its_end_is_cut():
    bare = sweep.trace(flat(bins=400), poses_of(0.0, 0.0, 8.0))[0]
    beyond = sweep.trace(flat(bins=400, solids=[((0.0, 25.0, 1.0), 1.0)]), poses_of(0.0, 0.0, 8.0))[0]
    np.testing.assert_array_equal(beyond, bare)
    across = sweep.trace(flat(bins=400, solids=[((0.0, 19.7, 1.0), 1.0)]), poses_of(0.0, 0.0, 8.0))[0]
    assert across[0, -1] > 2.0 * bare[0, -1]


@pytest.mark.parametrize("altitude", [1e-3, 0.02, 1000.0])
@pytest.mark.parametrize("half_width", [0.0, 1e-3, math.radians(30.0)])
def test_a_fish_on_the_bed_or_far_above_it_makes_numbers(altitude, half_width):
    record = sweep.trace(flat(half_width=half_width, spreading=True), poses_of(0.03, 0.04, altitude))
    assert np.isfinite(record).all()
    assert (record >= 0.0).all()
    assert record.any() == (altitude < 50.0)


def test_no_targets_and_none_in_sight_are_the_same():
    scene = edit(load_scene("default"), {"track.pings": 4})
    away = [{"kind": "sphere", "position": [0.0, 500.0], "radius": 0.5}]
    pings = np.arange(4)
    none, far = (prepare(edit(scene, {"targets": targets}), method="sweep") for targets in ([], away))
    traced = [sweep.trace(one.arrays, one.poses(pings), planes=8) for one in (none, far)]
    np.testing.assert_array_equal(*traced)


def test_kernels_raise_nothing_and_leave_threads_to_others():
    # Inside a parallel kernel an exception is swallowed and its result half filled.
    for source in sorted(Path(kernels.__file__).parent.rglob("*.py")):
        tree = ast.parse(source.read_text(encoding="utf-8"))
        assert not [node for node in ast.walk(tree) if isinstance(node, ast.Raise)], source.name
        assert "prange" not in {node.id for node in ast.walk(tree) if isinstance(node, ast.Name)}, source.name


def test_kernels_keep_their_guards_against_nan():
    assert not FAST & {"nnan", "ninf", "fast"}
