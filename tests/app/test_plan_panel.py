"""The plan's panel and the chart's window: what is modelled, what forcing a choice changes, and what is measured."""

import threading
from collections.abc import Callable

import numpy as np
import pytest
from controls import choose, colours_of, finish, move_slider
from PySide6.QtCore import Qt
from PySide6.QtWidgets import QFileDialog
from stand_in import StandIn

from insonify.accuracy.charts.kinds.accuracy import AccuracyChart, AccuracyRow, TracedScene
from insonify.accuracy.charts.method_settings import SettingKey
from insonify.accuracy.charts.reference import Reference
from insonify.cli import main
from insonify.scene import SceneError, edit, load_scene
from insonify.simulation import prepare
from insonify.statistics.record_errors import compare_records, measure_displacement
from insonify.tracers import sweep
from insonify_viewer.panels.chart.chart_details import details_in_words, place_of_row, row_details
from insonify_viewer.panels.plan.controller import changed_subject, difference_in_words
from insonify_viewer.record.comparison.record_difference import RecordDifference
from insonify_viewer.state.history import Modelling
from insonify_viewer.state.session import Session
from insonify_viewer.work.jobs import State

BENT = {"kind": "profile", "depth": [0.0, 10.0, 20.0, 30.0], "sound_speed": [1520.0, 1518.0, 1500.0, 1502.0]}


def line_of(view, subject: str):
    return next(group.lines[subject] for group in view.groups.values() if subject in group.lines)


def pick(viewer, qtbot, subject: str, choice: str | None):
    combo = line_of(viewer.panels["plan"].view, subject).combo
    index = combo.findData(choice)
    assert index >= 0
    finish(viewer, qtbot, choose, combo, index)


def test_forced_choices_are_undone_with_the_scenes_and_a_drag_keeps_what_is_left_out():
    default = load_scene("default")
    session = Session(default)
    session.model(session.modelling.forcing("planes", "16"))
    session.settle({"track.altitude": 8.0})
    session.model(session.modelling.forcing("planes", None).forcing("targets", "off"))
    assert session.modelling.forced == (("targets", "off"),)
    session.undo()
    assert session.modelling.forced == (("planes", "16"),)
    session.undo()
    session.undo()
    assert session.modelling == Modelling()
    session.redo()
    assert dict(session.modelling.forced) == {"planes": "16"}
    session.open(edit(default, {"seed": 9}))
    assert session.modelling == Modelling(), "another scene leaves every choice to its own plan"
    modelling = Modelling(0.01, (("planes", "64"), ("targets", "off"), ("method", "rays")))
    assert dict(modelling.coarse.forced) == {"targets": "off", "planes": "1", "rays": "1000"}, "a drag forgets planes"
    assert modelling.coarse.tolerance == 0.01


def test_every_entry_has_a_line_in_its_group_and_the_tolerance_is_final_when_it_is_let_go(open_viewer, small, qtbot):
    viewer = open_viewer(edit(small, {"water": BENT}))
    view, plan = viewer.panels["plan"].view, viewer.answer.simulation.plan
    assert {entry.subject for entry in plan.entries if entry.modelled} == set(view.groups[True].lines)
    assert "bending" in view.groups[True].lines
    pick(viewer, qtbot, "bending", "off")
    assert "bending" in view.groups[False].lines
    assert line_of(view, "bending").combo.currentText() == "off"
    assert view.automatic.isEnabled()
    finish(viewer, qtbot, view.automatic.click)
    assert "bending" in view.groups[True].lines
    assert not view.automatic.isEnabled()
    assert viewer.session.modelling == Modelling()
    # The tolerance is final when it is let go.
    finish(viewer, qtbot, viewer.open, small)
    slider = move_slider(viewer.panels["plan"].view.tolerance.slider, 1000)
    assert viewer.session.modelling.tolerance == 0.03
    finish(viewer, qtbot, slider.setSliderDown, False)
    assert viewer.session.modelling.tolerance == viewer.answer.simulation.tolerance == 0.5
    # What cannot be done is said and taken back.
    finish(viewer, qtbot, viewer.open, edit(small, {"receiver.speckle": "coherent"}))
    before = viewer.session.modelling
    viewer.session.model(before.forcing("method", "rays"))
    qtbot.waitUntil(lambda: viewer.session.modelling == before)
    assert "coherent" in viewer.window.status.sentence.text()


def test_a_forced_choice_tells_what_it_changed_and_is_what_the_command_writes(open_viewer, small, qtbot, tmp_path):
    scene = edit(small, {"track.pings": 32})
    viewer = open_viewer(scene, prepare=prepare)
    pings = np.arange(32, dtype=np.int64)
    before = viewer.answer.simulation.intensity(pings)
    pick(viewer, qtbot, "planes", "2")
    after = viewer.answer.simulation.intensity(pings)
    assert (after != before).any()
    said = viewer.window.status.sentence.text()
    assert said.startswith("planes 2: changes the record by")
    assert said.endswith("× the time")
    assert line_of(viewer.panels["plan"].view, "planes")._change.text() == said.partition(": ")[2]
    path = tmp_path / "two.npz"
    assert main(["render", "default", "-o", str(path), "--set", "sonar.bins=100", "--set", "track.pings=32",
                 "--model", "planes=2"]) == 0  # fmt: skip
    with np.load(path) as written:
        np.testing.assert_array_equal(np.moveaxis(written["intensity"], 0, 1), after)


