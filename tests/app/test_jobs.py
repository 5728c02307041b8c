"""Jobs beside the window: begun, followed and stopped, also by the keyboard alone, with nothing half-written."""

import math
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
from controls import accessible_name, activate, answer_questions
from PIL import Image
from PySide6.QtCore import Qt
from PySide6.QtGui import QAccessible
from PySide6.QtWidgets import QApplication, QMessageBox, QWidget

from insonify import simulate
from insonify.commands.render import write
from insonify.display.display_options import DisplayOptions
from insonify.io.records import read_record
from insonify.scene import bundled_scenes, edit, load_scene
from insonify.surveys.datasets.scenes import draw_scene
from insonify.surveys.datasets.specification import DatasetSpecification
from insonify.surveys.lines.specification import SurveySpecification
from insonify.surveys.lines.work import lay_lawnmower
from insonify.surveys.specification import read_specification
from insonify_viewer.panels.jobs.view import jobs_view as jobs_window
from insonify_viewer.panels.jobs.view.questions import PRESENT, DatasetQuestion, SurveyQuestion
from insonify_viewer.state.quantities import format_time_left
from insonify_viewer.work import jobs as background_job
from insonify_viewer.work.jobs import CommandJob, Stage, State, ThreadJob
from strangers import traces, write_modules

PATIENCE = 240_000  # ms, while kernels compile at worst


def advanced(job: CommandJob) -> bool:
    return job.stage.unit == "ping" and job.stage.done > 0.0


def test_a_command_imports_nothing_of_the_current_folder(monkeypatch, qtbot, tmp_path):
    write_modules(tmp_path)
    monkeypatch.chdir(tmp_path)
    job = CommandJob("the scenes", ["scenes"], tmp_path, lambda work, *values: work(*values))
    job.start()
    qtbot.waitUntil(lambda: not job.running, timeout=PATIENCE)
    assert (job.state, traces(tmp_path)) == (State.DONE, set())


def test_a_job_prepares_all_scenes_stops_with_its_workers_and_writes_what_the_window_shows(
    viewer, small, qtbot, tmp_path, monkeypatch
):
    traced = []

    def note(scene, modelling, pings):
        """Two pings, for a difference of a parameter may be at work beside the job."""
        traced.append(scene.title)
        return np.ones((len(pings), 2, scene.sonar.bins), dtype=np.float32)

    with monkeypatch.context() as patch:
        patch.setattr(viewer.simulator, "trace_beside", note)
        viewer.window.prepare_all.trigger()
        qtbot.waitUntil(lambda: not viewer.jobs.running, timeout=PATIENCE)
    assert viewer.jobs.jobs[0].state is State.DONE
    assert {load_scene(file).title for file in bundled_scenes().values()} <= set(traced)
    # A record is as in the window.
    viewer.session.model(viewer.session.modelling.forcing("planes", "2").tolerating(0.2))
    job = viewer.jobs.write_record(viewer.session, tmp_path / "record.nc")
    qtbot.waitUntil(lambda: not job.running, timeout=PATIENCE)
    expected = simulate(small, tolerance=0.2, forced={"planes": "2"})
    np.testing.assert_array_equal(read_record(tmp_path / "record.nc").intensity, expected.intensity)
    # A data set is stopped with its workers.
    arguments = ["dataset", "mines", "-o", str(tmp_path / "mines"), "--scenes", "400", "--scheduler", "local:1"]
    job = viewer.jobs.begin("data set", arguments, tmp_path / "mines")
    qtbot.waitUntil(lambda: job.stage.unit == "job", timeout=PATIENCE)
    job.stop()
    qtbot.waitUntil(lambda: not job.running)
    assert job.state is State.STOPPED
    # A picture is displayed as in the window.
    knife = edit(small, {"sonar.beam": "knife"})
    viewer.open(knife)
    look = {"gain": 6.0, "water_column": False, "side_gains": (0.0, 6.0), "levels": (0.1, 4.0), "palette": "grey"}
    look |= {"side": "starboard", "decibels": True, "ground_range": True}
    viewer.session.show(**look)
    job = viewer.jobs.write_record(viewer.session, tmp_path / "window.png")
    qtbot.waitUntil(lambda: not job.running, timeout=PATIENCE)
    write(knife, tmp_path / "library.png", DisplayOptions(**look), tolerance=viewer.session.modelling.tolerance)
    with Image.open(tmp_path / "window.png") as one, Image.open(tmp_path / "library.png") as other:
        np.testing.assert_array_equal(np.asarray(one), np.asarray(other))


