"""Kernels compiled by `numba.njit` alone, for versions of Numba whose private interfaces have changed."""

import contextlib
from collections.abc import Callable
from typing import Any

from numba import njit

from insonify.compiler.digests import FOLDER, PRIVATE, digest_of, settings


def compile_plainly(function: Callable[..., Any], kept: bool, options: dict[str, Any]) -> Callable[..., Any]:
    """Compile a function by Numba's decorator; machine code is kept in Numba's own cache, where it has a place."""
    compiled = njit(**options)(function)
    if kept and PRIVATE:
        # Numba notices changes of a function's own file alone: here each digest of the sources has a folder.
        before, settings.CACHE_DIR = settings.CACHE_DIR, str(FOLDER / f"plain-{digest_of(function.__module__, '')}")
        with contextlib.suppress(RuntimeError, OSError):  # without a file, or a folder that can be written
            compiled.enable_caching()
        settings.CACHE_DIR = before
    return compiled
