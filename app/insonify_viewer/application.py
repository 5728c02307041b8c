"""Opens the viewer's window on a screen, or draws it into a picture."""

from __future__ import annotations

import os
import signal
import sys
import time
from pathlib import Path

os.environ.setdefault("QT_API", "pyside6")

from PySide6.QtCore import QEventLoop, QTimer
from PySide6.QtGui import QGuiApplication, QOpenGLContext
from PySide6.QtWidgets import QApplication

from insonify.scene import Scene, SceneError
from insonify_viewer.gc_policy import collecting_here
from insonify_viewer.viewer import Viewer
from insonify_viewer.views.files import save_picture
from insonify_viewer.views.theme import dress

SNAPSHOT_SIZE = (1600, 1000)
PATIENCE = 240.0  # s, for a snapshot on a slow machine that compiles first


def open_window(scene: Scene) -> int:
    """Open the viewer and stay until it is closed; return an exit code."""
    application = make_application()
    with collecting_here():
        viewer = Viewer(scene, accelerated=has_opengl())
        viewer.window.show()
        QTimer.singleShot(0, viewer.start)
        signal.signal(signal.SIGINT, lambda *_: viewer.window.close())
        return application.exec()


def draw_window(scene: Scene, path: Path) -> None:
    """Draw the viewer's window into a PNG, without a screen.

    Raises
    ------
    SceneError
        If the scene cannot be simulated, or the picture not written.
    """
    application = make_application()
    with collecting_here():
        _draw(application, scene, path)


def _draw(application: QApplication, scene: Scene, path: Path) -> None:
    viewer = Viewer(scene, accelerated=False)
    viewer.window.resize(*SNAPSHOT_SIZE)
    viewer.window.move(40, 40)  # from under the pointer, which would light a button up
    viewer.window.show()
    viewer.tow.run(False)
    viewer.start()
    deadline = time.monotonic() + PATIENCE
    while not viewer.complete and not viewer.failure and time.monotonic() < deadline:
        application.processEvents(QEventLoop.ProcessEventsFlag.AllEvents, 50)
        time.sleep(0.005)
    failure = viewer.failure or ("" if viewer.complete else f"no picture after {PATIENCE:g} s; try a smaller scene")
    try:
        if failure:
            raise SceneError(failure)
        viewer.seabed.draw_now()
        save_picture(viewer.window, path)
    finally:
        viewer.window.close()


def make_application() -> QApplication:
    """Return the one application, dressed."""
    # The worker hands the interpreter over often enough for the window to stay smooth.
    sys.setswitchinterval(0.001)
    existing = QApplication.instance()
    application = existing if isinstance(existing, QApplication) else QApplication(sys.argv[:1])
    application.setApplicationName("insonify")
    dress(application)
    return application


def has_opengl() -> bool:
    """Whether a widget can be drawn with OpenGL here."""
    if QGuiApplication.platformName() in ("offscreen", "minimal"):
        return False
    return QOpenGLContext().create()