def test_the_time_left_counts_from_where_a_stage_goes_on_in_whole_numbers(monkeypatch):
    assert [format_time_left(seconds) for seconds in (0.2, 40.4, 170.0, 7300.0)] == ["1 s", "40 s", "3 min", "2 h"]
    clock = [0.0]
    monkeypatch.setattr(background_job.time, "monotonic", lambda: clock[0])
    job = ThreadJob("a page", print, lambda *_: None)
    told = []
    for now, stage in (
        (1.0, Stage("measuring", 1, 50, "case")), (40.0, Stage("measuring", 40, 50, "case")),
        (41.0, Stage("compiling", 1, 2, "kernel")), (60.0, Stage("measuring", 40, 50, "case")),
        (61.0, Stage("measuring", 41, 50, "case")), (63.0, Stage("measuring", 42, 50, "case")),
    ):  # fmt: skip
        clock[0] = now
        job._advance(stage)
        told.append(job.seconds_left)
    assert told == [None, 10.0, None, None, 9.0, 12.0]


def test_charts_data_sets_surveys_and_pages_are_commands(open_viewer, small, tmp_path, monkeypatch):
    viewer = open_viewer(edit(small, {"sonar.beam": "knife", "track.heading": 30.0, "track.start": [5.0, -3.0]}))
    begun = []
    monkeypatch.setattr(viewer.jobs, "begin", lambda title, arguments, result: begun.append(tuple(arguments)))
    viewer.window.save.jobs.trigger()
    view = viewer.panels["jobs"].widget
    view.chart_wanted.emit("convergence", tmp_path / "chart.png")
    records = [tmp_path / "a.xtf", tmp_path / "b.xtf"]
    view.mosaic_wanted.emit(records, tmp_path / "mosaic.tif")
    monkeypatch.setattr(DatasetQuestion, "exec", lambda question: fill(question, tmp_path / "mines", "mines"))
    view.dataset_wanted.emit()
    view.stability_wanted.emit(tmp_path / "page.html")
    (chart, scene_file, *of), mosaic, dataset, page = begun
    assert (chart, *of) == ("chart", "--of", "convergence", "-o", str(tmp_path / "chart.png"))
    assert Path(scene_file).suffix == ".toml"
    assert mosaic == ("mosaic", *map(str, records), "-o", str(tmp_path / "mosaic.tif"))
    assert dataset == ("dataset", "mines", "-o", str(tmp_path / "mines"), "--scenes", "3")
    assert page == ("stability", "-o", str(tmp_path / "page.html"))
    # A survey of the scene covers the area of the question.

    def answer(question: SurveyQuestion) -> bool:
        for spin, value in ((question.length, 40.0), (question.width_, 60.0), (question.spacing, 20.0)):
            spin.setValue(value)
        question.overlap.setCurrentText("nearest")
        return True

    monkeypatch.setattr(SurveyQuestion, "exec", answer)
    view.survey_wanted.emit()
    specification = read_specification(begun[-1][1], SurveySpecification, "surveys")
    assert specification.mosaic.overlap == "nearest"
    lines = lay_lawnmower(specification.area)
    ahead, aside = np.array([math.sqrt(0.75), 0.5]), np.array([-0.5, math.sqrt(0.75)])
    for line, offset in zip(lines, (-20.0, 0.0, 20.0), strict=True):
        ends = np.array([line.start, line.end]) - (5.0, -3.0)
        np.testing.assert_allclose(sorted(ends @ ahead), [0.0, 40.0], atol=0.01)
        np.testing.assert_allclose(ends @ aside, offset, atol=0.01)
    # A data set of the scene draws fields and places.
    scene = edit(load_scene("default"), {"track.pings": 64})
    viewer.open(scene)
    ranges = {"track_altitude": ("6", "900 cm"), "seabed_seed": ("1", "50")}
    monkeypatch.setattr(DatasetQuestion, "exec", lambda question: fill(question, tmp_path / "set", PRESENT, **ranges))
    view.dataset_wanted.emit()
    specification = read_specification(begun[-1][1], DatasetSpecification, "datasets")
    drawn = [draw_scene(specification, load_scene(specification.base), number) for number in range(20)]
    altitudes = [one.scene.track.altitude for one in drawn]
    assert all(6.0 <= altitude <= 9.0 for altitude in altitudes)
    assert max(altitudes) - min(altitudes) > 1.0
    assert {len(one.scene.targets) for one in drawn} == {0, len(scene.targets)}  # a fifth of the scenes shows none
    assert {"pipe", "sphere"} == {target.kind for one in drawn for target in one.scene.targets}
    places = {one.scene.targets[0].position for one in drawn if one.scene.targets}
    assert len(places) > 10


