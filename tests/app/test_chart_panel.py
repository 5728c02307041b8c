"""The chart's window: measured on a thread of its own, stopped, picked from, saved."""

import threading
from collections.abc import Callable

import numpy as np
import pytest
from PySide6.QtCore import Qt
from PySide6.QtWidgets import QFileDialog
from stand_in import StandIn

from insonify.accuracy.charts.kinds.accuracy import AccuracyChart, AccuracyRow, TracedScene
from insonify.accuracy.charts.method_settings import SettingKey
from insonify.accuracy.charts.reference import Reference
from insonify.scene import SceneError
from insonify.statistics.record_errors import compare_records, measure_displacement
from insonify_viewer.panels.chart.chart_details import (
    ChartPoint,
    details_in_words,
    draw_chart,
    nearest_row,
    row_details,
)
from insonify_viewer.work.jobs import State


def a_chart(scene, progress: Callable[[float], None] = lambda share: None) -> AccuracyChart:
    """Two methods over the stand-in's record, of which one is right and the other a tenth too loud."""
    simulation = StandIn(scene, 0.03)
    pings = np.arange(4, dtype=np.int64)
    poses, right = simulation.poses(pings), simulation.intensity(pings)
    records = {
        SettingKey("sweep", "4 planes", True): right,
        SettingKey("rays", "1,000 rays", True): np.float32(1.1) * right,
    }
    rows = tuple(
        AccuracyRow(
            *(name.method, name.setting, size, True, size, 0.05),
            compare_records(simulation.arrays, poses, records[name], right),
            measure_displacement(simulation.arrays, poses, records[name], right),
        )
        for name, size in zip(records, (4.0, 1000.0))
    )
    progress(0.5)
    cases = {True: TracedScene(simulation.arrays, poses, Reference(right, 1e-4, 65536))}
    return AccuracyChart(scene.title, rows, 4, "this machine", cases, records)


@pytest.fixture
def window(viewer, qtbot):
    viewer.panels["chart"].measure = a_chart
    viewer.panels["plan"].view.chart.click()
    assert viewer.panels["chart"].view.isVisible()
    return viewer


def measure(viewer, qtbot):
    viewer.panels["chart"].view.measure.click()
    qtbot.waitUntil(lambda: not viewer.panels["chart"].busy)


def test_a_click_on_a_point_shows_its_record_keys_lead_to_the_others_and_it_is_saved(
    window, qtbot, tmp_path, monkeypatch
):
    measure(window, qtbot)
    view = window.panels["chart"].view
    assert window.session.scene.title in view.windowTitle()
    loud = next(point.row for point in window.panels["chart"]._picture.points if point.row.method == "rays")
    qtbot.mouseClick(view.picture, Qt.MouseButton.LeftButton, pos=view.picture.place_of(loud).toPoint())
    qtbot.waitUntil(lambda: bool(view._numbers.text()))
    assert "error 10 % beyond" in view._numbers.text()
    assert "energy +10 %" in view._numbers.text()
    assert view._strips.isVisible()
    image = view._strips.grab().toImage()
    assert len({image.pixel(x, y) for x in range(0, image.width(), 5) for y in range(0, image.height(), 5)}) > 4
    # Points are stepped through by keys.
    panel = window.panels["chart"]
    points, picked = panel._picture.points, []
    panel.view.picked.connect(picked.append)
    for key in (Qt.Key.Key_Right, Qt.Key.Key_Right, Qt.Key.Key_Left, Qt.Key.Key_Left):
        qtbot.keyClick(panel.view.picture, key)
        qtbot.waitUntil(lambda: panel.view.picture._chosen is picked[-1])
    assert [id(row) for row in picked] == [id(points[k].row) for k in (0, 1, 0, len(points) - 1)]
    # The chart is saved.
    monkeypatch.setattr(QFileDialog, "getSaveFileName", lambda *_: (str(tmp_path / "c.csv"), ""))
    view.save.click()
    qtbot.waitUntil(lambda: "saved" in view._sentence.text())
    assert "1,000 rays" in (tmp_path / "c.csv").read_text()
    monkeypatch.setattr(QFileDialog, "getSaveFileName", lambda *_: (str(tmp_path / "c.doc"), ""))
    view.save.click()
    qtbot.waitUntil(lambda: "saved" not in view._sentence.text())
    assert ".png" in view._sentence.text()


