"""The second process of a compilation: compiles kernels, and links and optimises parts, see `part_process`."""

from __future__ import annotations

import os
import pickle
import queue
import sys
import threading
from typing import Any

import llvmlite.binding as llvm
from numba.core.compiler_lock import global_compiler_lock
from numba.core.registry import cpu_target

from insonify.kernels.common.part_library import Source, link_part
from insonify.kernels.common.separate import find_address


def main() -> None:
    """Answer until told to leave, or until the input ends."""
    asked: queue.SimpleQueue[Any] = queue.SimpleQueue()
    threading.Thread(target=_read, args=(asked,), daemon=True).start()
    modules: dict[int, Any] = {}
    codegen = cpu_target.target_context.codegen()
    while (message := asked.get()) is not None:
        if isinstance(message, bytes):
            find_address(message)
            _answer(message)
            continue
        key, *part = message
        with global_compiler_lock:
            if key < 0:
                modules[key] = llvm.parse_bitcode(*part)
                continue
            name, sources, keys, optimised = part
            modules[key] = link_part(
                codegen, name, [Source(*source) for source in sources], [modules[k] for k in keys], optimised
            )
            _answer((key, bytes(modules[key].as_bitcode())))


def _answer(answer: bytes | tuple[int, bytes]) -> None:
    pickle.dump(answer, sys.stdout.buffer)
    sys.stdout.buffer.flush()


def _read(asked: queue.SimpleQueue[Any]) -> None:
    """Take all that is asked for at once, so that the other process does not wait; leave when it has ended."""
    try:
        while True:
            asked.put(pickle.load(sys.stdin.buffer))
    except EOFError:
        os._exit(0)


if __name__ == "__main__":
    main()
