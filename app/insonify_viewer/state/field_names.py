"""Names of fields and of edits, in the words of the window."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from insonify.display.display_options import DisplayOptions
from insonify.scene import Scene
from insonify.scene.edit import part_at

# Names of the places within a pair or a row, by field.
PLACES = {
    "peaks": ("fx", "fy"),
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
AMBIGUOUS = {("seabed", "depth"): "bed depth", ("track", "depth"): "fish depth", ("track", "heading"): "track heading"}
# Display options whose names are not those of the window.
OPTIONS = {"side": "sides", "reverse": "reversed colours", "levels": "contrast", "draped": "draping in 3-D"}
SPELLED = {"tvg": "TVG"}


def name_field(scene: Scene, path: str) -> str:
    """Name the field at a dotted path, as "beam width", "pipe 1 gap height 4" or "relief rms"."""
    steps = path.split(".")
    if tuple(steps) in AMBIGUOUS:
        return AMBIGUOUS[steps[0], steps[1]]
    words: list[str] = []
    for k, step in enumerate(steps):
        if step.isdigit():
            words = [*words[:-1], *_name_item(scene, steps[: k + 1], words[-1] if words else "")]
        elif step not in ("kind", "name") or k == 0:
            words.append(SPELLED.get(step, step.replace("_", " ")))
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


def _name_item(scene: Scene, steps: list[str], of: str) -> tuple[str, ...]:
    """Name an item of a list: a part by its kind and number, a number by its place."""
    number, owner = int(steps[-1]) + 1, steps[-2]
    item = part_at(scene, ".".join(steps))
    kind = getattr(item, "kind", "")
    if kind:
        return (f"{kind.replace('_', ' ')} {number}",)
    if owner.isdigit():  # a place within a pair of a list of pairs
        place = PLACES.get(steps[-3], ())
        return (of, place[number - 1]) if number <= len(place) else (of, str(number))
    if owner in PLACES and not isinstance(item, tuple):
        return (of, PLACES[owner][number - 1]) if number <= len(PLACES[owner]) else (of, str(number))
    return (f"{of.removesuffix('s')} {number}",)
