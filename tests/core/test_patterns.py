"""Maps with known borders: stripes, checks, waves and pictures, on every kind of bed."""

import numpy as np
import pytest
from PIL import Image

from insonify.scene import SceneError, build, load_scene, plain
from insonify.scene.seabed.materials import Material
from insonify.scene.seabed.materials.catalogue import MATERIALS
from insonify.scene.seabed.materials.pattern import GRADES, PatternMap
from insonify.scene.seabed.materials.pictures import ImageMap
from insonify.simulation import simulate
from insonify.terrain import build_ground
from insonify.terrain.materials import Lattice, material_indices

TWO = (Material(name="silt"), Material(name="rock"))
THREE = (*TWO, Material(name="medium_sand"))
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
        (PatternMap(of=THREE, period=1.8), np.tile((np.floor(Y / 0.6) % 3)[:, None], (1, 120))),
        (PatternMap(of=THREE, period=1.8, heading=-90.0), np.tile(np.floor(X / 0.6) % 3, (100, 1))),
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


def test_waves_blend_from_the_first_to_the_last_and_back():
    layout = PatternMap(of=THREE, shape="waves", period=6.0)
    names, numbers = layout.rows()
    rows = material_indices(layout, Lattice((600, 1), 0.01), 1)[:, 0]
    assert len(names) == len(numbers) == len(set(names)) == GRADES
    assert (names[0], names[-1]) == ("silt", "medium_sand")
    assert names[51] == "60.0_silt+40.0_rock"
    assert numbers[0] == MATERIALS["silt"].reflectivity
    assert numbers[-1] == MATERIALS["medium_sand"].reflectivity
    silt, rock = MATERIALS["silt"].reflectivity, MATERIALS["rock"].reflectivity
    np.testing.assert_allclose(numbers[51][:5], 0.6 * np.array(silt[:5]) + 0.4 * np.array(rock[:5]))
    y = (np.arange(600) + 0.5) * 0.01
    np.testing.assert_allclose(rows / 255.0, 0.5 - 0.5 * np.cos(2.0 * np.pi * y / 6.0), atol=0.5 / 255.0)


def test_graded_rows_mix_the_variance_of_speckle():
    one, other = (Material(name="silt", speckle_shape=shape) for shape in (2.0, 10.0))
    rows = PatternMap(of=(one, other), shape="waves").rows()[1]
    assert 1.0 / rows[51].speckle_shape == pytest.approx(0.8 / 2.0 + 0.2 / 10.0)
    half_given = PatternMap(of=(one, TWO[0]), shape="waves").rows()[1]
    assert half_given[0].speckle_shape == 2.0
    assert {row.speckle_shape for row in half_given[1:]} == {None}


def test_truth_names_graded_rows():
    scene = build(
        {
            "seabed": {"spacing": 0.2, "material": pattern(shape="waves", period=8.0)},
            "sonar": {"range": 20.0, "bins": 100, "beam": "knife"},
            "track": {"pings": 2},
        }
    )
    material = simulate(scene, truth=True).material
    meanings = dict(zip(material.attrs["flag_values"].tolist(), material.attrs["flag_meanings"].split()))
    row = int(material[0, 0, -1])
    assert meanings[row] == build_ground(scene).names[row]
    assert "_silt+" in meanings[row]


@pytest.fixture
def picture(tmp_path):
    """Write a picture from rows, the northernmost first, and return its path."""

    def write(rows, name="map.png", dtype=np.uint8, palette=None):
        image = Image.fromarray(np.asarray(rows, dtype=dtype))
        if palette is not None:
            image.putpalette(palette)
        image.save(tmp_path / name)
        return str(tmp_path / name)

    return write


