"""Mosaics: places on the map, filled swaths, gaps and overlaps, and a file that other programs open."""

import io
import re
import zipfile

import numpy as np
import pyproj
import pytest
import rasterio
import xarray as xr
from PIL import Image

from commands import refused
from insonify.cli import main
from insonify.io.records import read_record, write_record
from insonify.scene import edit, load_scene
from insonify.simulation import simulate
from insonify.surveys.mosaic import Mosaic, choose_cell, make_mosaic, write_mosaic
from insonify.surveys.swath import RecordSwath, StoredSwaths, Swath
from level_records import level_record

BOX = re.compile(r"<(north|south|east|west)>([-\d.]+)</")


def straight_swath(pings=60, spacing=0.5, heading=30.0, start=(100.0, 200.0), altitude=5.0, level=1.0, range_=20.0):
    """Level bed below a straight line, of one amplitude on port and twice that on starboard."""
    along = np.array([np.cos(np.radians(heading)), np.sin(np.radians(heading))])
    left = np.array([-along[1], along[0]])
    nadir = np.asarray(start) + spacing * np.arange(pings)[:, None] * along
    reach = np.sqrt(range_**2 - altitude**2)
    ends = np.stack([nadir + reach * left, nadir - reach * left], axis=1)
    amplitude = level * np.ones((pings, 2, 200), dtype=np.float32) * np.array([1.0, 2.0], dtype=np.float32)[:, None]
    return Swath(nadir, ends, reach, np.full(pings, altitude), amplitude, range_ / 200)


def cell_centres(mosaic):
    rows, columns = mosaic.level.shape
    x = mosaic.corner[0] + (np.arange(columns) + 0.5) * mosaic.cell
    y = mosaic.corner[1] - (np.arange(rows) + 0.5) * mosaic.cell
    return np.meshgrid(x, y)


@pytest.mark.parametrize("heading", [0.0, 30.0, 135.0, -90.0])
@pytest.mark.parametrize("cell", [0.1, 0.5, 2.0])
def test_the_swath_is_filled_and_nothing_else(heading, cell):
    swath = straight_swath(heading=heading)
    mosaic = make_mosaic([swath], cell)
    x, y = cell_centres(mosaic)
    turn = np.radians(heading)
    dx, dy = x - swath.nadir[0, 0], y - swath.nadir[0, 1]
    along, left = dx * np.cos(turn) + dy * np.sin(turn), dy * np.cos(turn) - dx * np.sin(turn)
    length, edge = 59 * 0.5, 1.5 * cell
    inside = (along > edge) & (along < length - edge) & (np.abs(left) < swath.reach - edge)
    outside = (along < -edge) | (along > length + edge) | (np.abs(left) > swath.reach + edge)
    assert np.isfinite(mosaic.level[inside]).all()
    assert np.isnan(mosaic.level[outside]).all()
    # Port is to the left of the heading.
    np.testing.assert_allclose(mosaic.level[inside & (left > edge)], 0.0, atol=1e-6)
    np.testing.assert_allclose(mosaic.level[inside & (left < -edge)], 20.0 * np.log10(2.0), rtol=1e-5)


def test_slant_range_becomes_ground_range_and_lost_pings_and_altitudes_that_no_sonar_has_leave_a_gap():
    swath = straight_swath(heading=0.0, start=(0.0, 0.0), altitude=12.0)
    swath.amplitude[:, :, 150:152] = 100.0  # slant range 15.0 m to 15.2 m: ground range 9.00 m to 9.33 m
    mosaic = make_mosaic([swath], 0.1)
    x, y = cell_centres(mosaic)
    bright = (mosaic.level > 30.0) & (np.abs(x - 15.0) < 10.0)
    assert 8.95 < np.abs(y[bright]).min() < 9.1
    assert 9.2 < np.abs(y[bright]).max() < 9.4
    swath = straight_swath(heading=0.0, start=(0.0, 0.0))
    keep = np.r_[0:20, 40:60]
    cut = Swath(swath.nadir[keep], swath.ends[keep], swath.reach, swath.altitude[keep], swath.amplitude[keep], 0.1)
    mosaic = make_mosaic([cut], 0.25)
    x, _ = cell_centres(mosaic)
    assert np.isnan(mosaic.level[(x > 10.0) & (x < 19.5)]).all()
    assert np.isfinite(mosaic.level[(x > 0.5) & (x < 9.0)]).any()
    for altitude in (1e300, np.inf, np.nan):
        mosaic = make_mosaic([swath._replace(altitude=np.where(np.arange(60) < 30, 5.0, altitude))], 0.5)
        x, _ = cell_centres(mosaic)
        assert mosaic.count[x < 14.0].mean() > 0.9
        assert not mosaic.count[x > 15.0].any()


