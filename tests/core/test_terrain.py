"""Grounds: where they lie, what they share, what they are made of, and maps with known borders on every kind of bed."""

import tracemalloc
from dataclasses import replace

import numpy as np
import pytest
from PIL import Image

from insonify.kernels.bed.voronoi import ACROSS, ALONG, KIND, nearest_seed_hash
from insonify.kernels.common.hashing import hash_integers, hash_uniform
from insonify.packing.scene_arrays import make_bed
from insonify.scene import SceneError, build, edit, load_scene, plain
from insonify.scene.seabed import Seabed
from insonify.scene.seabed.materials import Material
from insonify.scene.seabed.materials.catalogue import MATERIALS
from insonify.scene.seabed.materials.pattern import GRADES, PatternMap
from insonify.scene.seabed.materials.pictures import ImageMap
from insonify.scene.seabed.materials.random_maps import FractalMap, Patches
from insonify.simulation import simulate
from insonify.terrain import build_ground, relief, relief_picture
from insonify.terrain.materials import Lattice, material_indices

FRACTAL = {"kind": "fractal", "beta": 1.4, "period": 12.8, "rms": 0.05}
THREE = (Material(name="silt"), Material(name="medium_sand"), Material(name="rock"))


def scene(**seabed):
    return build({"seabed": {"depth": 30.0, "spacing": 0.1, "relief": FRACTAL} | seabed})


def test_made_ground_is_periodic_from_the_local_origin_and_small_where_it_is_level():
    base = scene()
    ground = build_ground(base)
    assert (ground.heights.shape, ground.heights.dtype) == ((128, 128), np.float32)
    assert (ground.materials.shape, ground.materials.dtype) == ((128, 128), np.uint8)
    assert (ground.x0, ground.y0, ground.spacing, ground.periodic, ground.datum) == (0.0, 0.0, 0.1, True, -30.0)
    assert ground.heights.std() == pytest.approx(0.05, rel=1e-6)
    heights = relief(base.seabed, seed=base.seed)
    assert heights.dtype == np.float64
    np.testing.assert_array_equal(heights.astype(np.float32), ground.heights)
    odd = build_ground(scene(relief=FRACTAL | {"period": 10.04}))  # no whole number of cells
    assert odd.heights.shape == (100, 100)
    assert odd.spacing * 100 == pytest.approx(10.04, rel=1e-12)
    level = build_ground(scene(relief="flat"))
    assert level.periodic
    assert level.heights.size <= 64
    assert not level.heights.any()
    mapped = build_ground(scene(relief="flat", material={"kind": "patches", "of": ["silt", "rock"]}))
    assert mapped.heights.shape == (1024, 1024)
    assert mapped.spacing * 1024 == pytest.approx(102.4)


def test_ground_depends_on_the_seed_and_not_on_the_track_depth_or_numbers_of_materials():
    seabed = scene().seabed.model_dump()
    changes = {}, {"track": {"start": [500.0, -40.0], "heading": 30.0}}, {"seed": 2}
    one, elsewhere, reseeded = (build_ground(build({"seabed": seabed} | change)).heights for change in changes)
    np.testing.assert_array_equal(one, elsewhere)
    assert np.abs(one - reseeded).max() > 0.05
    first, second = build_ground(scene()), build_ground(scene(depth=40.0, material="rock"))
    assert second.heights is first.heights
    assert second.datum == -40.0
    assert second.names == ("rock",)
    assert second.reflectivities == (MATERIALS["rock"].reflectivity,)
    patches = {"kind": "patches", "of": ["silt", "rock"], "size": 3.0}
    brighter = patches | {"of": ["silt", {"name": "rock", "diffuse": 0.3}]}
    first, second = build_ground(scene(material=patches)), build_ground(scene(material=brighter))
    assert second.materials is first.materials
    assert second.reflectivities[1].diffuse == 0.3


