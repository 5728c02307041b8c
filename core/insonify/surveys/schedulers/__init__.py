"""Schedulers of dask.distributed that run jobs: a kind is one module here that holds a `SchedulerKind`."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass
from typing import Any

from insonify.errors import SceneError
from insonify.plugins import announced, modules_in

GROUP = "insonify.schedulers"
PACKAGE = "insonify.surveys.schedulers"


@dataclass(frozen=True)
class SchedulerKind:
    """How jobs come to workers."""

    prefix: str  # beginning of the option's text, such as ``local``; a ``:`` follows it or it ends there
    form: str  # the whole text, for help and errors
    # Takes the text after the prefix and its ``:``, and returns a context manager that yields a ``Client``.
    connect: Callable[[str], AbstractContextManager[Any]]


def find_schedulers() -> dict[str, SchedulerKind]:
    """Return the kinds by their prefixes: those of this package and those that installed packages announce."""
    modules = [value for module in modules_in(PACKAGE) for value in vars(module).values()]
    found = [value for value in modules if isinstance(value, SchedulerKind)]
    return {kind.prefix: kind for kind in (*found, *(entry.load() for entry in announced(GROUP)))}


def choose_scheduler(text: str) -> tuple[SchedulerKind, str]:
    """Find the kind of scheduler that a text asks for, and the rest of the text."""
    prefix, _, rest = text.partition(":")
    known = find_schedulers()
    if prefix not in known:
        forms = " or ".join(kind.form for kind in known.values())
        raise SceneError(f"--scheduler {text}: {prefix!r} is no kind of scheduler; write {forms}")
    return known[prefix], rest


@contextmanager
def connected(text: str) -> Iterator[Any]:
    """Yield a client of the scheduler that a text asks for."""
    kind, rest = choose_scheduler(text)
    try:
        import distributed  # noqa: F401  # lazy: an optional extra
    except ImportError:
        raise SceneError(
            "surveys and data sets need dask.distributed, which is not installed; run: pip install 'insonify[surveys]'"
        ) from None
    with kind.connect(rest) as client:
        yield client
