"""Surveys: lines over an area, their records, mosaic, coverage and page."""

import math
import re
import tomllib

import numpy as np
import pytest
import rasterio

import insonify
from commands import refused
from insonify import cli
from insonify.files import bundled_specifications
from insonify.io.records import read_record
from insonify.scene import load_scene, scene_from_toml
from insonify.simulation import prepare
from insonify.surveys.engine import done_jobs, finish
from insonify.surveys.lines.specification import Area, SurveySpecification
from insonify.surveys.lines.summary import measure_coverage, summarise
from insonify.surveys.lines.work import SurveyLine, SurveyWork, join_lines, lay_lawnmower
from insonify.surveys.mosaic import Mosaic
from insonify.surveys.specification import read_specification
from small_sets import SURVEY, contents, run_here, write_set

SQUARE = [(0.0, 0.0), (100.0, 0.0), (100.0, 60.0), (0.0, 60.0)]
BASE = load_scene("default")


@pytest.fixture(scope="module")
def small(tmp_path_factory):
    """A survey of three lines, made by the command on a worker."""
    folder = tmp_path_factory.mktemp("small")
    path = write_set(folder, SURVEY)
    assert cli.main(["survey", str(path), "-o", str(folder / "survey"), "--scheduler", "local:1"]) == 0
    return folder / "survey"


def test_lines_lie_in_the_middle_of_their_strips():
    lines = [((0.0, 10.0), (100.0, 10.0)), ((100.0, 30.0), (0.0, 30.0)), ((0.0, 50.0), (100.0, 50.0))]
    assert lay_lawnmower(Area(corners=SQUARE, spacing=20.0)) == [SurveyLine(*ends) for ends in lines]
    assert [len(lay_lawnmower(Area(corners=SQUARE, spacing=spacing))) for spacing in (60.0, 59.9)] == [1, 2]


@pytest.mark.parametrize("heading", [0.0, 30.0, 90.0, -135.0])
@pytest.mark.parametrize("spacing", [7.0, 13.0])
def test_lines_of_any_heading_cover_the_area(heading, spacing):
    lines = lay_lawnmower(Area(corners=SQUARE, spacing=spacing, heading=heading))
    ahead = np.array([math.cos(math.radians(heading)), math.sin(math.radians(heading))])
    aside = np.array([-ahead[1], ahead[0]])
    starts, ends = (np.array([getattr(line, name) for line in lines]) for name in ("start", "end"))
    offsets, across = starts @ aside, np.array(SQUARE) @ aside
    np.testing.assert_allclose(np.diff(offsets), spacing)
    assert max(offsets[0] - across.min(), across.max() - offsets[-1]) <= 0.5 * spacing + 1e-9
    ways = (ends - starts) / np.array([line.length for line in lines])[:, None]
    np.testing.assert_allclose(ways, np.outer((-1.0) ** np.arange(len(lines)), ahead), atol=1e-9)
    places = np.concatenate([starts, ends])
    assert ((places >= -1e-9) & (places <= np.add(SQUARE[2], 1e-9))).all()


def test_a_recorded_turn_leads_from_one_line_to_the_next():
    corners = [(0.0, 0.0), (100.0, 0.0), (70.0, 40.0), (10.0, 40.0)]
    lines = lay_lawnmower(Area(corners=corners, spacing=20.0, turns="in"))
    track = join_lines(lines, speed=2.0, ping_rate=5.0)
    assert [line.turn for line in lines] == [10.0, 0.0]
    assert lines[0].end[0] == lines[1].start[0] == pytest.approx(92.5)
    # Half a circle of 10 m radius, to port.
    begun = lines[0].length / 2.0
    turned = (track.time >= begun) & (track.time <= begun + math.pi * 10.0 / 2.0)
    np.testing.assert_allclose(np.hypot(track.x[turned] - 92.5, track.y[turned] - 20.0), 10.0, atol=1e-9)
    steps = np.hypot(np.diff(track.x), np.diff(track.y)) / np.diff(track.time)
    np.testing.assert_allclose(steps, 2.0, rtol=1e-4)
    assert track.pings[0].stop == track.pings[1].start
    np.testing.assert_allclose(np.diff(track.heading)[turned[1:]].max(), 1.0, atol=0.01)


def test_every_line_without_turns_begins_with_a_ping():
    lines = [SurveyLine((0.0, 0.0), (10.0, 0.0)), SurveyLine((3.0, 7.0), (3.0, 27.0))]
    track = join_lines(lines, speed=2.0, ping_rate=5.0)
    assert [len(pings) for pings in track.pings] == [26, 51]
    at = [pings.start / 5.0 for pings in track.pings]
    found = [np.interp(at, track.time, values) for values in (track.x, track.heading)]
    np.testing.assert_allclose(found, [[0.0, 3.0], [0.0, 90.0]], atol=1e-9)


def test_records_are_those_of_one_scene_and_have_unlike_speckle(small):
    work = SurveyWork(SurveySpecification.model_validate(tomllib.loads(SURVEY)), BASE, small).begun()
    simulation, records = prepare(work.scene, plan=work.plan), []
    for number, pings in enumerate(work.track.pings):
        record = read_record(str(small / "records" / f"line-{number + 1:04d}.nc"))
        records.append(record["intensity"].values)
        np.testing.assert_array_equal(record["intensity"].values.swapaxes(0, 1), simulation.intensity(np.array(pings)))
        line = work.lines[number]
        np.testing.assert_allclose([record["platform_x"][0], record["platform_y"][0]], line.start, atol=1e-6)
        assert abs(float(record["platform_x"][-1]) - line.end[0]) <= 0.4
    assert abs(np.corrcoef(records[0][:, :50].ravel(), records[2][:, :50].ravel())[0, 1]) < 0.9
    assert not np.array_equal(records[0], records[2])


