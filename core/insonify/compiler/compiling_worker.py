"""The process that compiles kernels for another one, see `compiling_process`."""

from __future__ import annotations

import contextlib
import importlib
import queue

from numba.core.serialize import loads

from insonify.compiler.progress import watch_compilation
from insonify.compiler.worker_pipe import send_answer, take_requests

IDLE = 20.0  # s, without a kernel to compile, after which the process ends


def main() -> None:
    """Compile what is asked for until nothing is for a while, or until the input ends."""
    asked = take_requests()
    with watch_compilation(send_answer), contextlib.suppress(queue.Empty):
        while True:
            name = asked.get(timeout=IDLE)
            with contextlib.suppress(Exception):  # the other process finds no code, and meets the same error
                _compile(name)
            send_answer(name)


def _compile(name: bytes) -> None:
    """Compile a kernel for types of arguments, which leaves its machine code on disk."""
    module, qualname, way, arguments = loads(name)
    getattr(getattr(importlib.import_module(module), qualname), way).compile(arguments)


if __name__ == "__main__":
    main()
