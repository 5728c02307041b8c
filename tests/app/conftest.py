"""One window a test, and nothing left behind."""

import os
import threading
from collections.abc import Callable, Iterator
from functools import lru_cache, partial
from typing import Any

import pytest

os.environ.setdefault("QT_API", "pyside6")

from PySide6.QtCore import QCoreApplication, QEvent, QEventLoop, QSettings, QTimer
from PySide6.QtWidgets import QApplication, QMessageBox
from stand_in import StandIn

from insonify.explanation import compilation, listeners
from insonify.explanation import pixel as explained
from insonify.scene import Scene, edit, load_scene
from insonify_viewer.application import has_opengl, main_thread_collection
from insonify_viewer.panels.comparison import controller as comparison
from insonify_viewer.panels.pixel import controller as pixel
from insonify_viewer.seabed import controller as seabed
from insonify_viewer.viewer import Viewer
from insonify_viewer.widgets.theme import apply_theme

COMPILING = 240.0  # s, that a thread may take to compile its kernels where other tests keep the cores busy
TURNS, TURN = 10, 20  # of the loop of events, at least, in any time that a test waits; ms, of one that goes on and on
PATIENCE = 60_000  # ms, that only a fault takes longer than, however busy the cores are

Opener = Callable[..., Viewer]


@pytest.fixture
def small() -> Scene:
    return edit(load_scene("default"), {"sonar.bins": 100, "track.pings": 128})


@pytest.fixture
def qtbot(qtbot: Any) -> Any:
    """Wait as long as a busy machine may take: the time that a test gives for a condition is no bound that it asserts.

    In a given time such a machine may go through the loop of events but once, where a layout takes several turns.
    """
    wait_until, wait = qtbot.waitUntil, qtbot.wait

    def wait_some_turns(milliseconds: int) -> None:
        wait(milliseconds)
        for _ in range(TURNS):
            QCoreApplication.processEvents(QEventLoop.ProcessEventsFlag.AllEvents, TURN)

    qtbot.wait = wait_some_turns
    qtbot.waitUntil = lambda condition, *, timeout=0: wait_until(condition, timeout=max(timeout, PATIENCE))
    return qtbot


@pytest.fixture(autouse=True)
def _no_person_is_needed(tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch) -> None:
    """Discard unsaved changes where a test does not answer otherwise: a question would wait for ever.

    Settings and states of windows are in a folder of each test, not in the person's own.
    """
    monkeypatch.setattr(QMessageBox, "question", lambda *_: QMessageBox.StandardButton.Discard)
    folder = tmp_path_factory.mktemp("settings")
    QSettings.setPath(QSettings.Format.IniFormat, QSettings.Scope.UserScope, str(folder))
    monkeypatch.setenv("XDG_STATE_HOME", str(folder))


def await_threads(before: set[threading.Thread]) -> None:
    """Wait for the window's threads: closing it does not wait for a block that is traced or a kernel being compiled."""
    for thread in (t for t in set(threading.enumerate()) - before if t.name.startswith("insonify ")):
        thread.join(timeout=COMPILING)
        assert not thread.is_alive()


@pytest.fixture(autouse=True)
def _nothing_is_left(qapp: QApplication) -> Iterator[None]:
    """Leave no thread at work, also where the command draws a window: LLVM would abort as the process ends.

    Delete what is to be deleted later, as a loop of events does: style sheets are applied to it too. Every test begins
    with the usual colours and size of text, and with an application that has the screen: a command that draws without
    one would take it from all tests.
    """
    apply_theme(qapp)
    before, font = set(threading.enumerate()), qapp.font()
    yield
    await_threads(before)
    QCoreApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete)
    qapp.setFont(font)


@pytest.fixture(scope="session")
def _beds_are_shaded_once() -> Iterator[None]:
    """Shade a bed once for all windows that show it, and draw it without the smaller copies of its picture.

    Where no graphics card makes these, they take a tenth of a second of each window, a quarter of its opening. Commands
    that draw a window are tested with them.
    """
    from insonify_viewer.seabed import pv_meshes, seabed_view

    def plain_texture() -> Any:
        texture = blank_texture()
        texture.mipmap = False
        return texture

    blank_texture = seabed_view._blank_texture
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(pv_meshes, "bed_patch", lru_cache(maxsize=32)(pv_meshes.bed_patch))
        patch.setattr(seabed_view, "_blank_texture", plain_texture)
        yield


@pytest.fixture
def drawn_seabed() -> None:
    """Draw the three-dimensional view, in tests that look at it."""


@pytest.fixture
def _seabed_is_not_drawn(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """Leave the three-dimensional view blank elsewhere: software draws it in a third of the time of a window."""
    from pyvistaqt.rwi import QVTKRenderWindowInteractor

    if "drawn_seabed" not in request.fixturenames:
        monkeypatch.setattr(QVTKRenderWindowInteractor, "paintGL", lambda _: None)


@pytest.fixture(autouse=True)
def _stand_ins_are_not_explained(monkeypatch: pytest.MonkeyPatch) -> None:
    """Leave out what is computed from the packed scene of a simulation, which a stand-in lacks."""
    for module, name in (
        (compilation, "compile_explanations"), (explained, "find_bin_errors"), (listeners, "find_listeners"),
        (seabed, "fan_sheet"), (pixel, "_explained"), (comparison, "measure_simulation"),
    ):  # fmt: skip
        monkeypatch.setattr(module, name, partial(_unless_stand_in, getattr(module, name)))


def _unless_stand_in(compute: Callable[..., Any], simulation: Any, *rest: Any) -> Any:
    """Compute something of a simulation; nothing of a stand-in."""
    return None if isinstance(simulation, StandIn) else compute(simulation, *rest)


@pytest.fixture
def open_viewer(
    qtbot: Any, qapp: QApplication, _beds_are_shaded_once: None, _seabed_is_not_drawn: None
) -> Iterator[Opener]:
    """Open viewers on the stand-in simulation; close them and look for what they left."""
    viewers: list[Viewer] = []
    before = set(threading.enumerate())

    def open_one(
        scene: Scene,
        *,
        prepare: Any = StandIn,
        solid: bool = False,
        until: Callable[[Viewer], bool] = lambda viewer: viewer.complete,
    ) -> Viewer:
        viewer = Viewer(scene, accelerated=has_opengl() and not solid, prepare=prepare)
        viewers.append(viewer)
        viewer.window.show()
        viewer.tow.run(False)
        viewer.window.show_running(False)
        viewer.start()
        qtbot.waitUntil(lambda: until(viewer), timeout=int(1000 * COMPILING))
        return viewer

    with main_thread_collection():
        yield open_one
        for window in [viewer.window for viewer in viewers]:
            window.close()
            window.deleteLater()
        qapp.processEvents()
        await_threads(before)
        assert not [t for viewer in viewers for t in viewer.findChildren(QTimer) if t.isActive()]
        viewers.clear()


@pytest.fixture
def viewer(open_viewer: Opener, small: Scene) -> Viewer:
    return open_viewer(small)
