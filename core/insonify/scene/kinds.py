"""Families of declarations picked by their ``kind``: every kind is one class, found without being listed.

A family holds the kinds of its own package, those that installed packages bring by an entry point of the group
``insonify.<family>``, and those that are declared later. A field of a family accepts any of them.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from typing import Any, TypeVar

from pydantic import BaseModel, GetCoreSchemaHandler
from pydantic_core import CoreSchema, core_schema

from insonify.plugins import announced, modules_in

Model = TypeVar("Model", bound=BaseModel)
_DECLARED: list[type[BaseModel]] = []


def kind_name(model: type[BaseModel]) -> str | None:
    """Return the ``kind`` by which a declaration is picked, None for one that is not picked by kind."""
    field = model.model_fields.get("kind")
    return field.default if field is not None and isinstance(field.default, str) else None


class Family:
    """All kinds of one choice."""

    def __init__(self, name: str, package: str | None = None) -> None:
        self.name, self.package = name, package
        self._models: dict[str, type[BaseModel]] = {}
        self._discovered = False
        self._used: set[type[BaseModel]] = set()

    def add(self, model: type[BaseModel]) -> None:
        """Add a kind; a declaration of this family does so when its class is made."""
        kind = kind_name(model)
        if kind is None:
            return
        self._models[kind] = model
        if self._discovered and issubclass(model, tuple(self._used)):
            rebuild_declarations()

    @contextmanager
    def without(self, *kinds: str) -> Iterator[None]:
        """Forget kinds after the block, for tests that declare them."""
        try:
            yield
        finally:
            for kind in kinds:
                self._models.pop(kind, None)
            rebuild_declarations()

    def models(self, base: type[Model]) -> dict[str, type[Model]]:
        """Return the kinds that derive from a class, by name, in the order of their ranks."""
        self._discover()
        found = sorted(self._models.items(), key=lambda item: getattr(item[1], "rank", 0))
        return {kind: model for kind, model in found if issubclass(model, base)}

    def use(self, base: type[BaseModel]) -> None:
        """Note that a field holds the kinds that derive from a class: a later one of these rebuilds the field."""
        self._used.add(base)

    def _discover(self) -> None:
        """Import the package's modules and what installed packages bring; classes add themselves."""
        if self._discovered:
            return
        # A kind that holds others of its family needs them while its own module is being imported: the other modules
        # are then imported first, and the outer loop has nothing left to do.
        if self.package is not None:
            modules_in(self.package)
        for entry in announced(f"insonify.{self.name}"):
            entry.load()
        self._discovered = True


class KindOf:
    """Annotation of a field that holds one declaration of a family."""

    def __init__(
        self,
        family: Family,
        base: type[BaseModel] = BaseModel,
        *,
        default: str = "missing",
        text: str | None = None,
        number: str | None = None,
    ) -> None:
        self.family, self.base, self.default, self.text, self.number = family, base, default, text, number

    @property
    def models(self) -> tuple[type[BaseModel], ...]:
        """The declarations that the field accepts."""
        return tuple(self.family.models(self.base).values())

    def kind(self, value: Any) -> str:
        """Read the kind of a raw or validated value."""
        if isinstance(value, str):
            return self.text or value
        if self.number is not None and isinstance(value, (int, float)):
            return self.number
        if isinstance(value, dict):
            return str(value.get("kind", self.default))
        return str(getattr(value, "kind", self.default))

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        """Accept every kind of the family, told apart by its name."""
        choices = {str(kind_name(model)): handler.generate_schema(model) for model in self.models}
        self.family.use(self.base)
        return core_schema.tagged_union_schema(choices, discriminator=self.kind)


def declare(model: type[BaseModel], family: Family | None) -> None:
    """Register a declaration when its class is made, and add it to its family."""
    _DECLARED.append(model)
    if family is not None:
        family.add(model)


def rebuild_declarations() -> None:
    """Update the fields of all declarations to the present kinds of their families."""
    models_of.cache_clear()
    # In the order in which they were made: a declaration comes after all that it holds.
    for model in _DECLARED:
        model.model_rebuild(force=True)


@cache
def models_of(parent: type[BaseModel], field: str) -> tuple[type[BaseModel], ...]:
    """List the declarations that a field can hold, in order; empty for plain numbers and names."""
    if field not in parent.model_fields:
        return ()
    info = parent.model_fields[field]
    found: list[type[BaseModel]] = []
    pending: list[Any] = [*info.metadata, info.annotation]
    if any(isinstance(entry, KindOf) for entry in info.metadata):
        pending.remove(info.annotation)
    while pending:
        annotation = pending.pop(0)
        kinds = [entry for entry in getattr(annotation, "__metadata__", ()) if isinstance(entry, KindOf)]
        if isinstance(annotation, KindOf):
            found.extend(annotation.models)
        elif kinds:
            pending.extend(kinds)
        elif isinstance(annotation, type) and issubclass(annotation, BaseModel):
            found.append(annotation)
        else:
            pending.extend(getattr(annotation, "__args__", ()))
    return tuple(found)
