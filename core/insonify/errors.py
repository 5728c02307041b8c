"""The error that reports a mistake in a scene or a file to the user."""

import sys
import warnings
from collections.abc import Iterator
from contextlib import contextmanager

MOST_DIGITS = 20  # of a count
OWN = ("insonify", "insonify_viewer", "contextlib")  # packages between a warning and the line that it is about

# Control characters, which a terminal obeys, and marks that turn the direction of text; tabs and ends of lines stay.
_UNSAFE = dict.fromkeys(
    [*(c for c in range(0x20) if chr(c) not in "\t\n\r"), *range(0x7F, 0xA0), 0x61C, 0x200E, 0x200F,
     *range(0x202A, 0x202F), *range(0x2066, 0x206A)]
)  # fmt: skip


def plain_text(text: str) -> str:
    """Text of a file as it may be shown: without characters that a terminal or a window would obey."""
    return text.translate(_UNSAFE)


def is_count(text: str) -> bool:
    """Whether text is a whole number in decimal digits, and so few that Python converts them."""
    return text.isascii() and text.isdecimal() and len(text) < MOST_DIGITS


class SceneError(ValueError):
    """A mistake in a scene, in one sentence that names the field, the value and the remedy."""


class FileWarning(UserWarning):
    """What to know of a file that is used: a part that cannot be, or a better way to write it, in one sentence."""


class ExtensionWarning(FileWarning):
    """An extension that an installed package announces is left out, in one sentence with the cause."""


class PlanWarning(UserWarning):
    """The estimated error of a record or of some pings exceeds the tolerance, in one sentence with the remedy."""


def warn_caller(warning: Warning) -> None:
    """Warn at the line outside this package that led here: that one can be changed, or filtered by its module."""
    frame, level = sys._getframe(1), 2
    while frame.f_back is not None and str(frame.f_globals.get("__name__")).partition(".")[0] in OWN:
        frame, level = frame.f_back, level + 1
    warnings.warn(warning, stacklevel=level)


@contextmanager
def located(where: str) -> Iterator[None]:
    """Put a place in front of an error within, such as ``lesson beams: ``, or ``targets.0.`` before its field."""
    try:
        yield
    except SceneError as error:
        raise SceneError(f"{where}{error}") from None
