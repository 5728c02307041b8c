"""Errors as one sentence, with traceback and details for faults of the program, and guards of Qt's overrides."""

import platform
import sys
import traceback
from collections.abc import Callable, Sequence
from functools import wraps
from importlib.metadata import PackageNotFoundError, version
from typing import NamedTuple, ParamSpec, TypeVar
from weakref import WeakKeyDictionary

from psygnal import EmitLoopError

from insonify.scene import SceneError

PARTS = ("insonify", "numpy", "numba", "PySide6-Essentials", "vtk", "pyvista")
P = ParamSpec("P")
R = TypeVar("R")


class Failure(NamedTuple):
    """What went wrong."""

    sentence: str  # for the person
    trace: str = ""  # Python's traceback; empty for a mistake in a scene, a file or a number


def describe_error(error: BaseException, what: str = "this") -> Failure:
    """Describe an exception; ``what`` is named as that which failed where it is a fault of the program."""
    if isinstance(error, SceneError):
        return Failure(str(error), "" if error.__cause__ is None else format_trace(error.__cause__))
    if isinstance(error, OSError):
        return Failure(f"{error.filename}: {error.strerror or error}; check that the folder can be written to")
    return Failure(f"{what} failed ({type(error).__name__}: {error})", format_trace(error))


def cause_of(error: BaseException) -> BaseException:
    """Return the error that a callback of a signal raised; psygnal wraps it once for every signal on the way."""
    while isinstance(error, EmitLoopError) and error.__cause__ is not None:
        error = error.__cause__
    return error


def format_trace(error: BaseException) -> str:
    """Format the traceback of an exception."""
    return "".join(traceback.format_exception(error))


def list_versions() -> list[str]:
    """Name the program, its parts, Python and the system, each with its version."""
    parts = [f"{part} {version_of(part)}" for part in PARTS]
    return [*parts, f"Python {platform.python_version()}, {platform.platform(terse=True)}"]


def version_of(part: str) -> str:
    """Version of an installed package."""
    try:
        return version(part)
    except PackageNotFoundError:
        return "(version unknown)"


def write_details(failure: Failure, scene: str, said: Sequence[str]) -> str:
    """Write what helps to find the cause of an error, as text."""
    parts = (
        ("", [failure.sentence]),
        ("Traceback", failure.trace.splitlines()),
        ("Said before", said),
        ("Versions", list_versions()),
        ("Scene", scene.splitlines()),
    )
    return "\n\n".join("\n".join([title] * bool(title) + list(lines)) for title, lines in parts if lines) + "\n"


class FaultReport:
    """Reports the faults of one source, such as a picture that fails at every frame."""

    # A fault is reported again only after another one or after a success.

    def __init__(self) -> None:
        self._last = ""

    def is_news(self, error: Exception) -> bool:
        """Whether a fault is to be reported."""
        known, self._last = self._last, repr(error)
        return self._last != known

    def report(self, error: Exception | None) -> None:
        """Report how work on a thread ended; a `SceneError` is dropped, because the simulator reports it too."""
        if error is None:
            self._last = ""
        elif not isinstance(error, SceneError) and self.is_news(error):
            report_fault(error)


def report_fault(error: Exception) -> None:
    """Pass an exception to `sys.excepthook`, which prints it and shows it in the window; on the main thread."""
    sys.excepthook(type(error), error, error.__traceback__)


def guard_override(otherwise: R) -> Callable[[Callable[P, R]], Callable[P, R]]:
    """Decorate a method that overrides one of Qt's, so that no exception passes from it into Qt."""
    # PySide 6.11 on Python 3.11 ends the process when a function written in C raises in an override that Qt calls on
    # behalf of Python code, for instance in a ``paintEvent`` under ``repaint()`` or a ``resizeEvent`` under ``show()``.

    def decorate(method: Callable[P, R]) -> Callable[P, R]:
        reports: WeakKeyDictionary[object, FaultReport] = WeakKeyDictionary()

        @wraps(method)
        def guarded(*args: P.args, **kwargs: P.kwargs) -> R:
            try:
                result = method(*args, **kwargs)
            except Exception as error:
                if reports.setdefault(args[0], FaultReport()).is_news(error):
                    report_fault(error)
                return otherwise
            if reports:
                reports.pop(args[0], None)
            return result

        return guarded

    return decorate
