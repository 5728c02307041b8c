"""Scenes over endless ground: windows that no record shows."""

import gc
import itertools
import sys
import weakref
from dataclasses import replace
from unittest.mock import Mock

import numpy as np
import pytest

from beds import bed_of
from commands import wait_until
from insonify.array_cache import ARRAYS
from insonify.packing import terrain_tiles
from insonify.packing.packed_scene import pack
from insonify.scene import build, edit
from insonify.simulation import prepare, simulate_blocks
from insonify.terrain import Ground, StoredWindow, build_excerpt, build_ground, relief, relief_picture
from insonify.terrain.endless_field import PART, TILE, EndlessField, Nodes, gather_tiles
from insonify.tow.line import tow_line_at
from insonify.tracers import sweep

SOFT = {"clamp": "soft", "coefficients": "gaussian"}
FRACTAL = {"kind": "fractal", "beta": 1.6, "rms": 0.1, "period": 25.6, "extent": "endless"} | SOFT
SIDE = 0.4 * TILE  # m
# A tow that crosses from window to window in x and in y.
SCENE = build(
    {
        "seabed": {"depth": 30.0, "spacing": 0.4, "relief": FRACTAL},
        "sonar": {"range": 30.0, "bins": 150, "beam": "knife", "ping_rate": 10.0},
        "track": {"start": [SIDE - 3.0, SIDE - 2.0], "heading": 30.0, "altitude": 6.0, "speed": 2.0, "pings": 40},
    }
)
PINGS = np.arange(40)
NO_TILE = Mock(side_effect=AssertionError("a tile is made"))


@pytest.fixture(scope="module")
def record():
    return prepare(SCENE).intensity(PINGS)


def test_a_record_across_windows_does_not_depend_on_how_pings_are_split(record):
    simulation = prepare(SCENE)
    poses = simulation.poses(PINGS)
    assert len(np.unique(simulation.ground.cell(poses.x, poses.y), axis=0)) == 3
    assert record[:, :, 60:].min() >= 0.0
    assert (record[:, :, 60:].mean(axis=2) > 0.0).all()
    blocks = list(simulate_blocks(SCENE, block=7))
    split = np.concatenate([np.moveaxis(block.intensity.values, 1, 0) for block in blocks])
    np.testing.assert_array_equal(split, record)
    np.testing.assert_array_equal(prepare(SCENE).intensity(PINGS[::-1])[::-1], record)


def test_record_is_that_over_a_bed_held_whole(record):
    simulation = prepare(SCENE)
    nodes = gather_tiles(simulation.ground.heights, (TILE - 150, TILE - 150), (400, 400))
    corner = 0.4 * (TILE - 150)
    bed = bed_of(nodes, 0.4, x0=corner, y0=corner)
    whole = edit(SCENE, {"sonar.pulse": "ideal"})
    held = sweep.trace(simulation.reduced._replace(bed=bed), simulation.poses(PINGS), **simulation.plan.settings)
    np.testing.assert_allclose(prepare(whole).intensity(PINGS), held, rtol=2e-4, atol=2e-5 * held.max())


@pytest.mark.parametrize("method", ["march", "rays"])
def test_every_method_and_the_truth_go_from_window_to_window(method):
    simulation = prepare(edit(SCENE, {"sonar.bins": 40}), method=method)
    found = simulation.intensity(PINGS[::8])
    np.testing.assert_array_equal(found, np.concatenate([simulation.intensity(PINGS[k : k + 1]) for k in PINGS[::8]]))
    assert (found[:, :, 20:].mean(axis=2) > 0.0).all()
    simulation = prepare(SCENE)
    whole = simulation.truth(PINGS)
    for k in (0, 17, 39):
        for part, column in zip(simulation.truth(PINGS[k : k + 1]), whole):
            np.testing.assert_array_equal(part[0], column[k])


def test_heights_are_those_of_the_window():
    ground = build_ground(SCENE)
    rng = np.random.default_rng(2)
    x, y = rng.uniform(SIDE - 20.0, SIDE + 20.0, (2, 50))
    window = ground.around((SIDE - 1.0, SIDE - 1.0), 30.0)
    assert isinstance(window, Ground)
    np.testing.assert_allclose(window.height_at(x, y), ground.height_at(x, y), atol=1e-6)
    np.testing.assert_array_equal(ground.height_near(x, y), ground.height_at(x, y))
    picture = relief_picture(SCENE)
    assert picture.shape == (1024, 1024)
    assert (picture.min(), picture.max()) == (0, 255)


