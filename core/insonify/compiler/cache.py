"""Machine code of kernels on disk, keyed by the content of the sources, so that every checkout shares it.

Numba finds cached code by a file's place and notices changes in that file alone. Here the code of a module lies in a
folder named by a digest of the module and of all kernel modules that it imports, directly or not. Comments, docstrings
and line numbers do not count, for they do not change the code.
"""

from __future__ import annotations

import ast
import contextlib
import hashlib
import json
import os
import pickle
import re
import shutil
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import llvmlite.binding as llvm
import numba
import numba.core.config
import platformdirs
from numba.core.caching import CompileResultCacheImpl, FunctionCache, IndexDataCacheFile
from numba.core.compiler import compile_result
from numba.core.runtime import rtsys  # type: ignore[attr-defined]

from insonify.compiler.part_library import PartLibrary

PACKAGE = "insonify"
SOURCES = Path(__file__).parents[1]
FOLDERS = ("compiler", "kernels")  # of the sources that machine code is made of
# Modules that leave the code alone.
WITHOUT_CODE = {
    f"compiler.{name}"
    for name in (
        "compilation_events", "compiling_process", "compiling_worker", "part_process", "part_worker", "progress",
        "worker_pipe",
    )
}  # fmt: skip
UNUSED = 30 * 86400.0  # seconds after which machine code that no process has used is removed


def cache_folder() -> Path:
    """Return the folder of all machine code: below NUMBA_CACHE_DIR where that is set, else the user's cache."""
    chosen: Any = numba.core.config
    shelf = Path(chosen.CACHE_DIR) / "insonify" if chosen.CACHE_DIR else Path(platformdirs.user_cache_dir("insonify"))
    return shelf / "kernels"


def source_digests(sources: Path, folder: Path) -> dict[str, str]:
    """Digest every kernel module together with all that it imports; computed once for each state of the sources."""
    paths = [path for name in FOLDERS for path in (sources / name).rglob("*.py")]
    texts = {".".join(path.relative_to(sources).with_suffix("").parts): path.read_bytes() for path in paths}
    texts = {name: text for name, text in texts.items() if name not in WITHOUT_CODE}
    state = hashlib.sha256(b"\0".join(name.encode() + b"\0" + texts[name] for name in sorted(texts))).hexdigest()[:24]
    kept = folder / f"{state}.json"
    with contextlib.suppress(OSError, ValueError):
        found = json.loads(kept.read_text())
        if isinstance(found, dict) and found.keys() == texts.keys() and all(map(_is_digest, found.values())):
            return found
    digests = _digest(texts)
    with contextlib.suppress(OSError):
        folder.mkdir(parents=True, exist_ok=True)
        part = kept.with_suffix(f".{os.getpid()}")
        part.write_text(json.dumps(digests))
        part.replace(kept)
        remove_unused(folder)
    return digests


def _is_digest(value: object) -> bool:
    return isinstance(value, str) and re.fullmatch(r"[0-9a-f]{24}", value) is not None


def remove_unused(folder: Path) -> None:
    """Remove machine code and digests that no process has used for a month."""
    for entry in folder.iterdir():
        with contextlib.suppress(OSError):
            if time.time() - entry.stat().st_mtime > UNUSED:
                shutil.rmtree(entry) if entry.is_dir() else entry.unlink()


def _digest(texts: dict[str, bytes]) -> dict[str, str]:
    trees = {name: ast.parse(text) for name, text in texts.items()}
    imports = {name: _imported(tree) & trees.keys() for name, tree in trees.items()}
    own = {name: ast.dump(_without_docstrings(tree)) for name, tree in trees.items()}
    digests = {}
    for name in trees:
        reached, pending = {name}, [name]
        while pending:
            found = imports[pending.pop()] - reached
            reached |= found
            pending.extend(found)
        joined = "\0".join(f"{other}\0{own[other]}" for other in sorted(reached))
        digests[name] = hashlib.sha256(joined.encode()).hexdigest()[:24]
    return digests


def _imported(tree: ast.Module) -> set[str]:
    """Name the modules of the package that a module may import, dotted as within the package."""
    names = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith(f"{PACKAGE}."):
            module = (node.module or "")[len(PACKAGE) + 1 :]
            names |= {module, *(f"{module}.{alias.name}".lstrip(".") for alias in node.names)}
    return names


def _without_docstrings(tree: ast.Module) -> ast.Module:
    for node in ast.walk(tree):
        if isinstance(node, (ast.Module, ast.ClassDef, ast.FunctionDef)) and ast.get_docstring(node) is not None:
            node.body = node.body[1:]
    return tree


FOLDER = cache_folder()
DIGESTS = source_digests(SOURCES, FOLDER)


def _digest_of(module: str, file: str) -> str:
    """Digest a module; one outside this package may call any kernel, so that all of them count."""
    name = module.removeprefix(f"{PACKAGE}.")
    if name != module and name in DIGESTS:
        return DIGESTS[name]
    own = Path(file).read_bytes() if Path(file).is_file() else module.encode()
    return hashlib.sha256(own + json.dumps(DIGESTS, sort_keys=True).encode()).hexdigest()[:24]


