"""A window that is killed loses seconds of work at most, and the next one offers scene and contacts once."""

import os
import signal
import subprocess
import sys
from dataclasses import replace

import pytest

from insonify.io.contacts import Contact, read_contacts, write_contacts
from insonify.scene import edit
from insonify_viewer.window.recovery import INTERVAL, Recovery

FISH = Contact("fish", "a shoal?", "A scene", 3, "port", 7, 2.0, snapshot=bytes(range(256)))
# A window that takes an edit after a moment, or says what it offers at its start, with the answer Yes.
DRIVER = """
import sys
from PySide6.QtCore import QTimer
from PySide6.QtWidgets import QMessageBox
from insonify.scene import load_scene
from insonify_viewer import application
from insonify.io.contacts import Contact
from insonify_viewer.viewer import Viewer
from insonify_viewer.window.recovery import CrashRecovery

def ask(window, title, question, *rest):
    print("ASKED", question, flush=True)
    return QMessageBox.StandardButton.Yes

QMessageBox.question = ask
opened = Viewer.open
Viewer.open = lambda viewer, scene, file="": (opened(viewer, scene, file), report(viewer))
FISH = Contact("fish", "a shoal?", "A scene", 3, "port", 7, 2.0, snapshot=bytes(range(256)))
def report(viewer):
    print("ALTITUDE", viewer.session.scene.track.altitude, viewer.session.unsaved, flush=True)
offer = CrashRecovery.offer
def offer_and_report(recovery):
    offer(recovery)
    if sys.argv[1] == "look":
        print("CONTACTS", recovery._contacts.all == (FISH,), recovery._contacts.unsaved, flush=True)
        print("READY", flush=True)
CrashRecovery.offer = offer_and_report
def aged():
    # By the window's own loop of events: a busy machine delays all its timers alike.
    QTimer.singleShot(5000, lambda: print("AGED", flush=True))
def begin(viewer):
    if sys.argv[1] == "edit":
        QTimer.singleShot(300, lambda: (viewer.session.settle({"track.altitude": 7.25}), aged()))
    if sys.argv[1] in ("edit", "mark"):
        QTimer.singleShot(300, lambda: viewer.contacts.add(FISH))
    if sys.argv[1] == "mark":
        QTimer.singleShot(300, aged)
Viewer.start = begin
application.open_window(load_scene("default"))
"""


def run_until(word: str, last: str, folder) -> list[str]:
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
def test_a_killed_window_loses_no_edit_older_than_5_s(tmp_path):
    run_until("edit", "AGED", tmp_path)
    said = run_until("look", "READY", tmp_path)
    assert len([line for line in said if line.startswith("ASKED")]) == 1
    assert "“A pipe that rests and spans” and the list of 1 contact. Open them as they were?" in said[0]
    assert "ALTITUDE 7.25 True" in said
    assert "CONTACTS True True" in said
    said = run_until("look", "READY", tmp_path)
    assert "ALTITUDE 7.25 True" in said, "the second window had kept it anew before it was killed"
    assert "CONTACTS True True" in said


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="needs SIGKILL")
def test_a_killed_window_loses_no_contact_though_the_scene_is_saved(tmp_path):
    run_until("mark", "AGED", tmp_path)
    said = run_until("look", "READY", tmp_path)
    assert said[0].endswith("with unsaved changes of the list of 1 contact. Open it as it was?")
    assert "CONTACTS True True" in said
    assert not [line for line in said if line.startswith("ALTITUDE")], "no scene is opened"


@pytest.fixture
def recovery():
    made = Recovery()
    yield made
    made.close()


def test_work_of_a_window_that_runs_is_not_offered(recovery, small):
    recovery.keep(small, (FISH,))
    other = Recovery()
    assert other.find_left() is None
    other.close()


def test_a_window_that_closes_leaves_nothing(small):
    recovery = Recovery()
    recovery.keep(small, (FISH,))
    folder = recovery._folder
    names = lambda: sorted(path.suffix for path in folder.iterdir())  # noqa: E731
    assert names() == [".geojson", ".lock", ".toml"]
    recovery.keep(small, ())
    assert names() == [".lock", ".toml"]
    recovery.keep(None, (FISH,))
    assert names() == [".geojson", ".lock"]
    recovery.keep(edit(small, {"seed": 5}), ())
    recovery.close()
    assert list(folder.iterdir()) == []


def test_what_cannot_be_read_is_removed(recovery):
    folder = recovery._folder
    (folder / "unsaved-0-bad.toml").write_text("no scene [")
    write_contacts(folder / "unsaved-0-bad.geojson", [FISH])
    left = recovery.find_left()
    assert left is not None
    assert (left.scene, left.contacts) == (None, (FISH,))
    assert not (folder / "unsaved-0-bad.toml").exists()
    (folder / "unsaved-0-bad.geojson").write_text("no contacts")
    assert recovery.find_left() is None
    assert not (folder / "unsaved-0-bad.geojson").exists()


def test_what_is_kept_of_contacts_is_bounded(recovery, monkeypatch):
    monkeypatch.setattr("insonify_viewer.window.recovery.MOST_CONTACTS", 4)
    monkeypatch.setattr("insonify_viewer.window.recovery.MOST_PICTURES", 5)
    recovery.keep(None, tuple(replace(FISH, name=str(number), snapshot=b"12") for number in range(6)))
    (file,) = recovery._folder.glob("*.geojson")
    kept = read_contacts(file)
    assert [(each.name, each.snapshot) for each in kept] == [("2", b""), ("3", b""), ("4", b"12"), ("5", b"12")]


def test_little_is_lost():
    assert INTERVAL < 4.0, "and a second to write"
