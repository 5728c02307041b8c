"""Measured beds: readers, on files written here and on real ones where they are at hand, and detail between nodes."""

import os
import re
import subprocess
import sys

import netCDF4
import numpy as np
import pyproj
import pytest
import rasterio
from scipy.ndimage import binary_erosion

from bathymetry_files import EAST, NORTH, UTM, scene, sloped, write_tiff
from insonify.cli import main
from insonify.errors import FileWarning
from insonify.io.bathymetry import read_grid
from insonify.io.georeference import DEGREES, project
from insonify.scene import SceneError, build, edit, scene_to_toml
from insonify.simulation import simulate
from insonify.terrain import build_ground, relief


def test_geotiff_runs_north_and_keeps_its_place_and_holes_and_its_own_or_the_finer_spacing(tmp_path):
    rows = sloped(5, 7)
    rows[0, 1] = -9999.0
    rows[2, 2] = np.nan
    ground = build_ground(scene(write_tiff(tmp_path / "bed.tif", rows, **UTM)))
    assert (ground.spacing, ground.periodic) == (2.0, False)
    known = np.where(rows == -9999.0, np.nan, rows)
    assert ground.datum == pytest.approx(np.nanmean(known), rel=1e-6)  # of the places where there is a bed
    np.testing.assert_allclose(ground.heights + ground.datum, known[::-1], atol=1e-5)
    # The centre of the grid is the local (0, 0).
    assert (ground.x0, ground.y0) == (-6.0, -4.0)
    # Large coordinates on the map are subtracted in double precision.
    path = write_tiff(tmp_path / "bed.tif", sloped(5, 7), pixel=(0.25, 0.25), **UTM)
    ground = build_ground(scene(path, origin=(EAST + 0.5, NORTH - 1.0)))
    # Node (0, 0) is the centre of the south-western pixel.
    assert (ground.x0, ground.y0) == (-0.375, 1.0 - 1.25 + 0.125)
    # A plane comes through a linear interpolation of oblong pixels as it was.
    rows = np.arange(4.0)[:, np.newaxis] * 3.0 + np.arange(3.0) * 2.0
    ground = build_ground(scene(write_tiff(tmp_path / "oblong.tif", rows, pixel=(2.0, 1.0), **UTM)))
    assert ground.spacing == 1.0
    assert ground.heights.shape == (4, 5)
    plane = np.arange(4.0)[::-1, np.newaxis] * 3.0 + np.arange(5.0)
    np.testing.assert_allclose(ground.heights + ground.datum, plane, atol=1e-5)


def test_measured_relief_is_scaled_before_its_datum_about_its_mean_and_takes_no_shape(tmp_path):
    path = write_tiff(tmp_path / "bed.tif", [[10.0, 10.0], [20.0, 20.0]], **UTM)
    ground = build_ground(scene(path, scale=0.1, datum=-30.0))
    assert ground.datum == pytest.approx(-28.5)
    np.testing.assert_allclose(ground.heights[:, 0], [0.5, -0.5], atol=1e-6)
    np.save(tmp_path / "bed.npy", sloped(4, 6))
    seabed = scene(tmp_path / "bed.npy").seabed
    assert abs(relief(seabed).mean()) < 1e-12
    with pytest.raises(SceneError, match="own grid; leave it out"):
        relief(seabed, (8, 8))


def test_grids_without_coordinates_take_the_spacing_of_the_scene_and_arrays_run_towards_y(tmp_path):
    rows = sloped(4, 6)
    write_tiff(tmp_path / "bare.tif", rows[::-1], corner=None)
    np.save(tmp_path / "bed.npy", rows)
    np.savez(tmp_path / "named.npz", x=np.zeros((3, 3)), z=rows)
    np.savez(tmp_path / "first.npz", axis=np.arange(6.0), heights=rows)
    for name in ("bare.tif", "bed.npy", "named.npz", "first.npz"):
        ground = build_ground(scene(tmp_path / name, spacing=0.5))
        assert (ground.spacing, ground.x0, ground.y0) == (0.5, -1.25, -0.75)
        np.testing.assert_allclose(ground.heights + ground.datum, rows, atol=1e-5)


