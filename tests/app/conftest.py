"""One window a test, and nothing left behind."""

import os
import threading
from collections.abc import Callable, Iterator
from contextlib import suppress
from functools import lru_cache, partial
from typing import Any

import pytest

os.environ.setdefault("QT_API", "pyside6")

from PySide6.QtCore import QCoreApplication, QEvent, QEventLoop, QPoint, QSettings, QTimer
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QMessageBox
from stand_in import StandIn

from insonify.explanation import compilation, listeners
from insonify.explanation import pixel as explained
from insonify.scene import Scene, edit, load_scene
from insonify_viewer.application import has_opengl, main_thread_collection
from insonify_viewer.panels.comparison import controller as comparison
from insonify_viewer.panels.panel import Place
from insonify_viewer.panels.pixel import controller as pixel
from insonify_viewer.record.comparison.arrangement import Arrangement
from insonify_viewer.record.projection import Zoom
from insonify_viewer.seabed import controller as seabed
from insonify_viewer.viewer import Viewer
from insonify_viewer.widgets.theme import apply_theme
from insonify_viewer.window.main_window import USUAL
from insonify_viewer.work.executor import Lane

COMPILING = 240.0  # s, that a thread may take to compile its kernels where other tests keep the cores busy
TURNS, TURN = 10, 20  # of the loop of events, at least, in any time that a test waits; ms, of one that goes on and on
PATIENCE = 60_000  # ms, that only a fault takes longer than, however busy the cores are

Opener = Callable[..., Viewer]
DRAWN = {"seabed": False}  # what is drawn in the test under way
SHARED: dict[Any, list[Viewer]] = {StandIn: [], None: []}  # viewers between tests, by the simulation that they show


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
    kept = {lane.thread for viewers in SHARED.values() for viewer in viewers for lane in lanes_of(viewer)}
    for thread in (t for t in set(threading.enumerate()) - before - kept if t.name.startswith("insonify ")):
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
def drawn_seabed(monkeypatch: pytest.MonkeyPatch) -> None:
    """Draw the three-dimensional view, in tests that look at it."""
    monkeypatch.setitem(DRAWN, "seabed", True)


@pytest.fixture(scope="session")
def _seabed_is_not_drawn() -> Iterator[None]:
    """Leave the three-dimensional view blank elsewhere: software draws it in a third of the time of a window."""
    from pyvistaqt.rwi import QVTKRenderWindowInteractor

    paint = QVTKRenderWindowInteractor.paintGL
    with pytest.MonkeyPatch.context() as patch:  # for all tests: Qt's bindings keep the method of a view
        patch.setattr(QVTKRenderWindowInteractor, "paintGL", lambda view: paint(view) if DRAWN["seabed"] else None)
        yield


@pytest.fixture(scope="session", autouse=True)
def _stand_ins_are_not_explained() -> Iterator[None]:
    """Leave out what is computed from the packed scene of a simulation, which a stand-in lacks."""
    with pytest.MonkeyPatch.context() as patch:
        for module, name in (
            (compilation, "compile_explanations"), (explained, "find_bin_errors"), (listeners, "find_listeners"),
            (seabed, "fan_sheet"), (pixel, "_explained"), (comparison, "measure_simulation"),
        ):  # fmt: skip
            patch.setattr(module, name, partial(_unless_stand_in, getattr(module, name)))
        yield


def _unless_stand_in(compute: Callable[..., Any], simulation: Any, *rest: Any) -> Any:
    """Compute something of a simulation; nothing of a stand-in."""
    return None if isinstance(simulation, StandIn) else compute(simulation, *rest)


@pytest.fixture(scope="session", autouse=True)
def _shared_viewers_are_closed(qapp: QApplication) -> Iterator[None]:
    """Close what tests have shared, without a question."""
    yield
    for viewers in SHARED.values():
        for viewer in viewers:
            viewer.window.may_close = lambda: True
            viewer.window.close()
        viewers.clear()
    await_threads(set())


