"""Opens the viewer on a screen, or draws its window into a picture."""

import linecache
import os
import signal
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import Any

os.environ.setdefault("QT_API", "pyside6")

from PySide6.QtCore import QEventLoop, QTimer
from PySide6.QtGui import QGuiApplication, QOpenGLContext
from PySide6.QtWidgets import QApplication

from insonify.compiler.progress import watch_compilation
from insonify.io.sealed import SUFFIX
from insonify.lessons.lesson import Lesson
from insonify.scene import Scene, SceneError
from insonify_viewer.errors import cause_of
from insonify_viewer.panels.comparison.controller import ComparisonPanel
from insonify_viewer.panels.lessons.controller import LessonsPanel
from insonify_viewer.record.comparison.arrangement import Arrangement
from insonify_viewer.state.inspection import Mark
from insonify_viewer.viewer import Viewer
from insonify_viewer.widgets.save_dialogs import save_picture
from insonify_viewer.widgets.theme import Theme, apply_theme
from insonify_viewer.window.recovery import CrashRecovery
from insonify_viewer.window.settings import Settings
from insonify_viewer.window.uncaught_errors import reported_errors, reported_warnings
from insonify_viewer.work.gc_policy import collected_by_hand, limit_free_memory

SNAPSHOT_SIZE = (1600, 1000)
COLLECTION_INTERVAL = 200  # ms
REST = 20.0  # s, at most, for what panels measure in the background before a snapshot
FRAMED = 100  # ms, from the window to its frame, which the system draws around it
TOUR = 2000  # ms, from the first start of all to the tour, by when the seabed mostly is in view
PATIENCE = 240.0  # s, for a snapshot, from the last sign that a kernel is being compiled


def open_window(
    scene: Scene,
    pin: Mark | None = None,
    lesson: Lesson | None = None,
    recording: str = "",
    pair: Arrangement | None = None,
    panel: str = "",
) -> int:
    """Open the viewer, run it until it is closed, and return an exit code."""
    settings = Settings()
    application = make_application(settings.theme)
    enlarge_text(application, settings.size)
    with main_thread_collection():
        viewer = Viewer(scene, accelerated=has_opengl())
        keep_display(viewer)
        keep_place(viewer)
        viewer.window.show()
        QTimer.singleShot(FRAMED, viewer.window.fit_screen)
        _begin(viewer, pin, lesson, recording, pair, panel)
        QTimer.singleShot(0, viewer.start)
        recovery = CrashRecovery(viewer.window, viewer.session, viewer.contacts, viewer.open)
        QTimer.singleShot(0, recovery.offer)
        if not (settings.toured or pin or lesson or recording or pair or panel):
            settings.toured = True
            QTimer.singleShot(TOUR, viewer.window.tour.begin)
        signal.signal(signal.SIGINT, lambda *_: _close_on_interrupt(viewer))
        tell = partial(viewer.simulator.executor.call_later, partial(viewer.window.say, lasting=True))
        with reported_errors(viewer.window.complain), reported_warnings(tell):
            return application.exec()


def keep_display(viewer: Viewer) -> None:
    """Show the record by the display options of the last start, and keep every change of them for the next."""
    settings = viewer.window.settings
    viewer.session.show_first(**settings.display)
    viewer.session.displayed.connect(settings.keep_display)


def keep_place(viewer: Viewer) -> None:
    """Open the window where it was closed the last time, as far as the screen is still there."""
    window = viewer.window
    window.restoreGeometry(window.settings.geometry)
    window.closing.connect(lambda: setattr(window.settings, "geometry", window.saveGeometry()))


def _begin(
    viewer: Viewer, pin: Mark | None, lesson: Lesson | None, recording: str, pair: Arrangement | None, panel: str
) -> None:
    """Pin a pixel, begin a lesson, open a recording or exercise, the scene's partner and a panel, if given."""
    viewer.inspection.pin(pin)
    if pin is not None:
        viewer.targets.handles.choose_at(pin)
    if panel:
        viewer.window.open_panel(panel)
    if lesson is not None:
        viewer.window.open_panel(LessonsPanel.name)
        lessons = viewer.panels[LessonsPanel.name]
        assert isinstance(lessons, LessonsPanel)
        lessons.begin(lesson)
    if recording:
        opener = viewer.files if recording.lower().endswith(SUFFIX) else viewer.recordings
        QTimer.singleShot(0, lambda: opener.open(recording))  # once the window is laid out
    if pair is not None:
        viewer.window.open_panel(ComparisonPanel.name)
        viewer.comparison.open_partner()
        viewer.comparison.arrange(pair)


