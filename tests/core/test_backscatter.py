"""Backscatter rasters as maps of materials, laid on the bed by their coordinate reference system."""

import numpy as np
import pyproj
import pytest

from bathymetry_files import write_tiff
from insonify.cli import main
from insonify.scene import SceneError, build
from insonify.terrain import build_ground

EAST, NORTH = 560_000.0, 6_500_000.0
HERE = {"origin": [EAST, NORTH]}
MATERIALS = ["silt", "medium_sand", "rock"]
PLACE = {"corner": (EAST, NORTH), "crs": "EPSG:32631", "nodata": np.nan}


def scene(path, relief="flat", world=None, spacing=0.5, **fields):
    material = {"kind": "backscatter", "path": str(path), "of": MATERIALS, **fields}
    seabed = {"depth": 30.0, "spacing": spacing, "relief": relief, "material": material}
    return build({"world": world or {}, "seabed": seabed})


def at(ground, x, y):
    """Material of the cells at local places of a bed that repeats."""
    ny, nx = ground.materials.shape
    i = np.floor((np.asarray(x) - ground.x0) / ground.spacing).astype(int) % nx
    j = np.floor((np.asarray(y) - ground.y0) / ground.spacing).astype(int) % ny
    return [ground.names[k] for k in ground.materials[j, i]]


def test_values_choose_materials_where_they_lie_or_nearest_by_levels_or_by_equal_shares(tmp_path):
    rows = [[-40.0, -30.0, -20.0], [-20.0, -40.0, -30.0]]
    path = write_tiff(tmp_path / "a.tif", rows, **PLACE)
    world = {"crs": "EPSG:32631", "origin": [EAST, NORTH - 4.0]}  # the south-western corner
    ground = build_ground(scene(path, world=world, levels=[-35.0, -25.0]))
    assert at(ground, [1.0, 3.0, 5.0], [3.0] * 3) == ["silt", "medium_sand", "rock"]
    assert at(ground, [1.0, 3.0, 5.0], [1.0] * 3) == ["rock", "silt", "medium_sand"]
    moved = build_ground(scene(path, world={**world, "origin": [EAST - 2.0, NORTH - 4.0]}, levels=[-35.0, -25.0]))
    assert at(moved, [3.0, 5.0, 7.0], [3.0] * 3) == ["silt", "medium_sand", "rock"]
    path = write_tiff(tmp_path / "b.tif", np.random.default_rng(1).normal(-30.0, 5.0, (60, 60)), **PLACE)
    ground = build_ground(scene(path, world=HERE))
    shares = np.bincount(ground.materials.ravel()) / ground.materials.size
    np.testing.assert_allclose(shares, 1.0 / 3.0, atol=0.01)
    path = write_tiff(tmp_path / "thin.tif", [[-40.0, np.nan, np.nan, -20.0]], **PLACE)
    with pytest.raises(SceneError, match="is only 4 by 1"):
        build_ground(scene(path, world=HERE))
    path = write_tiff(tmp_path / "gap.tif", [[-40.0, np.nan, np.nan, -20.0]] * 2, **PLACE)
    ground = build_ground(scene(path, world={"origin": [EAST, NORTH - 4.0]}, levels=[-30.0, 0.0]))
    assert at(ground, [1.0, 3.0, 5.0, 7.0], [1.0] * 4) == ["silt", "silt", "medium_sand", "medium_sand"]


def test_another_map_is_transformed(tmp_path):
    """A border between two materials, at an easting of one UTM zone, on a bed of the next."""
    to_next = pyproj.Transformer.from_crs("EPSG:32631", "EPSG:32632", always_xy=True)
    values = np.where(np.arange(100) < 50, -40.0, -20.0) * np.ones((100, 1))
    path = write_tiff(tmp_path / "a.tif", values, **PLACE)
    heights = tmp_path / "bed.tif"
    corner = to_next.transform(EAST + 70.0, NORTH - 70.0)
    write_tiff(heights, np.full((30, 30), -20.0), corner=corner, crs="EPSG:32632", nodata=np.nan)
    ground = build_ground(scene(path, relief={"kind": "dem", "path": str(heights)}, levels=[-30.0, 0.0]))
    place = scene(path, relief={"kind": "dem", "path": str(heights)}).georeference
    x = ground.x0 + (np.arange(29) + 0.5) * 2.0 + place.origin[0]
    y = ground.y0 + (np.arange(29) + 0.5) * 2.0 + place.origin[1]
    east, _ = to_next.transform(*np.meshgrid(x, y), direction="INVERSE")
    inner = np.abs(east - (EAST + 100.0)) > 0.01
    expected = np.where(east < EAST + 100.0, 0, 1)
    np.testing.assert_array_equal(ground.materials[:29, :29][inner], expected[inner])
    assert 0.0 < expected.mean() < 1.0


PLACED = "give a raster with coordinates, and world.origin and world.crs or a measured"


@pytest.mark.parametrize(
    ("world", "fields", "expected"),
    [
        ({}, {}, f"has no position on the bed; {PLACED}"),
        (HERE, {"levels": [1.0]}, "levels has 1 values for 3 materials; give one value less than materials"),
        (HERE, {"levels": [2.0, 1.0]}, "levels does not increase; sort it"),
        (HERE, {"path": "nowhere.tif"}, "does not exist"),
    ],
)
def test_what_cannot_be_laid_is_one_sentence(tmp_path, world, fields, expected):
    path = write_tiff(tmp_path / "a.tif", [[-40.0, -20.0], [-30.0, -10.0]], **PLACE)
    with pytest.raises(SceneError, match=expected) as caught:
        build_ground(scene(fields.pop("path", path), world=world, **fields))
    assert "seabed.material" in str(caught.value)


def test_a_mosaic_becomes_a_bed(tmp_path, capsys):
    """What one scene sounds like is the map of the materials of the next."""
    words = ["--set", "world.crs=EPSG:32631", "--set", f"world.origin=[{EAST}, {NORTH}]", "--set", "sonar.bins=200"]
    assert main(["render", "sediments", "-o", str(tmp_path / "a.nc"), "--set", "track.pings=40", *words]) == 0
    assert main(["mosaic", str(tmp_path / "a.nc"), "-o", str(tmp_path / "a.tif")]) == 0
    ground = build_ground(scene(tmp_path / "a.tif", world={"crs": "EPSG:32631", "origin": [EAST, NORTH]}))
    assert set(np.unique(ground.materials)) == {0, 1, 2}