@pytest.mark.parametrize("every", [1, 2, pytest.param(4, marks=pytest.mark.slow)])
def test_heights_of_a_few_places_need_no_tile(every):
    ground = build_ground(SCENE).thinned(every)
    x, y = np.random.default_rng(3).uniform(-60.0, 60.0, (2, 50))
    ARRAYS.clear()
    at_once = replace(ground, heights=NO_TILE).height_at_once(x, y)
    exact = ground.height_at(x, y)
    np.testing.assert_allclose(at_once, exact, rtol=0.0, atol=1e-5 * np.std(exact))
    if every == 1:
        np.testing.assert_array_equal(ground.height_at_once(x, y), exact)  # those of tiles that are kept
        excerpt = replace(build_excerpt(SCENE, (0.0, 0.0), (10.0, 10.0)), heights=NO_TILE)
        x, y = np.array([5.0, 300.0]), np.array([5.0, -70.0])  # within it and beyond
        np.testing.assert_allclose(excerpt.height_at_once(x, y), ground.height_at(x, y), rtol=0.0, atol=1e-6)


@pytest.mark.parametrize("reach", [0.0, 30.0, pytest.param(0.4 * TILE, marks=pytest.mark.slow), 1.3 * 0.4 * TILE])
def test_a_window_holds_each_node_at_its_place_whatever_window_is_held(reach):
    ground = build_ground(edit(SCENE, {"seabed.material": {"kind": "fractal", "of": ["fine_sand", "coarse_sand"]}}))
    held = None
    # A step along each axis, none, one across, one to a place that shares nothing, and back.
    for row, column in [(-1, 0), (-1, 1), (0, 1), (0, 1), (1, 0), (40, -30), (0, 0)]:
        window = ground.window(row, column, reach, held)
        side, margin = len(window.heights), (len(window.heights) - 1 - TILE) // 2
        first = (row * TILE - margin, column * TILE - margin)
        for tiles, torus in ((ground.heights, window.heights), (ground.materials, window.materials)):
            nodes = gather_tiles(tiles, first, (side, side))
            stored = [(low + np.arange(side)) % side for low in first]
            np.testing.assert_array_equal(torus[np.ix_(*stored)], nodes)
        held = StoredWindow(row, column, window.heights, window.materials)


def level_beds():
    """Beds of the windows of a level ground of its own."""
    level = replace(build_ground(SCENE), heights=lambda row, column: np.zeros((TILE, TILE), np.float32))
    return terrain_tiles._beds_of(level, 20.0)


def test_beds_of_windows_are_bounded_by_their_bytes(monkeypatch):
    beds = level_beds()
    beds.make_room(6)
    for column in range(5):
        beds.bed(0, column)
    assert len(beds._beds) == 5
    monkeypatch.setattr(terrain_tiles, "LARGEST", 2.5 * beds.shrink(sys.maxsize) / 5)
    assert beds.bed(0, 5) is beds.bed(0, 5)
    assert list(beds._beds) == [(0, 4), (0, 5)]
    monkeypatch.setattr(terrain_tiles, "LARGEST", 1)
    beds.bed(0, 6)
    assert list(beds._beds) == [(0, 6)]


def test_beds_of_all_grounds_share_one_bound(monkeypatch):
    one, other = level_beds(), level_beds()
    for beds in (one, other, one):
        beds.make_room(3)
        beds.bed(0, beds.used)
    bed = one.shrink(sys.maxsize) / 2
    monkeypatch.setattr(terrain_tiles, "LARGEST", 3.5 * bed)
    kept = one.bed(0, 7)
    assert (len(one._beds), len(other._beds)) == (3, 0)
    other.bed(0, 0)
    other.bed(0, 1)
    assert (len(one._beds), len(other._beds)) == (1, 2)
    assert one.bed(0, 7) is kept
    terrain_tiles.drop_windows()
    assert not one._beds
    assert not other._beds


def test_a_step_to_the_next_window_makes_its_new_tiles_alone():
    tiles = Mock(return_value=np.zeros((TILE, TILE), np.float32))
    ground = replace(build_ground(SCENE), heights=tiles)
    window = ground.window(0, 0, 100.0)
    assert sorted(asked.args for asked in tiles.mock_calls) == list(itertools.product((-1, 0, 1), (-1, 0, 1)))
    tiles.reset_mock()
    ground.window(0, 1, 100.0, StoredWindow(0, 0, window.heights, window.materials))
    assert sorted(asked.args for asked in tiles.mock_calls) == list(itertools.product((-1, 0, 1), (1, 2)))