def test_overlaps_follow_the_named_rule():
    strong, weak = straight_swath(heading=0.0, level=4.0), straight_swath(heading=0.0, level=1.0)
    for rule, energy in {"mean": 8.5, "last": 1.0, "strongest": 16.0}.items():
        mosaic = make_mosaic([strong, weak], 0.5, rule)
        _, y = cell_centres(mosaic)
        port = mosaic.level[(y > 202.0) & (y < 215.0)]
        np.testing.assert_allclose(port[np.isfinite(port)], 10.0 * np.log10(energy), atol=1e-5, err_msg=rule)
    lines = [straight_swath(heading=0.0, start=(0.0, y), level=level) for y, level in ((0.0, 1.0), (15.0, 3.0))]
    mosaic = make_mosaic(lines, 0.5, "nearest")
    x, y = cell_centres(mosaic)
    middle = (x > 2.0) & (x < 27.0)
    np.testing.assert_allclose(mosaic.level[middle & (y > 0.6) & (y < 7.0)], 0.0, atol=1e-6)
    np.testing.assert_allclose(mosaic.level[middle & (y > 8.0) & (y < 14.0)], 20.0 * np.log10(6.0), rtol=1e-5)
    mosaic = make_mosaic(lines, 0.5, "no-nadir")  # neighbours fill the nadir of one
    np.testing.assert_allclose(mosaic.level[middle & (abs(y) < 4.0)], 20.0 * np.log10(6.0), rtol=1e-5)
    np.testing.assert_allclose(mosaic.level[middle & (y < -6.0) & (y > -18.0)], 20.0 * np.log10(2.0), rtol=1e-5)


def test_cells_are_round_hold_about_a_ping_and_fit_those_of_all_mosaics():
    for spacing, cell in ((0.5, 0.5), (0.3, 0.2), (0.1999, 0.2), (0.13, 0.1), (0.01, 0.1), (7.0, 5.0)):
        assert choose_cell(max(spacing, 0.1)) == pytest.approx(cell)
        corner = np.array(make_mosaic([straight_swath(start=(100.123, 200.456))], cell).corner) / cell
        np.testing.assert_allclose(corner, np.rint(corner))


def test_a_target_lies_where_it_lies_on_earth(tmp_path, capsys):
    """A sphere towed past at a heading of 40°, in a scene placed on a map 3° from the zone of the mosaic."""
    origin, place = (250_000.0, 6_000_000.0), (2.0, 20.0)
    target = {"kind": "sphere", "radius": 0.4, "position": list(place), "material": "steel"}
    changes = {
        "world.crs": "EPSG:32631", "world.origin": list(origin), "targets": [target], "seabed.relief": "flat",
        "track.heading": 40.0, "track.pings": 160, "sonar.range": 25.0, "sonar.bins": 500, "sonar.ping_rate": 10.0,
    }  # fmt: skip
    scene = edit(load_scene("default"), changes)
    level = {}
    records = {"with": simulate(scene), "without": simulate(edit(scene, {"targets": []}))}
    for name in ("with.nc", "with.xtf", "without.nc", "without.xtf"):
        write_record(tmp_path / name, [records[name.partition(".")[0]]])
        words = [str(tmp_path / name), "-o", str(tmp_path / "a.tif"), "--cell", "0.1", "--crs", "EPSG:32632"]
        assert main(["mosaic", *words]) == 0
        assert "cells of 0.1 m on EPSG:32632" in capsys.readouterr().out
        with rasterio.open(tmp_path / "a.tif") as file:
            level[name], crs, transform = file.read(1), file.crs, file.transform
    assert crs.to_epsg() == 32632
    to_mosaic = pyproj.Transformer.from_crs("EPSG:32631", "EPSG:32632", always_xy=True)
    expected = to_mosaic.transform(origin[0] + place[0], origin[1] + place[1])
    for suffix in (".nc", ".xtf"):
        brighter = level[f"with{suffix}"] - level[f"without{suffix}"]
        row, column = np.unravel_index(np.nanargmax(brighter), brighter.shape)
        found = transform @ (column + 0.5, row + 0.5)
        # The highlight is the near side of a sphere that rises above the bed: up to a metre towards the sonar.
        assert np.hypot(found[0] - expected[0], found[1] - expected[1]) < 1.2, suffix