def test_relief_samples_one_period_on_any_shape_that_has_nodes_and_dunes_are_as_high_as_on_their_ground():
    fractal, ripples = scene().seabed, Seabed(relief={"kind": "ripples"})
    for made, shape in ((fractal, (32, 200)), (Seabed(), (3, 5)), *((ripples, s) for s in ((1, 1), (1, 7), (7, 1)))):
        heights = relief(made, shape)
        assert heights.shape == shape
        assert np.isfinite(heights).all()
    assert not relief(Seabed(), (3, 5)).any()
    for kind in ("flat", "fractal", "cascade", "marks", "strata", "mimic"):
        for shape in ((0, 5), (5, 0), (-1, 3)):
            with pytest.raises(SceneError, match=r"^shape: \(.+\) has no nodes; give at least \(1, 1\)$"):
                relief(Seabed(relief={"kind": kind}), shape)
    with pytest.raises(SceneError, match=r"^seabed\.relief\.period: 0\.2 m spans 2 cells .*; lengthen it"):
        build_ground(scene(relief=FRACTAL | {"period": 0.2}))
    for spacing in (0.4, 1e3):
        dunes = scene(relief="mimic", spacing=spacing)
        np.testing.assert_allclose(relief(dunes.seabed), build_ground(dunes).heights, atol=1e-6)


def test_marks_cover_their_share_with_peaks_and_lie_along_their_heading():
    marks = {"kind": "marks", "period": 64.0, "height": 0.5, "size": 2.0, "share": 0.05}
    heights = relief(Seabed(relief=marks, spacing=0.25))
    covered = heights > 0.0
    assert covered.mean() == pytest.approx(0.05, abs=1e-3)
    assert heights.min() == 0.0
    np.testing.assert_array_equal(relief(Seabed(relief=marks | {"height": -0.5}, spacing=0.25)), -heights)
    edges = [(np.diff(covered.astype(int), axis=axis) != 0).sum() for axis in (0, 1)]
    width = 2.0 * covered.sum() * 0.25 / np.array(edges)
    assert width == pytest.approx(2.0, rel=0.5)  # mean chord of the marks
    long = relief(Seabed(relief=marks | {"length": 30.0, "heading": 0.0}, spacing=0.25)) > 0.0
    edges = [(np.diff(long.astype(int), axis=axis) != 0).sum() for axis in (0, 1)]
    assert edges[0] > 5.0 * edges[1]


def test_strata_step_by_their_height_at_their_interval_and_repeat():
    strata = {"kind": "strata", "period": 64.0, "height": 0.8, "interval": 8.0, "heading": 0.0, "bends": 0.0}
    heights = relief(Seabed(relief=strata, spacing=0.25))
    np.testing.assert_allclose(heights, heights[:, :1] * np.ones(256), atol=1e-12)
    line = heights[:, 0]
    np.testing.assert_allclose(line, np.roll(line, 32), atol=1e-9)
    assert np.ptp(line) == pytest.approx(0.8, rel=0.1)
    # Scarps are as wide as they are declared: 0.15 of the interval rises.
    assert (np.diff(line) > 0.0).mean() == pytest.approx(0.15, abs=0.02)


def test_soft_borders_mix_the_materials_over_their_share_of_the_bed():
    lattice = Lattice((256, 256), 0.1)
    sharp, soft = (FractalMap(of=THREE[:2], softness=softness) for softness in (0.0, 0.5))
    rows = material_indices(soft, lattice, 1)
    pure = (rows == 0) | (rows == 255)
    assert pure.mean() == pytest.approx(0.75, abs=0.02)  # half of the half-bands on both sides of the border
    # Where it is pure, the soft map is the sharp one.
    np.testing.assert_array_equal(rows[pure] > 0, material_indices(sharp, lattice, 1)[pure] > 0)
    names, reflectivities = soft.rows()
    levels = [reflectivity.diffuse for reflectivity in reflectivities]
    assert len(names) == 256
    assert sorted(levels) in (levels, levels[::-1])


def test_picture_has_north_at_the_top_and_the_whole_range_of_grey(tmp_path):
    base = scene()
    picture = relief_picture(base)
    heights = build_ground(base).heights
    assert picture.dtype == np.uint8
    assert (picture.min(), picture.max()) == (0, 255)
    row, column = np.unravel_index(np.argmax(heights), heights.shape)
    assert picture[127 - row, column] == 255
    assert not relief_picture(scene(relief="flat")).any()
    # A narrow measured bed is pictured as it is.
    np.save(tmp_path / "bed.npy", np.arange(15.0).reshape(5, 3))
    picture = relief_picture(scene(relief={"kind": "dem", "path": str(tmp_path / "bed.npy")}))
    np.testing.assert_array_equal(picture[::-1], np.rint(np.arange(15.0).reshape(5, 3) * 255.0 / 14.0))


