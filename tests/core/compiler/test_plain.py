"""Kernels compiled by plain Numba: the same results, machine code in Numba's own cache, nothing private of Numba."""

import os
import sys

import numba
import pytest

from commands import output_of

pytestmark = pytest.mark.skipif(bool(numba.config.DISABLE_JIT), reason="nothing is compiled")

KERNELS = """
from insonify.compiler.jit import INTEGER, NOTHING, inlined, inlined_ieee, kernel, kernel_separate

@inlined
def half(x):
    return 0.5 * x

@inlined_ieee
def third(x):
    return x / 3.0

@kernel_separate(INTEGER)
def square(x):
    return x * x

@kernel_separate(NOTHING)
def add_one(values):
    for i in range(values.size):
        values[i] += 1.0

@kernel
def combine(values, x):
    add_one(values)
    return half(values.sum()) + third(square(x))
"""
CALL = """
import sys
import numpy as np
from numba import config
before = config.CACHE_DIR
from plain_kernels import combine
value = combine(np.ones(4), 3)
assert config.CACHE_DIR == before
own = ("cache", "dispatch", "separate", "processes")
private = [name for name in own if f"insonify.compiler.{name}" in sys.modules]
print(value, sum(combine.stats.cache_hits.values()), *private)
"""


def test_plain_numba_gives_the_same_and_is_read_from_disk(tmp_path):
    (tmp_path / "plain_kernels.py").write_text(KERNELS)
    path = os.pathsep.join([str(tmp_path), *filter(None, sys.path)])
    cache = str(tmp_path / "cache")

    def call() -> list[str]:
        return output_of("-c", CALL, INSONIFY_COMPILER="numba", NUMBA_CACHE_DIR=cache, PYTHONPATH=path)

    assert call() == ["7.0", "0"]
    assert call() == ["7.0", "1"]
    (tmp_path / "plain_kernels.py").write_text(KERNELS.replace("0.5 * x", "1.5 * x"))
    assert call() == ["15.0", "0"]