def made_record(altitude=5.0, heading=0.0, **attributes) -> xr.Dataset:
    echo = np.where(np.arange(200) > 50, np.random.default_rng(2).exponential(size=(2, 40, 200)), 0.0)
    record = level_record(1e-9 + echo, 0.1, altitude, 0.125, **attributes)
    return record.assign(platform_heading=("ping_time", np.full(40, heading)))


def test_altitude_and_course_come_from_the_record_itself_where_they_are_not_told():
    told, untold = RecordSwath("a", made_record(5.0), ""), RecordSwath("a", made_record(np.nan), "")
    np.testing.assert_allclose(told.altitude, 5.0)
    np.testing.assert_allclose(untold.altitude, 5.1, atol=0.1)
    tracked = RecordSwath("a", made_record(4.0), "", "bottom-track")
    np.testing.assert_allclose(tracked.altitude, untold.altitude)
    course = RecordSwath("a", made_record(heading=np.nan), "")
    ((swath, _),) = course.blocks(*course.corners)
    np.testing.assert_allclose(swath.ends[:, 0, 0], swath.nadir[:, 0], atol=1e-9)
    assert (swath.ends[:, 0, 1] > 10.0).all()


def test_one_record_is_read_once_and_several_do_not_stay_in_memory(tmp_path, monkeypatch):
    read, paths = [], [str(tmp_path / f"{name}.nc") for name in "ab"]
    for path in paths:
        write_record(path, [made_record()])
    monkeypatch.setattr("insonify.surveys.swath.read_record", lambda path, **how: read.append(path) or made_record())
    make_mosaic(StoredSwaths(paths[:1]))
    assert read == paths[:1]
    read.clear()
    make_mosaic(StoredSwaths(paths))
    assert read == [*paths, *paths]


def test_what_cannot_be_mapped_is_one_sentence_and_a_file_tells_what_it_holds(tmp_path, capsys):
    blank = made_record(np.nan)
    blank["intensity"] = 0.0 * blank.intensity + 1.0
    deep = made_record(25.0)
    metric, placed = made_record(origin_x=5e5, origin_y=4e6), made_record(crs="EPSG:32631", origin_x=5e5, origin_y=4e6)
    east, north = (("ping_time", np.full(40, degrees)) for degrees in (3.0, 36.0))
    placed = placed.assign(platform_longitude=east, platform_latitude=north)
    records = {"blank": blank, "deep": deep, "metric": metric, "placed": placed, "bare": made_record(heading=20.0)}
    for name, record in records.items():
        write_record(tmp_path / f"{name}.nc", [record])

    def words(names, options=()):
        return ["mosaic", *(str(tmp_path / f"{name}.nc") for name in names), "-o", str(tmp_path / "a.tif"), *options]

    for names, options, expected in (
        (["blank"], (), "blank.nc: has neither an altitude nor a first echo of the bed; leave it out of the mosaic"),
        (["deep"], (), "deep.nc: ends at a slant range of 20 m, before the bed 25 m beneath; leave it out"),
        (["bare"], ("--crs", "EPSG:32631"), "bare.nc: has no geographic position, so that --crs does not apply"),
        (["placed", "bare"], (), "bare.nc: has no geographic position, unlike other records"),
        (["metric", "placed"], (), "placed.nc: has coordinates in EPSG:32631, other records have none; give theirs"),
        (["placed"], ("--crs", "EPSG:1x"), "crs 'EPSG:1x' is not a coordinate reference system known to PROJ"),
        (["bare"], ("--cell", "0.0001"), "give metres from 0.001 to 1000000"),
        (["bare"], ("--cell", "0.001"), "widen the cell to"),
        (["nowhere"], (), "nowhere.nc: does not exist"),
    ):
        assert expected in refused(capsys, *words(names, options)), names
        assert not (tmp_path / "a.tif").exists()
    assert main(words(["metric", "placed"], ["--crs", "EPSG:32631"])) == 0
    assert main(words(["bare"])) == 0
    with rasterio.open(tmp_path / "a.tif") as file:
        assert file.crs is None
        assert np.isnan(file.nodata)
        assert file.descriptions == ("echo relative to the median of the record at its range",)
        assert file.units == ("dB",)
        level = file.read(1)
    assert np.isnan(level).any()
    assert np.nanmin(level) >= -40.0


