"""The child process that compiles kernels (`processes`)."""

import contextlib
import importlib
from collections.abc import Callable
from typing import Any

from insonify.child_process import serve
from insonify.compiler.dispatch import compile_named
from insonify.compiler.progress import watch_compilation

IDLE = 20.0  # s, without a kernel to compile, after which the process ends


def main() -> None:
    """Compile requested kernels, which leaves their machine code on disk."""
    serve(_answer, IDLE)


def _answer(request: bytes | str, send: Callable[[Any], None]) -> None:
    with (
        watch_compilation(send),
        contextlib.suppress(Exception),
    ):  # the parent then finds no code and raises the error itself
        if isinstance(request, str):
            module, _, name = request.partition(":")
            getattr(importlib.import_module(module), name)()
        else:
            compile_named(request)
    send(request)
