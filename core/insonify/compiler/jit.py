"""Decorators that compile kernels; the table says which one a function takes.

=========================  =======================  ===========  =====================  ==================
decorator                  called by a kernel       on disk      counts references      arithmetic
=========================  =======================  ===========  =====================  ==================
`kernel`                   a function of its own    yes          yes                    relaxed (`FAST`)
`kernel_uncounted`         a function of its own    yes          no                     relaxed (`FAST`)
`kernel_separate`          by its address           yes          optional               relaxed (`FAST`)
`inlined`                  inlined                  no           yes                    relaxed (`FAST`)
`inlined_uncounted`        inlined                  no           no                     relaxed (`FAST`)
`inlined_ieee`             inlined                  no           yes                    IEEE 754, in order
`inlined_before_typing`    inlined                  no           as its caller          as its caller
=========================  =======================  ===========  =====================  ==================

Reference counting costs an atomic operation of about 5 ns, twice for every array of every tuple passed to a function.
A function that does not count references may neither create nor return arrays, nor call one that returns them: its
callers count. Small functions are inlined because passing a tuple of arrays costs more than many of them compute.

What is called by its address is compiled once for all kernels that call it, when it is first called (`separate`): a
scene compiles what it runs.

With ``INSONIFY_COMPILER=numba`` all of them are plain `numba.njit`, which compiles the same code several times over and
takes longer, but relies on nothing private of Numba.
"""

import contextlib
import os
from collections.abc import Callable
from typing import Any

from numba import njit, types

from insonify.compiler.digests import FOLDER, PRIVATE, digest_of, settings

Function = Callable[..., Any]
# Every licence that keeps NaN and infinity meaningful: guards against them must survive.
FAST = {"nsz", "arcp", "contract", "afn", "reassoc"}
# Division by zero gives infinity, as in NumPy: Python's check would cost the vector units and could only raise.
COMMON: dict[str, Any] = {"nogil": True, "error_model": "numpy"}
NOTHING, INTEGER, TWO_INTEGERS = types.none, types.intp, types.UniTuple(types.intp, 2)  # what separate kernels return
PLAIN = os.environ.get("INSONIFY_COMPILER") == "numba"

if not PLAIN:
    from insonify.compiler.compilation_events import report_compilations
    from insonify.compiler.dispatch import Kernel
    from insonify.compiler.separate import SeparateKernel

    report_compilations()


def kernel(function: Function) -> Function:
    """Compile a function as a kernel of this package and keep its machine code on disk."""
    return _compile(function, counting=True)


def kernel_uncounted(function: Function) -> Function:
    """Compile a function as a kernel that does not count references, and keep its machine code on disk."""
    return _compile(function, counting=False)


def kernel_separate(returned: Any, counting: bool = False) -> Callable[[Function], Function]:
    """Compile a function when a kernel first calls it, by default without counting references."""

    def compile_separately(function: Function) -> Function:
        if PLAIN or settings.DISABLE_JIT:
            return _compile(function, counting)
        return SeparateKernel(function, COMMON | {"fastmath": FAST, "_nrt": counting}, returned)

    return compile_separately


def inlined(function: Function) -> Function:
    """Compile a small function into each of its callers."""
    return _compile(function, counting=True, kept=False, forceinline=True)


def inlined_uncounted(function: Function) -> Function:
    """Compile a small function into each of its callers, without counting references."""
    return _compile(function, counting=False, kept=False, forceinline=True)


def inlined_ieee(function: Function) -> Function:
    """Compile a small function into each of its callers, in IEEE arithmetic that is never reordered."""
    return _compile(function, counting=True, kept=False, forceinline=True, fastmath=False)


def inlined_before_typing(function: Function) -> Function:
    """Write a small function out in each of its callers before types are inferred."""
    # The per-cell loops of rays run faster so; types are inferred in every caller again, which takes longer to compile.
    return njit(**COMMON, fastmath=FAST, inline="always")(function)


def _compile(function: Function, counting: bool, kept: bool = True, **options: Any) -> Function:
    # `fastmath` and `_nrt` are always given: an option left out is inherited from the caller.
    options = COMMON | {"fastmath": FAST} | options
    if settings.DISABLE_JIT:
        return function
    return _compile_plainly(function, kept, options) if PLAIN else Kernel(function, options | {"_nrt": counting}, kept)


def _compile_plainly(function: Function, kept: bool, options: dict[str, Any]) -> Function:
    """Compile a function by Numba's decorator; machine code is kept in Numba's own cache, where it has a place."""
    compiled = njit(**options)(function)
    if kept and PRIVATE:
        # Numba notices changes of a function's own file alone: here each digest of the sources has a folder.
        before, settings.CACHE_DIR = settings.CACHE_DIR, str(FOLDER / f"plain-{digest_of(function.__module__, '')}")
        with contextlib.suppress(RuntimeError, OSError):  # without a file, or a folder that can be written
            compiled.enable_caching()
        settings.CACHE_DIR = before
    return compiled
