"""How every kernel is compiled, and where its machine code is kept."""

from __future__ import annotations

import hashlib
import shutil
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numba.core.config
import platformdirs
from numba import njit

SETTINGS: Any = numba.core.config
# Every licence that keeps NaN and infinity meaningful: guards against them must survive.
FAST = {"nsz", "arcp", "contract", "afn", "reassoc"}
# Numba's types do not know of `_nrt`, whether references are counted; unsaid, it would be inherited from the caller.
NJIT: Callable[..., Callable[[Callable[..., Any]], Callable[..., Any]]] = njit
KEPT = 30 * 86400.0  # seconds for which machine code of other versions is kept


def _cache_folder() -> str:
    """Return a folder of machine code that belongs to these very sources.

    Numba notices a change in a kernel's own file, not in those of the kernels it calls; a folder named after all of
    them cannot serve stale code. It also lies where the user may write, wherever the package is installed.
    """
    if SETTINGS.CACHE_DIR:
        return str(SETTINGS.CACHE_DIR)
    digest = hashlib.sha256()
    for source in sorted(Path(__file__).parent.glob("*.py")):
        digest.update(source.read_bytes())
    shelf = Path(platformdirs.user_cache_dir("insonify")) / "kernels"
    folder = shelf / digest.hexdigest()[:16]
    if not folder.is_dir():
        for other in shelf.glob("*"):
            # Another version may be running; one not opened for a month is not.
            if time.time() - other.stat().st_mtime > KEPT:
                shutil.rmtree(other, ignore_errors=True)
    return str(folder)


_FOLDER = _cache_folder()


def kernel(function: Callable[..., Any]) -> Callable[..., Any]:
    """Compile a function as a kernel of this package."""
    return _kept(function, counting=True)


def lean(function: Callable[..., Any]) -> Callable[..., Any]:
    """Compile a function as a kernel of this package that counts no more than `bare` does."""
    return _kept(function, counting=False)


def _kept(function: Callable[..., Any], counting: bool) -> Callable[..., Any]:
    """Compile a function and keep its machine code."""
    # Division by zero gives infinity, as in NumPy: Python's check would cost the vector units and could only raise.
    compiled = NJIT(cache=True, nogil=True, fastmath=FAST, error_model="numpy", _nrt=counting)
    before = SETTINGS.CACHE_DIR
    SETTINGS.CACHE_DIR = _FOLDER
    try:
        return compiled(function)
    finally:
        SETTINGS.CACHE_DIR = before


def fused(function: Callable[..., Any]) -> Callable[..., Any]:
    """Compile a small part of a kernel into each of its callers: handing arrays over costs more than many a part."""
    return NJIT(nogil=True, fastmath=FAST, error_model="numpy", forceinline=True, _nrt=True)(function)


def bare(function: Callable[..., Any]) -> Callable[..., Any]:
    """Compile a small part of a kernel into each of its callers, without counting who holds the arrays it is given.

    A count costs an atomic of some 5 ns, twice for every array of every tuple that is handed on. What does not count
    may neither make arrays nor return any, nor call what returns them: its callers count.
    """
    return NJIT(nogil=True, fastmath=FAST, error_model="numpy", forceinline=True, _nrt=False)(function)


def exact(function: Callable[..., Any]) -> Callable[..., Any]:
    """Compile a small part of a kernel into each of its callers, in plain IEEE arithmetic: nothing is reordered."""
    # What is not said is inherited from the caller.
    return NJIT(nogil=True, fastmath=False, error_model="numpy", forceinline=True, _nrt=True)(function)
