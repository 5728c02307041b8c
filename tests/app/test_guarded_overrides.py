"""An exception in a method that Qt calls is reported and leaves the process alive."""

import ast
import subprocess
import sys
from pathlib import Path

import insonify_viewer
from commands import PATIENCE
from insonify_viewer.errors import guard_override

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
    command = [sys.executable, "-c", DRIVER]
    done = subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE)
    lines = done.stdout.splitlines()
    assert done.returncode == 0, done.stderr
    assert lines[-1] == "ALIVE (7, 5) True"
    told = "TOLD ValueError: cannot convert float NaN to integer 1"
    assert lines[:-1].count(told) == len(lines) - 1
    assert 5 <= len(lines) - 1 <= 10, "one of the record, one of each override of the two widgets, not one a call"
    assert "QPaintDevice: Cannot destroy" not in done.stderr


def test_every_override_that_qt_may_call_within_a_call_is_guarded():
    root = Path(insonify_viewer.__file__).parent
    bare = [
        f"{path.stem}.{kind.name}.{method.name}"
        for path in root.rglob("*.py")
        for kind in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(kind, ast.ClassDef)
        for method in kind.body
        if isinstance(method, ast.FunctionDef) and method.name in OF_QT
        if not any(ast.unparse(one).startswith("guard_override(") for one in method.decorator_list)
    ]
    assert bare == []


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


def test_painters_end_whatever_happens():
    """One that is left in a frame keeps its widget busy; a pixmap that goes before its painter ends the process."""
    for path in Path(insonify_viewer.__file__).parent.rglob("*.py"):
        for line in path.read_text(encoding="utf-8").splitlines():
            assert "QPainter(" not in line or "with QPainter(" in line, f"{path.name}: {line.strip()}"
