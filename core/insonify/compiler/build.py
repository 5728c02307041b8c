"""What the numbers of a record depend on beside its scene: versions, the code of the kernels, and the processor."""

from __future__ import annotations

import hashlib
import json
import platform
from functools import cache
from importlib.metadata import version
from typing import NamedTuple

from numba.core.registry import cpu_target

from insonify.compiler import digests

DIGITS = 12  # hexadecimal


class Build(NamedTuple):
    """What two processes must have in common to write the same bits."""

    insonify: str  # version
    kernels: str  # digest of their code
    numba: str  # version, as of the others
    numpy: str
    # Name, and a digest of the instructions that may be used: of multiplication and addition in one, of wider vectors.
    processor: str

    def difference(self, other: Build) -> str:
        """Name what another build has instead; empty if it is the same."""
        pairs = ((name, getattr(other, name), getattr(self, name)) for name in self._fields)
        return ", ".join(f"{name} {there} instead of {here}" for name, there, here in pairs if there != here)


@cache
def own_build() -> Build:
    """Return what this process calculates with."""
    _, name, instructions = cpu_target.target_context.codegen().magic_tuple()
    return Build(
        version("insonify"),
        _digest(json.dumps(digests.DIGESTS, sort_keys=True)),
        version("numba"),
        version("numpy"),
        f"{name or platform.machine()}-{_digest(instructions)[:8]}",
    )


def _digest(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()[:DIGITS]
