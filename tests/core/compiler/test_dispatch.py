"""Functions that Python calls and those that kernels call: parts of their callers, or separate machine code."""

import os
import sys
from concurrent.futures import ThreadPoolExecutor

import numba
import numpy as np
import pytest

from commands import output_of
from insonify.compiler.cache import PartLibrary
from insonify.compiler.dispatch import Kernel
from insonify.compiler.jit import INTEGER, NOTHING, TWO_INTEGERS, inlined, kernel, kernel_on_demand
from insonify.compiler.processes import WORKER

pytestmark = pytest.mark.skipif(bool(numba.config.DISABLE_JIT), reason="nothing is compiled")


@inlined
def half(x):
    return 0.5 * x


@inlined
def lengthen(values, by=1):
    return np.full(values.size + by, half(values.sum()))


@kernel_on_demand(TWO_INTEGERS)
def halve(count, shares):
    return count // 2, int(shares[1])


@kernel_on_demand(NOTHING)
def add_one(values):
    for i in range(values.size):
        values[i] += 1.0


@kernel_on_demand(INTEGER)
def refuse(x):
    if x > 8.0:
        raise ValueError("above 8")
    return 1


@kernel_on_demand(INTEGER)
def break_promise(x):
    return x + 0.5


@kernel_on_demand(INTEGER)
def never_asked_for(x):
    return x + 1


def test_a_part_gives_the_same_from_python_and_from_a_kernel():
    outer = kernel(lambda values: lengthen(values))
    assert half(3.0) == 1.5
    np.testing.assert_array_equal(outer(np.ones(3)), lengthen(np.ones(3)))
    np.testing.assert_array_equal(lengthen(np.ones(3), by=2), np.full(5, 1.5))


def test_a_separate_kernel_gives_the_same_from_python_and_from_a_kernel():
    outer = kernel(lambda count: halve(count, (0.5, 3.0)))
    assert outer(11) == halve(11, (0.5, 3.0)) == (5, 3)
    values = np.zeros(3)
    kernel(lambda values: add_one(values))(values)
    np.testing.assert_array_equal(values, np.ones(3))


def test_an_exception_passes_through_parts_and_separate_calls():
    @inlined
    def refuse_part(x):
        if x < 0.0:
            raise ValueError("negative part")
        return refuse(x)

    outer = kernel(lambda x: refuse_part(x))
    assert outer(1.0) == 1
    for x, told in ((-1.0, "negative part"), (9.0, "above 8")):
        with pytest.raises(ValueError, match=told):
            outer(x)
    with pytest.raises(TypeError, match="break_promise returns float64, not int64"):  # instead of a crash
        kernel(lambda x: break_promise(x))(1)


def test_a_function_that_kernels_alone_call_has_no_machine_code(tmp_path, monkeypatch):
    monkeypatch.setattr(numba.core.config, "CACHE_DIR", str(tmp_path))  # a kernel read from disk asks for no parts

    @inlined
    def double(values):
        return np.full(values.size, 2.0 * values.sum())

    outer = kernel(lambda values: double(values))
    outer(np.ones(2))
    assert isinstance(double, Kernel)
    assert double.part.signatures
    for compiled in double.part.overloads.values():
        assert isinstance(compiled.library, PartLibrary)
        assert not compiled.library.codegen._engine.is_symbol_defined(compiled.fndesc.mangled_name)


def test_nothing_is_compiled_before_it_is_called():
    outer = kernel(lambda x: never_asked_for(x) if x > 0 else 0)
    assert outer(0) == 0
    assert not never_asked_for.machine_code.overloads
    assert outer(1) == 2
    assert never_asked_for.machine_code.overloads


def test_threads_that_call_first_at_once_find_one_address():
    outer = kernel(lambda values: add_one(values))
    rows = np.zeros((8, 100), np.float32)
    outer(np.zeros(1))  # compiled, for other numbers
    with ThreadPoolExecutor(8) as pool:
        list(pool.map(outer, rows))
    np.testing.assert_array_equal(rows, 1.0)


PARTS = """
import sys
from insonify.compiler.jit import kernel

@kernel
def square(x):
    return x * x

@kernel
def fourth(x):
    return square(square(x))

@kernel
def eighth(x):
    return square(fourth(x))

called = globals()[sys.argv[1]]
print(called(2.0), *(sum(found.stats.cache_hits.values()) for found in (called.entry, square.part, fourth.part)))
"""


def test_parts_are_read_from_disk_by_kernels_that_are_compiled_later(tmp_path):
    source = tmp_path / "kernels.py"
    source.write_text(PARTS)

    def call(name: str) -> list[str]:
        return output_of(str(source), name, NUMBA_CACHE_DIR=str(tmp_path))

    assert call("fourth") == ["16.0", "0", "0", "0"]
    assert call("eighth") == ["256.0", "0", "1", "0"]
    assert call("eighth") == ["256.0", "1", "0", "0"]
    source.write_text(PARTS.replace("fourth(x))", "fourth(x)) + 1.0"))
    assert call("eighth") == ["257.0", "0", "0", "0"]


SEPARATE = """
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


@pytest.mark.parametrize(
    ("threads", "worker", "calls"),
    [
        (1, WORKER, {2: ["12", "0", "0"], 3: ["36", "1", "1"]}),
        (2, WORKER, {2: ["12", "1", "0"], 0: ["0", "0", "0"]}),
        (2, "insonify.kernels.no_such_module", {2: ["12", "0", "0"]}),
    ],
    ids=["one process", "a second process", "a second process that ends early"],
)
def test_separate_machine_code_is_read_from_disk(tmp_path, threads, worker, calls):
    """By later processes, and where a second process has compiled what is not left to the first call."""
    (tmp_path / "powers.py").write_text(SEPARATE)
    path, cache = os.pathsep.join([str(tmp_path), *filter(None, sys.path)]), str(tmp_path / "cache")
    more = {"NUMBA_CACHE_DIR": cache, "INSONIFY_THREADS": str(threads), "PYTHONPATH": path}
    for x, expected in calls.items():
        assert output_of("-c", CALL, str(x), worker, **more) == expected
