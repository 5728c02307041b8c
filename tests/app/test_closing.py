"""What a window loads before it opens, what a closed one leaves behind, and what is kept of one that is killed."""

import gc
import os
import platform
import signal
import subprocess
import sys
import threading
import time
import weakref
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

import pytest
from PySide6.QtCore import QObject, Qt
from shiboken6 import delete
from stand_in import StandIn

from commands import PATIENCE, run_python
from insonify.io.contacts import Contact, read_contacts, write_contacts
from insonify.scene import SceneError, edit
from insonify_viewer import application
from insonify_viewer.application import has_opengl
from insonify_viewer.window.recovery import INTERVAL, Recovery
from insonify_viewer.work.gc_policy import collected_by_hand, leave_out_libraries
from insonify_viewer.work.jobs import ThreadJob


def test_workers_yield_the_processor_and_collect_nothing_of_a_window_which_frees_scenes_and_views(viewer, small, qtbot):
    from pyvistaqt import QtInteractor

    def niceness():
        return os.getpriority(os.PRIO_PROCESS, 0)

    if sys.platform == "linux":  # elsewhere single threads have no priorities
        found = []
        viewer.simulator.send(niceness, found.append)
        viewer.simulator.executor.start("test", niceness, done=found.append, failed=print)
        viewer.simulator.executor.submit("test", niceness, found.append)
        qtbot.waitUntil(lambda: len(found) == 3)
        assert min(found) > niceness()
    part, ends, done = QObject(), [], []
    part.itself = part
    part.destroyed.connect(lambda: ends.append(threading.current_thread()), Qt.ConnectionType.DirectConnection)
    del part
    viewer.simulator.send(lambda: len([[number] for number in range(300_000)]), done.append)
    qtbot.waitUntil(lambda: bool(done))
    kept = [[number] for number in range(2 * gc.get_threshold()[0])]
    qtbot.waitUntil(lambda: bool(ends))
    assert kept
    assert ends == [threading.main_thread()]
    # Opening a scene frees what the one before held.
    part = QObject()
    part.itself = part
    gc.collect()  # so that only a full collection finds it
    gone = weakref.ref(part)
    del part
    viewer.open(edit(small, {"seed": 7}))
    qtbot.waitUntil(lambda: viewer.complete and gone() is None)
    # A closed view names nothing that Qt deletes, and what a thread finds later is dropped.
    views = viewer.window.findChildren(QtInteractor)
    assert [view._surface is not None for view in views] == [True] * has_opengl()
    viewer.window.close()
    assert all(view._surface is None for view in views)
    later = viewer.simulator.executor.call_later
    delete(viewer.simulator.executor)
    later(print, "found too late")


def test_a_window_closes_at_once_during_work_of_the_simulator_a_bed_and_a_chart(open_viewer, small, qtbot):
    """Closing returns while each of them still works, for which it would have to wait two minutes."""
    going, at_work = threading.Event(), set()

    def work(*_):
        at_work.add(threading.current_thread())
        going.wait(120.0)

    class Compiling(StandIn):
        def intensity(self, pings):
            if self.scene.seed == 5:
                work()
            return super().intensity(pings)

    viewer = open_viewer(small, prepare=Compiling)
    viewer.simulator.executor.start("picture of the bed", work, done=print, failed=print)
    viewer.panels["chart"].measure = work
    viewer.panels["chart"].begin()
    viewer.session.settle({"seed": 5})
    qtbot.waitUntil(lambda: len(at_work) == 3)
    assert viewer.window.close()
    assert all(thread.is_alive() for thread in at_work)
    assert viewer.simulator.lane.thread in at_work
    going.set()


def test_windows_are_opened_and_drawn_with_garbage_in_one_place(small, qapp, monkeypatch, tmp_path):
    opened = []

    def viewer(*_, **__):
        opened.append(gc.isenabled())
        raise SceneError("enough is seen")

    monkeypatch.setattr(application, "Viewer", viewer)
    for use in (lambda: application.open_window(small), lambda: application.draw_window(small, tmp_path / "w.png")):
        with pytest.raises(SceneError):
            use()
    assert opened == [False, False]
    assert gc.isenabled()