ASCII_HEADS = {
    "corner": "ncols 3\nnrows 2\nxllcorner 100\nyllcorner 200\ncellsize 2\nNODATA_value -9999\n",
    "centre": "NCOLS 3\nNROWS 2\nXLLCENTER 101\nYLLCENTER 201\nCELLSIZE 2\nNODATA_VALUE -9999\n",
    "oblong": "ncols 3\nnrows 2\nxllcorner 100\nyllcorner 200\ndx 2\ndy 2\nNODATA_value -9999\n",
}


@pytest.mark.parametrize(
    ("head", "rows", "heights"),
    [
        *((head, "-4.5 -9999 -6.5\n-1 -2 -3\n", [[-1.0, -2.0, -3.0], [-4.5, np.nan, -6.5]]) for head in ASCII_HEADS),
        ("corner", "-4 nan -6\n-1 -2 -3\n", [[-1.0, -2.0, -3.0], [-4.0, np.nan, -6.0]]),
        ("corner", "-4 -5 -6\n" + " " * 200_000 + "-1.25 -2.5 inf\n", [[-1.25, -2.5, np.nan], [-4.0, -5.0, -6.0]]),
        ("corner", "-4.123456789 -5 -6\n-1 -2 -3\n", [[-1.0, -2.0, -3.0], [-4.123456789, -5.0, -6.0]]),
    ],
    ids=[*ASCII_HEADS, "whole numbers and NaN", "fractions far on", "many digits"],
)
def test_ascii_grids_run_from_the_north_and_lie_by_their_cells(tmp_path, head, rows, heights):
    path = tmp_path / "bed.asc"
    path.write_text(ASCII_HEADS[head] + rows)
    grid = read_grid(str(path))
    # Whether the file gives the corner of the first cell or its centre, node (0, 0) is the centre.
    assert (grid.spacing, grid.corner) == ((2.0, 2.0), (101.0, 201.0))
    np.testing.assert_array_equal(grid.heights, heights)
    path.write_text(ASCII_HEADS["oblong"].replace("dy 2", "dy 4") + "1 2 3\n4 5 6\n")
    assert (read_grid(str(path)).spacing, read_grid(str(path)).corner) == ((2.0, 4.0), (101.0, 202.0))


def test_whole_numbers_and_infinities_are_read_and_a_file_written_anew_anew(tmp_path):
    path = tmp_path / "bed.npy"
    np.save(path, np.array([[-1, -2], [-3, -4]], dtype=np.int16))
    assert build_ground(scene(path)).datum == -2.5
    np.save(path, np.array([[-1.0, np.inf], [-3.0, -4.0]]))
    assert np.isnan(build_ground(scene(path)).heights[0, 1])
    for height, time in ((-10.0, 2), (-12.0, 1)):
        np.save(path, np.full((2, 2), height))
        os.utime(path, ns=(time, time))
        assert build_ground(scene(path)).datum == height


