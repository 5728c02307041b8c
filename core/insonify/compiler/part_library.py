"""LLVM code of functions that other kernels call, without machine code of its own.

It is linked and optimised by `link_part`: here when it is needed, or beforehand in a second process while the caller is
still typed and lowered (`part_process`). Both give the same code.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import llvmlite.binding as llvm
from numba.core import cgutils
from numba.core.codegen import JITCodeLibrary

from insonify.compiler.part_process import running_process

_keys = itertools.count()


class Source(NamedTuple):
    """What one function adds to a part."""

    name: str
    code: str  # LLVM's text


class PartLibrary(JITCodeLibrary):
    """LLVM code of a function and of all that it calls, which is linked into the code of its callers."""

    optimised = True  # before it is linked; if not, with the callers' code alone

    def __init__(self, codegen: Any, name: str) -> None:
        super().__init__(codegen, name)
        self.key = next(_keys)
        self._sources: list[Source] = []
        self._process: Any = None
        self._bitcode: bytes | None = None

    @classmethod
    def from_bitcode(cls, codegen: Any, name: str, bitcode: bytes) -> PartLibrary:
        """Restore a library from its bitcode."""
        library = cls(codegen, name)
        library._bitcode = bitcode
        library._finalized = True
        return library

    def to_bitcode(self) -> bytes:
        """Return the code as it is linked into callers."""
        self._ensure_finalized()
        if self._bitcode is None and self._process is not None:
            self._bitcode = self._process.bitcode_of(self.key)
            self._process = None
        if self._bitcode is None:
            self._shared_module = self._linked_here()
            self._bitcode = bytes(self._shared_module.as_bitcode())
        self._sources.clear()
        return self._bitcode

    def add_ir_module(self, ir_module: Any) -> None:
        """Take the code of a function."""
        self._raise_if_finalized()
        self._sources.append(Source(ir_module.name, cgutils.normalize_ir_text(str(ir_module))))

    def finalize(self) -> None:
        """Let a second process link and optimise the code, if there is one."""
        self._raise_if_finalized()
        self._linking_libraries = list(dict.fromkeys(self._linking_libraries))
        if hasattr(self, "_reload_init"):  # not in Numba 0.62, where a result alone has it
            for library in self._linking_libraries:
                self._reload_init.update(library._reload_init)
        self._finalized = True
        process = running_process()
        if process is not None and not process.compiles:
            self._process = process
            self._process.link(self.key, self.name, tuple(self._sources), self._linking_libraries, self.optimised)

    def save_when_linked(self, save: Callable[[], None]) -> None:
        """Write the code to disk: now, or when the second process has linked all parts."""
        self._ensure_finalized()
        if self._process is None:
            save()
        else:
            self._process.unsaved.append(save)

    @property
    def has_dynamic_globals(self) -> bool:
        """Whether the code holds addresses of this process, which cannot be kept."""
        return b"numba.dynamic.globals" in self.to_bitcode()

    def _get_module_for_linking(self) -> Any:
        bitcode = self.to_bitcode()
        if self._shared_module is None:
            self._shared_module = llvm.parse_bitcode(bitcode)
        return self._shared_module

    def _linked_here(self) -> Any:
        modules = [library._get_module_for_linking() for library in self._linking_libraries]
        return link_part(self._codegen, self.name, self._sources, modules, self.optimised)


class _Linker(JITCodeLibrary):
    """Links and optimises one part; no machine code is made of it."""

    optimised = True

    def link(self, module: Any) -> None:
        self._final_module.link_in(module, preserve=True)

    def finish(self) -> Any:
        if self.optimised:
            self._optimize_final_module()
        else:
            # Numba's cheap passes inline what must be inlined.
            passes, builder = self._codegen._module_pass_manager(
                loop_vectorize=False, slp_vectorize=False, opt=0, cost="cheap"
            )
            passes.run(self._final_module, builder)
        self._final_module.verify()
        self._verify_declare_only_symbols()
        self._finalized = True
        return self._get_module_for_linking()


def link_part(codegen: Any, name: str, sources: Sequence[Source], modules: Sequence[Any], optimised: bool) -> Any:
    """Link a function with what it calls, and optimise it."""
    linker = _Linker(codegen, name)
    linker.optimised = optimised
    for source in sources:
        module = llvm.parse_assembly(source.code)
        module.name = source.name
        module.verify()
        linker.add_llvm_module(module)
    for module in modules:
        linker.link(module)
    return linker.finish()
