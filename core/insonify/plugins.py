"""Find extensions: the modules of a package, and the entry points that installed packages announce."""

import pkgutil
from collections.abc import Callable, Container, Iterable
from functools import cache
from importlib import import_module
from importlib.metadata import EntryPoint, entry_points
from types import ModuleType
from typing import Any

from insonify.errors import ExtensionWarning, warn_caller


def modules_in(package: str, *, without: Container[str] = ()) -> list[ModuleType]:
    """Import every module of a package but some, in the order of their names."""
    names = [found.name for found in pkgutil.iter_modules(import_module(package).__path__)]
    return [import_module(f"{package}.{name}") for name in names if name not in without]


def announced(group: str) -> Iterable[EntryPoint]:
    """Entry points of a group, such as ``insonify.commands``, over all installed packages."""
    found: Iterable[EntryPoint] = _entry_points().select(group=group)
    return found


@cache
def extensions(package: str, group: str) -> tuple[Any, ...]:
    """Return the modules of a package, if it is named, and what a group's entry points hold, all imported once."""
    return (*(modules_in(package) if package else ()), *loaded(announced(group)))


def loaded(entries: Iterable[EntryPoint], use: Callable[[Any], Any] = lambda held: held) -> list[Any]:
    """Return what becomes of what entry points hold; one that cannot be loaded or used is named, and left out."""
    found = []
    for entry in entries:
        try:
            found.append(use(entry.load()))
        except (Exception, SystemExit) as error:  # any package may be broken in any way
            sentence = f"{entry.name!r} of {entry.value} is left out ({type(error).__name__}: {error})"
            warn_caller(ExtensionWarning(f"{sentence}; update or remove the package that announces it"))
    return found


_entry_points: Any = cache(entry_points)  # looked up once: it takes 2 ms, and every family of kinds needs them