@pytest.mark.parametrize("material", [Patches(of=THREE, size=3.0), FractalMap(of=THREE)])
def test_map_repeats_with_its_bed_and_shares_the_area(material):
    indices = material_indices(material, Lattice((512, 512), 0.1), 1)
    assert indices.dtype == np.uint8
    share = np.bincount(indices.ravel(), minlength=3) / indices.size
    np.testing.assert_allclose(share, 1 / 3, atol=1e-3 if material.kind == "fractal" else 0.12)
    # No seam: borders cross the edge of the period no more often than any other line.
    changes = (indices != np.roll(indices, 1, axis=1)).mean(axis=0)
    assert changes[0] <= changes[1:].max()
    assert changes[0] < 0.5


def test_maps_keep_their_places_on_other_grids():
    patches = Patches(of=THREE, size=3.0)
    coarse = material_indices(patches, Lattice((100, 100), 0.3), 1)
    fine = material_indices(patches, Lattice((300, 300), 0.1), 1)
    # The centre of a coarse cell is that of the middle one of nine fine cells.
    np.testing.assert_array_equal(fine[1::3, 1::3], coarse)
    whole = material_indices(patches, Lattice((80, 80), 0.5, -20.0, -20.0, periodic=False), 1)
    part = material_indices(patches, Lattice((20, 30), 0.5, -10.0, 5.0, periodic=False), 1)
    np.testing.assert_array_equal(whole[50:70, 20:50], part)
    bands = FractalMap(of=THREE, beta=2.5)
    coarse = material_indices(bands, Lattice((128, 128), 0.4), 1)
    fine = material_indices(bands, Lattice((256, 256), 0.2), 1)
    assert (fine[::2, ::2] == coarse).mean() > 0.97


def test_patches_agree_with_the_slow_search():
    rng = np.random.default_rng(0)
    squares = [(i % 5, j % 5, i, j) for i in range(-4, 10) for j in range(-4, 10)]
    places = [(i + hash_uniform(9, 3, a, b, ACROSS), j + hash_uniform(9, 3, a, b, ALONG)) for a, b, i, j in squares]
    points = np.array(places)
    for u, v in rng.uniform(0.0, 5.0, (300, 2)):
        a, b, _, _ = squares[np.argmin(np.hypot(points[:, 0] - u, points[:, 1] - v))]
        assert nearest_seed_hash(9, 3, u, v, 5) == hash_integers(9, 3, a, b, KIND)


@pytest.mark.parametrize("name", ["default", "figure-6", "real-bed"])
def test_bundled_scene_has_a_bed_under_its_whole_track(name):
    bundled = load_scene(name)
    ground = build_ground(bundled)
    track = bundled.track
    along = np.linspace(0.0, track.speed * (track.pings - 1) / bundled.sonar.ping_rate, 200)
    heading = np.radians(track.heading)
    across = bundled.sonar.range * np.array([-1.0, 0.0, 1.0])[:, np.newaxis]
    x = track.start[0] + along * np.cos(heading) - across * np.sin(heading)
    y = track.start[1] + along * np.sin(heading) + across * np.cos(heading)
    heights = ground.height_at(x.ravel(), y.ravel()).reshape(x.shape)
    assert np.isfinite(heights).all()
    assert bundled.altitude > heights[1].max() + 1.0


def test_beds_of_the_same_heights_share_their_transposed_copy():
    grounds = [build_ground(edit(load_scene("default"), {"sonar.beam.width": width})) for width in (1.0, 2.0)]
    one, other = map(make_bed, grounds)
    assert one.heights is other.heights
    assert one.transposed is other.transposed
    np.testing.assert_array_equal(one.transposed, one.heights.T)
    copied = make_bed(replace(grounds[0], heights=grounds[0].heights.copy()))
    assert copied.transposed is not one.transposed
    np.testing.assert_array_equal(copied.transposed, one.transposed)


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("name", ["default", "endless", "real-bed"])
def test_no_height_is_known_where_a_place_is_none(name):
    ground = build_ground(load_scene(name))
    for far in (np.nan, np.inf, -np.inf, 1e25):
        places = np.array([far, 0.0, far]), np.array([0.0, far, far])
        assert np.isnan(ground.height_at(*places)).all()