def test_reports_that_wait_are_passed_on_as_one():
    calls = []
    told = []

    def work(progress):
        for k in range(1000):
            progress(k / 1000.0)

    job = ThreadJob("test", work, lambda *call: calls.append(call))
    job.changed.connect(lambda job: told.append(job.stage.share))
    job.start()
    job.thread.join(60.0)
    assert len(calls) == 2, "one of its progress, one of its end"
    receive, result = calls[0]
    receive(result)
    assert told == [0.999]


OPENED = """
import atexit
from insonify.scene import load_scene
from insonify_viewer.application import has_opengl, make_application
from insonify_viewer.viewer import Viewer
application = make_application()
viewer = Viewer(load_scene("default"), accelerated=has_opengl())
viewer.window.show()
application.processEvents()
atexit.register(viewer.window.close)
"""


@pytest.mark.parametrize(
    ("before", "work", "libraries"),
    [
        ("", "from insonify.cli import build_parser; build_parser()", ("PySide6", "pyvista", "vtkmodules")),
        ("", OPENED, ("numba", "pyvista", "matplotlib", "xarray", "pandas")),  # Numba alone takes a third of a second
        # PySide6 makes the classes of a module when they are first asked for, which two threads must not do at once.
        ("from insonify_viewer.seabed.controller import load_qt_modules as load; load()", "import pyvistaqt",
         ("PySide6", "qtpy", "shiboken6")),
        ("", "import insonify_viewer.seabed.seabed_view, pyvistaqt", ("matplotlib", "mypy")),
    ],
    ids=["command", "window", "worker", "view"],
)  # fmt: skip
def test_libraries_are_not_loaded_before_they_are_needed(before, work, libraries):
    """Neither a window by the command, kernels and three dimensions by a window, nor Qt by a worker."""
    modules = f"{{name.split('.')[0] for name in set(sys.modules) - known}} & set({libraries})"
    code = f"import sys\n{before}\nknown = set(sys.modules)\n{work}\nprint(*{modules})"
    assert run_python("-c", code, timeout=PATIENCE) == (0, "\n", "")


def test_pyvista_imports_matplotlib_for_the_colours_of_a_map():
    code = """
import sys
from insonify_viewer.seabed.lean_pyvista import pv
assert "matplotlib" not in sys.modules
print(pv.LookupTable("viridis", n_values=2).values.tolist(), "matplotlib" in sys.modules)
"""
    assert run_python("-c", code, timeout=PATIENCE) == (0, "[[68, 1, 84, 255], [253, 231, 36, 255]] True\n", "")


class Node:
    """An object that refers to itself."""

    def __init__(self):
        self.own = self


def test_what_is_left_out_is_collected_in_the_end_and_what_comes_later_as_ever_in_a_small_share_of_the_time():
    with collected_by_hand():
        kept = weakref.ref(Node())
        before = len(gc.get_objects())
        leave_out_libraries()
        assert len(gc.get_objects()) < 0.1 * before + 1000
        gc.collect()
        assert kept() is not None
        gone = weakref.ref(Node())
        gc.collect()
        assert gone() is None
    assert kept() is None
    assert gc.isenabled()
    # Cycles are collected while the program works.
    with collected_by_hand() as policy:
        gone = weakref.ref(Node())
        kept = [[number] for number in range(200_000)]
        until = time.perf_counter() + 120.0
        while gone() is not None and time.perf_counter() < until:
            kept.extend([number] for number in range(10_000))
            policy.collect()
    assert gone() is None


@pytest.mark.parametrize("function", ["get_objects", "get_referrers"])
def test_no_source_asks_for_all_objects(function):
    """A tuple that another thread makes from a generator would have a second owner, which ends its making."""
    sources = [path for folder in ("app", "core") for path in Path(folder).rglob("*.py")]
    assert len(sources) > 100
    assert [path for path in sources if f"gc.{function}(" in path.read_text(encoding="utf-8")] == []


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
        print("CONTACTS", recovery.contacts.all == (FISH,), recovery.contacts.unsaved, flush=True)
        print("READY", flush=True)
