"""Errors are one sentence with details to copy; a fault in a slot or an override leaves the window alive."""

import ast
import sys
from importlib.metadata import version
from pathlib import Path

import numba
from PySide6.QtCore import Qt, QTimer
from PySide6.QtGui import QGuiApplication
from PySide6.QtTest import QTest
from stand_in import StandIn

import insonify_viewer
from commands import PATIENCE, run_python
from insonify.scene import SceneError, scene_to_toml
from insonify_viewer.errors import guard_override
from insonify_viewer.state.inspection import Mark
from insonify_viewer.window.uncaught_errors import reported_errors
from insonify_viewer.work.jobs import State


def copied(viewer) -> str:
    """Click the button beside the sentence of an error, and return what it copies."""
    button = viewer.window.status.copy
    assert button.isVisible()
    QTest.mouseClick(button, Qt.MouseButton.LeftButton)
    return QGuiApplication.clipboard().text()


def test_a_mistake_is_copied_with_its_circumstances_and_a_fault_of_an_explanation_is_told(viewer, qtbot, monkeypatch):
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
    # The button is reached by the keyboard.
    viewer.window.complain(SceneError("track.pings: 0 is too few; give at least 1"))
    button = viewer.window.status.copy
    button.setFocus()
    QTest.keyClick(button, Qt.Key.Key_Space)
    assert QGuiApplication.clipboard().text().startswith("track.pings: 0 is too few")
    # A fault of an explanation is told.
    viewer.window.say("another sentence")
    monkeypatch.setattr(viewer.panels["pixel"]._question, "_work", fail)
    with qtbot.captureExceptions() as printed, reported_errors(viewer.window.complain):
        viewer.inspection.pin(Mark(viewer.tow.top - 5, 0, 40))
        qtbot.waitUntil(viewer.window.status.copy.isVisible)
    assert ValueError in [kind for kind, *_ in printed]
    assert "in fail" in copied(viewer)


def fail(*_):
    """Raise an error in C."""
    int(float("nan"))


class Broken(StandIn):
    """A stand-in for a core with a fault."""

    def intensity(self, pings):
        if self.scene.seed == 13:
            raise ZeroDivisionError("a fault in the core")
        return super().intensity(pings)


def test_a_fault_of_core_slot_thread_or_job_is_one_sentence_and_the_window_lives(open_viewer, small, qtbot, tmp_path):
    viewer = open_viewer(small, prepare=Broken)
    viewer.session.settle({"seed": 13})
    qtbot.waitUntil(viewer.window.status.copy.isVisible)
    assert "a fault in the core" in viewer.window.status.sentence.text()
    text = copied(viewer)
    assert "Traceback" in text
    assert "in intensity" in text
    viewer.window.say("another sentence")

    def miss():
        raise KeyError("no such thing")

    def be_damaged():
        raise SceneError("tow.csv: has no rows; export it again")

    with qtbot.captureExceptions() as printed, reported_errors(viewer.window.complain):
        QTimer.singleShot(0, miss)
        qtbot.waitUntil(viewer.window.status.copy.isVisible)
        assert "bug in insonify (KeyError: 'no such thing')" in viewer.window.status.sentence.text()
        assert "in miss" in copied(viewer)
        assert viewer.session.settle({"track.altitude": 8.0})
        qtbot.waitUntil(lambda: viewer.complete)
        # A file that is damaged is no fault of the program.
        QTimer.singleShot(0, be_damaged)
        qtbot.waitUntil(lambda: viewer.window.status.sentence.text() == "tow.csv: has no rows; export it again")
    assert [kind for kind, *_ in printed] == [KeyError], "standard error has it as before"
    # A fault in a thread beside the window is reported once, and again only after a success.
    received = []
    with qtbot.captureExceptions() as printed, reported_errors(viewer.window.complain):
        for errand in (be_damaged, fail, fail, lambda: 7, fail):
            count = len(received)
            viewer.simulator.executor.submit("test", errand, received.append)
            qtbot.waitUntil(lambda count=count: len(received) > count)
        assert received == [None, None, None, 7, None]
        assert [kind for kind, *_ in printed] == [ValueError, ValueError]
        assert "bug in insonify (ValueError: cannot convert" in viewer.window.status.sentence.text()
        assert "in fail" in copied(viewer)
    # So is one after which there is nothing to receive.
    with qtbot.captureExceptions() as printed:
        viewer.simulator.executor.submit("other", fail, len)
        qtbot.waitUntil(lambda: len(printed) == 2)
    assert [kind for kind, *_ in printed] == [ValueError, TypeError]
    # A job that failed or crashed offers its details.
    viewer.window.open_panel("jobs")
    panel = viewer.panels["jobs"]
    panel.write_record(tmp_path / "nowhere" / "record.nc")
    qtbot.waitUntil(lambda: not viewer.jobs.running)
    (row,) = panel.view.rows
    assert viewer.jobs.jobs[0].state is State.FAILED
    assert "there is no folder" in row.words.text() == viewer.window.status.sentence.text()
    assert row.copy.isVisible()
    assert copied(viewer).startswith(row.words.text())
    QGuiApplication.clipboard().clear()
    QTest.mouseClick(row.copy, Qt.MouseButton.LeftButton)
    assert QGuiApplication.clipboard().text().startswith(row.words.text())
    # So does a command that crashes.
    viewer.window.say("another sentence")
    assert not viewer.window.status.copy.isVisible()
    job = viewer.jobs.begin("crash", ["render", "--display", "palette=none-such"], Path("none.png"))
    qtbot.waitUntil(lambda: not job.running)
    assert job.sentence
    assert viewer.window.status.copy.isVisible()


