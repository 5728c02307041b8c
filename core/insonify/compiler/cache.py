"""Machine code of kernels on disk, in folders named by digests of the sources (`digests`).

Beside that, Numba's own cache lacks this: a damaged file is noticed, processes that compile at once never mix up their
code, and versions of Numba keep theirs apart.
"""

import contextlib
import hashlib
import json
import os
import pickle
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, BinaryIO, Self

import llvmlite.binding as llvm
import numba
from numba.core.caching import CompileResultCacheImpl, FunctionCache, IndexDataCacheFile
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import compile_result
from numba.core.runtime import _nrt_python  # type: ignore[attr-defined]

from insonify.compiler import digests
from insonify.operating_system import lock_file

PAUSE = 0.05  # s, between two looks whether another process has compiled a kernel


class PartLibrary(JITCodeLibrary):
    """LLVM code of a function and of all that it calls, linked into the code of its callers; no machine code."""

    optimised = True  # on its own; if not, with the callers' code alone

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
        # Numba would make machine code here.
        self._finalize_dynamic_globals()
        self._verify_declare_only_symbols()
        self._finalized = True


class _Locator:
    """Place of one kernel's machine code, as Numba's cache expects it."""

    def __init__(self, function: Callable[..., Any], file: str) -> None:
        self._py_file = file
        self.digest = digests.digest_of(function.__module__, file)
        self.folder = digests.FOLDER / self.digest
        with contextlib.suppress(OSError):
            os.utime(self.folder)  # in use: `remove_unused` leaves it

    @classmethod
    def from_function(cls, function: Callable[..., Any], file: str) -> Self:
        return cls(function, file)

    def ensure_cache_path(self) -> None:
        self.folder.mkdir(parents=True, exist_ok=True)

    def get_cache_path(self) -> str:
        return str(self.folder)

    def get_source_stamp(self) -> str:
        return self.digest

    def get_disambiguator(self) -> str:
        return "kernel"


class EntryCode(CompileResultCacheImpl):
    """What is written of a function that Python calls: its machine code, and the name of that."""

    _locator_classes = [_Locator]  # noqa: RUF012  # Numba's own attribute
    ending = ""  # of the names of its files

    def get_filename_base(self, fullname: str, abiflags: str) -> str:
        """Name the files with the version of Numba, which empties an index that another of its versions wrote."""
        return f"{super().get_filename_base(fullname, abiflags)}.numba-{numba.__version__}{self.ending}"

    def reduce(self, cres: Any) -> tuple[Any, ...]:
        """Leave out the LLVM code that Numba adds for callers: here they have the part, and the name is enough."""
        (name, kind, (code, _)), *rest = super().reduce(cres)
        return (name, kind, (code, _bitcode_of_name(cres.fndesc.llvm_cpython_wrapper_name))), *rest


def _bitcode_of_name(name: str) -> bytes:
    """LLVM code that defines a function of a name and nothing else."""
    return bytes(llvm.parse_assembly(f'define void @"{name}"() {{ ret void }}').as_bitcode())


class PartCode(EntryCode):
    """What is written of a function that other kernels call, and how it is read."""

    ending = ".part"

    def reduce(self, cres: Any) -> tuple[Any, ...]:
        """Return what is pickled."""
        cres.fndesc.typemap = cres.fndesc.calltypes = None  # not needed to link it, and cannot all be pickled
        code = self._code_of(cres)
        return cres.library.name, code, cres.fndesc, cres.environment, cres.signature, cres.reload_init

    def _code_of(self, cres: Any) -> Any:
        return bytes(cres.library._get_module_for_linking().as_bitcode())

    def _library_from(self, codegen: Any, name: str, code: Any) -> Any:
        library = PartLibrary(codegen, name)
        library._shared_module = llvm.parse_bitcode(code)
        library._finalized = True
        return library

    def rebuild(self, target_context: Any, payload: tuple[Any, ...]) -> Any:
        """Restore what was pickled."""
        name, code, fndesc, environment, signature, reload_init = payload
        for again in reload_init:
            again()
        return compile_result(
            typing_context=target_context.typing_context,
            target_context=target_context,
            entry_point=object(),
            library=self._library_from(target_context.codegen(), name, code),
            fndesc=fndesc,
            environment=environment,
            signature=signature,
            objectmode=False,
            lifted=(),
            reload_init=reload_init,
        )


