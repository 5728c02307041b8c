"""Values to try: links of the description that move a control and move it back; without widgets."""

from __future__ import annotations

from typing import Any

from insonify.scene import Scene, SceneError, edit, plain
from insonify.scene.edit import part_at
from insonify.scene.links import Link, split_description
from insonify_viewer.state.fields import NumberField
from insonify_viewer.state.quantities import slider_position, slider_value


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
        self._before[number] = _part(scene, link.path.removesuffix(".kind"))
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


def _part(scene: Scene, path: str) -> dict[str, Any]:
    """Plain value of a part by its path; None where the scene leaves it open."""
    values: Any = plain(scene)
    for step in path.split("."):
        values = values[int(step)] if isinstance(values, list) else values.get(step)
    return {path: values}