def renew(viewer: Viewer, scene: Scene) -> None:
    """Bring a viewer that another test has used to where one begins."""
    window, session = viewer.window, viewer.session
    window.settings.__init__()  # type: ignore[misc]  # in the folder of this test
    window.recent.fill()
    for button in window.buttons.values():
        button.setChecked(False)
    viewer.run(False)
    window.say("")
    viewer.tow.speed = 1.0
    window.speed.setCurrentText("1×")
    viewer.contacts.open((), "")
    session.__init__(scene)  # type: ignore[misc]  # without a step
    session.displayed.emit(session.display)
    viewer.panels["record"].view.contacts.list.sortItems(0)
    viewer.panels["record"]._forget_line(window.waterfall)
    for view in (window.waterfall, window.record_a):
        view.show_zoom(Zoom())
    if viewer.seabed.view is not None:
        viewer.seabed.view.eases = False  # the camera is at its place at once
        viewer.seabed.view.canvas.widget.setMaximumSize(*window.maximumSize().toTuple())
    viewer.open(scene)
    window.open_panel("parameters")
    window.resize(*USUAL)
    window.waterfall.setFocus()
    QTest.mouseMove(window.menuBar(), QPoint(2, 2))  # a later move to where the mouse was is none


def lanes_of(viewer: Viewer) -> list[Lane]:
    """Threads of a viewer that live as long as it does."""
    return [viewer.simulator.lane, *viewer.simulator.executor.lanes.values()]


def leave(viewer: Viewer) -> bool:
    """Leave what a test has opened; whether the next one may use the viewer."""
    window = viewer.window
    if window.isHidden() or window.lecture.action.isChecked() or viewer.failure:
        return False
    for panel in viewer.panels.values():
        if panel.place is Place.WINDOW and panel.view is not None:
            panel.view.close()
    viewer.panels["lessons"].leave()
    viewer.comparison.leave()
    viewer.comparison.arrange(Arrangement.ALONE)
    window.tour.end()
    viewer.jobs.forget_ended()
    return not (viewer.jobs.running or viewer.recordings.busy)


@pytest.fixture
def open_viewer(
    qtbot: Any, qapp: QApplication, request: pytest.FixtureRequest,
    _beds_are_shaded_once: None, _seabed_is_not_drawn: None,
) -> Iterator[Opener]:  # fmt: skip
    """Open viewers on the stand-in simulation, their own or those of other tests, and look for what they leave."""
    viewers: list[tuple[Viewer, Any]] = []
    before, failed = set(threading.enumerate()), request.session.testsfailed

    def open_one(
        scene: Scene,
        *,
        prepare: Any = StandIn,
        solid: bool = False,
        own: bool = False,
        until: Callable[[Viewer], bool] = lambda viewer: viewer.complete,
    ) -> Viewer:
        shared = None if own or solid else SHARED.get(prepare)
        viewer = shared.pop() if shared else None
        if viewer is not None:
            renew(viewer, scene)
            with suppress(qtbot.TimeoutError):
                qtbot.waitUntil(lambda: viewer.complete)
            if not viewer.complete:  # a test has left something that waits for ever
                viewer.window.close()
                viewer.window.deleteLater()
                viewer = None
        if viewer is None:
            viewer = Viewer(scene, accelerated=has_opengl() and not solid, prepare=prepare)
            viewer.window.show()
            viewer.tow.run(False)
            viewer.window.show_running(False)
            viewer.start()
        viewers.append((viewer, shared))
        qtbot.waitUntil(lambda: until(viewer), timeout=int(1000 * COMPILING))
        if viewer.seabed.view is not None:
            viewer.seabed.view.eases = viewer.seabed.accelerated
        return viewer

    with main_thread_collection():
        yield open_one
        closed = []
        for viewer, shared in viewers:
            if shared is not None and request.session.testsfailed == failed and leave(viewer):
                shared.append(viewer)
            else:
                viewer.window.close()
                viewer.window.deleteLater()
                closed.append(viewer)
        qapp.processEvents()
        await_threads(before)
        assert not [t for viewer in closed for t in viewer.findChildren(QTimer) if t.isActive()]
        viewers.clear()


@pytest.fixture
def viewer(open_viewer: Opener, small: Scene) -> Viewer:
    return open_viewer(small)
