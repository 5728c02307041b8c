"""Faults of the program that were caught, reported like those that nothing catches."""

from __future__ import annotations

import sys


class FaultReport:
    """Reports the faults of one source, such as a picture that fails at every frame.

    A fault is reported again only after another one or after a success.
    """

    def __init__(self) -> None:
        self._last = ""

    def is_news(self, error: Exception) -> bool:
        """Whether a fault is to be reported."""
        known, self._last = self._last, repr(error)
        return self._last != known

    def forget(self) -> None:
        """Note a success."""
        self._last = ""


def report_fault(error: Exception) -> None:
    """Pass an exception to `sys.excepthook`, which prints it and tells the person; on the main thread."""
    sys.excepthook(type(error), error, error.__traceback__)
