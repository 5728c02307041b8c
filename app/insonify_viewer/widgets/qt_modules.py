"""Qt modules that the three-dimensional view needs, and how Qt for Python sees the modules that are imported later."""

from __future__ import annotations

import linecache
import sys
from importlib import import_module
from typing import Any

# pyvistaqt imports these, and they every class of PySide6. On another thread that races with the main thread, which
# looks up the classes of the events that it handles, and ends the program.
MODULES = ("qtpy.QtCore", "qtpy.QtGui", "qtpy.QtWidgets", "qtpy.QtOpenGLWidgets")


def load_qt_modules() -> None:
    """Import the modules; to be called on the main thread, before pyvistaqt is imported on another."""
    for name in MODULES:
        import_module(name)


def leave_sources_unread() -> None:
    """Import modules from now on without reading their sources.

    From its first import on, PySide6 reads the source of every module that is imported, to learn whether the module
    may use the optional spelling of ``from __feature__ import snake_case``. None here does. A thousand sources would
    stay in `linecache`, 60 MB, and reading them holds the interpreter. PySide6 has no switch for it; a version that
    keeps the search elsewhere goes on as before.
    """
    feature: Any = sys.modules.get("shibokensupport.feature")
    if hasattr(feature, "_mod_uses_pyside"):
        feature._mod_uses_pyside = lambda module: False
    linecache.clearcache()  # of those that were imported before
