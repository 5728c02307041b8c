"""The chart, on a scene small enough to measure in a moment."""

from __future__ import annotations

import csv
import itertools

import pytest

from insonify.chart import Chart, Row, chart
from insonify.scene import SceneError, edit, load_scene

ROWS = (
    Row("march", "0.1 m", 500.0, 0.30, 0.4, 0.01),
    Row("rays", "1,000 rays", 120.0, 0.31, 0.5, 0.01),
    Row("rays", "4,000 rays", 470.0, 0.08, 0.2, 0.01),
    Row("sweep", "1 plane", 12.0, 0.01, 0.01, 0.01),
)


def made(rows=ROWS):
    return Chart("Pipe", rows, 16, 0.001, "a machine, two cores")


@pytest.fixture(scope="module")
def measured():
    scene = edit(
        load_scene("default"),
        {
            "seabed.relief.period": 12.8, "seabed.relief.peaks": [[6.0, 3.0]], "sonar.range": 25.0, "sonar.bins": 100,
            "targets": [], "sonar.beam": {"kind": "fan", "width": 2.0},
        },
    )  # fmt: skip
    return chart(scene, pings=2)


def test_every_method_is_measured(measured):
    assert {row.method for row in measured.rows} == {"march", "rays", "sweep"}
    assert all(row.microseconds > 0.0 and row.spread >= 0.0 for row in measured.rows)
    assert measured.pings == 2
    assert 0.0 < measured.moved < 0.01
    assert measured.machine


def test_more_rays_and_more_planes_are_nearer_the_truth(measured):
    for method in ("rays", "sweep"):
        errors = [row.error_beyond for row in measured.rows if row.method == method]
        assert errors[-1] < 0.2 * errors[0]
    errors = [row.error_beyond for row in measured.rows if row.method == "rays"]
    assert all(later < earlier for earlier, later in itertools.pairwise(errors))


def test_front_keeps_what_none_beats():
    slow = (Row("rays", "16,000 rays", 1900.0, 0.005, 0.1, 0.0),)
    assert [row.setting for row in made(ROWS + slow).front()] == ["1 plane", "16,000 rays"]


def test_table_holds_what_was_measured(tmp_path):
    made().save(tmp_path / "chart.csv")
    with (tmp_path / "chart.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    assert [row["method"] for row in rows] == ["march", "rays", "rays", "sweep"]
    assert float(rows[2]["error_beyond"]) == pytest.approx(0.08)
    assert rows[0]["machine"] == "a machine, two cores"


def test_picture_is_written_whole(tmp_path):
    # One method may lack an error altogether.
    made((*ROWS, Row("sweep", "2 planes", 20.0, 0.0, 0.0, 0.0))).save(tmp_path / "chart.png")
    assert (tmp_path / "chart.png").read_bytes().startswith(b"\x89PNG")
    assert [path.name for path in tmp_path.iterdir()] == ["chart.png"]


def test_other_endings_are_refused(tmp_path):
    with pytest.raises(SceneError, match=r"chart\.pdf.*\.png or \.csv"):
        made().save(tmp_path / "chart.pdf")
    assert not list(tmp_path.iterdir())


def test_no_pings_is_refused():
    with pytest.raises(SceneError, match="pings"):
        chart(load_scene("default"), pings=0)
