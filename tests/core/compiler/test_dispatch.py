"""Functions that Python calls and those that kernels call: one result, and no machine code of what is only a part."""

from pathlib import Path

import numba
import numpy as np
import pytest

from commands import output_of
from insonify.compiler.cache import PartLibrary
from insonify.compiler.dispatch import Kernel
from insonify.compiler.jit import inlined, kernel

pytestmark = pytest.mark.skipif(bool(numba.config.DISABLE_JIT), reason="nothing is compiled")


@inlined
def half(x):
    return 0.5 * x


@inlined
def lengthen(values, by=1):
    return np.full(values.size + by, half(values.sum()))


KERNELS = """
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


def test_a_function_gives_the_same_from_python_and_from_a_kernel():
    outer = kernel(lambda values: lengthen(values))
    assert half(3.0) == 1.5
    np.testing.assert_array_equal(outer(np.ones(3)), lengthen(np.ones(3)))
    np.testing.assert_array_equal(lengthen(np.ones(3), by=2), np.full(5, 1.5))


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


def test_an_exception_passes_through_parts():
    @inlined
    def refuse(x):
        if x < 0.0:
            raise ValueError("negative")
        return x

    outer = kernel(lambda x: refuse(x))
    assert outer(1.0) == 1.0
    with pytest.raises(ValueError, match="negative"):
        outer(-1.0)


def test_parts_are_read_from_disk_by_kernels_that_are_compiled_later(tmp_path: Path) -> None:
    source = tmp_path / "kernels.py"
    source.write_text(KERNELS)

    def call(name: str) -> list[str]:
        return output_of(str(source), name, NUMBA_CACHE_DIR=str(tmp_path))

    assert call("fourth") == ["16.0", "0", "0", "0"]
    assert call("eighth") == ["256.0", "0", "1", "0"]
    assert call("eighth") == ["256.0", "1", "0", "0"]
    source.write_text(KERNELS.replace("fourth(x))", "fourth(x)) + 1.0"))
    assert call("eighth") == ["257.0", "0", "0", "0"]
