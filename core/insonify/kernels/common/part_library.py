"""LLVM code of functions that other kernels call, without machine code of its own."""

from __future__ import annotations

from typing import Any

import llvmlite.binding as llvm
from numba.core.codegen import JITCodeLibrary


class PartLibrary(JITCodeLibrary):
    """LLVM code of a function and of all that it calls, which is linked into the code of its callers."""

    optimised = True  # before it is linked; if not, with the callers' code alone

    @classmethod
    def from_bitcode(cls, codegen: Any, name: str, bitcode: bytes) -> PartLibrary:
        """Restore a library from its bitcode.

        Parameters
        ----------
        codegen : JITCPUCodegen
            Numba's generator of code.
        name : str
        bitcode : bytes
            As `to_bitcode` returned it.

        Returns
        -------
        PartLibrary
        """
        library = cls(codegen, name)
        library._final_module = llvm.parse_bitcode(bitcode)
        library._finalize_final_module()
        return library

    def to_bitcode(self) -> bytes:
        """Return the code as it is linked into callers."""
        return bytes(self._get_module_for_linking().as_bitcode())

    def _optimize_final_module(self) -> None:
        if self.optimised:
            super()._optimize_final_module()
            return
        # Numba's cheap passes inline what must be inlined.
        passes, builder = self._codegen._module_pass_manager(
            loop_vectorize=False, slp_vectorize=False, opt=0, cost="cheap"
        )
        passes.run(self._final_module, builder)

    def _finalize_final_module(self) -> None:
        # Not handed to the engine, which would make machine code of it.
        self._finalize_dynamic_globals()
        self._verify_declare_only_symbols()
        self._finalized = True
