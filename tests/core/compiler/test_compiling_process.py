"""Kernels compiled by another process: the same results, nothing compiled here, and no harm where it is missing."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numba
import numpy as np
import pytest
from numba.core import event, types
from numba.core.errors import TypingError

from insonify.compiler import cache, compiling_process
from insonify.compiler.compiling_process import CompilationStoppedError, compiled_elsewhere
from insonify.compiler.jit import kernel, kernel_on_demand
from insonify.compiler.progress import Compilation, watch_compilation
from insonify.kernels.display.rows import relate_amplitudes

pytestmark = pytest.mark.skipif(bool(numba.config.DISABLE_JIT), reason="nothing is compiled")
VALUES = np.arange(5.0)


@kernel
def sum_squares(values):
    total = 0.0
    for value in values:
        total += value * value
    return total


@kernel_on_demand(types.none)
def negate(values):
    for k in range(values.size):
        values[k] = -values[k]


@kernel
def negate_all(values):
    negate(values)


class Compiled(event.Listener):
    """Collects the names of functions that this process compiles."""

    def __init__(self) -> None:
        self.names: list[str] = []

    def on_start(self, event: Any) -> None:
        self.names.append(event.data["dispatcher"].py_func.__name__)

    def on_end(self, event: Any) -> None:
        pass


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[list[str]]:
    """Functions that this process compiles, beginning with an empty cache and unknown kernels."""
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "cache"))  # of the other process
    monkeypatch.setattr(cache, "FOLDER", tmp_path / "cache" / "insonify" / "kernels")
    for one in (sum_squares, negate, negate_all, relate_amplitudes):
        for made in ("entry", "part", "machine_code", "_names"):
            monkeypatch.delitem(vars(one), made, raising=False)
    monkeypatch.setitem(vars(negate), "_names", {})
    listener = Compiled()
    with event.install_listener("numba:compile", listener):
        yield listener.names
    assert compiling_process._elsewhere.process is None


def test_a_kernel_is_compiled_by_the_other_process(here: list[str]) -> None:
    with compiled_elsewhere():
        assert sum_squares(VALUES) == 30.0
        assert sum_squares(VALUES) == 30.0
        assert sum_squares(VALUES.astype(np.float32)) == 30.0
    assert here == []


def test_how_far_it_is_is_told_here(here: list[str]) -> None:
    told: list[Compilation | None] = []
    record = np.full((1, 3), 4.0, dtype=np.float32)
    with compiled_elsewhere(), watch_compilation(told.append):
        relate_amplitudes(record, np.ones((1, 3)), np.zeros(1, dtype=np.int64))
    np.testing.assert_array_equal(record, 2.0)
    assert here == []
    assert told[0] is not None
    assert told[0].subject == "the picture"
    assert told[-1] is None


def test_so_is_a_kernel_that_another_one_calls_by_its_address(here: list[str]) -> None:
    values = VALUES.copy()
    with compiled_elsewhere():
        negate_all(values)
    np.testing.assert_array_equal(values, -VALUES)
    assert here == []


def test_what_is_on_disk_needs_no_process(here: list[str], monkeypatch: pytest.MonkeyPatch) -> None:
    sum_squares(VALUES)
    monkeypatch.delitem(vars(sum_squares), "entry")
    with compiled_elsewhere():
        assert sum_squares(VALUES) == 30.0
        assert compiling_process._elsewhere.process is None
    assert here == ["sum_squares"]


def test_without_a_folder_for_its_code_a_kernel_is_compiled_here(
    here: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "file").touch()
    monkeypatch.setattr(cache, "FOLDER", tmp_path / "file" / "kernels")
    with compiled_elsewhere():
        assert sum_squares(VALUES) == 30.0
        assert compiling_process._elsewhere.process is None
    assert here == ["sum_squares"]


@pytest.mark.parametrize("code", ["", "import time, sys; sys.stdin.buffer.read(1)", "raise RuntimeError"])
def test_a_process_that_ends_early_is_done_without(
    code: str, here: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "ending_worker.py").write_text(code)
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(compiling_process, "WORKER", "ending_worker")
    with compiled_elsewhere():
        assert sum_squares(VALUES) == 30.0
    assert here == ["sum_squares"]


def test_a_process_that_ended_for_want_of_work_is_started_again(here: list[str]) -> None:
    with compiled_elsewhere():
        sum_squares(VALUES)
        first = compiling_process._elsewhere.process
        assert first is not None
        first.stop()
        sum_squares(VALUES.astype(np.float32))
        assert compiling_process._elsewhere.process is not first
    assert here == []


def test_what_cannot_be_compiled_fails_as_ever(here: list[str]) -> None:
    with compiled_elsewhere(), pytest.raises(TypingError):
        sum_squares(5)


def test_a_thread_that_waits_is_told_when_the_block_ends(
    here: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "sleeping_worker.py").write_text("import time; time.sleep(600)")
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(compiling_process, "WORKER", "sleeping_worker")
    ends: list[type[BaseException]] = []

    def call() -> None:
        try:
            sum_squares(VALUES)
        except BaseException as error:
            ends.append(type(error))

    thread = threading.Thread(target=call)
    with compiled_elsewhere():
        thread.start()
        while (process := compiling_process._elsewhere.process) is None or not process._asked:
            thread.join(0.01)
    thread.join(60.0)
    assert ends == [CompilationStoppedError]
    assert here == []
