"""The process that compiles kernels for another one, see `compiling_process`."""

from __future__ import annotations

import contextlib
import importlib
import os
import pickle
import queue
import sys
import threading

from numba.core.serialize import loads

from insonify.kernels.common.compilation import Compilation, watch_compilation

IDLE = 20.0  # s, without a kernel to compile, after which the process ends


def main() -> None:
    """Compile what is asked for until nothing is for a while, or until the input ends."""
    asked: queue.SimpleQueue[bytes] = queue.SimpleQueue()
    threading.Thread(target=_read, args=(asked,), daemon=True).start()
    with watch_compilation(_answer), contextlib.suppress(queue.Empty):
        while True:
            name = asked.get(timeout=IDLE)
            with contextlib.suppress(Exception):  # the other process finds no code, and meets the same error
                _compile(name)
            _answer(name)


def _compile(name: bytes) -> None:
    """Compile a kernel for types of arguments, which leaves its machine code on disk."""
    module, qualname, way, arguments = loads(name)
    getattr(getattr(importlib.import_module(module), qualname), way).compile(arguments)


def _answer(answer: bytes | Compilation | None) -> None:
    pickle.dump(answer, sys.stdout.buffer)
    sys.stdout.buffer.flush()


def _read(asked: queue.SimpleQueue[bytes]) -> None:
    """Take all that is asked for at once; leave when the other process has ended."""
    try:
        while True:
            asked.put(pickle.load(sys.stdin.buffer))
    except EOFError:
        os._exit(0)


if __name__ == "__main__":
    main()
