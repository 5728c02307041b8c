"""What the numbers of a record depend on beside its scene: versions, the code of the kernels, system and processor."""

import hashlib
import json
import platform
from functools import cache
from importlib import import_module
from importlib.metadata import PackageNotFoundError, version
from typing import NamedTuple, Self

from numba.core.registry import cpu_target

from insonify.compiler import digests
from insonify.compiler.jit import PLAIN

DIGITS = 12  # hexadecimal
LIBRARIES = ("numba", "llvmlite", "numpy", "scipy")  # that calculate


class Build(NamedTuple):
    """What two processes must have in common to write the same bits."""

    insonify: str  # version
    kernels: str  # digest of their code, and whether plain Numba compiled it
    libraries: str  # names and versions
    system: str  # with the version of its C library: exponentials and sines are calculated there
    # Name, and a digest of the instructions that may be used: of multiplication and addition in one, of wider vectors.
    processor: str

    def difference(self, other: Self) -> str:
        """Name what another build has instead; empty if it is the same."""
        pairs = ((name, getattr(other, name), getattr(self, name)) for name in self._fields)
        return ", ".join(f"{name} {there} instead of {here}" for name, there, here in pairs if there != here)

    def text(self) -> str:
        """Return the whole description on one line, as records contain it."""
        return "; ".join(f"{name} {value}" for name, value in self._asdict().items())


@cache
def own_build() -> Build:
    """Return what this process calculates with."""
    _, name, instructions = cpu_target.target_context.codegen().magic_tuple()
    return Build(
        version("insonify"),
        _digest(json.dumps(digests.DIGESTS, sort_keys=True)) + "-plain" * PLAIN,
        " ".join(f"{library} {_version(library)}" for library in LIBRARIES),
        f"{platform.system()} {' '.join(filter(None, platform.libc_ver())) or platform.release()}",
        f"{name or platform.machine()}-{_digest(instructions)[:8]}",
    )


def stated_build() -> dict[str, str]:
    """Return what this process calculates with as plain texts, which another version can read."""
    return own_build()._asdict()


def _version(library: str) -> str:
    try:
        return version(library)
    except PackageNotFoundError:  # in a frozen program
        return str(import_module(library).__version__)


def _digest(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()[:DIGITS]