def test_the_window_lives_while_it_is_measured_until_that_is_stopped_fails_or_the_window_closes(window, qtbot):
    going, seen = threading.Event(), []

    def slow(scene, progress):
        for step in range(2000):
            progress(step / 2000)
            seen.append(step)
            going.wait(0.01)
        return a_chart(scene)

    window.panels["chart"].measure = slow
    window.run(True)
    view = window.panels["chart"].view
    view.measure.click()
    assert not window.tow.running, "a tow would take time from what is timed"
    qtbot.waitUntil(lambda: len(seen) > 5)
    assert not view.measure.isEnabled()
    window.session.settle({"track.altitude": 7.0})
    qtbot.waitUntil(lambda: window.complete)
    job = window.jobs.running[0]
    assert job.title == f"chart of {window.session.scene.title}"
    assert window.window.jobs.isVisible()
    qtbot.waitUntil(lambda: "left: measuring" in view._sentence.text())
    view.stop.click()
    qtbot.waitUntil(lambda: not window.panels["chart"].busy)
    assert view._sentence.text() == "stopped"
    assert job.state is State.STOPPED
    assert view.measure.isEnabled()

    # It is stopped among the jobs.
    def endless(scene, progress):
        while True:
            progress(0.1)

    window.panels["chart"].measure = endless
    window.panels["chart"].view.measure.click()
    window.window.open_panel("jobs")
    row = window.panels["jobs"].view.rows[-1]
    qtbot.waitUntil(lambda: row.bar.value() == 100)
    row.stop.click()
    qtbot.waitUntil(lambda: not window.panels["chart"].busy)
    assert not row.show_result.isVisible(), "a chart in a window is no file"
    assert window.panels["chart"].view._sentence.text() == "stopped"
    # What cannot be charted is said.

    def refuse(scene, progress):
        raise SceneError("track.pings: 0 is too few; give at least 1")

    window.panels["chart"].measure = refuse
    measure(window, qtbot)
    assert "too few" in window.panels["chart"].view._sentence.text()
    # A viewer that is closed meanwhile leaves no thread.
    window.panels["chart"].measure = endless
    window.panels["chart"].view.measure.click()
    window.window.close()
    assert not window.panels["chart"].busy


def test_points_lie_where_they_are_drawn(small):
    pictured = draw_chart(a_chart(small))
    height, width = pictured.pixels.shape[:2]
    for point in pictured.points:
        colour = pictured.pixels[round(point.y * height), round(point.x * width), :3].astype(int)
        assert np.ptp(colour) > 40, "a mark, and no paper"
        assert nearest_row(pictured.points, point.x + 2e-3, point.y, height / width, 0.01) is point.row
    assert nearest_row(pictured.points, 0.01, 0.01, height / width, 0.01) is None
    assert nearest_row((), 0.5, 0.5, 1.0, 1.0) is None


def test_the_nearer_point_is_picked():
    one, other = "one", "other"
    points = (ChartPoint(0.4, 0.5, one), ChartPoint(0.6, 0.5, other))
    assert nearest_row(points, 0.45, 0.5, 1.0, 0.1) == one
    assert nearest_row(points, 0.55, 0.5, 1.0, 0.1) == other
    assert nearest_row(points, 0.4, 0.58, 2.0, 0.1) is None, "heights count as they are seen"


def test_a_record_is_laid_out_as_it_is_read(small):
    chart = a_chart(small)
    judged = row_details(chart, chart.rows[0])
    assert judged.similarity == pytest.approx(1.0)
    assert judged.record.shape == (4, 200)
    np.testing.assert_array_equal(judged.record, judged.record[:, ::-1])
    np.testing.assert_array_equal(judged.record[0, 100:], chart.normalise_row(chart.rows[0])[0][3, 1])
    assert "error 0 % beyond 1.4 altitudes" in details_in_words(judged)
    assert "± 5 %" in details_in_words(judged)
