"""An error as one sentence, with the traceback where it is a fault of the program."""

from __future__ import annotations

import traceback
from typing import NamedTuple

from insonify.scene import SceneError


class Failure(NamedTuple):
    """What went wrong."""

    sentence: str  # for the person
    trace: str = ""  # where it went wrong, as Python tells it; empty for a mistake in a scene, a file or a number


def describe_error(error: BaseException, what: str = "this") -> Failure:
    """Describe an exception; ``what`` is named as that which failed where it is a fault of the program."""
    if isinstance(error, SceneError):
        return Failure(str(error), "" if error.__cause__ is None else format_trace(error.__cause__))
    if isinstance(error, OSError):
        return Failure(f"{error.filename}: {error.strerror or error}; check that the folder can be written to")
    return Failure(f"{what} failed ({type(error).__name__}: {error})", format_trace(error))


def format_trace(error: BaseException) -> str:
    """Format the traceback of an exception."""
    return "".join(traceback.format_exception(error))
