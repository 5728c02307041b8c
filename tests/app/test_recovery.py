"""A window that is killed loses seconds of work at most, and the next one offers the scene once."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from PySide6.QtCore import QLockFile

from insonify.scene import Scene, edit
from insonify_viewer.recovery import INTERVAL, Recovery

# A window that takes an edit after a moment, or says what it offers at its start, with the answer Yes.
DRIVER = """
import sys
from PySide6.QtCore import QTimer
from PySide6.QtWidgets import QMessageBox
from insonify.scene import load_scene
from insonify_viewer import application
from insonify_viewer.viewer import Viewer

def ask(window, title, question, *rest):
    print("ASKED", question, flush=True)
    return QMessageBox.StandardButton.Yes

QMessageBox.question = ask
opened = Viewer.open
Viewer.open = lambda viewer, scene, file="": (opened(viewer, scene, file), report(viewer))
def report(viewer):
    print("ALTITUDE", viewer.session.scene.track.altitude, viewer.session.unsaved, flush=True)
def aged():
    # By the window's own loop of events: a busy machine delays all its timers alike.
    QTimer.singleShot(5000, lambda: print("AGED", flush=True))
def begin(viewer):
    if sys.argv[1] == "edit":
        QTimer.singleShot(300, lambda: (viewer.session.settle({"track.altitude": 7.25}), aged()))
    else:
        QTimer.singleShot(1500, lambda: print("READY", flush=True))
Viewer.start = begin
application.open_window(load_scene("default"))
"""


def run_until(word: str, last: str, folder: Path) -> list[str]:
    """Lines that a window writes up to one that begins with a word, at which it is killed."""
    environment = os.environ | {
        "QT_QPA_PLATFORM": "offscreen", "XDG_STATE_HOME": str(folder), "XDG_CONFIG_HOME": str(folder)
    }  # fmt: skip
    command = [sys.executable, "-c", DRIVER, word]
    lines: list[str] = []
    with subprocess.Popen(command, env=environment, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        for line in process.stdout:
            lines.append(line.strip())
            if line.startswith(last):
                break
        assert process.poll() is None, "it ran until it was killed"
        process.send_signal(signal.SIGKILL)
    return lines


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="needs SIGKILL")
def test_a_killed_window_loses_no_edit_older_than_5_s(tmp_path: Path) -> None:
    run_until("edit", "AGED", tmp_path)
    said = run_until("look", "READY", tmp_path)
    assert len([line for line in said if line.startswith("ASKED")]) == 1
    assert "“A pipe that rests and spans”. Open it as it was?" in said[0]
    assert "ALTITUDE 7.25 True" in said
    said = run_until("look", "READY", tmp_path)
    assert "ALTITUDE 7.25 True" in said, "the second window had kept it anew before it was killed"


@pytest.fixture
def recovery() -> Any:
    made = Recovery(QLockFile)
    yield made
    made.close()


def test_work_of_a_window_that_runs_is_not_offered(recovery: Recovery, small: Scene) -> None:
    recovery.keep(small, unsaved=True)
    other = Recovery(QLockFile)
    assert other.find_left() is None
    other.close()


def test_a_window_that_closes_leaves_nothing(small: Scene) -> None:
    recovery = Recovery(QLockFile)
    recovery.keep(small, unsaved=True)
    assert recovery._file.exists()
    recovery.keep(small, unsaved=False)
    assert not recovery._file.exists()
    recovery.keep(edit(small, {"seed": 5}), unsaved=True)
    recovery.close()
    assert list(recovery._file.parent.iterdir()) == []


def test_what_cannot_be_read_is_removed(recovery: Recovery, small: Scene) -> None:
    folder = recovery._file.parent
    (folder / "unsaved-0-bad.toml").write_text("no scene [")
    assert recovery.find_left() is None
    assert not (folder / "unsaved-0-bad.toml").exists()


def test_little_is_lost() -> None:
    assert INTERVAL < 4.0, "and a second to write"
