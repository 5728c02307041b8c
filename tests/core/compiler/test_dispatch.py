"""Functions that Python calls and those that kernels call: parts of their callers, or separate machine code."""

from concurrent.futures import ThreadPoolExecutor

import numba
import numpy as np
import pytest

from commands import output_of
from insonify.compiler.cache import PartLibrary
from insonify.compiler.dispatch import Kernel
from insonify.compiler.jit import INTEGER, NOTHING, TWO_INTEGERS, inlined, kernel, kernel_separate

pytestmark = pytest.mark.skipif(bool(numba.config.DISABLE_JIT), reason="nothing is compiled")


@inlined
def half(x):
    return 0.5 * x


@inlined
def lengthen(values, by=1):
    return np.full(values.size + by, half(values.sum()))


@kernel_separate(TWO_INTEGERS)
def halve(count, shares):
    return count // 2, int(shares[1])


@kernel_separate(NOTHING)
def add_one(values):
    for i in range(values.size):
        values[i] += 1.0


@kernel_separate(INTEGER)
def refuse(x):
    if x > 8.0:
        raise ValueError("above 8")
    return 1


@kernel_separate(INTEGER)
def break_promise(x):
    return x + 0.5


@kernel_separate(INTEGER)
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
import sys
from insonify.compiler.jit import INTEGER, kernel, kernel_separate

@kernel_separate(INTEGER)
def square(x):
    return x * x

@kernel
def add_square(x):
    return square(x) + x if x > 0 else 0

print(add_square(int(sys.argv[1])), sum(square.machine_code.stats.cache_hits.values()))
"""


def test_separate_machine_code_is_read_from_disk(tmp_path):
    source = tmp_path / "powers.py"
    source.write_text(SEPARATE)
    for x, expected in ((0, ["0", "0"]), (2, ["6", "0"]), (3, ["12", "1"]), (0, ["0", "0"])):
        assert output_of(str(source), str(x), NUMBA_CACHE_DIR=str(tmp_path / "cache")) == expected