# Methods that Qt calls within a call from Python. Events of mouse and keys come from the loop of events instead,
# under which Qt for Python prints an exception.
OF_QT = {"paintEvent", "resizeEvent", "changeEvent", "closeEvent", "leaveEvent", "showEvent", "hideEvent", "event"}
OF_QT |= {"sizeHint", "minimumSizeHint", "eventFilter", "paintGL", "resizeGL", "customEvent", "timerEvent"}

# A window whose record, and another widget, fail in C within a call from Python.
DRIVER = """
import sys
from PySide6.QtCore import QSize, QTimer
from PySide6.QtGui import QPainter, QPixmap
from PySide6.QtWidgets import QVBoxLayout, QWidget
from insonify_viewer.application import make_application
from insonify_viewer.errors import guard_override
from insonify_viewer.window.main_window import MainWindow
from insonify_viewer.record.record_image import RecordImage
from insonify_viewer.window.uncaught_errors import reported_errors

def fail(*_):
    int(float("nan"))

class Broken(QWidget):
    @guard_override(QSize(7, 5))
    def sizeHint(self):
        fail()

    @guard_override(None)
    def resizeEvent(self, event):
        fail()

    @guard_override(False)
    def eventFilter(self, watched, event):
        fail()

    @guard_override(None)
    def paintEvent(self, event):
        picture = QPixmap(20, 20)
        with QPainter(self), QPainter(picture) as painter:
            painter.drawLine(0, 0, 9, 9)
            fail()

application = make_application()
window = MainWindow(native=False, palettes=("copper",))
window.show()
RecordImage.draw = fail
broken = Broken()

def act():
    for _ in range(3):
        window.waterfall.repaint()
    QVBoxLayout(broken).addWidget(inner := Broken())
    inner.installEventFilter(broken)
    broken.resize(80, 60)
    broken.show()
    for _ in range(3):
        broken.repaint()
    QTimer.singleShot(0, application.quit)

QTimer.singleShot(0, act)
with reported_errors(lambda failure: print("TOLD", failure.trace.splitlines()[-1], failure.trace.count("in fail"))):
    application.exec()
print("ALIVE", broken.sizeHint().toTuple(), window.status is not None, flush=True)
"""


def test_a_painting_that_fails_in_c_is_told_once_and_the_window_lives():
    code, written, errors = run_python("-c", DRIVER, timeout=PATIENCE)
    lines = written.splitlines()
    assert code == 0, errors
    assert lines[-1] == "ALIVE (7, 5) True"
    told = "TOLD ValueError: cannot convert float NaN to integer 1"
    assert lines[:-1].count(told) == len(lines) - 1
    assert 5 <= len(lines) - 1 <= 10, "one of the record, one of each override of the two widgets, not one a call"
    assert "QPaintDevice: Cannot destroy" not in errors


def test_every_override_that_qt_may_call_within_a_call_is_guarded_and_painters_end_whatever_happens():
    """A painter left in a frame keeps its widget busy; a pixmap that goes before its painter ends the process."""
    root = Path(insonify_viewer.__file__).parent
    sources = {path: path.read_text(encoding="utf-8") for path in root.rglob("*.py")}
    bare = [
        f"{path.stem}.{kind.name}.{method.name}"
        for path, source in sources.items()
        for kind in ast.walk(ast.parse(source))
        if isinstance(kind, ast.ClassDef)
        for method in kind.body
        if isinstance(method, ast.FunctionDef) and method.name in OF_QT
        if not any(ast.unparse(one).startswith("guard_override(") for one in method.decorator_list)
    ]
    assert bare == []
    for path, source in sources.items():
        for line in source.splitlines():
            assert "QPainter(" not in line or "with QPainter(" in line, f"{path.name}: {line.strip()}"


def test_an_exception_is_told_anew_after_a_success_or_another_exception(monkeypatch):
    told = []
    monkeypatch.setattr(sys, "excepthook", lambda kind, error, trace: told.append(str(error)))

    class Owner:
        @guard_override(-1)
        def divide(self, by):
            return 6 // int(by)

    first, second = Owner(), Owner()
    assert [first.divide(by) for by in (0, 0, 2, 0, "x", "x")] == [-1, -1, 3, -1, -1, -1]
    assert [message.split(" ")[0] for message in told] == ["integer", "integer", "invalid"]
    assert second.divide(0) == -1
    assert len(told) == 4, "each object is told of by itself"
