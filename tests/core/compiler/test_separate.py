"""Separate kernels: found by address at the first call, compiled once for all callers, or by a second process."""

import os
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numba
import numpy as np
import pytest

from commands import output_of
from insonify.compiler.jit import INTEGER, NOTHING, TWO_INTEGERS, kernel, kernel_on_demand
from insonify.compiler.processes import WORKER

pytestmark = pytest.mark.skipif(bool(numba.config.DISABLE_JIT), reason="nothing is compiled")


@kernel_on_demand(TWO_INTEGERS)
def halve(count, shares):
    return count // 2, int(shares[1])


@kernel_on_demand(NOTHING)
def add_one(values):
    for i in range(values.size):
        values[i] += 1.0


@kernel_on_demand(INTEGER)
def refuse(x):
    if x < 0.0:
        raise ValueError("negative")
    return 1


@kernel_on_demand(INTEGER)
def break_promise(x):
    return x + 0.5


@kernel_on_demand(INTEGER)
def never_asked_for(x):
    return x + 1


def test_a_kernel_gives_the_same_from_python_and_from_a_kernel() -> None:
    outer = kernel(lambda count: halve(count, (0.5, 3.0)))
    assert outer(11) == halve(11, (0.5, 3.0)) == (5, 3)
    values = np.zeros(3)
    kernel(lambda values: add_one(values))(values)
    np.testing.assert_array_equal(values, np.ones(3))


def test_nothing_is_compiled_before_it_is_called() -> None:
    outer = kernel(lambda x: never_asked_for(x) if x > 0 else 0)
    assert outer(0) == 0
    assert not never_asked_for.machine_code.overloads
    assert outer(1) == 2
    assert never_asked_for.machine_code.overloads


def test_threads_that_call_first_at_once_find_one_address() -> None:
    outer = kernel(lambda values: add_one(values))
    rows = np.zeros((8, 100), np.float32)
    outer(np.zeros(1))  # compiled, for other numbers
    with ThreadPoolExecutor(8) as pool:
        list(pool.map(outer, rows))
    np.testing.assert_array_equal(rows, 1.0)


def test_an_exception_passes_through_the_call() -> None:
    outer = kernel(lambda x: refuse(x))
    assert outer(1.0) == 1
    with pytest.raises(ValueError, match="negative"):
        outer(-1.0)


def test_a_kernel_that_cannot_be_compiled_says_why_instead_of_crashing() -> None:
    outer = kernel(lambda x: break_promise(x))
    with pytest.raises(TypeError, match="break_promise returns float64, not int64"):
        outer(1)


SEPARATE = """
from commands import output_of
from insonify.compiler.jit import INTEGER, kernel, kernel_on_demand, kernel_separate

@kernel_separate(INTEGER)
def square(x):
    return x * x

@kernel_on_demand(INTEGER)
def cube(x):
    return x * x * x

@kernel
def add_powers(x):
    return square(x) + cube(x) if x > 0 else 0
"""
CALL = """
import sys
from insonify.compiler import processes
from powers import add_powers, cube, square
processes.WORKER = sys.argv[2]
processes.helper.start()  # of itself it starts for kernels of this package
print(add_powers(int(sys.argv[1])), *(sum(called.machine_code.stats.cache_hits.values()) for called in (square, cube)))
"""


def call(folder: Path, x: int, threads: int, worker: str = WORKER) -> list[str]:
    """Sum of the powers of x in a new process, then how often the machine code of each power was read from disk."""
    (folder / "powers.py").write_text(SEPARATE)
    path, cache = os.pathsep.join([str(folder), *filter(None, sys.path)]), str(folder / "cache")
    more = {"NUMBA_CACHE_DIR": cache, "INSONIFY_THREADS": str(threads), "PYTHONPATH": path}
    return output_of("-c", CALL, str(x), worker, **more)


def test_machine_code_is_read_from_disk_by_later_processes(tmp_path: Path) -> None:
    assert call(tmp_path, 2, threads=1) == ["12", "0", "0"]
    assert call(tmp_path, 3, threads=1) == ["36", "1", "1"]


def test_a_second_process_compiles_what_is_not_left_to_the_first_call(tmp_path: Path) -> None:
    assert call(tmp_path, 2, threads=2) == ["12", "1", "0"]
    assert call(tmp_path, 0, threads=2) == ["0", "0", "0"]


def test_a_second_process_that_ends_early_leaves_its_kernels_to_the_first(tmp_path: Path) -> None:
    assert call(tmp_path, 2, threads=2, worker="insonify.kernels.no_such_module") == ["12", "0", "0"]