def test_mosaic_and_coverage_lie_on_one_grid_and_the_page_that_shows_them_needs_no_other_file(small):
    with rasterio.open(small / "mosaic.tif") as mosaic, rasterio.open(small / "coverage.tif") as coverage:
        assert mosaic.transform == coverage.transform
        level, count = mosaic.read(1), coverage.read(1)
    assert ((count > 0) == np.isfinite(level)).all()
    assert count.max() == 3
    page = (small / "index.html").read_text()
    assert page.count("data:image/png;base64,") == 2
    assert "3 of 3 lines" in page
    assert "100.0 % of 720 m² are shown at least once" in page
    assert set(re.findall(r"href='([^']+)'", page)) == {f"records/line-{number:04d}.nc" for number in (1, 2, 3)}
    assert not re.search("<link|<script", page)


def test_coverage_is_that_of_the_area():
    count = np.zeros((10, 20), np.uint16)
    count[:, :10] = 1
    count[:5, :5] = 2
    mosaic = Mosaic(np.zeros((10, 20), np.float32), (0.0, 10.0), 1.0, count)
    whole = np.array([(0.0, 0.0), (20.0, 0.0), (20.0, 10.0), (0.0, 10.0)])
    assert measure_coverage(mosaic, whole) == (200.0, 0.5, 0.125)
    assert measure_coverage(mosaic, 2.0 * whole).once == 0.125  # what lies beyond the mosaic is not shown
    assert measure_coverage(mosaic, None) == (100.0, 1.0, 0.25)


def first_job(folder, values):
    """Do the first job of a survey in a folder; return its work."""
    work = SurveyWork(SurveySpecification.model_validate(values), BASE, folder / "survey").begun()
    finish(work, work.names()[0])
    return work


def test_the_page_shows_text_of_a_specification_as_it_is(tmp_path):
    hostile = "\x1b]0;owned\x07<img src=x> R&D"
    values = tomllib.loads(SURVEY) | {"title": hostile, "description": hostile}
    values["area"] |= {"corners": [(0.0, 0.0), (6.0, 0.0), (6.0, 9.0), (0.0, 9.0)]}
    work = first_job(tmp_path, values)
    summarise(work, work.names())
    page = (tmp_path / "survey" / "index.html").read_text()
    assert page.count("&lt;img src=x&gt; R&amp;D") >= 4
    assert "<img src=x" not in page
    assert not set(page) & set("\x07\x1b")


def test_a_survey_elsewhere_is_the_same_to_the_bit_and_can_be_moved(small, tmp_path):
    (tmp_path / "here").mkdir()
    path = write_set(tmp_path / "here", SURVEY)
    words = ["survey", str(path), "-o", str(tmp_path / "here" / "another")]
    assert run_here(*words) == 0
    before, moved = contents(tmp_path / "here" / "another"), tmp_path / "there" / "another"
    assert before == contents(small)
    (tmp_path / "here").rename(tmp_path / "there")
    words = [word.replace("/here", "/there") for word in words]
    assert run_here(*words) == 0
    assert contents(moved) == before
    record = moved / "records" / "line-0003.nc"
    record.unlink()
    next((moved / "jobs").glob("*/0000002-*")).unlink()
    assert run_here(*words) == 0
    assert contents(moved) == before
    assert len(done_jobs(moved)) == 3
    scene = scene_from_toml(read_record(str(record)).attrs["scene"], source=record)
    assert scene.track.motion.path == str(moved / "jobs" / "track.csv")


def test_recorded_turns_are_in_the_records(tmp_path):
    values = tomllib.loads(SURVEY)
    values["area"]["turns"] = "in"
    work = first_job(tmp_path, values)
    heading = read_record(str(tmp_path / "survey" / "records" / "line-0001.nc"))["platform_heading"].values
    assert heading[0] == pytest.approx(0.0, abs=1e-6)
    assert 170.0 < heading[-1] < 180.0
    assert insonify.simulate(work.scene.model_copy(), threads=1).sizes["ping_time"] == work.track.pings[-1].stop


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({"lines": "[{ start = [0.0, 0.0], end = [5.0, 0.0] }]"}, "area, lines: give one of the two"),
        ({"suffix": '".doc"'}, "suffix: '.doc' is not a format of records; give one of .nc"),
        ({"mosaic": '{ overlap = "best" }'}, "mosaic.overlap"),
        ({"base": '"no-such"'}, "no such file; give a TOML file or one of"),
        ({"spacing": "-1.0"}, "area.spacing: -1.0 is out of bounds; give a value above 0"),
        ({"corners": "[[0.0, 0.0], [1.0, 1.0]]"}, "area.corners"),
    ],
)
def test_a_mistake_in_a_specification_is_told_in_a_sentence(tmp_path, capsys, changes, told):
    path = write_set(tmp_path, SURVEY, **changes)
    assert told in refused(capsys, "survey", str(path), "-o", str(tmp_path / "survey"))
    assert not (tmp_path / "survey").exists()


@pytest.mark.parametrize("name", list(bundled_specifications("surveys")))
def test_a_bundled_survey_can_be_planned(name, tmp_path):
    one = read_specification(name, SurveySpecification, "surveys")
    work = SurveyWork(one, load_scene(one.base), tmp_path).begun()
    assert work.plan is not None
    assert prepare(work.scene, plan=work.plan).plan == work.plan
