"""Qt modules that the three-dimensional view needs, loaded on the main thread."""

from __future__ import annotations

from importlib import import_module

# pyvistaqt imports these, and they every class of PySide6. On another thread that races with the main thread, which
# looks up the classes of the events that it handles, and ends the program.
MODULES = ("qtpy.QtCore", "qtpy.QtGui", "qtpy.QtWidgets", "qtpy.QtOpenGLWidgets")


def load_qt_modules() -> None:
    """Import the modules; to be called on the main thread, before pyvistaqt is imported on another."""
    for name in MODULES:
        import_module(name)