@pytest.mark.parametrize(
    "relief",
    [
        {"kind": "ripples", "period": 51.2, "wavelength": 1.5, "height": 0.1},
        {"kind": "fractal", "period": 51.2, "beta": 1.4, "rms": 0.03, "mask": {"kind": "patches"}},
    ],
)
def test_a_bed_takes_few_arrays_of_its_size_while_it_is_made(relief):
    # Of the finest beds, 16,384 nodes a side, one array takes 2 GB.
    made = build({"seed": 77, "seabed": {"depth": 30.0, "spacing": 0.02, "relief": relief}})  # noise is not kept
    tracemalloc.start()
    try:
        ground = build_ground(made)
        most = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert most < 45 * ground.heights.size


def test_heights_beside_a_bed_are_those_of_its_edge():
    """At any place and spacing: the place of the last node in metres may be rounded to beyond it."""
    rng = np.random.default_rng(6)
    heights = rng.normal(size=(7, 11)).astype(np.float32)
    whole = replace(build_ground(load_scene("default")), periodic=False)
    for x0, y0, spacing in np.stack([*rng.uniform(-1e3, 1e3, (2, 200)), 10.0 ** rng.uniform(-2.0, 1.0, 200)], axis=1):
        ground = replace(whole, heights=heights, materials=heights > 9.0, x0=x0, y0=y0, spacing=spacing)
        far = np.array([-1e5, 1e5])
        np.testing.assert_array_equal(ground.height_near(far, far), heights[[0, -1], [0, -1]])


TWO = (Material(name="silt"), Material(name="rock"))
BANDS = (*TWO, Material(name="medium_sand"))
FREE = Lattice((100, 120), 0.1, -4.0, -3.0, periodic=False)


def ground_of(material, spacing=0.1, relief="flat"):
    return build_ground(build({"seabed": {"spacing": spacing, "relief": relief, "material": material}}))


def pattern(**options):
    return {"kind": "pattern", "of": ["silt", "rock"]} | options


def unrolled(ground, x, y):
    """Row at places of a bed that repeats."""
    ny, nx = ground.materials.shape
    i, j = (np.floor(np.asarray(place) / ground.spacing).astype(int) for place in (x, y))
    return ground.materials[j % ny, i % nx]


X, Y = FREE.centres()
OBLIQUE = Y[:, None] * np.cos(np.radians(30.0)) - X * np.sin(np.radians(30.0))


@pytest.mark.parametrize(
    ("layout", "expected"),
    [
        (PatternMap(of=BANDS, period=1.8), np.tile((np.floor(Y / 0.6) % 3)[:, None], (1, 120))),
        (PatternMap(of=BANDS, period=1.8, heading=-90.0), np.tile(np.floor(X / 0.6) % 3, (100, 1))),
        (PatternMap(of=TWO, period=2.0, heading=30.0), np.floor(OBLIQUE) % 2),
        (PatternMap(of=TWO, shape="checks", period=2.0), (np.floor(Y)[:, None] + np.floor(X)) % 2),
    ],
    ids=["along x", "along y", "oblique", "checks"],
)
def test_patterns_have_their_borders_in_the_world(layout, expected):
    np.testing.assert_array_equal(material_indices(layout, FREE, 1), expected.astype(np.uint8))


@pytest.mark.parametrize("spacing", [0.05, 0.1, 0.2])
def test_borders_do_not_depend_on_the_grid(spacing):
    ground = ground_of(pattern(shape="checks", period=3.2), spacing)
    x, y = np.meshgrid(np.arange(0.01, 30.0, 0.13), np.arange(-20.0, 0.0, 0.17))
    np.testing.assert_array_equal(unrolled(ground, x, y), (np.floor(x / 1.6) + np.floor(y / 1.6)) % 2)


@pytest.mark.parametrize(
    ("options", "shape"),
    [
        ({"period": 12.8}, (128, 4)),
        ({"period": 12.8, "heading": 90.0}, (4, 128)),
        ({"period": 12.8, "shape": "checks"}, (128, 128)),
        ({"period": 10.05}, (201, 4)),
    ],
)
def test_a_level_bed_is_as_small_as_its_pattern(options, shape):
    ground = ground_of(pattern(**options))
    assert ground.materials.shape == ground.heights.shape == shape
    assert ground.spacing == 0.1