def test_a_picture_for_google_earth_lies_where_the_map_does(tmp_path, capsys):
    """A checkerboard in metres is found again, by its corners in degrees, in the tiles of the KMZ."""
    level = np.kron(np.indices((4, 6)).sum(axis=0) % 2, np.ones((40, 40))).astype(np.float32)
    level[:40, :40] = np.nan
    corner, cell = (400_000.0, 5_700_000.0), 0.5
    write_mosaic(tmp_path / "a.kmz", Mosaic(level, corner, cell, np.ones(level.shape, np.uint16)), "EPSG:32631")
    to_degrees = pyproj.Transformer.from_crs("EPSG:32631", "EPSG:4326", always_xy=True)
    with zipfile.ZipFile(tmp_path / "a.kmz") as archive:
        names = [name for name in archive.namelist() if name.endswith(".kml") and name.count("/") == 2]
        (tile,) = (name for name in names if name.startswith("0/"))
        box = {side: float(value) for side, value in BOX.findall(archive.read(tile).decode())}
        with Image.open(io.BytesIO(archive.read(tile.replace(".kml", ".png")))) as picture:
            colours = np.asarray(picture.convert("RGBA"))
    for x, y in ((60.5, 10.5), (90.5, 10.5), (10.5, 30.5), (50.5, 30.5), (110.5, 70.5), (10.5, 10.5)):
        longitude, latitude = to_degrees.transform(corner[0] + x, corner[1] - y)
        column = int((longitude - box["west"]) / (box["east"] - box["west"]) * colours.shape[1])
        row = int((box["north"] - latitude) / (box["north"] - box["south"]) * colours.shape[0])
        expected = level[int(y / cell), int(x / cell)]
        if np.isnan(expected):
            assert colours[row, column, 3] == 0
        else:
            assert colours[row, column, 3] == 255
            assert (colours[row, column, 0] > 128) == (expected > 0.5)
    write_record(tmp_path / "a.nc", [made_record(heading=20.0)])
    error = refused(capsys, "mosaic", str(tmp_path / "a.nc"), "-o", str(tmp_path / "b.kmz"))
    assert "b.kmz: the records have no place on Earth" in error
    assert not (tmp_path / "b.kmz").exists()


def test_a_real_recording(real_recording, tmp_path, capsys):
    assert main(["mosaic", str(real_recording), "-o", str(tmp_path / "a.tif")]) == 0
    assert "cells of 0.1 m on EPSG:32619" in capsys.readouterr().out
    record = read_record(real_recording)
    with rasterio.open(tmp_path / "a.tif") as file:
        lon, lat = pyproj.Transformer.from_crs(file.crs, "EPSG:4326", always_xy=True).transform(
            *file.xy(file.height // 2, file.width // 2)
        )
        level = file.read(1)
    # The middle of the mosaic is within the range of the sonar from the middle of the line.
    _, _, off = pyproj.Geod(ellps="WGS84").inv(
        lon, lat, record.platform_longitude.values[230], record.platform_latitude.values[230]
    )
    assert off < 15.0
    assert 0.4 < np.isfinite(level).mean() < 0.8
    assert abs(float(np.nanmedian(level))) < 1.5
