"""Modules of a stranger in a folder, by every name that a program may import."""

import os
import sys
from collections.abc import Collection
from importlib.metadata import packages_distributions
from pathlib import Path

# It leaves a trace, and ends the process that imports it.
MODULE = "import posix\nposix.close(posix.open({trace!r} + __name__, posix.O_CREAT))\nposix._exit(77)\n"


def write_modules(folder: Path, left_out: Collection[str] = ()) -> None:
    """Write a module for every one of the standard library and of the installed packages, but for some names."""
    (folder / "traces").mkdir()
    names = {*sys.stdlib_module_names, *packages_distributions(), "sitecustomize"}.difference(left_out)
    for name in filter(str.isidentifier, names):
        (folder / f"{name}.py").write_text(MODULE.format(trace=f"{folder / 'traces'}{os.sep}"))


def traces(folder: Path) -> set[str]:
    """Names of the modules that were imported from a folder."""
    return {path.name for path in (folder / "traces").iterdir()}