@pytest.mark.parametrize("heading", [10.0, 30.0, 45.0, 77.0, -123.0])
@pytest.mark.parametrize("shape", ["stripes", "checks"])
def test_an_oblique_pattern_hardly_gives_way_to_a_level_bed(heading, shape):
    ground = ground_of(pattern(period=8.0, heading=heading, shape=shape))
    ny, nx = ground.materials.shape
    # The nearest wave that fills the period whole.
    angle = np.radians(heading)
    wave = np.array([-np.sin(angle), np.cos(angle)]) / 8.0
    size = np.array([nx, ny]) * ground.spacing
    fitted = np.rint(wave * size) / size
    assert np.linalg.norm(fitted - wave) < 3e-3 * np.linalg.norm(wave)
    share = np.bincount(ground.materials.ravel(), minlength=2) / ground.materials.size
    np.testing.assert_allclose(share, 0.5, atol=0.02)


@pytest.mark.parametrize("shape", ["stripes", "checks", "waves"])
@pytest.mark.parametrize("heading", [0.0, 33.0])
def test_a_pattern_repeats_with_a_bed_that_repeats(shape, heading):
    relief = {"kind": "fractal", "period": 12.8}
    rows = ground_of(pattern(shape=shape, heading=heading, period=3.0), relief=relief).materials.astype(int)
    assert rows.shape == (128, 128)
    for axis in (0, 1):
        steps = np.abs(np.diff(rows, axis=axis, append=rows.take([0], axis=axis)))
        if shape == "waves":
            assert steps.max() <= 2 * np.pi * 0.1 / 3.0 * GRADES
        else:
            # A seam would be a line along which the pattern breaks off.
            assert steps.take(-1, axis=axis).mean() <= steps.mean(axis=1 - axis).max()


def test_a_pattern_longer_than_its_bed_is_stretched_to_it_or_refused():
    rows = ground_of(pattern(period=500.0), relief={"kind": "fractal", "period": 12.8}).materials
    np.testing.assert_array_equal(rows[:, 0], np.repeat([0, 1], 64))
    with pytest.raises(SceneError, match=r"^seabed\.material\.period: 500 m spans more than 4096 cells .*; shorten it"):
        ground_of(pattern(period=500.0))  # of a level bed


def test_waves_blend_from_the_first_to_the_last_and_back_mix_the_variance_of_speckle_and_are_named_by_truth():
    layout = PatternMap(of=BANDS, shape="waves", period=6.0)
    names, numbers = layout.rows()
    assert len(names) == len(numbers) == len(set(names)) == GRADES
    assert (names[0], names[51], names[-1]) == ("silt", "60.0_silt+40.0_rock", "medium_sand")
    silt, rock, sand = (MATERIALS[name].reflectivity for name in ("silt", "rock", "medium_sand"))
    assert (numbers[0], numbers[-1]) == (silt, sand)
    np.testing.assert_allclose(numbers[51][:5], 0.6 * np.array(silt[:5]) + 0.4 * np.array(rock[:5]))
    rows = material_indices(layout, Lattice((600, 1), 0.01), 1)[:, 0]
    y = (np.arange(600) + 0.5) * 0.01
    np.testing.assert_allclose(rows / 255.0, 0.5 - 0.5 * np.cos(2.0 * np.pi * y / 6.0), atol=0.5 / 255.0)
    one, other = (Material(name="silt", speckle_shape=shape) for shape in (2.0, 10.0))
    whole, half_given = (PatternMap(of=of, shape="waves").rows()[1] for of in ((one, other), (one, TWO[0])))
    assert 1.0 / whole[51].speckle_shape == pytest.approx(0.8 / 2.0 + 0.2 / 10.0)
    assert half_given[0].speckle_shape == 2.0
    assert {row.speckle_shape for row in half_given[1:]} == {None}
    seabed = {"spacing": 0.2, "material": pattern(shape="waves", period=8.0)}
    sonar = {"range": 20.0, "bins": 100, "beam": "knife"}
    scene = build({"seabed": seabed, "sonar": sonar, "track": {"pings": 2}})
    material = simulate(scene, truth=True).material
    meanings = dict(zip(material.attrs["flag_values"].tolist(), material.attrs["flag_meanings"].split()))
    row = int(material[0, 0, -1])
    assert meanings[row] == build_ground(scene).names[row]
    assert "_silt+" in meanings[row]


def picture(folder, rows, name="map.png", dtype=np.uint8, palette=None):
    """Write a picture from rows, the northernmost first, and return its path."""
    image = Image.fromarray(np.asarray(rows, dtype=dtype))
    if palette is not None:
        image.putpalette(palette)
    image.save(folder / name)
    return str(folder / name)


