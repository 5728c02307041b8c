"""Exceptions in methods that Qt calls, reported instead of raised through Qt."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import ParamSpec, TypeVar
from weakref import WeakKeyDictionary

from insonify_viewer.errors.fault_report import FaultReport, report_fault

P = ParamSpec("P")
R = TypeVar("R")


def guard_override(otherwise: R) -> Callable[[Callable[P, R]], Callable[P, R]]:
    """Decorate a method that overrides one of Qt's, so that no exception passes from it into Qt.

    PySide 6.11 on Python 3.11 ends the process when a function written in C raises in an override that Qt calls on
    behalf of Python code, for instance in a ``paintEvent`` under ``repaint()`` or a ``resizeEvent`` under ``show()``.
    """

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