@pytest.mark.parametrize(("name", "shape"), [("jacksboro", (344, 403)), ("topobathy", (91, 120))])
def test_samples_have_north_at_the_end(name, shape):
    grid = read_grid(f"sample:{name}")
    assert grid.heights.shape == shape
    assert grid.spacing is None
    # In the south-west lie the mountains of the one and the ocean of the other.
    low, high = np.nanpercentile(grid.heights, [20, 80])
    corner = grid.heights[: shape[0] // 3, : shape[1] // 3].mean()
    assert corner > np.median(grid.heights) if name == "jacksboro" else corner < high
    assert low < high


def test_every_bad_file_is_told_in_one_sentence(tmp_path):
    for name in ("text.tif", "text.asc", "text.bag", "text.h5", "text.npy", "text.npz"):
        (tmp_path / name).write_text("not a grid")
    (tmp_path / "empty.npy").write_bytes(b"")
    for name in ("bed.xyz", "bed.nc", "bed.grd"):
        (tmp_path / name).write_text("1 2 3")
    write_tiff(tmp_path / "nought.tif", sloped(3, 3), band={"scales": (0.0,)}, **UTM)
    packed = [[-3000, -3100], [-32768, -3050]]
    write_tiff(tmp_path / "packed.tif", packed, dtype="int16", crs="EPSG:32633", band={"scales": (0.01,)})
    (tmp_path / "nan.asc").write_text(ASCII_HEADS["corner"] + "nan nan nan\n" * 2)
    (tmp_path / "undeclared.asc").write_text(ASCII_HEADS["corner"].replace("NODATA_value -9999\n", "") + "-9999 " * 6)
    np.save(tmp_path / "line.npy", np.zeros(5))
    np.save(tmp_path / "words.npy", np.array([["a", "b"], ["c", "d"]]))
    np.save(tmp_path / "object.npy", np.array([[None, 1], [2, 3]], dtype=object), allow_pickle=True)
    np.save(tmp_path / "thin.npy", np.zeros((1, 5)))
    np.save(tmp_path / "nothing.npy", np.full((3, 3), np.nan))
    np.savez(tmp_path / "lines.npz", a=np.zeros(3), b=np.zeros(4))
    lone = np.full((4, 3), np.nan)
    lone[1, 1] = -5.0
    write_tiff(tmp_path / "lone.tif", lone, pixel=(1.5, 1.0), **UTM)
    write_tiff(tmp_path / "nodata.tif", np.full((3, 3), -9999.0), **UTM)
    write_tiff(tmp_path / "degrees.tif", sloped(3, 3), pixel=(1e-4, 1e-4), corner=(10.0, 95.0), crs="EPSG:4326")
    write_tiff(tmp_path / "feet.tif", sloped(3, 3), crs="EPSG:2263")
    write_tiff(tmp_path / "waves.tif", sloped(3, 3).astype(np.complex64), **UTM)
    np.save(tmp_path / "gaps.npy", np.array([[-30.0, -31.0], [-9999999.0, -30.0]]))
    for expected, names in {
        "does not exist; give": "absent.tif",
        "cannot be read .*; give a valid": "text.tif text.asc text.bag text.h5",
        "cannot be read .*; save it": "text.npy text.npz empty.npy object.npy",
        "is not a format known here; give a file that ends in one of": "bed.xyz",
        "holds no valid height; check": "nan.asc nothing.npy nodata.tif",
        "has 6 cells of -9999, which it does not declare as nodata": "undeclared.asc",
        "has 1 dimensions; save": "line.npy",
        "holds <U1 values; save": "words.npy",
        "is only 5 by 1 heights; give at least 2 by 2": "thin.npy",
        "holds no 2-D array; save": "lines.npz",
        r".*only single heights between gaps, in cells of 1\.5 by 1 m; fill its gaps": "lone.tif",
        "is in degrees beyond the poles; georeference it again": "degrees.tif",
        r"names no unit of its heights, on a map in US survey foot; name it, for example with rio": "feet.tif",
        "is in the format netCDF grid, which is not read here; convert it to GeoTIFF": "bed.nc bed.grd",
        "has 1 cells of -32768, which it does not declare as nodata": "packed.tif",
        "declares a scale of 0 and an offset of 0; correct them, for example with gdal_edit.py": "nought.tif",
        "holds complex64 values; save": "waves.tif",
        "has heights from -1e.07 to -30 m; declare its nodata value": "gaps.npy",
    }.items():
        for name in names.split():
            with pytest.raises(SceneError, match=rf"^seabed\.relief\.path: '.*{name}' {expected}") as caught:
                build_ground(scene(tmp_path / name))
            assert "\n" not in str(caught.value)
    with pytest.raises(SceneError, match="choose sample:jacksboro or sample:topobathy"):
        build_ground(scene("sample:matterhorn"))


def test_real_bag_has_negative_elevations_and_gaps_and_one_of_varying_resolution_its_finest(real_data):
    ground = build_ground(scene(real_data / "dem" / "bdb_01.bag"))
    assert (ground.spacing, ground.heights.shape) == (4.0, (12, 16))
    assert np.isnan(ground.heights).mean() == pytest.approx(0.526, abs=1e-3)
    assert -4.52 < ground.datum < -2.80
    grid = read_grid(str(real_data / "dem" / "hyo2qc_tiny_vr.bag"))
    assert grid.spacing == (0.5, 0.5)
    assert grid.heights.shape == (128, 128)
    assert np.nanmin(grid.heights) == pytest.approx(-13.727, abs=1e-3)


def test_degrees_are_projected_to_the_utm_zone_of_the_place_and_a_local_system_is_no_place_on_earth(tmp_path):
    """A plane that slopes in metres on the map, sampled in degrees, is that plane again."""
    spacing = 2e-5  # degrees, 2.2 m
    lon, lat = 10.0 + spacing * (np.arange(80) + 0.5), 55.0 - spacing * (np.arange(60) + 0.5)
    to_utm = pyproj.Transformer.from_crs("EPSG:4326", "EPSG:32632", always_xy=True)
    east, north = to_utm.transform(*np.meshgrid(lon, lat))
    rows = -30.0 + 0.01 * (east - east.mean()) - 0.02 * (north - north.mean())
    path = write_tiff(tmp_path / "a.tif", rows, pixel=(spacing, spacing), corner=(10.0, 55.0), crs="EPSG:4326")
    grid = read_grid(str(path))
    assert grid.crs == "EPSG:32632"
    assert grid.spacing[0] == pytest.approx(grid.spacing[1])
    assert 1.2 < grid.spacing[0] < 2.4
    x = grid.corner[0] + grid.spacing[0] * np.arange(grid.heights.shape[1])
    y = grid.corner[1] + grid.spacing[1] * np.arange(grid.heights.shape[0])[:, None]
    expected = -30.0 + 0.01 * (x - east.mean()) - 0.02 * (y - north.mean())
    inside = np.isfinite(grid.heights)
    assert inside.mean() > 0.9
    # Bilinear interpolation is exact on a plane, except beside the edge; its weights resolve a millimetre here.
    inner = binary_erosion(inside, iterations=2)
    np.testing.assert_allclose(grid.heights[inner], expected[inner], atol=2e-3)
    place = scene(path).seabed.relief.georeference(None)
    assert place.crs == "EPSG:32632"
    np.testing.assert_allclose(place.origin, to_utm.transform(lon.mean(), lat.mean()), atol=4.0)
    local = 'LOCAL_CS["harbour",UNIT["metre",1],AXIS["Easting",EAST],AXIS["Northing",NORTH]]'
    grid = read_grid(str(write_tiff(tmp_path / "bed.tif", sloped(3, 3), crs=local)))
    assert (grid.crs, grid.spacing) == ("", (2.0, 2.0))
    with pytest.raises(SceneError, match=r"^crs 'LOCAL_CS.* cannot be transformed to 'EPSG:4326'; give one on Earth"):
        project(local, DEGREES, np.zeros(1), np.zeros(1))


def test_depths_are_recognised_or_asked_about(tmp_path):
    depths = -sloped(5, 7)
    path = write_tiff(tmp_path / "bed.tif", depths, **UTM)
    with pytest.raises(SceneError, match=r"lies from 19.94 to 22 m above the sea surface; write positive = 'down' if"):
        build_ground(scene(path))
    asked = build_ground(scene(path, positive="down"))
    np.testing.assert_allclose(asked.heights + asked.datum, -depths[::-1], atol=1e-5)
    with rasterio.open(path, "r+") as raster:
        raster.set_band_description(1, "Depth")
    recognised = build_ground(scene(path))
    np.testing.assert_array_equal(recognised.heights, asked.heights)
    np.testing.assert_array_equal(build_ground(scene(path, positive="down")).heights, asked.heights)
    with rasterio.open(path, "r+") as raster:
        raster.update_tags(positive="up")
    with pytest.raises(SceneError, match="above the sea surface"):
        build_ground(scene(path))
    # A negative "depth" is a height.
    path = write_tiff(tmp_path / "negative.tif", -depths, **UTM)
    with rasterio.open(path, "r+") as raster:
        raster.set_band_description(1, "depth")
    np.testing.assert_array_equal(build_ground(scene(path)).heights, asked.heights)


def tag(path, **tags):
    """Set tags of a raster's band."""
    with rasterio.open(path, "r+") as raster:
        raster.update_tags(1, **tags)
    return path


FOOT, SURVEY_FOOT = 0.3048, 1200.0 / 3937.0
STORED = {  # factor and offset from stored numbers to metres, type, reference system, attributes and tags of the band
    "a scale": (0.02, 0.0, "int16", "EPSG:32633", {"scales": (0.02,)}, {}),
    "a scale and an offset": (0.25, -90.0, "uint16", "EPSG:32633", {"scales": (0.25,), "offsets": (-90.0,)}, {}),
    "a scale of feet": (0.1 * FOOT, 0.0, "int16", "EPSG:32633", {"scales": (0.1,), "units": ("ft",)}, {}),
    "centimetres": (0.01, 0.0, "int32", "EPSG:32633", {"units": ("Centimeters",)}, {}),
    "decimetres": (0.1, 0.0, "int32", "EPSG:32633", {"units": ("dm",)}, {}),
    "metres": (1.0, 0.0, "float32", "EPSG:32633", {"units": ("Meters",)}, {}),
    "feet": (FOOT, 0.0, "float32", "EPSG:32633", {"units": ("feet",)}, {}),
    "feet by a tag": (FOOT, 0.0, "float32", "EPSG:32633", {}, {"units": "ft"}),
    "survey feet": (SURVEY_FOOT, 0.0, "float32", "EPSG:32633", {"units": ("US survey feet",)}, {}),
    "fathoms": (1.8288, 0.0, "float32", "EPSG:32633", {"units": ("fathoms",)}, {}),
    "heights of survey feet": (SURVEY_FOOT, 0.0, "float32", "EPSG:32633+6360", {}, {}),
    "heights of feet": (FOOT, 0.0, "float32", "EPSG:32633+8228", {}, {}),
    "depths of a reference system": (-1.0, 0.0, "float32", "EPSG:32633+5866", {}, {}),
    "depths of feet": (-SURVEY_FOOT, 0.0, "float32", "EPSG:32633+6358", {}, {}),
    "depths by a tag": (-1.0, 0.0, "float32", "EPSG:32633", {}, {"positive": "down"}),
    "depths by a name": (-0.01, 0.0, "uint16", "EPSG:32633", {"units": ("cm",)}, {"standard_name": "depth"}),
}


@pytest.mark.parametrize("name", STORED)
def test_stored_numbers_become_metres_by_scale_offset_unit_and_sign_and_nodata_comes_first(tmp_path, name):
    factor, offset, dtype, crs, attributes, tags = STORED[name]
    rows = sloped(5, 7)
    stored = (rows - offset) / factor
    stored = np.round(stored) if "int" in dtype else stored
    nodata = 32767 if "int" in dtype else -9999.0
    stored[1, 2] = nodata
    path = tag(write_tiff(tmp_path / "a.tif", stored, dtype=dtype, crs=crs, nodata=nodata, band=attributes), **tags)
    ground = build_ground(scene(path))
    expected = np.where(stored == nodata, np.nan, stored * factor + offset)[::-1]
    np.testing.assert_allclose(ground.heights + ground.datum, expected, atol=2e-5)
    assert read_grid(str(path)).crs == "EPSG:32633"


def test_depths_that_a_tag_declares_may_dry_and_numbers_in_degrees_are_scaled_too(tmp_path):
    rows = np.array([[-1.5, 2.0, 7.0], [3.0, 8.0, 9.0]])
    path = tag(write_tiff(tmp_path / "drying.tif", rows, **UTM), positive="down")
    ground = build_ground(scene(path))
    np.testing.assert_allclose(ground.heights + ground.datum, -rows[::-1], atol=1e-6)
    path = tag(write_tiff(tmp_path / "inverted.tif", -rows - 5.0, **UTM), positive="down")
    with pytest.raises(SceneError, match="above the sea surface; write positive = 'up' if its numbers are heights, or"):
        build_ground(scene(path))
    build_ground(scene(path, positive="up"))
    packed = np.full((20, 20), -2500, np.int16)
    packed[5:7, 5:7] = -32768
    path = write_tiff(
        tmp_path / "degrees.tif", packed, pixel=(2e-5, 2e-5), corner=(10.0, 55.0), crs="EPSG:4326",
        dtype="int16", nodata=-32768, band={"scales": (0.01,), "units": ("ft",)},
    )  # fmt: skip
    heights = read_grid(str(path)).heights
    assert heights[np.isfinite(heights)] == pytest.approx(-25.0 * FOOT)
    assert 0.005 < np.isnan(heights).mean() < 0.6


def test_s102_holds_depths_from_the_south(tmp_path):
    """Written as S-100 lays out its HDF5."""
    with netCDF4.Dataset(tmp_path / "bed.h5", "w") as file:
        file.setncatts({"productSpecification": "INT.IHO.S-102.2.2", "horizontalCRS": np.int32(32633)})
        file.createGroup("Group_F")
        coverage = file.createGroup("BathymetryCoverage").createGroup("BathymetryCoverage.01")
        sides = {"gridSpacingLongitudinal": 2.0, "gridSpacingLatitudinal": 2.0}
        counts = {"numPointsLongitudinal": np.int32(7), "numPointsLatitudinal": np.int32(5)}
        coverage.setncatts({"gridOriginLongitude": EAST, "gridOriginLatitude": NORTH, "startSequence": "0,0"})
        coverage.setncatts(sides | counts)
        values = coverage.createGroup("Group_001")
        values.createDimension("y", 5)
        values.createDimension("x", 7)
        node = np.dtype([("depth", "f4"), ("uncertainty", "f4")])
        nodes = np.zeros((5, 7), node)
        nodes["depth"] = -sloped(5, 7)
        nodes["depth"][1, 2] = 1e6
        values.createVariable("values", values.createCompoundType(node, "node"), ("y", "x"))[:] = nodes
    grid = read_grid(str(tmp_path / "bed.h5"))
    assert (grid.spacing, grid.corner, grid.crs) == ((2.0, 2.0), (EAST, NORTH), "EPSG:32633")
    ground = build_ground(scene(tmp_path / "bed.h5"))
    expected = sloped(5, 7)
    expected[1, 2] = np.nan
    np.testing.assert_allclose(ground.heights + ground.datum, expected, atol=1e-5)


def test_a_map_in_feet_is_projected_and_a_local_one_scaled(tmp_path):
    rows = sloped(40, 40) / SURVEY_FOOT
    path = write_tiff(tmp_path / "a.tif", rows, pixel=(10.0, 10.0), corner=(6e6, 2.1e6), crs="EPSG:2227+6360")
    grid = read_grid(str(path))
    assert grid.crs == "EPSG:32610"
    assert grid.spacing == pytest.approx((10.0 * FOOT, 10.0 * FOOT), rel=0.02)
    assert (np.nanmin(grid.heights), np.nanmax(grid.heights)) == pytest.approx((-39.5, -19.61), abs=0.1)
    local = 'LOCAL_CS["harbour",UNIT["foot",0.3048],AXIS["Easting",EAST],AXIS["Northing",NORTH]]'
    band = {"units": ("m",)}
    path = write_tiff(tmp_path / "b.tif", rows, pixel=(10.0, 10.0), corner=(0.0, 0.0), crs=local, band=band)
    assert read_grid(str(path)).spacing == pytest.approx((3.048, 3.048))


def test_a_map_that_stretches_lengths_is_projected_and_a_place_has_no_vertical_system(tmp_path):
    """Web Mercator makes lengths at 60° twice as long as they are."""
    x, y = project(DEGREES, "EPSG:3857", np.array(15.0), np.array(60.0))
    path = write_tiff(tmp_path / "a.tif", sloped(20, 20), corner=(float(x), float(y)), crs="EPSG:3857")
    assert read_grid(str(path)).crs == "EPSG:32633"
    assert read_grid(str(path)).spacing == pytest.approx((1.0, 1.0), rel=0.01)
    three = pyproj.CRS("EPSG:32633").to_3d().to_wkt()
    for crs in ("EPSG:32633+5703", three):
        grid = read_grid(str(write_tiff(tmp_path / "b.tif", sloped(20, 20), crs=crs)))
        assert (grid.crs, grid.spacing) == ("EPSG:32633", (2.0, 2.0))


def test_a_unit_that_is_not_known_or_contradicts_itself_is_named_and_the_remedy_works(tmp_path):
    path = write_tiff(tmp_path / "a.tif", sloped(5, 7) / 20.0, band={"units": ("cubit rods",)}, **UTM)
    with pytest.raises(
        SceneError, match="heights in 'cubit rods', a unit that is not known here; name it m, for"
    ) as caught:
        build_ground(scene(path))
    command = re.search(r"rio edit-info --bidx 1 --units m", str(caught.value))[0].split()
    rio = "from rasterio.rio.main import main_group; main_group()"
    subprocess.run([sys.executable, "-c", rio, *command[1:], str(path)], check=True)
    ground = build_ground(scene(path, scale=20.0))
    np.testing.assert_allclose(ground.heights + ground.datum, sloped(5, 7)[::-1], atol=1e-5)
    path = write_tiff(tmp_path / "b.tif", sloped(5, 7), crs="EPSG:32633+6360", band={"units": ("m",)})
    with pytest.raises(
        SceneError, match="heights in 'm' and a reference system of heights in 'US survey foot'; correct"
    ):
        build_ground(scene(path))
    (tmp_path / "c.asc").write_text(ASCII_HEADS["corner"] + "-10 -20 -30\n-10 -20 -30\n")
    (tmp_path / "c.prj").write_text("Projection UTM\nZone 33\nDatum NAD83\nZunits FEET\nUnits METERS\nSpheroid GRS80\n")
    np.testing.assert_allclose(read_grid(str(tmp_path / "c.asc")).heights[0], [-10 * FOOT, -20 * FOOT, -30 * FOOT])


def test_degrees_without_a_reference_system_are_said(tmp_path):
    path = tmp_path / "bed.asc"
    head = "ncols 3\nnrows 2\nxllcorner {}\nyllcorner {}\ncellsize {}\n"
    path.write_text(head.format(-5.25, 48.5, 0.0011) + "-10 -20 -30\n" * 2)
    with pytest.warns(
        FileWarning, match=r"its cells of 0.0011 count as metres; if they are degrees, name its reference"
    ):
        read_grid(str(path))
    for other in ((0.0, 0.0, 0.0011), (500.0, 48.5, 0.01), (-5.25, 48.5, 0.5)):
        path.write_text(head.format(*other) + "-10 -20 -30\n" * 2)
        assert read_grid(str(path)).spacing == (other[2], other[2])


@pytest.mark.parametrize("value", [-9999.0, 9999.0, 1e6, -32768.0, -99999.0])
def test_an_undeclared_nodata_value_is_refused(tmp_path, value):
    rows = sloped(5, 7)
    rows[1, 2:4] = value
    np.save(tmp_path / "bed.npy", rows)
    for path in (tmp_path / "bed.npy", write_tiff(tmp_path / "bed.tif", rows, crs="EPSG:32633")):
        with pytest.raises(SceneError, match=re.escape(f"has 2 cells of {value:.15g}, which it does not declare")):
            read_grid(str(path))
    np.save(tmp_path / "trench.npy", -9990.0 - np.arange(20.0).reshape(4, 5))  # a trench may be that deep
    assert np.isfinite(read_grid(str(tmp_path / "trench.npy")).heights).all()


# Random detail between the nodes of a measured bed


def detailed(path, *, spacing=0.25, seed=1, rms=0.05, **changes):
    detail = {"kind": "fractal", "beta": 1.4, "rms": rms, "period": 16.0} | changes
    relief = {"kind": "sum", "of": [{"kind": "dem", "path": str(path)}, detail]}
    return build({"seed": seed, "seabed": {"spacing": spacing, "relief": relief}})


def test_a_measured_bed_takes_random_detail(tmp_path):
    """2 m bathymetry with 5 cm of roughness: the measured bed between its nodes, plus a periodic relief."""
    path = write_tiff(tmp_path / "a.tif", sloped(40, 50), **UTM)
    plain, rough = build_ground(scene(path)), build_ground(detailed(path))
    assert rough.spacing == 0.25
    assert rough.heights.shape == (39 * 8 + 1, 49 * 8 + 1)
    assert (rough.x0, rough.y0) == (plain.x0, plain.y0)
    smooth = build_ground(detailed(path, rms=0.0))
    np.testing.assert_allclose(smooth.heights[::8, ::8] + smooth.datum, plain.heights + plain.datum, atol=1e-5)
    between = 0.5 * (smooth.heights[:, :-1:8] + smooth.heights[:, 8::8])
    np.testing.assert_allclose(smooth.heights[:, 4::8], between, atol=1e-5)
    detail = rough.heights + rough.datum - smooth.heights - smooth.datum
    assert detail[:256, :256].std() == pytest.approx(0.05, rel=0.02)
    np.testing.assert_allclose(detail[64:], detail[:-64], atol=1e-5)  # repeats after its period of 64 nodes
    other = build_ground(detailed(path, seed=2))
    assert np.abs(other.heights - rough.heights).max() > 0.05
    np.testing.assert_array_equal(build_ground(detailed(path)).heights, rough.heights)


def test_holes_stay_holes_under_detail_no_coarser_than_the_measurement(tmp_path):
    rows = sloped(10, 10)
    rows[4, 5] = -9999.0
    ground = build_ground(detailed(write_tiff(tmp_path / "a.tif", rows, **UTM)))
    assert np.isnan(ground.heights[40, 40])
    assert 0.0 < np.isnan(ground.heights).mean() < 0.1
    fine = write_tiff(tmp_path / "b.tif", sloped(40, 50), pixel=(0.11, 0.11), **UTM)
    assert 0.1 < build_ground(detailed(fine, spacing=5.0)).spacing <= 0.11
    wide = write_tiff(tmp_path / "c.tif", sloped(5, 5), pixel=(500.0, 500.0), **UTM)
    with pytest.raises(SceneError, match=r"seabed.spacing: 0.1 m makes 20001 nodes along a side of the measured bed"):
        build_ground(detailed(wide, spacing=0.1))


def test_a_record_over_a_measured_bed_lies_on_its_map_and_its_detail_is_heard_and_drawn(tmp_path, capsys):
    path = write_tiff(tmp_path / "a.tif", np.full((60, 60), -20.0), **UTM)
    over = edit(scene(path), {"track.pings": 2, "sonar.bins": 50, "sonar.range": 20.0})
    record = simulate(over)
    assert record.attrs["crs"] == "EPSG:32633"
    assert (record.attrs["origin_x"], record.attrs["origin_y"]) == (EAST + 60.0, NORTH - 60.0)
    assert simulate(edit(over, {"world.crs": "EPSG:25833"})).attrs["crs"] == "EPSG:25833"
    small = {"track.pings": 3, "sonar.bins": 200, "sonar.range": 30.0}
    records = [simulate(edit(detailed(path, rms=rms), small)) for rms in (0.0, 0.05)]
    assert records[1].attrs["crs"] == "EPSG:32633"
    far = records[0].intensity.values[..., 100:]
    assert np.std(records[1].intensity.values[..., 100:] / far) > 0.05
    text = tmp_path / "scene.toml"
    text.write_text(scene_to_toml(detailed(path)))
    assert main(["relief", str(text), "-o", str(tmp_path / "a.png")]) == 0
    assert main(["plan", str(text)]) == 0


POWER_LAW = {"kind": "power_law"}


@pytest.mark.parametrize(
    ("of", "expected"),
    [
        (["dem", "dem"], "of has 2 measured beds; keep one"),
        (["dem", POWER_LAW | {"extent": "endless"}], "of is endless in one part and measured in another"),
        (["dem", {"kind": "flat"}], "flat"),
        (["dem", POWER_LAW | {"period": 16.0}, {"kind": "ripples", "period": 12.8}], "give all the same period"),
    ],
)
def test_what_cannot_be_added_is_one_sentence(tmp_path, of, expected):
    path = write_tiff(tmp_path / "a.tif", sloped(5, 5), **UTM)
    parts = [{"kind": "dem", "path": str(path)} if part == "dem" else part for part in of]
    with pytest.raises(SceneError, match=expected):
        build({"seabed": {"relief": {"kind": "sum", "of": parts}}})
