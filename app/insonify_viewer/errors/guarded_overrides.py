"""Exceptions in methods that Qt calls, reported instead of raised through Qt."""

from __future__ import annotations

import sys
import traceback
from collections.abc import Callable
from functools import wraps
from typing import ParamSpec, TypeVar
from weakref import WeakKeyDictionary

P = ParamSpec("P")
R = TypeVar("R")


def guard_override(otherwise: R) -> Callable[[Callable[P, R]], Callable[P, R]]:
    """Decorate a method that overrides one of Qt's, so that no exception passes from it into Qt.

    PySide 6.11 on Python 3.11 ends the process when a function written in C raises in an override that Qt calls on
    behalf of Python code, for instance in a ``paintEvent`` under ``repaint()`` or a ``resizeEvent`` under ``show()``.

    Parameters
    ----------
    otherwise : object
        Returned in place of the result of a call that raised.

    Returns
    -------
    callable
        Decorator. An exception is passed to `sys.excepthook`, once per object until another one is raised or a call
        succeeds: a picture that cannot be painted fails at every frame.
    """

    def decorate(method: Callable[P, R]) -> Callable[P, R]:
        told: WeakKeyDictionary[object, str] = WeakKeyDictionary()

        @wraps(method)
        def guarded(*args: P.args, **kwargs: P.kwargs) -> R:
            owner = args[0]
            try:
                result = method(*args, **kwargs)
            except Exception as error:
                if told.get(owner) != repr(error):
                    told[owner] = repr(error)
                    sys.excepthook(type(error), error, error.__traceback__)
                traceback.clear_frames(error.__traceback__)  # a painter left in a frame would keep its widget busy
                return otherwise
            if told:
                told.pop(owner, None)
            return result

        return guarded

    return decorate