def fill(question: DatasetQuestion, folder: Path, name: str, **ranges: tuple[str, str]) -> bool:
    """Answer the question about a data set: folder, specification, and the texts of fields that are drawn."""
    question._folder.setText(str(folder))
    question.specification.setCurrentText(name)
    question.scenes.setValue(3)
    for row, field in enumerate(question._fields):
        for column, text in enumerate(ranges.get(field.path.replace(".", "_"), ())):
            question.drawn.item(row, column + 1).setText(text)
    return True


def test_the_bar_shortens_the_title_keeps_the_time_left_and_is_worked_by_keys(open_viewer, small, qtbot):
    viewer = open_viewer(edit(small, {"sonar.beam": "knife"}))
    chart, bar = begin_waiting(viewer, f"chart of {' '.join(30 * ['balls'])}"), viewer.window.jobs
    qtbot.waitUntil(lambda: "left" in bar.format())
    words = bar.text()
    assert words.startswith("chart of balls")
    assert "…: 40 %, " in words
    assert bar.fontMetrics().horizontalAdvance(words) <= bar.width()
    chart.stop()
    qtbot.waitUntil(lambda: not bar.isVisible())
    # It opens the list, and stops the newest.
    activate(viewer.window, qtbot)
    older, newer = begin_waiting(viewer, "older"), begin_waiting(viewer, "newer")
    qtbot.waitUntil(bar.isVisible)
    bar.setFocus(Qt.FocusReason.TabFocusReason)
    assert bar.focusPolicy() & Qt.FocusPolicy.TabFocus
    heard = QAccessible.queryAccessibleInterface(bar)
    qtbot.waitUntil(lambda: heard.text(QAccessible.Text.Description).startswith("newer"))
    qtbot.keyClick(bar, Qt.Key.Key_Delete)
    qtbot.waitUntil(lambda: not newer.running)
    assert older.running
    qtbot.keyClick(bar, Qt.Key.Key_Return)
    view = viewer.panels["jobs"].widget
    qtbot.waitUntil(view.isVisible)
    older.stop()
    qtbot.waitUntil(lambda: not older.running)
    # Keys go from job to job in the order in which they stand.
    view.forget.click()
    qtbot.waitUntil(lambda: not viewer.jobs.jobs)
    activate(view, qtbot)
    for title in ("first", "second", "third"):
        begin_waiting(viewer, title)
    first, second, third = view.rows
    qtbot.waitUntil(first.isVisible)
    view.forget.setFocus()
    order = []
    for _ in range(6):
        press(qtbot, Qt.Key.Key_Tab)
        order.append(focus())
    assert order == [third, third.stop, second, second.stop, first, first.stop]
    first.setFocus()
    press(qtbot, Qt.Key.Key_Up)
    assert focus() is second
    press(qtbot, Qt.Key.Key_Delete)
    qtbot.waitUntil(lambda: not viewer.jobs.jobs[1].running)
    assert [job.state for job in viewer.jobs.jobs] == [State.RUNNING, State.STOPPED, State.RUNNING]
    for job in viewer.jobs.running:
        job.stop()
    qtbot.waitUntil(lambda: not viewer.jobs.running)


