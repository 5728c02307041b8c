"""Errors of slots that nothing caught: the window says so and goes on."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import TracebackType

from insonify.scene import SceneError
from insonify_viewer.errors.failure import Failure, describe_error, format_trace


@contextmanager
def told_errors(complain: Callable[[Failure], None]) -> Iterator[None]:
    """Tell the person of every exception that no slot caught, besides writing faults to standard error.

    A `SceneError` is no fault: a file of the scene may be damaged or removed while the window shows it.
    """
    before = sys.excepthook

    def tell(kind: type[BaseException], error: BaseException, trace: TracebackType | None) -> None:
        if isinstance(error, SceneError):
            complain(describe_error(error))
            return
        before(kind, error, trace)
        if isinstance(error, Exception):
            sentence = f"this is a fault of the program ({kind.__name__}: {error}); save the scene and go on"
            complain(Failure(sentence, format_trace(error)))

    sys.excepthook = tell
    try:
        yield
    finally:
        sys.excepthook = before
