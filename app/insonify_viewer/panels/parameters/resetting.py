"""Fields that differ from the scene as it was opened, and the edits that reset them; without widgets."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from insonify.scene import Scene, plain
from insonify.scene.edit import part_at
from insonify_viewer.panels.parameters.sections import sections_of
from insonify_viewer.state.fields import NumberField, Parameter
from insonify_viewer.state.quantities import format_quantity


class Resets:
    """The values to which fields are reset: those of the scene as it was opened."""

    def __init__(self) -> None:
        self._opened: Scene | None = None
        self._first: dict[str, Parameter] = {}
        self._values: dict[str, Any] = {}  # of the scene as it was opened

    def follow(self, opened: Scene) -> None:
        """Take the values of a scene that is opened."""
        if opened is not self._opened:
            self._opened, self._values = opened, plain(opened)
            self._first = {row.path: row for section in sections_of(opened) for row in section.parameters}

    def changed(self, scene: Scene, parameters: Iterable[Parameter]) -> dict[str, str]:
        """Find the fields that can be reset, each with the text of the value that it had."""
        now = plain(scene)
        return {
            row.path: _text(self._first[row.path])
            for row in parameters
            if row.path in self._first
            and type(row) is type(self._first[row.path])
            and _value_at(now, row.path) != _value_at(self._values, row.path)
            and self._is_same_part(scene, row.path)
        }

    def edit(self, paths: Iterable[str]) -> dict[str, Any]:
        """Edit that resets fields; a kind returns with all that belongs to it."""
        owners = sorted({path.removesuffix(".kind") for path in paths}, key=len)
        return {owner: _value_at(self._values, owner) for owner in owners}

    def _is_same_part(self, scene: Scene, path: str) -> bool:
        """Whether a path leads into the same kind of target or volume: others may have been removed before it."""
        part = ".".join(path.split(".")[:2])
        if self._opened is None or not part.startswith(("targets.", "volumes.")):
            return True
        return getattr(part_at(scene, part), "kind", None) == getattr(part_at(self._opened, part), "kind", None)


def _text(parameter: Parameter) -> str:
    if isinstance(parameter, NumberField):
        return format_quantity(parameter.value, parameter.unit)
    return str(parameter.value).replace("_", " ")


def _value_at(values: Any, path: str) -> Any:
    """Plain value at a dotted path; None where it is left open."""
    for step in path.split("."):
        if values is None:
            return None
        values = values[int(step)] if isinstance(values, list) else values.get(step)
    return values