def focus() -> QWidget:
    """Widget that has the keyboard."""
    widget = QApplication.focusWidget()
    assert widget is not None
    return widget


def press(qtbot, key: Qt.Key, modifier=Qt.KeyboardModifier.NoModifier):
    qtbot.keyClick(focus(), key, modifier)


def begin_waiting(viewer, title: str):
    """Begin work that ends when it is stopped."""

    def work(report: Callable[[float], None]):
        while True:
            time.sleep(0.02)
            report(0.4)

    return viewer.jobs.begin_work(title, work)


def test_a_record_is_begun_followed_stopped_and_ended_by_closing(open_viewer, small, qtbot, tmp_path, monkeypatch):
    # A record that takes minutes: the planes of a fan cost ten times as much as a knife.
    viewer = open_viewer(edit(small, {"track.pings": 1_000_000}))
    path = tmp_path / "record.nc"
    monkeypatch.setattr(jobs_window, "ask_where_to_save", lambda *_: path)
    activate(viewer.window, qtbot)
    qtbot.keyClick(viewer.window, Qt.Key.Key_J, Qt.KeyboardModifier.ControlModifier)
    view = viewer.panels["jobs"].widget
    activate(view, qtbot)
    assert focus() is view.record
    press(qtbot, Qt.Key.Key_Return)
    (job,) = viewer.jobs.jobs
    qtbot.waitUntil(lambda: advanced(job), timeout=PATIENCE)
    (row,) = view.rows
    for _ in range(7):  # past the other buttons
        press(qtbot, Qt.Key.Key_Tab)
    assert focus() is row
    heard = accessible_name(row)
    assert heard.startswith("writing record.nc: ")
    assert "of 1000000 pings" in heard
    qtbot.waitUntil(lambda: job.seconds_left is not None, timeout=PATIENCE)
    assert viewer.window.jobs.isVisible()
    assert viewer.session.settle({"track.altitude": 7.0})
    qtbot.waitUntil(lambda: viewer.complete, timeout=PATIENCE)
    assert job.running, "the window is free meanwhile"
    press(qtbot, Qt.Key.Key_Tab)
    assert focus() is row.stop
    assert accessible_name(row.stop) == "Stop: writing record.nc"
    press(qtbot, Qt.Key.Key_Return)
    assert focus() is row, "the keyboard stays at the job that was stopped"
    qtbot.waitUntil(lambda: not job.running)
    assert job.state is State.STOPPED
    assert "stopped" in accessible_name(row)
    assert list(tmp_path.iterdir()) == []
    press(qtbot, Qt.Key.Key_L, Qt.KeyboardModifier.AltModifier)
    assert not viewer.window.jobs.isVisible()
    # A button that is pressed by its letter is shown pressed for a moment.
    qtbot.waitUntil(lambda: not view.rows and not viewer.jobs.jobs)
    qtbot.keyClick(view, Qt.Key.Key_Escape)
    assert not view.isVisible()
    # Closing asks about a job, and ends it at once.
    asked = answer_questions(monkeypatch, QMessageBox.StandardButton.Cancel, QMessageBox.StandardButton.Discard)
    viewer.session.undo()
    job = viewer.jobs.write_record(viewer.session, path)
    qtbot.waitUntil(lambda: advanced(job), timeout=PATIENCE)
    viewer.window.close()
    assert viewer.window.isVisible()
    assert job.running
    viewer.window.close()
    assert asked == ["A job is still running. Stop and close the window? What is finished stays."] * 2
    assert not viewer.window.isVisible()
    assert not job.running
    assert [path for path in tmp_path.iterdir() if not path.name.startswith(".")] == []