CrashRecovery.offer = offer_and_report
def begin(viewer):
    def act():
        if sys.argv[1] == "edit":
            viewer.session.settle({"track.altitude": 7.25})
        viewer.contacts.add(FISH)
        # By the window's own loop of events: a busy machine delays all its timers alike.
        QTimer.singleShot(5000, lambda: print("AGED", flush=True))
    if sys.argv[1] != "look":
        QTimer.singleShot(300, act)
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
def test_a_killed_window_loses_no_edit_older_than_5_s_nor_a_contact_though_the_scene_is_saved(tmp_path):
    edited, marked = (tmp_path / word for word in ("edit", "mark"))
    with ThreadPoolExecutor() as pool:  # both windows grow old at the same time
        list(pool.map(lambda folder: (folder.mkdir(), run_until(folder.name, "AGED", folder)), (edited, marked)))
    said = run_until("look", "READY", edited)
    assert len([line for line in said if line.startswith("ASKED")]) == 1
    assert "“A pipe that rests and spans” and the list of 1 contact. Open them as they were?" in said[0]
    assert {"ALTITUDE 7.25 True", "CONTACTS True True"} <= set(said)
    said = run_until("look", "READY", edited)
    assert {"ALTITUDE 7.25 True", "CONTACTS True True"} <= set(said), "the second window had kept it anew"
    said = run_until("look", "READY", marked)
    assert said[0].endswith("with unsaved changes of the list of 1 contact. Open it as it was?")
    assert "CONTACTS True True" in said
    assert not [line for line in said if line.startswith("ALTITUDE")], "no scene is opened"


def test_unsaved_work_is_bounded_offered_after_a_crash_alone_and_removed_by_closing(small, monkeypatch):
    recovery, other = Recovery(), Recovery()
    folder = recovery._folder
    for scene, contacts, suffixes in (
        (small, (FISH,), [".geojson", ".toml"]),
        (small, (), [".toml"]),
        (None, (FISH,), [".geojson"]),
        (edit(small, {"seed": 5}), (), [".toml"]),
    ):
        recovery.keep(scene, contacts)
        assert sorted(path.suffix for path in folder.iterdir()) == sorted([*suffixes, ".lock", ".lock"])
        assert other.find_left() is None, "its window runs"
    other.close()
    # What cannot be read is removed, and the lock of a window that was killed without unsaved work.
    killed = folder / "unsaved-999999999-dead.lock"
    killed.write_text(f"999999999\nviewer\n{platform.node()}\n")
    (folder / "unsaved-0-bad.toml").write_text("no scene [")
    write_contacts(folder / "unsaved-0-bad.geojson", [FISH])
    left = recovery.find_left()
    assert left is not None
    assert (left.scene, left.contacts) == (None, (FISH,))
    assert not killed.exists()
    assert not (folder / "unsaved-0-bad.toml").exists()
    (folder / "unsaved-0-bad.geojson").write_text("no contacts")
    assert recovery.find_left() is None
    assert not (folder / "unsaved-0-bad.geojson").exists()
    assert INTERVAL < 4.0, "and a second to write"
    monkeypatch.setattr("insonify_viewer.window.recovery.MOST_CONTACTS", 4)
    monkeypatch.setattr("insonify_viewer.window.recovery.MOST_PICTURES", 5)
    recovery.keep(None, tuple(replace(FISH, name=str(number), snapshot=b"12") for number in range(6)))
    (file,) = folder.glob("*.geojson")
    kept = read_contacts(file)
    assert [(each.name, each.snapshot) for each in kept] == [("2", b""), ("3", b""), ("4", b"12"), ("5", b"12")]
    recovery.close()
    assert list(folder.iterdir()) == []