def test_a_picture_lies_north_up_from_the_origin(picture):
    path = picture([[0, 255], [255, 255], [0, 0]])
    ground = ground_of({"kind": "image", "path": path, "of": ["silt", "rock"], "width": 4.0})
    assert ground.materials.shape == (60, 40)
    x, y = np.meshgrid(np.arange(0.05, 8.0, 0.1), np.arange(-5.95, 6.0, 0.1))
    expected = np.array([[0, 0], [1, 1], [0, 1]])[np.floor(y / 2.0).astype(int) % 3, np.floor(x / 2.0).astype(int) % 2]
    np.testing.assert_array_equal(unrolled(ground, x, y), expected)


def test_grey_of_any_depth_colours_and_palettes_choose_materials(picture):
    four = (*THREE, TWO[0])
    for path, of, expected in (
        (picture([[0, 63, 64, 127, 128, 191, 192, 255]]), four, [0, 0, 1, 1, 2, 2, 3, 3]),  # equal bands of grey
        (picture([[0, 32767, 32768, 65535]], "deep.tif", np.uint16), TWO, [0, 0, 1, 1]),
        (picture([[0, 32767, 32768, 65535]], "deep.png", np.uint16), TWO, [0, 0, 1, 1]),
        (picture([[False, True]], "black.png", bool), TWO, [0, 1]),
        (picture([[(0, 0, 0), (250, 250, 250)]], "rgb.png"), TWO, [0, 1]),
        (picture([[2, 0, 1]], "palette.png", palette=[9, 9, 9, 200, 0, 0, 1, 2, 3]), THREE, [2, 0, 1]),
    ):
        layout = ImageMap(path=path, of=of, width=float(len(expected)))
        np.testing.assert_array_equal(material_indices(layout, Lattice((1, len(expected)), 1.0), 1), [expected])


def test_a_picture_gives_way_to_a_bed_that_repeats_and_stays_on_one_that_does_not(picture):
    layout = ImageMap(path=picture([[0, 255]]), of=TWO, width=3.0)
    squeezed = material_indices(layout, Lattice((4, 100), 0.1), 1)[0]
    np.testing.assert_array_equal(squeezed, np.floor((np.arange(100) + 0.5) * 0.1 / (10.0 / 6.0)) % 2)
    free = material_indices(layout, FREE, 1)[0]
    np.testing.assert_array_equal(free, np.floor(FREE.centres()[0] / 1.5) % 2)


def test_a_picture_lies_beside_its_scene_and_is_read_anew(picture, tmp_path):
    layout = {"kind": "image", "path": picture([[0, 255]]), "of": ["silt", "rock"], "width": 4.0}
    first = ground_of(layout).materials.copy()
    picture([[255, 0, 0]])
    assert ground_of(layout).materials.tolist() != first.tolist()
    (tmp_path / "scene.toml").write_text(
        '[seabed]\nmaterial = { kind = "image", path = "map.png", of = ["silt", "rock"] }\n'
    )
    assert plain(load_scene(tmp_path / "scene.toml"))["seabed"]["material"]["path"] == str(tmp_path / "map.png")


def test_pictures_that_cannot_be_are_refused(picture, tmp_path):
    (tmp_path / "text.png").write_text("no picture")
    floats = picture([[0.0, 1.0]], "floats.tif", np.float32)
    many = picture([[0, 1, 2]], "many.png", palette=[0, 0, 0, 1, 1, 1, 2, 2, 2])
    for path, fault in {
        str(tmp_path / "none.png"): "does not exist; give",
        str(tmp_path / "text.png"): "is not a picture in PNG or TIFF; save",
        floats: "has pixels of mode F; save",
        picture([[0, 70000]], "long.tif", np.int32): "has pixels of mode I; save",
        many: "uses colour 2 of its palette; give a material for each colour, not only 2",
    }.items():
        with pytest.raises(SceneError, match=f"^seabed.material.path: .* {fault}"):
            ground_of({"kind": "image", "path": path, "of": ["silt", "rock"]})
    with pytest.raises(SceneError, match=r"^seabed\.material\.width: a picture 1e\+06 m wide covers"):
        ground_of({"kind": "image", "path": picture([[0, 255]]), "of": ["silt", "rock"], "width": 1e6})
