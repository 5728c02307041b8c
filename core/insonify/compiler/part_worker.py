"""The second process of a compilation: compiles kernels, and links and optimises parts, see `part_process`."""

from __future__ import annotations

from typing import Any

import llvmlite.binding as llvm
from numba.core.compiler_lock import global_compiler_lock
from numba.core.registry import cpu_target

from insonify.compiler.part_library import Source, link_part
from insonify.compiler.separate import find_address
from insonify.compiler.worker_pipe import send_answer, take_requests


def main() -> None:
    """Answer until told to leave, or until the input ends."""
    asked = take_requests()
    modules: dict[int, Any] = {}
    codegen = cpu_target.target_context.codegen()
    while (message := asked.get()) is not None:
        if isinstance(message, bytes):
            find_address(message)
            send_answer(message)
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
            send_answer((key, bytes(modules[key].as_bitcode())))


if __name__ == "__main__":
    main()
