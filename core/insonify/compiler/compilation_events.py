"""Numba's events of compilation, turned into the progress of one kernel at a time."""

import time
from types import FunctionType
from typing import Any

from numba.core import event

from insonify.compiler.progress import Compilation, report_progress
from insonify.compiler.separate import SeparateKernel

PACKAGE = "insonify.kernels"
WORDS = {  # by the folder of the kernel's module
    "beam": "the beam",
    "bed": "the bed",
    "common": "range bins",
    "display": "the picture",
    "geometry": "solids",
    "labels": "labels",
    "multipath": "multipath",
    "rays": "rays",
    "receiver": "the receiver",
    "refraction": "bent rays",
    "speckle": "speckle",
    "sweep": "the sweep",
    "targets": "targets",
}
UNSURE = 0.05  # share done up to which the time left is not predicted
ROOT = 0.4  # share of a kernel's time that remains when all its functions are compiled; 0.29 to 0.45 of the sweep's


class _Progress:
    """Functions that a kernel calls and that are not compiled yet, each weighed by the size of its bytecode."""

    def __init__(self, kernel: FunctionType) -> None:
        folder = kernel.__module__.removeprefix(f"{PACKAGE}.").partition(".")[0]
        self.subject, self.start = WORDS.get(folder, "kernels"), time.monotonic()
        self.left = {function: len(function.__code__.co_code) for function in called_functions(kernel)}
        self.whole = sum(self.left.values())

    def finish(self, function: FunctionType) -> None:
        """Take a function as done, with all that it calls."""
        for finished in called_functions(function):
            self.left.pop(finished, None)

    def report(self) -> Compilation:
        """Return the share done, and the time left if the rest takes as long per share."""
        done = (1.0 - ROOT) * (1.0 - sum(self.left.values()) / self.whole)
        now = time.monotonic()
        left = (now - self.start) * (1.0 / done - 1.0) if done > UNSURE else None
        return Compilation(self.subject, done, left, now)


class CompilationListener(event.Listener):
    """Reports compilations to the watchers; Numba sends all events under its lock, from one thread at a time."""

    def __init__(self) -> None:
        self.depth = 0
        self.progress: _Progress | None = None

    def on_start(self, event: Any) -> None:
        """Begin a kernel, unless the function is part of a kernel that is being compiled."""
        function = event.data["dispatcher"].py_func
        if self.depth == 0 and function.__module__.startswith(f"{PACKAGE}."):
            self.progress = _Progress(function)
            report_progress(self.progress.report())
        self.depth += 1

    def on_end(self, event: Any) -> None:
        """Report a function that is finished; the outermost function ends its kernel."""
        self.depth -= 1
        if self.progress is None:
            return
        if self.depth == 0:
            self.progress = None
            report_progress(None)
            return
        self.progress.finish(event.data["dispatcher"].py_func)
        report_progress(self.progress.report())


def called_functions(function: FunctionType) -> set[FunctionType]:
    """Collect a function and all that are compiled into it, directly or not."""
    found, pending = {function}, [function]
    while pending:
        calling = pending.pop()
        named = (calling.__globals__.get(name) for name in calling.__code__.co_names)
        parts = (value for value in named if not isinstance(value, SeparateKernel))
        called = (getattr(value, "py_func", None) for value in parts)
        new = {function for function in called if function is not None} - found
        found |= new
        pending.extend(new)
    return found


def report_compilations() -> None:
    """Report all compilations of Numba from now on."""
    event.register("numba:compile", CompilationListener())