class SeparateCode(PartCode):
    """What is written of a function that other kernels call by its address: its machine code, and the name of that."""

    ending = ".part.separate"

    def _code_of(self, cres: Any) -> Any:
        return cres.library._get_compiled_object(), _bitcode_of_name(cres.fndesc.llvm_func_name)

    def _library_from(self, codegen: Any, name: str, code: Any) -> Any:
        return codegen.unserialize_library((name, "object", code))


class _CacheFile(IndexDataCacheFile):
    """Index and machine code of one kernel, by signature."""

    def save(self, key: Any, data: Any) -> None:
        """Keep the code of a signature in a file named by its content, written before the index names it."""
        # Numba numbers the files by the index as it was read: of two processes that compile two signatures at once, one
        # may then load the other's code. Here the worst is that the index loses one, which is compiled again.
        content = self._dump(data)
        name = _name_of_content(content)
        self._save_data(name, content)
        self._save_index(self._load_index() | {key: name})

    def _load_index(self) -> dict[str, str]:
        """Names of the files by signature; none of a damaged index."""
        with contextlib.suppress(OSError, ValueError):
            index = json.loads(Path(self._index_path).read_bytes())
            if isinstance(index, dict):
                return index
        return {}

    def _save_index(self, overloads: dict[str, str]) -> None:
        with self._open_for_write(self._index_path) as file:
            file.write(json.dumps(overloads).encode())

    def _save_data(self, name: str, data: bytes) -> None:
        with self._open_for_write(self._data_path(name)) as file:
            file.write(data)

    def _load_data(self, name: str) -> Any:
        """Read the code in a file, which is executed unchecked: one changed bit may end the process."""
        content = Path(self._data_path(name)).read_bytes()
        if _name_of_content(content) != name:
            raise ValueError(f"{name} is damaged")
        return pickle.loads(content)  # written by this user


def _name_of_content(content: bytes) -> str:
    return f"{hashlib.sha256(content).hexdigest()[:32]}.nbc"


class KernelCache(FunctionCache):
    """Machine code of one kernel on disk; a damaged file is compiled again, an unusable folder is ignored.

    Of several processes that lack the same kernel one compiles it. The others wait and load what it has kept.
    """

    def __init__(self, function: Callable[..., Any], form: type[EntryCode]) -> None:
        self._impl_class = form
        super().__init__(function)
        impl = self._impl
        self._cache_file = _CacheFile(self._cache_path, impl.filename_base, impl.locator.get_source_stamp())
        self._lock: BinaryIO | None = None
        if not digests.PRIVATE:
            self.disable()

    def _index_key(self, sig: Any, codegen: Any) -> str:
        return repr(super()._index_key(sig, codegen))

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """Return the code kept for a signature; None after the right to compile it has been taken, until `let_go`."""
        # Numba would first load all that it can compile, half a second, and compile its runtime; finished code needs
        # only the addresses of what the runtime has in C.
        try:
            for name, address in _nrt_python.c_helpers.items():
                llvm.add_symbol(name if name.startswith("_") else f"NRT_{name}", address)
            found = self._load_overload(sig, target_context)
            return self._load_overload(sig, target_context) if found is None and self._has_waited() else found
        except Exception:  # unpickling a damaged file may raise anything
            with contextlib.suppress(OSError):
                self.flush()
            return None

    def _has_waited(self) -> bool:
        """Take the right to compile this kernel; whether another process had it meanwhile."""
        # Threads of one process take turns by Numba's lock. No kernel calls itself, not even through others,
        # so that no two processes can wait for each other.
        waited = False
        if self._enabled and self._lock is None:
            with contextlib.suppress(OSError):
                self._impl.locator.ensure_cache_path()
                self._lock = open(f"{self._cache_file._index_path}.lock", "wb")
                while lock_file(self._lock) is False:
                    waited = True
                    time.sleep(PAUSE)
        return waited

    def let_go(self) -> None:
        """End the right to compile this kernel."""
        if self._lock is not None:
            self._lock.close()
            self._lock = None

    def lacks(self, sig: Any, target_context: Any) -> bool:
        """Whether the code of a signature is not kept, and could be."""
        if not self._enabled or self._index_key(sig, target_context.codegen()) in self._cache_file._load_index():
            return False
        with contextlib.suppress(OSError):
            digests.FOLDER.mkdir(parents=True, exist_ok=True)
        return os.access(digests.FOLDER, os.W_OK)

    def save_overload(self, sig: Any, data: Any) -> None:
        """Keep the code of a signature."""
        with contextlib.suppress(OSError):
            super().save_overload(sig, data)
