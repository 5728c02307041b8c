"""Digests of kernels' sources, and the folder of their machine code.

Numba finds cached code by a file's place and notices changes in that file alone. Here the code of a module lies in a
folder named by a digest of the module and of all kernel modules that it imports, directly or not, so that all checkouts
share it. Comments, docstrings and line numbers do not count, for they do not change the code.
"""

import ast
import contextlib
import hashlib
import json
import os
import re
import shutil
import time
from pathlib import Path
from typing import Any

from numba import config

from insonify.compiler.cache_folder import cache_folder, is_private

settings: Any = config
PACKAGE = "insonify"
SOURCES = Path(__file__).parents[1]
FOLDERS = ("compiler", "kernels")  # of the sources that machine code is made of
# Modules that leave the code alone.
WITHOUT_CODE = {
    f"compiler.{name}"
    for name in ("build", "cache_folder", "compilation_events", "digests", "processes", "progress", "worker")
}
UNUSED = 30 * 86400.0  # seconds after which machine code that no process has used is removed


def source_digests(sources: Path, folder: Path | None) -> dict[str, str]:
    """Digest every kernel module together with all that it imports; computed once for each state of the sources."""
    paths = [path for name in FOLDERS for path in (sources / name).rglob("*.py")]
    texts = {".".join(path.relative_to(sources).with_suffix("").parts): path.read_bytes() for path in paths}
    texts = {name: text for name, text in texts.items() if name not in WITHOUT_CODE}
    state = hashlib.sha256(b"\0".join(name.encode() + b"\0" + texts[name] for name in sorted(texts))).hexdigest()[:24]
    if folder is None:
        return _digest(texts)
    kept = folder / f"{state}.json"
    with contextlib.suppress(OSError, ValueError):
        found = json.loads(kept.read_text(encoding="utf-8"))
        if isinstance(found, dict) and found.keys() == texts.keys() and all(map(_is_digest, found.values())):
            return found
    digests = _digest(texts)
    with contextlib.suppress(OSError):
        folder.mkdir(parents=True, exist_ok=True)
        part = kept.with_suffix(f".{os.getpid()}")
        part.write_text(json.dumps(digests), encoding="utf-8", newline="")
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
PRIVATE = is_private(FOLDER)  # whether machine code is read from disk and kept there
DIGESTS = source_digests(SOURCES, FOLDER if PRIVATE else None)


def digest_of(module: str, file: str) -> str:
    """Digest a module; one outside this package may call any kernel, so that all of them count."""
    name = module.removeprefix(f"{PACKAGE}.")
    if name != module and name in DIGESTS:
        return DIGESTS[name]
    own = Path(file).read_bytes() if Path(file).is_file() else module.encode()
    return hashlib.sha256(own + json.dumps(DIGESTS, sort_keys=True).encode()).hexdigest()[:24]
