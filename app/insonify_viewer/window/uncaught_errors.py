"""Errors that no slot caught, and warnings about files: the window shows them and continues."""

import sys
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import TracebackType
from typing import Any

from insonify.errors import FileWarning, PlanWarning
from insonify.scene import SceneError
from insonify_viewer.errors import Failure, cause_of, describe_error, format_trace


@contextmanager
def reported_errors(complain: Callable[[Failure], None]) -> Iterator[None]:
    """Show every exception that no slot caught in the window; faults are also written to standard error."""
    # A `SceneError` is no fault: a file of the scene may be damaged or removed while the window shows it.
    before = sys.excepthook

    def tell(kind: type[BaseException], error: BaseException, trace: TracebackType | None) -> None:
        if error is not (error := cause_of(error)):
            kind, trace = type(error), error.__traceback__
        if isinstance(error, SceneError):
            complain(describe_error(error))
            return
        before(kind, error, trace)
        if isinstance(error, Exception):
            sentence = f"this is a bug in insonify ({kind.__name__}: {error}); save the scene before you continue"
            complain(Failure(sentence, format_trace(error)))

    sys.excepthook = tell
    try:
        yield
    finally:
        sys.excepthook = before


@contextmanager
def reported_warnings(tell: Callable[[str], None]) -> Iterator[None]:
    """Show warnings about incomplete files and inaccurate plans in the window; others are written as before."""
    before = warnings.showwarning

    def show(message: Warning | str, category: type[Warning], *where: Any, **more: Any) -> None:
        if issubclass(category, (FileWarning, PlanWarning)):
            tell(" ".join(str(message).split()))
        else:
            before(message, category, *where, **more)

    with warnings.catch_warnings():
        for category in (FileWarning, PlanWarning):
            warnings.simplefilter("always", category)
        warnings.showwarning = show
        yield