def test_changes_in_words():
    words = {
        (RecordDifference(0.0041, 0.0, 0.0), 1.83): "changes the record by 0.41 %, not visibly, takes 1.8 × the time",
        (RecordDifference(0.0, 0.0, 0.0), 0.9): "does not change the record, takes 0.9 × the time",
        (None, 2.0): "takes 2 × the time",
    }
    assert {given: difference_in_words(*given) for given in words} == words
    auto, eight = Modelling(), Modelling().forcing("planes", "8")
    changes = ((auto, eight), (eight, auto.forcing("planes", "16")), (auto, eight.forcing("targets", "off")))
    assert [changed_subject(*each) for each in (*changes, (auto, Modelling(0.1)))] == ["planes", "planes", "", ""]


def test_what_a_drag_leaves_out_of_the_default_scene_is_a_fifth_at_most():
    scene, pings = load_scene("default"), np.arange(100, 340, 24, dtype=np.int64)
    coarse, fine = (
        prepare(scene, forced={**dict(Modelling().coarse.forced), **finer}) for finer in ({}, {"planes": "32"})
    )
    poses = fine.poses(pings)
    records = (sweep.trace(fine.arrays, poses, planes=one.plan.planes) for one in (coarse, fine))
    assert 0.02 < compare_records(fine.arrays, poses, *records).beyond < 0.2


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


def test_a_click_on_a_point_shows_its_record_and_keys_lead_to_the_others(window, qtbot, tmp_path, monkeypatch):
    measure(window, qtbot)
    view = window.panels["chart"].view
    assert window.session.scene.title in view.windowTitle()
    rows = view.picture.chart.rows
    loud = next(row for row in rows if row.method == "rays")
    plot = view.picture.plots[loud.targets]
    qtbot.waitUntil(lambda: plot.area.contains(plot.place_of(*place_of_row(loud))))
    top = plot.canvas.getAxis("top")
    assert (top.isVisible(), top.labelText) == (True, "512 pings"), "a whole record takes that much longer"
    assert any("tolerance 3 %" in getattr(item, "toPlainText", str)() for item in plot.canvas.items())
    qtbot.mouseClick(plot.surface, Qt.MouseButton.LeftButton, pos=plot.place_of(*place_of_row(loud)))
    qtbot.waitUntil(lambda: bool(view.numbers.text()))
    assert "error 10 % beyond" in view.numbers.text()
    assert "energy +10 %" in view.numbers.text()
    assert view.strips.isVisible()
    qtbot.waitUntil(lambda: np.unique(colours_of(view.strips.grab().toImage())[::5, ::5]).size > 4)
    # Points are stepped through by keys.
    panel = window.panels["chart"]
    picked = []
    panel.view.picked.connect(picked.append)
    for key in (Qt.Key.Key_Right, Qt.Key.Key_Right, Qt.Key.Key_Left, Qt.Key.Key_Left):
        qtbot.keyClick(panel.view.picture, key)
        qtbot.waitUntil(lambda: panel.view.picture.chosen is picked[-1])
    assert [id(row) for row in picked] == [id(rows[k]) for k in (0, 1, 0, len(rows) - 1)]
    # The chart is saved.
    monkeypatch.setattr(QFileDialog, "getSaveFileName", lambda *_: (str(tmp_path / "c.csv"), ""))
    view.save.click()
    qtbot.waitUntil(lambda: "saved" in view.sentence.text())
    assert "1,000 rays" in (tmp_path / "c.csv").read_text()
    monkeypatch.setattr(QFileDialog, "getSaveFileName", lambda *_: (str(tmp_path / "c.doc"), ""))
    view.save.click()
    qtbot.waitUntil(lambda: "saved" not in view.sentence.text())
    assert ".png" in view.sentence.text()


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
    finish(window, qtbot, window.session.settle, {"track.altitude": 7.0})
    job = window.jobs.running[0]
    assert job.title == f"chart of {window.session.scene.title}"
    assert window.window.jobs.isVisible()
    qtbot.waitUntil(lambda: "left: measuring" in view.sentence.text())
    view.stop.click()
    qtbot.waitUntil(lambda: not window.panels["chart"].busy)
    assert view.sentence.text() == "stopped"
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
    assert window.panels["chart"].view.sentence.text() == "stopped"
    # What cannot be charted is said.

    def refuse(scene, progress):
        raise SceneError("track.pings: 0 is too few; give at least 1")

    window.panels["chart"].measure = refuse
    measure(window, qtbot)
    assert "too few" in window.panels["chart"].view.sentence.text()
    # A viewer that is closed meanwhile leaves no thread.
    window.panels["chart"].measure = endless
    window.panels["chart"].view.measure.click()
    window.window.close()
    assert not window.panels["chart"].busy


def test_the_record_of_a_point_is_laid_out_as_it_is_read(small):
    chart = a_chart(small)
    judged = row_details(chart, chart.rows[0])
    assert judged.similarity == pytest.approx(1.0)
    assert judged.record.shape == (4, 200)
    np.testing.assert_array_equal(judged.record, judged.record[:, ::-1])
    np.testing.assert_array_equal(judged.record[0, 100:], chart.normalise_row(chart.rows[0])[0][3, 1])
    assert "error 0 % beyond 1.4 altitudes" in details_in_words(judged)
    assert "± 5 %" in details_in_words(judged)
