"""What somebody else's package brings, known for the length of a block: kinds, tracers, formats and materials."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from insonify.io.formats import FileFormat, FormatRegistry
from insonify.scene.base import Family, rebuild_declarations
from insonify.scene.seabed.materials.catalogue import MATERIALS, read_materials
from insonify.tracers import base


@contextmanager
def forgetting(family: Family, *kinds: str) -> Iterator[None]:
    """Forget kinds that are declared within the block."""
    try:
        yield
    finally:
        for kind in kinds:
            family._models.pop(kind, None)
        rebuild_declarations()


@contextmanager
def forgetting_tracers(*names: str) -> Iterator[None]:
    try:
        yield
    finally:
        for name in names:
            base._DECLARED.pop(name, None)


@contextmanager
def added_format(registry: FormatRegistry[Any], extra: FileFormat[Any]) -> Iterator[None]:
    formats = registry.formats()
    formats.append(extra)
    try:
        yield
    finally:
        formats.remove(extra)


@contextmanager
def added_materials(folder: Path) -> Iterator[None]:
    kept = dict(MATERIALS)
    try:
        MATERIALS.update(read_materials(folder))
        yield
    finally:
        MATERIALS.data = kept
