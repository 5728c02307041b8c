"""Values of the fields while a slider moves, without describing every field anew."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from pydantic import BaseModel

from insonify.scene import Scene
from insonify.scene.edit import part_at
from insonify_viewer.panels.parameters.sections import FieldSection, value_that_applies
from insonify_viewer.state.fields import NumberField, Parameter


def follow_values(scene: Scene, sections: tuple[FieldSection, ...]) -> tuple[FieldSection, ...] | None:
    """Give the numbers of sections the values that they have in another scene.

    Which fields there are, their labels and the ends of their sliders stay as they are: they follow once the slider is
    let go, and no row appears or disappears under the mouse.
    """
    followed = []
    for section in sections:
        found = [_followed(scene, parameter) for parameter in section.parameters]
        parameters = tuple(parameter for parameter in found if parameter is not None)
        if len(parameters) < len(found):
            return None
        same = all(new is old for new, old in zip(parameters, section.parameters, strict=True))
        followed.append(section if same else replace(section, parameters=parameters))
    return tuple(followed)


def _followed(scene: Scene, parameter: Parameter) -> Parameter | None:
    """Field with its value in a scene; None if it is no number and its value differs, or if there is no such field."""
    value = _value_at(scene, parameter.path)
    if value == parameter.value:
        return parameter
    if value is None or not isinstance(parameter, NumberField):
        return None
    return replace(parameter, value=float(value))


def _value_at(scene: Scene, path: str) -> Any:
    """Value of the field at a dotted path, the one that applies if the scene leaves it open."""
    value = part_at(scene, path)
    if value is not None:
        return value
    owner, _, name = path.rpartition(".")
    part = part_at(scene, owner)
    return value_that_applies(scene, part, name) if isinstance(part, BaseModel) else None