class _Locator:
    """Place of one kernel's machine code, as Numba asks for it."""

    def __init__(self, function: Callable[..., Any], file: str) -> None:
        self._py_file = file
        self.digest = _digest_of(function.__module__, file)
        self.folder = FOLDER / self.digest
        with contextlib.suppress(OSError):
            os.utime(self.folder)  # in use: `remove_unused` leaves it

    @classmethod
    def from_function(cls, function: Callable[..., Any], file: str) -> _Locator:
        return cls(function, file)

    def ensure_cache_path(self) -> None:
        self.folder.mkdir(parents=True, exist_ok=True)

    def get_cache_path(self) -> str:
        return str(self.folder)

    def get_source_stamp(self) -> str:
        return self.digest

    def get_disambiguator(self) -> str:
        return "kernel"


class _CacheImpl(CompileResultCacheImpl):
    """What is written of a function that Python calls: its machine code, and the name of that."""

    _locator_classes = [_Locator]  # noqa: RUF012  # Numba's own attribute

    def get_filename_base(self, fullname: str, abiflags: str) -> str:
        # Numba empties an index that another of its versions wrote: environments with two would do so in turn.
        return f"{super().get_filename_base(fullname, abiflags)}.numba-{numba.__version__}"

    def reduce(self, cres: Any) -> tuple[Any, ...]:
        (name, kind, (code, _)), *rest = super().reduce(cres)
        # Numba adds all LLVM code, to be linked into callers: here they have the part, and the name is enough.
        return (name, kind, (code, _bitcode_of_name(cres.fndesc.llvm_cpython_wrapper_name))), *rest


def _bitcode_of_name(name: str) -> bytes:
    """LLVM code that defines a function of a name and nothing else."""
    return bytes(llvm.parse_assembly(f'define void @"{name}"() {{ ret void }}').as_bitcode())


class _PartCacheImpl(_CacheImpl):
    """What is written of a function that other kernels call, and how it is read."""

    def get_filename_base(self, fullname: str, abiflags: str) -> str:
        return f"{super().get_filename_base(fullname, abiflags)}.part"

    def reduce(self, cres: Any) -> tuple[Any, ...]:
        cres.fndesc.typemap = cres.fndesc.calltypes = None  # not needed to link it, and cannot all be pickled
        code = self._code_of(cres)
        return cres.library.name, code, cres.fndesc, cres.environment, cres.signature, cres.reload_init

    def _code_of(self, cres: Any) -> Any:
        return cres.library.to_bitcode()

    def _library_from(self, codegen: Any, name: str, code: Any) -> Any:
        return PartLibrary.from_bitcode(codegen, name, code)

    def rebuild(self, target_context: Any, payload: tuple[Any, ...]) -> Any:
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


class _SeparateCacheImpl(_PartCacheImpl):
    """What is written of a function that other kernels call by its address: its machine code, and the name of that."""

    def get_filename_base(self, fullname: str, abiflags: str) -> str:
        return f"{super().get_filename_base(fullname, abiflags)}.separate"

    def _code_of(self, cres: Any) -> Any:
        return cres.library._get_compiled_object(), _bitcode_of_name(cres.fndesc.llvm_func_name)

    def _library_from(self, codegen: Any, name: str, code: Any) -> Any:
        return codegen.unserialize_library((name, "object", code))


class _CacheFile(IndexDataCacheFile):
    """Index and machine code of one kernel, by signature."""

    def save(self, key: Any, data: Any) -> None:
        """Keep the code of a signature in a file named by its content, written before the index names it.

        Numba numbers the files by the index as it was read: of two processes that compile two signatures at once, one
        may then load the other's code. Here the worst is that the index loses one, which is compiled anew.
        """
        content = self._dump(data)
        name = _name_of_content(content)
        self._save_data(name, content)
        try:
            index = self._load_index()
        except Exception:  # unpickling one that is damaged, or names types that have moved since, may raise anything
            index = {}
        self._save_index(index | {key: name})

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
    """Machine code of one kernel on disk; a damaged file is compiled anew, an unusable folder is ignored."""

    _impl_class: type[_CacheImpl] = _CacheImpl

    def __init__(self, function: Callable[..., Any]) -> None:
        super().__init__(function)
        impl = self._impl
        self._cache_file = _CacheFile(self._cache_path, impl.filename_base, impl.locator.get_source_stamp())

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """Return the code kept for a signature, or None.

        Numba would first load all that it can compile, a tenth of a second; finished code needs its runtime alone.
        """
        try:
            rtsys.initialize(target_context)
            return self._load_overload(sig, target_context)
        except Exception:  # unpickling a damaged file may raise anything
            with contextlib.suppress(OSError):
                self.flush()
            return None

    def lacks(self, sig: Any, target_context: Any) -> bool:
        """Whether the code of a signature is not kept, and could be."""
        with contextlib.suppress(Exception):  # as above
            if self._index_key(sig, target_context.codegen()) in self._cache_file._load_index():
                return False
        with contextlib.suppress(OSError):
            FOLDER.mkdir(parents=True, exist_ok=True)
        return os.access(FOLDER, os.W_OK)

    def save_overload(self, sig: Any, data: Any) -> None:
        """Keep the code of a signature."""
        with contextlib.suppress(OSError):
            super().save_overload(sig, data)


class PartCache(KernelCache):
    """LLVM code on disk of one function that other kernels call."""

    _impl_class = _PartCacheImpl

    def save_overload(self, sig: Any, data: Any) -> None:
        """Keep the code of a signature, once it is linked."""
        save = super().save_overload
        data.library.save_when_linked(lambda: save(sig, data))


class SeparateCache(KernelCache):
    """Machine code on disk of one function that other kernels call by its address."""

    _impl_class = _SeparateCacheImpl
