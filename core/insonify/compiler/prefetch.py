"""Prefetch memory before it is needed: what a ping reads and writes is fetched while the ping before is computed."""

from typing import Any

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic
from numba.np.arrayobj import make_array

from insonify.compiler.jit import PLAIN, inlined_uncounted

READ, WRITE = 0, 1
LINE = 64  # bytes that come at once
EVERY_CACHE, DATA = 3, 1  # arguments of LLVM's prefetch: cache level, and data instead of code


def _ask(purpose: int, array: Any) -> Any:
    """Signature and code of LLVM's prefetch of the cache line of one entry of an array."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        data = make_array(signature.args[0])(context, builder, arguments[0]).data
        address = builder.bitcast(builder.gep(data, [arguments[1]]), cgutils.voidptr_t)
        word = ir.IntType(32)
        shape = ir.FunctionType(ir.VoidType(), [address.type, word, word, word])
        prefetch = builder.module.declare_intrinsic("llvm.prefetch", [address.type], shape)
        builder.call(prefetch, [address, word(purpose), word(EVERY_CACHE), word(DATA)])
        return context.get_dummy_value()

    return types.void(array, types.intp), generate


def _to_read(typing, array, index):
    """Prefetch the cache line of one entry of a row, which will be read soon."""
    return _ask(READ, array)


def _to_write(typing, array, index):
    """Prefetch the cache line of one entry of a row, which will be written soon."""
    return _ask(WRITE, array)


def _nothing(array, index):
    """Prefetch nothing."""


# As kernels call them, with an array and an index.
prefetch_read: Any = inlined_uncounted(_nothing) if PLAIN else intrinsic(_to_read)
prefetch_write: Any = inlined_uncounted(_nothing) if PLAIN else intrinsic(_to_write)


@inlined_uncounted
def prefetch_row(row):
    """Prefetch a whole row that will be written soon."""
    for k in range(0, row.size, LINE // row.itemsize):
        prefetch_write(row, k)
