"""Kinds and formats of somebody else's package, known for the length of a block."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from insonify.io.formats import FileFormat, FormatRegistry
from insonify.scene.base import Family, rebuild_declarations


@contextmanager
def forgetting(*families: Family) -> Iterator[None]:
    """Forget kinds of these families that modules of others declare within the block."""
    try:
        yield
    finally:
        for family in families:
            models = family._models.items()
            family._models = {kind: model for kind, model in models if model.__module__.startswith("insonify.")}
        rebuild_declarations()


@contextmanager
def added_format(registry: FormatRegistry[Any], extra: FileFormat[Any]) -> Iterator[None]:
    formats = registry.formats()
    formats.append(extra)
    try:
        yield
    finally:
        formats.remove(extra)
