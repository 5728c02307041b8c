"""Errors are one sentence, with details to copy; a fault in a slot leaves the window alive."""

from importlib.metadata import version
from pathlib import Path

import numba
from PySide6.QtCore import Qt, QTimer
from PySide6.QtGui import QGuiApplication
from PySide6.QtTest import QTest
from stand_in import StandIn

from insonify.scene import SceneError, scene_to_toml
from insonify_viewer.panels.pixel import controller as pixel_controller
from insonify_viewer.state.inspection import Mark
from insonify_viewer.window.uncaught_errors import reported_errors


def copied(viewer) -> str:
    """Click the button beside the sentence of an error, and return what it copies."""
    button = viewer.window.status.copy
    assert button.isVisible()
    QTest.mouseClick(button, Qt.MouseButton.LeftButton)
    return QGuiApplication.clipboard().text()


def test_a_mistake_is_copied_with_versions_scene_and_what_was_said(viewer):
    status = viewer.window.status
    viewer.window.say("a sentence before")
    assert not status.copy.isVisible()
    assert not viewer.session.settle({"sonar.ping_rate": 1e6})
    sentence = status.sentence.text()
    assert "ping_rate" in sentence
    text = copied(viewer)
    assert text.startswith(sentence)
    assert f"numba {numba.__version__}" in text
    assert f"insonify {version('insonify')}" in text
    assert "a sentence before" in text
    assert text.endswith(scene_to_toml(viewer.session.scene).strip() + "\n")
    assert "Traceback" not in text, "a mistake of the person needs none"
    viewer.window.say("another sentence")
    assert not status.copy.isVisible()


def test_the_button_is_reached_by_the_keyboard(viewer):
    viewer.window.complain(SceneError("track.pings: 0 is too few; give at least 1"))
    button = viewer.window.status.copy
    button.setFocus()
    QTest.keyClick(button, Qt.Key.Key_Space)
    assert QGuiApplication.clipboard().text().startswith("track.pings: 0 is too few")


def test_a_fault_of_the_core_is_copied_with_its_traceback(open_viewer, small, qtbot):
    class Broken(StandIn):
        def intensity(self, pings):
            if self.scene.seed == 13:
                raise ZeroDivisionError("a fault in the core")
            return super().intensity(pings)

    viewer = open_viewer(small, prepare=Broken)
    viewer.session.settle({"seed": 13})
    qtbot.waitUntil(lambda: viewer.window.status.copy.isVisible())
    assert "a fault in the core" in viewer.window.status.sentence.text()
    text = copied(viewer)
    assert "Traceback" in text
    assert "in intensity" in text


def test_a_fault_in_a_slot_is_one_sentence_and_the_window_lives(viewer, qtbot):
    def fail():
        raise KeyError("no such thing")

    with qtbot.captureExceptions() as printed, reported_errors(viewer.window.complain):
        QTimer.singleShot(0, fail)
        qtbot.waitUntil(viewer.window.status.copy.isVisible)
    assert [kind for kind, *_ in printed] == [KeyError], "standard error tells of it as before"
    assert "fault of the program (KeyError: 'no such thing')" in viewer.window.status.sentence.text()
    assert "in fail" in copied(viewer)
    assert viewer.session.settle({"track.altitude": 8.0})
    qtbot.waitUntil(lambda: viewer.complete)


def test_a_file_that_is_damaged_while_it_is_shown_is_no_fault_of_the_program(viewer, qtbot):
    def fail():
        raise SceneError("tow.csv: has no rows; export it again")

    with qtbot.captureExceptions() as printed, reported_errors(viewer.window.complain):
        QTimer.singleShot(0, fail)
        qtbot.waitUntil(lambda: viewer.window.status.sentence.text() == "tow.csv: has no rows; export it again")
    assert not printed


def test_a_fault_in_a_thread_beside_the_window_is_told_once(viewer, qtbot):
    received = []

    def fail():
        int(float("nan"))

    def refuse():
        raise SceneError("track.pings: 0 is too few; give at least 1")

    def run(errand):
        count = len(received)
        viewer.simulator.executor.submit("test", errand, received.append)
        qtbot.waitUntil(lambda: len(received) > count)

    with qtbot.captureExceptions() as printed, reported_errors(viewer.window.complain):
        for errand in (refuse, fail, fail, lambda: 7, fail):
            run(errand)
        assert received == [None, None, None, 7, None]
        assert [kind for kind, *_ in printed] == [ValueError, ValueError], "again only after a success"
        assert "fault of the program (ValueError: cannot convert" in viewer.window.status.sentence.text()
        assert "in fail" in copied(viewer)


def test_a_fault_of_an_explanation_is_told(viewer, qtbot, monkeypatch):
    def fail(*_):
        int(float("nan"))

    monkeypatch.setattr(pixel_controller, "_explained", fail)
    with qtbot.captureExceptions() as printed, reported_errors(viewer.window.complain):
        viewer.inspection.pin(Mark(viewer.tow.top - 5, 0, 40))
        qtbot.waitUntil(viewer.window.status.copy.isVisible)
    assert ValueError in [kind for kind, *_ in printed]
    assert "in fail" in copied(viewer)


def test_a_job_that_failed_offers_its_details(viewer, qtbot, tmp_path):
    viewer.window.open_panel("jobs")
    panel = viewer.panels["jobs"]
    panel.write_record(tmp_path / "nowhere" / "record.nc")
    qtbot.waitUntil(lambda: not viewer.jobs.running, timeout=60_000)
    (row,) = panel.view.rows
    assert row.copy.isVisible()
    assert copied(viewer).startswith(row.words.text())
    QGuiApplication.clipboard().clear()
    QTest.mouseClick(row.copy, Qt.MouseButton.LeftButton)
    assert QGuiApplication.clipboard().text().startswith(row.words.text())


def test_a_command_that_crashes_leaves_its_traceback(viewer, qtbot):
    job = viewer.jobs.begin("crash", ["render", "--display", "palette=none-such"], Path("none.png"))
    qtbot.waitUntil(lambda: not job.running, timeout=60_000)
    assert job.sentence
    assert viewer.window.status.copy.isVisible()
