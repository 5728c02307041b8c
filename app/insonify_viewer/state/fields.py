"""Descriptions and names of editable fields: a number on a slider, a choice among names, a file."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from insonify.display.display_options import DisplayOptions
from insonify.explanation.words import name_part
from insonify.scene import Scene
from insonify.scene.edit import part_at
from insonify_viewer.state.quantities import format_quantity

# Names of the places within a pair or a row, by field.
PLACES = {
    "peaks": ("waves in x", "waves in y"),
    "points": ("lag", "value"),
    "gap": ("along", "height"),
    "gain": ("from", "level"),
    "gains": ("at", "level"),
    "levels": ("angle", ""),
    "position": ("x", "y", "z"),
    "start": ("x", "y"),
    "size": ("length", "width", "height"),
}
# Parts of the scene that go without saying in the names of their fields.
SILENT = ("sonar", "seabed", "track", "water", "receiver", "recorder")
# Fields whose names need the part that holds them.
AMBIGUOUS = {("seabed", "depth"): "bed depth", ("track", "depth"): "sonar depth", ("track", "heading"): "track heading"}
# Display options whose names are not those of the window.
OPTIONS = {"side": "sides", "reverse": "reversed colours", "levels": "contrast", "draped": "draping in 3-D"}
# Names of fields in plain words, where their own are short for the scene file.
SPELLED = {"tvg": "TVG", "rms": "rms height", "law": "echo law", "mask": "covered area"}


def spell(name: str) -> str:
    """Write the name of a field as people read it."""
    return SPELLED.get(name, name.replace("_", " "))


@dataclass(frozen=True)
class NumberField:
    """A number with a slider, or without one if the field declares no slider range."""

    path: str  # dotted path of the field, as ``insonify.scene.edit`` takes it
    label: str  # texts to show
    tooltip: str
    unit: str
    indent: int  # nesting depth within the section
    value: float  # value that applies, also if the scene leaves the field open
    slider: tuple[float, float] | None  # (float, float) ends of the slider
    log: bool  # whether the slider is logarithmic
    integer: bool  # whether the number is an integer
    idle: str = ""  # why the number has no effect at present; empty if it has
    rare: bool = False  # whether few people change it, so that it is folded away
    name: str = ""  # full name, understood without the rows around it; empty if that is the label
    # (float or None, float or None) smallest and largest value that the scene accepts; None where there is no
    # bound.
    bounds: tuple[float | None, float | None] = (None, None)

    @property
    def about(self) -> str:
        """Tooltip with the unit and the range of the number."""
        return f"{self.tooltip} ({self.unit or 'no unit'}; {self._range()})"

    def _range(self) -> str:
        """Values that the scene accepts, or the ends of the slider where it accepts more."""
        low, high = (None if bound is None else format_quantity(bound, self.unit) for bound in self.bounds)
        if low is not None and high is not None:
            return f"{low} to {high}"
        if self.slider is not None:
            first, last = (format_quantity(end, self.unit) for end in self.slider)
            return f"slider from {first} to {last}"
        return f"from {low}" if low is not None else f"up to {high}" if high is not None else "any number"


@dataclass(frozen=True)
class ChoiceField:
    """A choice among names; `NumberField` explains the attributes."""

    path: str
    label: str
    tooltip: str
    indent: int
    value: str | int
    options: tuple[str | int, ...]  # values to choose from
    rare: bool = False
    name: str = ""
    meanings: tuple[str, ...] = ()  # what each of them is, in a sentence; empty where their names say it

    @property
    def about(self) -> str:
        """Tooltip with the meaning of the value."""
        meaning = self.meanings[self.options.index(self.value)] if self.meanings else ""
        return f"{self.tooltip}; {self.value}: {meaning}" if meaning else self.tooltip


@dataclass(frozen=True)
class FileField:
    """A file; `NumberField` explains the attributes."""

    path: str
    label: str
    tooltip: str
    indent: int
    value: str
    rare: bool = False
    name: str = ""


Parameter = NumberField | ChoiceField | FileField


def name_field(scene: Scene, path: str) -> str:
    """Name the field at a dotted path, as "beam width", "pipe 1 gap height 4" or "relief rms"."""
    steps = path.split(".")
    if tuple(steps) in AMBIGUOUS:
        return AMBIGUOUS[steps[0], steps[1]]
    words: list[str] = []
    for k, step in enumerate(steps):
        if step.isdigit():
            words = _name_item(scene, steps[: k + 1], words)
        elif step not in ("kind", "name") or k == 0:
            words.append(spell(step))
    while len(words) > 1 and words[0] in SILENT:
        words = words[1:]
    return " ".join(words)


def name_edit(scene: Scene, changes: Mapping[str, Any]) -> str:
    """Name an edit by the field that it changes, or by the part of the scene that holds all of its fields."""
    paths = list(changes)
    if not paths:
        return "nothing"
    if len(paths) == 1:
        return name_field(scene, paths[0])
    parts = [path.split(".") for path in paths]
    common = 0
    while all(len(part) > common + 1 and part[common] == parts[0][common] for part in parts):
        common += 1
    return name_field(scene, ".".join(parts[0][:common])) if common else name_field(scene, paths[0])


def name_display(before: DisplayOptions, after: DisplayOptions) -> str:
    """Name a change of display options by the one or two that differ, as "palette" or "gain, contrast"."""
    changed = [name for name, old, new in zip(before._fields, before, after, strict=True) if old != new]
    return ", ".join(OPTIONS.get(name, name.replace("_", " ")) for name in changed) if len(changed) < 3 else "display"


def _name_item(scene: Scene, steps: list[str], words: list[str]) -> list[str]:
    """Name an item of a list: a part by its kind and number alone, a number by its place after the words so far."""
    number, owner = int(steps[-1]) + 1, steps[-2]
    item = part_at(scene, ".".join(steps))
    if kind := getattr(item, "kind", ""):
        return [f"material {number}" if kind == "uniform" else name_part(item, number - 1)]
    if owner.isdigit() or (owner in PLACES and not isinstance(item, tuple)):  # a place within a pair or a row
        place = PLACES.get(steps[-3] if owner.isdigit() else owner, ())
        return [*words, place[number - 1] if number <= len(place) else str(number)]
    return [*words[:-1], f"{words[-1].removesuffix('s')} {number}"]
