"""A second process links parts of kernels: the same code as here, and no harm where it is missing."""

from __future__ import annotations

import os
import signal
from collections.abc import Iterator
from typing import Any

import llvmlite.binding as llvm
import numba
import numpy as np
import pytest

from insonify.compiler import part_process
from insonify.compiler.jit import inlined, kernel
from insonify.compiler.part_library import link_part
from insonify.compiler.part_process import (
    PartProcess,
    end_process,
    running_process,
    start_process,
    stop_processes,
)

pytestmark = pytest.mark.skipif(bool(numba.config.DISABLE_JIT), reason="nothing is compiled")
VALUES = np.arange(5.0)
KILLED = -signal.SIGKILL if os.name == "posix" else 1


@pytest.fixture(autouse=True)
def _two_cores(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    monkeypatch.setattr(part_process, "default_threads", lambda: 2)
    yield
    end_process()


def make_kernel() -> tuple[Any, Any, Any]:
    """Sum of squares; with what it calls."""

    @inlined
    def square(x):
        return x * x

    @inlined
    def add_squares(values):
        total = 0.0
        for value in values:
            total += square(value)
        return total

    return kernel(lambda values: add_squares(values) + square(1.0)), square, add_squares


def test_a_second_process_makes_the_same_code(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: dict[int, tuple[Any, ...]] = {}
    link = PartProcess.link

    def keep(self: PartProcess, key: int, *part: Any) -> None:
        asked[key] = part
        link(self, key, *part)

    monkeypatch.setattr(PartProcess, "link", keep)
    start_process()
    outer, *called = make_kernel()
    assert outer(VALUES) == 31.0
    assert len(asked) == 2
    for library in (compiled.library for function in called for compiled in function.part.overloads.values()):
        name, sources, libraries, optimised = asked[library.key]
        modules = [other._get_module_for_linking() for other in libraries]
        here = bytes(link_part(library.codegen, name, sources, modules, optimised).as_bitcode())
        assert str(llvm.parse_bitcode(library.to_bitcode())) == str(llvm.parse_bitcode(here))


def test_parts_are_linked_here_when_the_process_ends_early(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(part_process, "WORKER", "insonify.kernels.no_such_module")
    start_process()
    outer, *_ = make_kernel()
    assert outer(VALUES) == 31.0


def test_parts_that_are_not_waited_for_are_saved() -> None:
    saved = []
    start_process()
    process = running_process()
    assert process is not None
    outer, _, add_squares = make_kernel()
    assert outer(VALUES) == 31.0
    (compiled,) = add_squares.part.overloads.values()
    process.unsaved.append(lambda: saved.append(compiled.library.to_bitcode()))
    end_process()
    assert saved
    assert running_process() is None


def test_processes_that_still_compile_are_stopped() -> None:
    start_process()
    process = running_process()
    assert process is not None
    process.compile(b"a kernel that takes long")
    end_process()
    assert process._reader.is_alive(), "it compiles on"
    stop_processes()
    assert process._process.returncode == KILLED, "it is not waited for"
    assert not process._reader.is_alive()
    process.wait_for(b"a kernel that takes long")  # at once: it is compiled here


def test_one_core_is_left_to_one_process(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(part_process, "default_threads", lambda: 1)
    start_process()
    assert running_process() is None
