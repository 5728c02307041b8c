"""Kernels compiled by another process: the same results, nothing compiled here, and no harm where it is missing."""

from concurrent.futures import ThreadPoolExecutor

import numba
import numpy as np
import pytest
from numba.core import event, types
from numba.core.errors import TypingError

from commands import wait_until
from insonify.compiler import digests, processes
from insonify.compiler.jit import inlined, kernel, kernel_separate
from insonify.compiler.processes import CompilationStoppedError, compiled_elsewhere
from insonify.compiler.progress import watch_compilation
from insonify.kernels.display.rows import relate_amplitudes

pytestmark = pytest.mark.skipif(bool(numba.config.DISABLE_JIT), reason="nothing is compiled")
VALUES = np.arange(5.0)


@kernel
def sum_squares(values):
    total = 0.0
    for value in values:
        total += value * value
    return total


@inlined
def halve(value):
    return 0.5 * value


@kernel_separate(types.none)
def negate(values):
    for k in range(values.size):
        values[k] = -values[k]


@kernel
def negate_all(values):
    negate(values)


@pytest.fixture
def here(tmp_path, monkeypatch):
    """Names of the functions that this process compiles, without a cache or known kernels, in a hostile folder.

    The other process would end if it imported modules of that folder, and its kernels would be compiled here.
    """
    for name in ("json", "pickle", "queue", "threading"):
        (tmp_path / f"{name}.py").write_text("raise SystemExit")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("PYTHONPATH", ".")
    for folder in (str(tmp_path), ""):
        monkeypatch.syspath_prepend(folder)
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "cache"))  # of the other process
    monkeypatch.setattr(digests, "FOLDER", tmp_path / "cache" / "insonify" / "kernels")
    for one in (halve, sum_squares, negate, negate_all, relate_amplitudes):
        for made in ("entry", "part", "machine_code"):
            monkeypatch.delitem(vars(one), made, raising=False)
    with event.install_recorder("numba:compile") as recorder:
        yield lambda: [one.data["dispatcher"].py_func.__name__ for _, one in recorder.buffer if one.is_start]
    assert processes.elsewhere.process is None


def test_what_is_compiled_into_its_callers_alone_is_compiled_here_when_python_calls_it(here):
    """No file would bring it from the other process."""
    with compiled_elsewhere():
        assert halve(3.0) == 1.5
    assert here() == ["halve"]


def test_kernels_are_compiled_by_the_other_process_which_is_started_again_where_it_ended(here):
    values, told = VALUES.copy(), []
    record = np.full((1, 3), 4.0, dtype=np.float32)
    with compiled_elsewhere(), watch_compilation(told.append):
        assert sum_squares(VALUES) == 30.0
        assert sum_squares(VALUES) == 30.0
        assert sum_squares(VALUES.astype(np.float32)) == 30.0
        negate_all(values)  # which calls another one by its address
        first = processes.elsewhere.process
        assert first is not None
        first.stop()  # as it does for want of work
        relate_amplitudes(record, np.ones((1, 3)), np.zeros(1, dtype=np.int64))
        assert processes.elsewhere.process is not first
        assert here() == []
        with pytest.raises(TypingError):  # as without the other process
            sum_squares(5)
    np.testing.assert_array_equal(values, -VALUES)
    np.testing.assert_array_equal(record, 2.0)
    assert "the picture" in {one.subject for one in told if one is not None}
    assert told[-1] is None


def test_what_is_on_disk_needs_no_process(here, monkeypatch):
    sum_squares(VALUES)
    monkeypatch.delitem(vars(sum_squares), "entry")
    with compiled_elsewhere():
        assert sum_squares(VALUES) == 30.0
        assert processes.elsewhere.process is None
    assert here() == ["sum_squares"]


def test_without_a_folder_for_its_code_a_kernel_is_compiled_here(here, tmp_path, monkeypatch):
    (tmp_path / "file").touch()
    monkeypatch.setattr(digests, "FOLDER", tmp_path / "file" / "kernels")
    with compiled_elsewhere():
        assert sum_squares(VALUES) == 30.0
        assert processes.elsewhere.process is None
    assert here() == ["sum_squares"]


@pytest.mark.parametrize("code", ["", "def main(): import sys; sys.stdin.buffer.read(1)", "raise RuntimeError"])
def test_a_process_that_ends_early_is_done_without(code, here, tmp_path, monkeypatch):
    (tmp_path / "ending_worker.py").write_text(code)
    monkeypatch.setattr(processes, "WORKER", "ending_worker")
    with compiled_elsewhere():
        assert sum_squares(VALUES) == 30.0
    assert here() == ["sum_squares"]


def test_a_thread_that_waits_is_told_when_the_block_ends(here, tmp_path, monkeypatch):
    (tmp_path / "sleeping_worker.py").write_text("def main(): import time; time.sleep(600)")
    monkeypatch.setattr(processes, "WORKER", "sleeping_worker")
    with ThreadPoolExecutor() as pool:
        with compiled_elsewhere():
            call = pool.submit(sum_squares, VALUES)
            wait_until(lambda: (process := processes.elsewhere.process) is not None and process.pending)
        assert type(call.exception(60.0)) is CompilationStoppedError
    assert here() == []