def test_a_picture_lies_north_up_from_the_origin_and_gives_way_to_a_bed_that_repeats(tmp_path):
    path = picture(tmp_path, [[0, 255], [255, 255], [0, 0]])
    ground = ground_of({"kind": "image", "path": path, "of": ["silt", "rock"], "width": 4.0})
    assert ground.materials.shape == (60, 40)
    x, y = np.meshgrid(np.arange(0.05, 8.0, 0.1), np.arange(-5.95, 6.0, 0.1))
    expected = np.array([[0, 0], [1, 1], [0, 1]])[np.floor(y / 2.0).astype(int) % 3, np.floor(x / 2.0).astype(int) % 2]
    np.testing.assert_array_equal(unrolled(ground, x, y), expected)
    layout = ImageMap(path=picture(tmp_path, [[0, 255]]), of=TWO, width=3.0)
    squeezed, free = (material_indices(layout, lattice, 1)[0] for lattice in (Lattice((4, 100), 0.1), FREE))
    np.testing.assert_array_equal(squeezed, np.floor((np.arange(100) + 0.5) * 0.1 / (10.0 / 6.0)) % 2)
    np.testing.assert_array_equal(free, np.floor(X / 1.5) % 2)


def test_grey_of_any_depth_colours_and_palettes_choose_materials(tmp_path):
    four = (*BANDS, TWO[0])
    for path, of, expected in (
        (picture(tmp_path, [[0, 63, 64, 127, 128, 191, 192, 255]]), four, [0, 0, 1, 1, 2, 2, 3, 3]),  # equal bands
        (picture(tmp_path, [[0, 32767, 32768, 65535]], "deep.tif", np.uint16), TWO, [0, 0, 1, 1]),
        (picture(tmp_path, [[0, 32767, 32768, 65535]], "deep.png", np.uint16), TWO, [0, 0, 1, 1]),
        (picture(tmp_path, [[False, True]], "black.png", bool), TWO, [0, 1]),
        (picture(tmp_path, [[(0, 0, 0), (250, 250, 250)]], "rgb.png"), TWO, [0, 1]),
        (picture(tmp_path, [[2, 0, 1]], "palette.png", palette=[9, 9, 9, 200, 0, 0, 1, 2, 3]), BANDS, [2, 0, 1]),
    ):
        layout = ImageMap(path=path, of=of, width=float(len(expected)))
        np.testing.assert_array_equal(material_indices(layout, Lattice((1, len(expected)), 1.0), 1), [expected])


def test_a_picture_lies_beside_its_scene_and_is_read_anew(tmp_path):
    layout = {"kind": "image", "path": picture(tmp_path, [[0, 255]]), "of": ["silt", "rock"], "width": 4.0}
    first = ground_of(layout).materials.copy()
    picture(tmp_path, [[255, 0, 0]])
    assert ground_of(layout).materials.tolist() != first.tolist()
    material = '{ kind = "image", path = "map.png", of = ["silt", "rock"] }'
    (tmp_path / "scene.toml").write_text(f"[seabed]\nmaterial = {material}\n")
    assert plain(load_scene(tmp_path / "scene.toml"))["seabed"]["material"]["path"] == str(tmp_path / "map.png")


def test_pictures_that_cannot_be_are_refused(tmp_path):
    (tmp_path / "text.png").write_text("no picture")
    floats = picture(tmp_path, [[0.0, 1.0]], "floats.tif", np.float32)
    many = picture(tmp_path, [[0, 1, 2]], "many.png", palette=[0, 0, 0, 1, 1, 1, 2, 2, 2])
    for path, fault in {
        str(tmp_path / "none.png"): "does not exist; give",
        str(tmp_path / "text.png"): "is not a picture in PNG or TIFF; save",
        floats: "has pixels of mode F; save",
        picture(tmp_path, [[0, 70000]], "long.tif", np.int32): "has pixels of mode I; save",
        many: "uses colour 2 of its palette; give a material for each colour, not only 2",
    }.items():
        with pytest.raises(SceneError, match=f"^seabed.material.path: .* {fault}"):
            ground_of({"kind": "image", "path": path, "of": ["silt", "rock"]})
    with pytest.raises(SceneError, match=r"^seabed\.material\.width: a picture 1e\+06 m wide covers"):
        ground_of({"kind": "image", "path": picture(tmp_path, [[0, 255]]), "of": ["silt", "rock"], "width": 1e6})