@pytest.mark.parametrize("every", [2, pytest.param(8, marks=pytest.mark.slow)])
def test_thinned_tiles_are_every_nth_node_and_hold_no_more(every):
    whole = build_ground(SCENE)
    thinned = whole.thinned(every)
    side = every * TILE
    for row, column in [(0, 0), (-1, 1)]:
        tile = thinned.heights(row, column)
        nodes = gather_tiles(whole.heights, (row * side, column * side), (side, side))[::every, ::every]
        np.testing.assert_array_equal(tile, nodes)
        assert tile.base is None  # the store counts the bytes of what it keeps


@pytest.fixture(scope="module")
def excerpt():
    scene = edit(SCENE, {"seabed.material": {"kind": "fractal", "of": ["fine_sand", "coarse_sand"]}})
    return build_ground(scene), build_excerpt(scene, (SIDE - 70.0, SIDE - 40.0), (SIDE + 60.0, SIDE + 30.0))


def test_an_excerpt_is_the_same_ground(excerpt):
    whole, part = excerpt
    rng = np.random.default_rng(5)
    within, beyond = SIDE + rng.uniform(-30.0, 30.0, (2, 50)), SIDE + rng.uniform(100.0, 200.0, (2, 5))
    for x, y in (within, beyond):
        np.testing.assert_allclose(part.height_at(x, y), whole.height_at(x, y), atol=1e-6)
    assert np.isfinite(part.height_near(*beyond)).all(), "that of the nearest edge, for which no tile is made"
    first = [round(low / part.spacing) for low in (part.rectangle.y0, part.rectangle.x0)]
    assert (
        np.mean(gather_tiles(whole.materials, first, part.rectangle.materials.shape) == part.rectangle.materials)
        > 0.999
    )


@pytest.mark.parametrize("every", [1, 4])
def test_a_window_of_an_excerpt_is_its_rectangle(excerpt, every):
    whole, part = (ground.thinned(every) for ground in excerpt)
    x, y = (SIDE + np.array([-37.0, 0.3, 28.0])[:, None] for _ in range(2))
    assert np.unique(part.cell(x[:, 0], y[:, 0]), axis=0).tolist() == [[0, 0]]
    assert part.window(0, 0, 20.0) is part.around((SIDE, SIDE), 25.0) is part.rectangle
    np.testing.assert_allclose(part.rectangle.height_at(x, y), whole.height_at(x, y), atol=1e-6)
    wider = part.around((SIDE, SIDE), 100.0)
    assert isinstance(wider, Ground)
    assert not np.isnan(wider.height_at(np.array([SIDE - 100.0, SIDE + 100.0]), np.full(2, SIDE))).any()


def test_a_record_over_an_excerpt_is_that_over_tiles(record):
    line = tow_line_at(SCENE, PINGS)
    low, high = ((end(line.x), end(line.y)) for end in (np.min, np.max))
    part = build_excerpt(SCENE, tuple(np.subtract(low, 40.0)), tuple(np.add(high, 40.0)))
    found = prepare(SCENE, packed=pack(SCENE, part)).intensity(PINGS)
    np.testing.assert_allclose(found, record, rtol=2e-4, atol=2e-5 * record.max())


def test_a_fish_follows_the_terrain_anywhere():
    scene = edit(SCENE, {"track.terrain_following": True, "track.start": [3e5, -2e5]})
    simulation = prepare(scene)
    poses = simulation.poses(PINGS)
    below = simulation.ground.height_at(poses.x, poses.y)
    assert np.ptp(poses.z) > 0.0
    assert np.abs(poses.z - below - 6.0).max() < 0.4


