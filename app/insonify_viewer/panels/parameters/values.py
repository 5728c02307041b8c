"""Values of fields: tried by links, reset, and followed while a slider moves; without widgets."""

from collections.abc import Iterable
from dataclasses import replace
from typing import Any

from pydantic import BaseModel

from insonify.scene import Scene, SceneError, edit, plain
from insonify.scene.edit import part_at
from insonify.scene.links import Link, split_description
from insonify_viewer.state.fields import NumberField, Parameter
from insonify_viewer.state.quantities import format_quantity, slider_position, slider_value
from insonify_viewer.state.sections import FieldSection, sections_of, value_that_applies


class Trials:
    """Links of a scene's description, and the values that they replaced."""

    def __init__(self) -> None:
        self._before: dict[int, dict[str, Any]] = {}  # by number of the link

    def forget(self) -> None:
        """Forget the replaced values, when another scene is opened."""
        self._before = {}

    def links(self, scene: Scene) -> tuple[Link, ...]:
        """Links of the description, in order."""
        return tuple(part for part in split_description(scene.description) if isinstance(part, Link))

    def tried(self, scene: Scene) -> tuple[bool, ...]:
        """Whether the value of each link was tried, and still holds."""
        return tuple(number in self._before and _holds(scene, link) for number, link in enumerate(self.links(scene)))

    def follow(self, scene: Scene, number: int) -> tuple[Link, dict[str, Any]]:
        """Return a link and the edit that it stands for: its value, or the value before if it is tried already."""
        link = self.links(scene)[number]
        if number in self._before and _holds(scene, link):
            return link, self._before[number]
        part = link.path.removesuffix(".kind")
        self._before[number] = {part: value_at(plain(scene), part)}
        return link, {link.path: link.value}


def row_of(link_path: str, paths: tuple[str, ...]) -> str:
    """Path of the row that shows a field: its own, that of its kind, or the first within it."""
    for path in (link_path, f"{link_path}.kind"):
        if path in paths:
            return path
    return next((path for path in paths if path.startswith(f"{link_path}.")), link_path)


def glide_value(number: NumberField, end: float, share: float) -> float:
    """Value of a number on its way to another, even along its slider."""
    if number.slider is None or share >= 1.0:
        return end
    places = [slider_position(value, number.slider, log=number.log) for value in (number.value, end)]
    place = places[0] + share * (places[1] - places[0])
    return slider_value(place, number.slider, log=number.log, integer=number.integer)


def _holds(scene: Scene, link: Link) -> bool:
    """Whether a scene has the value of a link: setting it changes nothing."""
    try:
        return part_at(edit(scene, {link.path: link.value}), link.path) == part_at(scene, link.path)
    except SceneError:
        return False


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
            and value_at(now, row.path) != value_at(self._values, row.path)
            and self._is_same_part(scene, row.path)
        }

    def edit(self, paths: Iterable[str]) -> dict[str, Any]:
        """Edit that resets fields; a kind returns with all that belongs to it."""
        owners = sorted({path.removesuffix(".kind") for path in paths}, key=len)
        return {owner: value_at(self._values, owner) for owner in owners}

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


def value_at(values: Any, path: str) -> Any:
    """Plain value at a dotted path; None where it is left open."""
    for step in path.split("."):
        if values is None:
            return None
        values = values[int(step)] if isinstance(values, list) else values.get(step)
    return values


def follow_values(scene: Scene, sections: tuple[FieldSection, ...]) -> tuple[FieldSection, ...] | None:
    """Give the numbers of sections the values that they have in another scene."""
    # Which fields there are, their labels and the ends of their sliders stay as they are: they follow once the slider
    # is let go, and no row appears or disappears under the mouse.
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
    """Field with its value in a scene; None if it is not numeric and its value differs, or there is no such field."""
    value = _applied_value(scene, parameter.path)
    if value == parameter.value:
        return parameter
    if value is None or not isinstance(parameter, NumberField):
        return None
    return replace(parameter, value=float(value))


def _applied_value(scene: Scene, path: str) -> Any:
    """Value of the field at a dotted path, the one that applies if the scene leaves it open."""
    value = part_at(scene, path)
    if value is not None:
        return value
    owner, _, name = path.rpartition(".")
    part = part_at(scene, owner)
    if name == "preset" or (part is None and name == "kind"):
        return "none"
    return value_that_applies(scene, part, name) if isinstance(part, BaseModel) else None
