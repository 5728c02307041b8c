"""Kernels with machine code of their own that other kernels call by its address, which is found at the first call.

A part is compiled into each of its callers. A separate kernel is compiled once, when any of them first calls it. Every
array is handed over as seven numbers and more: a whole scene costs half a microsecond. No inner loop should make such a
call.
"""

import ctypes
import hashlib
from collections.abc import Callable
from functools import cached_property
from typing import Any

import llvmlite.binding as llvm
from llvmlite import ir
from numba.core import cgutils, types
from numba.core.registry import cpu_target
from numba.core.typing.templates import AbstractTemplate, signature

from insonify.compiler.cache import KernelCache, SeparateCode
from insonify.compiler.dispatch import (
    Dispatcher,
    Kernel,
    NotCompiledError,
    WithoutWrapper,
    compile_named,
    failure,
    name_code,
)

RESOLVE = "insonify_resolve"
POINTER = ir.IntType(8).as_pointer()
_addresses: dict[bytes, int] = {}


class SeparateKernel(Kernel):
    """A kernel that other kernels call by the address of its machine code."""

    def __init__(self, function: Callable[..., Any], options: dict[str, Any], returned: Any) -> None:
        super().__init__(function, options, kept=True)
        self.returned = returned

    @cached_property
    def machine_code(self) -> Any:
        """Numba's dispatcher of its machine code, by type of the arguments."""
        code: Any = _MachineCode(self.py_func, {}, self.options, WithoutWrapper)
        code._cache = KernelCache(self.py_func, SeparateCode)
        code.returned = self.returned
        return code

    @cached_property
    def _numba_type_(self) -> Any:
        # Numba reads it when it compiles a caller.
        template = type("Call", (_Call,), {"key": self})
        cpu_target.target_context.insert_func_defn([(_generate_call(self), self, (types.VarArg(types.Any),))])
        return types.Function(template)


class _Call(AbstractTemplate):
    """Types of a call of a separate kernel, which need not be compiled for that."""

    key: SeparateKernel

    def generic(self, args: Any, kws: Any) -> Any:
        if kws:
            return None
        return signature(self.key.returned, *map(types.unliteral, args))


def _generate_call(kernel: SeparateKernel) -> Callable[..., Any]:
    """Return what writes LLVM code that calls a separate kernel."""

    def generate(context: Any, builder: Any, sig: Any, arguments: Any) -> Any:
        shape = context.call_conv.get_function_type(sig.return_type, sig.args)
        name = name_code(kernel.py_func, "machine_code", sig.args)
        function = builder.bitcast(_load_address(context, builder, name), shape.as_pointer())
        status, result = context.call_conv.call_function(builder, function, sig.return_type, sig.args, arguments)
        with cgutils.if_unlikely(builder, status.is_error):
            context.call_conv.return_status_propagate(builder, status)
        return result

    return generate


def _load_address(context: Any, builder: Any, name: bytes) -> Any:
    """Write LLVM code that loads the address of a kernel, and finds it if it is not known yet."""
    module, digest = builder.module, hashlib.sha256(name).hexdigest()[:16]
    place = f"insonify.address.{digest}"
    if place not in module.globals:
        slot = cgutils.add_global_variable(module, POINTER, place)
        slot.linkage, slot.initializer = "internal", POINTER(None)
    slot = module.globals[place]
    known = builder.load_atomic(slot, "acquire", align=8)
    with cgutils.if_unlikely(builder, cgutils.is_null(builder, known)):
        text = context.insert_unique_const(module, f"insonify.name.{digest}", cgutils.make_bytearray(name))
        resolve = cgutils.get_or_insert_function(module, ir.FunctionType(POINTER, [POINTER, ir.IntType(64)]), RESOLVE)
        found = builder.call(resolve, [builder.bitcast(text, POINTER), ir.IntType(64)(len(name))])
        with cgutils.if_unlikely(builder, cgutils.is_null(builder, found)):
            context.call_conv.return_user_exc(builder, NotCompiledError)
        builder.store_atomic(found, slot, "release", align=8)
    return builder.load_atomic(slot, "acquire", align=8)


class _MachineCode(Dispatcher):
    """Machine code of a separate kernel, by type of the arguments; its entry points are addresses."""

    returned: Any
    form = "machine_code"

    def add_overload(self, cres: Any) -> None:
        """Make the machine code of a compiled signature known."""
        if types.unliteral(cres.signature.return_type) != self.returned:
            raise TypeError(f"{self.py_func.__qualname__} returns {cres.signature.return_type}, not {self.returned}")
        address = cres.library.get_pointer_to_function(cres.fndesc.llvm_func_name)
        cres.library.codegen.set_env(self.targetctx.get_env_name(cres.fndesc), cres.environment)
        self.overloads[tuple(cres.signature.args)] = cres._replace(entry_point=address)


def find_address(name: bytes) -> int:
    """Address of the machine code of a separate kernel, compiled if that is not known."""
    if name not in _addresses:
        _addresses[name] = compile_named(name).entry_point
    return _addresses[name]


@ctypes.CFUNCTYPE(ctypes.c_void_p, ctypes.c_void_p, ctypes.c_size_t)
def _resolve(name: int, size: int) -> int:
    try:
        return find_address(ctypes.string_at(name, size))
    except BaseException as error:  # even one by the keyboard must pass through the caller's machine code
        failure.error = error
        return 0


llvm.add_symbol(RESOLVE, ctypes.cast(_resolve, ctypes.c_void_p).value)