@pytest.mark.parametrize(
    "material",
    [
        {"kind": "patches", "of": ["silt", "rock"], "size": 6.0},
        {"kind": "fractal", "of": ["silt", "medium_sand", "rock"]},
        {"kind": "pattern", "of": ["silt", "rock"], "shape": "checks", "period": 7.0, "heading": 30.0},
    ],
)
def test_maps_have_no_seam(material):
    ground = build_ground(edit(SCENE, {"seabed.material": material}))
    rows = gather_tiles(ground.materials, (-TILE, -TILE), (2 * TILE, 2 * TILE)).astype(int)
    share = np.bincount(rows.ravel()) / rows.size
    np.testing.assert_allclose(share, 1.0 / len(share), atol=0.12)
    for changes in ((np.diff(rows, axis=axis) != 0).mean(axis=1 - axis) for axis in (0, 1)):
        assert changes[TILE - 1] <= changes.max()
        assert changes[TILE - 1] < 4.0 * np.median(changes) + 0.05


def test_parts_of_a_sum_are_as_they_are_alone():
    ripples = {"kind": "ripples", "wavelength": 2.0, "period": 25.6, "extent": "endless", "mask": "patches"}
    both = edit(SCENE, {"seabed.relief": {"kind": "sum", "of": [FRACTAL, ripples]}})
    total, first = relief(both.seabed), relief(SCENE.seabed)
    left = total - first
    assert np.abs(left).max() > 0.02
    assert (np.abs(left) < 1e-12).mean() > 0.2  # where the mask lets no ripple be


def test_a_target_lies_on_it():
    scene = edit(SCENE, {"targets": [{"kind": "sphere", "position": [SIDE - 6.5, SIDE + 12.1], "radius": 0.8}]})
    simulation = prepare(scene)
    sphere = simulation.arrays.solids.start[0]
    below = simulation.ground.height_at(sphere[:1], sphere[1:2])[0]
    assert sphere[2] - below == pytest.approx(0.8, abs=1e-6)
    assert not np.array_equal(simulation.intensity(PINGS), prepare(SCENE).intensity(PINGS))


def test_scenes_on_the_same_ground_share_its_windows(record):
    simulation, other = prepare(SCENE), prepare(edit(SCENE, {"sonar.beam": {"kind": "fan", "width": 2.0}}))
    poses = simulation.poses(PINGS)
    windows = [list(each.tiles.split(each.reduced, poses)) for each in (simulation, other)]
    assert len(windows[0]) == 3
    for (some, one), (same, another) in zip(*windows, strict=True):
        np.testing.assert_array_equal(some, same)
        assert one.bed is another.bed
    rougher = prepare(edit(SCENE, {"seabed.relief.rms": 0.2}))
    assert next(rougher.tiles.split(rougher.reduced, poses))[1].bed is not windows[0][0][1].bed
    np.testing.assert_array_equal(simulation.intensity(PINGS), record)


def test_waves_and_filters_of_a_field_are_kept_and_go_with_it_at_once():
    ARRAYS.clear()
    field = EndlessField(SCENE.seabed.random_reliefs[0].bands(), 0.025, 5, 1)
    whole = field.values(Nodes.of_tile(0, 0))
    assert whole.nbytes < ARRAYS.bytes <= ARRAYS.limit
    parts = [key for key in ARRAYS._results if isinstance(key[1], tuple) and len(key[1]) == 4]
    assert {side for _, (_, side, _, _), *_ in parts} >= {TILE, PART}, "of coarse lattices parts are kept"
    filters = ARRAYS.bytes - sum(ARRAYS._results[key][1] for key in parts)
    gc.disable()
    try:
        del field
        # Waves wait for no collection of cycles; a thread of the pool lets go of its work a moment after it is done.
        wait_until(lambda: ARRAYS.bytes == filters)
    finally:
        gc.enable()


def test_windows_go_with_the_last_scene_on_their_ground():
    simulation = prepare(edit(SCENE, {"seed": 77}))
    simulation.intensity(PINGS[:1])
    held = weakref.ref(next(simulation.tiles.split(simulation.reduced, simulation.poses(PINGS)))[1].bed.transposed)
    assert held() is not None
    del simulation
    gc.collect()
    assert held() is None


def test_expected_ground_is_kept_between_blocks():
    """Blocks of pings over one window after another leave the beds of all of them for a call over all pings."""
    simulation = prepare(edit(SCENE, {"seed": 91}), tolerance=1.0)
    beds, poses = simulation.tiles._beds, simulation.poses(PINGS)
    cells, which = np.unique(simulation.ground.cell(poses.x, poses.y), axis=0, return_inverse=True)
    simulation.expect(PINGS)
    for k in range(len(cells)):
        simulation.intensity(PINGS[which.reshape(-1) == k])
    assert len(beds._beds) == len(cells) == terrain_tiles.KEPT_BEDS + 1
