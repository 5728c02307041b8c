"""Functions compiled in two ways: as a whole for a call from Python, and as a part of each kernel that calls them.

Numba compiles every function as if Python called it: with a wrapper that unpacks the arguments, all optimisation and
machine code. A function that another kernel calls needs no wrapper and no machine code: here such a part stays LLVM
code. It is optimised with the caller's code; on its own only if it has innermost loops, which otherwise become slower.
The callers' machine code is the same, and the first call of a kernel takes half the time.
"""

import dis
import importlib
import threading
from collections.abc import Callable
from functools import cache, cached_property, update_wrapper
from typing import Any

from numba.core import types
from numba.core.compiler import Compiler
from numba.core.registry import CPUDispatcher
from numba.core.serialize import dumps, loads

from insonify.compiler.cache import EntryCode, KernelCache, PartCode, PartLibrary
from insonify.compiler.processes import elsewhere


class NotCompiledError(RuntimeError):
    """A kernel that another one calls could not be compiled when it was first called; `failure.error` is the reason."""


failure = threading.local()


class Kernel:
    """A compiled function: Python calls its machine code, kernels take its part into theirs.

    Numba's own dispatchers, a fifth of a millisecond each, are made when they are first needed.
    """

    def __init__(self, function: Callable[..., Any], options: dict[str, Any], kept: bool) -> None:
        update_wrapper(self, function)
        self.py_func, self.kept = function, kept
        self.options = options | {"nopython": True, "no_cfunc_wrapper": True}

    def __call__(self, *arguments: Any, **named: Any) -> Any:
        """Call the machine code, which is compiled for types that it has not been called with."""
        try:
            return self.entry(*arguments, **named)
        except NotCompiledError:
            raise failure.error from None

    @cached_property
    def entry(self) -> Any:
        """Numba's dispatcher of calls from Python."""
        entry: Any = Dispatcher(self.py_func, {}, self.options)
        entry.form = "entry"
        if self.kept:
            entry._cache = KernelCache(self.py_func, EntryCode)
        return entry

    @cached_property
    def part(self) -> Any:
        """The `Part` that other kernels call."""
        part: Any = Part(self.py_func, {}, self.options, _PartCompiler)
        if self.kept:
            part._cache = KernelCache(self.py_func, PartCode)
        return part

    @property
    def _numba_type_(self) -> Any:
        # Numba reads it when it compiles a caller.
        return self.part._numba_type_


class Dispatcher(CPUDispatcher):
    """Numba's dispatcher, which gives up the right to compile a kernel once it is compiled or loaded."""

    _cache: Any
    form = ""  # ``entry`` or ``machine_code`` of a kernel, which another process may compile

    def compile(self, sig: Any) -> Any:
        """Compile the function for types of arguments, in another process if one is wanted, or load its code."""
        kept = isinstance(self._cache, KernelCache)  # else no file would bring it from there
        if self.form and elsewhere.wanted and kept and "<locals>" not in self.py_func.__qualname__:
            if sig not in self.overloads and self._cache.lacks(sig, self.targetctx):
                elsewhere.compile(name_code(self.py_func, self.form, sig))
        try:
            return super().compile(sig)
        finally:
            if kept:
                self._cache.let_go()


def name_code(function: Callable[..., Any], form: str, arguments: tuple[Any, ...]) -> bytes:
    """Name a form of a kernel, ``entry`` or ``machine_code``, for types of arguments."""
    return bytes(dumps((function.__module__, function.__qualname__, form, arguments)))


def compile_named(name: bytes) -> Any:
    """Compile what `name_code` names, or load its code; returns Numba's result."""
    module, qualname, form, arguments = loads(name)
    code = getattr(getattr(importlib.import_module(module), qualname), form)
    code.compile(arguments)
    return code.overloads[arguments]


class Part(Dispatcher):
    """A function as other kernels call it; Python cannot."""

    def get_call_template(self, args: Any, kws: Any) -> Any:
        """Compile the function for a call: once for all values of a constant, which LLVM sees when it is inlined."""
        args, kws = tuple(map(types.unliteral, args)), {name: types.unliteral(kind) for name, kind in kws.items()}
        return super().get_call_template(args, kws)

    def add_overload(self, cres: Any) -> None:
        """Make a compiled signature known to those that compile its callers."""
        place = object()  # for want of an address
        self.targetctx.insert_user_function(place, cres.fndesc, [cres.library])
        self.overloads[tuple(cres.signature.args)] = cres._replace(entry_point=place)


class WithoutWrapper(Compiler):
    """Numba's passes, less those that make a function callable from Python."""

    def __init__(self, *context: Any) -> None:
        *_, flags, _ = context
        flags.no_compile = flags.no_cpython_wrapper = flags.no_cfunc_wrapper = True
        super().__init__(*context)


class _PartCompiler(WithoutWrapper):
    """Numba's passes, up to LLVM code."""

    def __init__(self, typing: Any, target: Any, _: Any, *context: Any) -> None:
        super().__init__(typing, target, PartLibrary(target.codegen(), "part"), *context)

    def compile_extra(self, func: Any) -> Any:
        """Compile a function."""
        self.state.library.optimised = _has_innermost_loop(func)
        return super().compile_extra(func)


def _has_innermost_loop(function: Any) -> bool:
    """Whether a function has a loop that calls no kernel with a loop."""
    steps = list(dis.get_instructions(function))
    for first, last in _loops(steps):
        names = {step.argval for step in steps if step.opname == "LOAD_GLOBAL" and first <= step.offset <= last}
        called = (function.__globals__.get(name) for name in names)
        if not any(isinstance(value, Kernel) and _reaches_loop(value.py_func) for value in called):
            return True
    return False


@cache
def _reaches_loop(function: Any) -> bool:
    """Whether a function or a kernel that it calls, directly or not, has a loop."""
    if _loops(list(dis.get_instructions(function))):
        return True
    called = (function.__globals__.get(name) for name in function.__code__.co_names)
    return any(isinstance(value, Kernel) and _reaches_loop(value.py_func) for value in called)


def _loops(steps: list[dis.Instruction]) -> list[tuple[int, int]]:
    """Offsets of the first and the last instruction of each loop, which ends by a jump backwards."""
    jumps = {*dis.hasjrel, *dis.hasjabs}
    return [(step.argval, step.offset) for step in steps if step.opcode in jumps and step.argval <= step.offset]