def _close_on_interrupt(viewer: Viewer) -> None:
    """Close the window, which may ask about unsaved changes; a second interrupt ends the program at once."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    QTimer.singleShot(0, viewer.window.close)


def draw_window(
    scene: Scene,
    path: Path,
    pin: Mark | None = None,
    lesson: Lesson | None = None,
    recording: str = "",
    pair: Arrangement | None = None,
    panel: str = "",
) -> None:
    """Draw the viewer's window into a PNG, without a screen; `open_window` explains the parameters."""
    application = make_application()
    with main_thread_collection():
        viewer = Viewer(scene, accelerated=False)
        viewer.window.resize(*SNAPSHOT_SIZE)
        viewer.window.move(40, 40)  # away from the pointer, which would highlight a button
        viewer.window.show()
        viewer.tow.run(False)
        _begin(viewer, pin, lesson, recording, pair, panel)
        viewer.start()
        try:
            wait_for_picture(application, viewer)
            viewer.seabed.draw_now()
            save_picture(viewer.window, path)
        finally:
            viewer.window.close()


def wait_for_picture(application: QApplication, viewer: Viewer, rest: float = REST) -> None:
    """Wait until the window shows its scene, then some seconds at most for what its panels measure."""
    # Raise SceneError with the reason if the window does not show it.
    with _slot_errors() as errors:
        failure = _wait_for_scene(application, viewer, errors, rest)
    if failure:
        raise SceneError(failure)


def _wait_for_scene(application: QApplication, viewer: Viewer, errors: list[BaseException], rest: float) -> str:
    """Wait until the window shows its scene; return why it does not, in one sentence, or nothing."""
    since = time.monotonic()

    def begin_again(_: object = None) -> None:
        nonlocal since
        since = time.monotonic()

    def pend(seconds: float, until: Callable[[], bool]) -> bool:
        while not until() and not viewer.failure and not errors and time.monotonic() < since + seconds:
            application.processEvents(QEventLoop.ProcessEventsFlag.AllEvents, 50)
            time.sleep(0.005)
        return until() or bool(viewer.failure or errors)

    with watch_compilation(begin_again):  # however long a slow machine takes to compile
        if not pend(PATIENCE, lambda: viewer.complete):
            return f"no picture after {PATIENCE:g} s; try a smaller scene"
    begin_again()
    pend(rest, lambda: viewer.panels.at_rest)
    if errors:
        return f"the window cannot be drawn ({type(errors[0]).__name__}: {errors[0]}); this is a bug in insonify"
    return viewer.failure or viewer.recordings.failure


@contextmanager
def _slot_errors() -> Iterator[list[BaseException]]:
    """Collect exceptions of slots, which Qt would print and pass over."""
    errors: list[BaseException] = []
    before = sys.excepthook
    sys.excepthook = lambda kind, error, trace: errors.append(cause_of(error))
    try:
        yield errors
    finally:
        sys.excepthook = before


@contextmanager
def main_thread_collection() -> Iterator[None]:
    """Collect garbage on the calling thread alone, whenever its event loop runs, until the block ends."""
    with collected_by_hand() as policy:
        timer = QTimer()
        timer.timeout.connect(policy.collect)
        timer.start(COLLECTION_INTERVAL)
        try:
            yield
        finally:
            timer.stop()


def enlarge_text(application: QApplication, percent: int) -> None:
    """Enlarge the text, from which windows that are made later take all their sizes."""
    font = application.font()
    font.setPointSizeF(font.pointSizeF() * percent / 100.0)
    application.setFont(font)


def make_application(theme: Theme = Theme.DARK) -> QApplication:
    """Return the QApplication, with the colours and style of the viewer."""
    # A short switch interval lets the main thread interrupt the worker often enough to keep the window smooth.
    sys.setswitchinterval(0.001)
    leave_sources_unread()
    limit_free_memory()
    existing = QApplication.instance()
    application = existing if isinstance(existing, QApplication) else QApplication(sys.argv[:1])
    application.setApplicationName("insonify")
    apply_theme(application, theme)
    return application


def leave_sources_unread() -> None:
    """Import modules from now on without reading their sources."""
    # From its first import on, PySide6 reads the source of every module that is imported, to learn whether the module
    # may use the optional spelling of ``from __feature__ import snake_case``. None here does. A thousand sources would
    # stay in `linecache`, 60 MB, and reading them holds the interpreter. PySide6 has no switch for it; a version that
    # keeps the search elsewhere goes on as before.
    feature: Any = sys.modules.get("shibokensupport.feature")
    if hasattr(feature, "_mod_uses_pyside"):
        feature._mod_uses_pyside = lambda module: False
    linecache.clearcache()  # of those that were imported before


def has_opengl() -> bool:
    """Whether a widget can be drawn with OpenGL here."""
    if QGuiApplication.platformName() in ("offscreen", "minimal"):
        return False
    return QOpenGLContext().create()
