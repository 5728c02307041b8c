"""Scenes from plain values and from edits of another scene, with one-sentence errors."""

import math
import re
from collections.abc import Mapping
from copy import deepcopy
from typing import Any, Self

from pydantic import BaseModel, ValidationError

from insonify.errors import SceneError, is_count
from insonify.scene.base import Declaration, kind_name, models_of
from insonify.scene.faults import describe_fault, unit_at
from insonify.scene.links import read_literal
from insonify.scene.scene import Scene
from insonify.scene.sonar.presets import NO_PRESET, OF_RECEIVER

# By the unit of a value: what else people write, and its factor.
UNITS = {
    "m": {"mm": 1e-3, "cm": 1e-2, "dm": 0.1, "km": 1e3, "ft": 0.3048, "nmi": 1852.0},
    "s": {"ns": 1e-9, "µs": 1e-6, "us": 1e-6, "ms": 1e-3, "µ": 1e-6, "u": 1e-6, "m": 1e-3, "min": 60.0},
    "Hz": {"kHz": 1e3, "MHz": 1e6, "mHz": 1e-3, "k": 1e3, "M": 1e6, "m": 1e-3, "µ": 1e-6, "u": 1e-6},
    "°": {"deg": 1.0, "degrees": 1.0, "rad": math.degrees(1.0), "mrad": math.degrees(1e-3)},
    "m/s": {"kn": 1852.0 / 3600.0, "kt": 1852.0 / 3600.0, "km/h": 1.0 / 3.6, "km/s": 1e3},
    "dB/km": {"dB/m": 1e3},
    "°C": {"C": 1.0},
}
COMPASS = ("T", "°T")  # of an angle clockwise from north
QUANTITY = re.compile(r"(?P<number>[-+]?(?:\d+[.,]?\d*|[.,]\d+)(?:[eE][-+]?\d+)?)\s*(?P<unit>\D*)")


def parse_quantity(text: str, unit: str, like: str = "") -> float | None:
    """Read a number with a unit that people write, or without one."""
    parts = QUANTITY.fullmatch(text.strip().replace("−", "-"))
    if parts is None:
        return None
    number, written = parts["number"].replace(",", "."), parts["unit"]
    if not written and "e" not in number.lower():
        shown = QUANTITY.fullmatch(like.strip())
        written = shown["unit"] if shown else ""
    if unit == "°" and written.upper() in COMPASS:
        turned = 90.0 - float(number)  # headings run the other way round, from east
        return turned + 360.0 * math.ceil((-180.0 - turned) / 360.0) if math.isfinite(turned) else None
    scale = _scale(written, unit)
    value = math.nan if scale is None else float(number) * scale
    return value if math.isfinite(value) else None


def _scale(written: str, unit: str) -> float | None:
    """Factor from a written unit to the unit of a value; None for an unknown one."""
    if written in ("", unit):
        return 1.0
    scales = UNITS.get(unit, {})
    if written in scales:
        return scales[written]
    alike = {scale for name, scale in scales.items() if name.lower() == written.lower()}
    return alike.pop() if len(alike) == 1 else None


def build(values: Mapping[str, Any]) -> Scene:
    """Validate plain values into a scene."""
    try:
        return Scene.model_validate(dict(values))
    except ValidationError as error:
        raise SceneError(describe_fault(error, Scene)) from None


def plain(scene: Scene) -> dict[str, Any]:
    """Convert a scene to plain values for TOML, without None, because TOML has no null."""
    values: dict[str, Any] = _without_none(scene.model_dump(mode="json"))
    return values


def _without_none(value: Any) -> Any:
    if isinstance(value, list):
        return [_without_none(item) for item in value]
    if not isinstance(value, dict):
        return value
    return {key: _without_none(item) for key, item in value.items() if item is not None}


def edit(scene: Scene, changes: Mapping[str, Any]) -> Scene:
    """Apply changes to a scene, then validate the whole scene."""
    values = plain(scene)
    if isinstance(changes.get("sonar"), str):
        changes = {"sonar.preset" if path == "sonar" else path: value for path, value in changes.items()}
    if changes.get("sonar.preset") not in (None, NO_PRESET):
        # Numbers of the present sonar would override those of its successor.
        values["sonar"] = {}
        for path in OF_RECEIVER:
            _put(values, path, None)
    # A kind decides which fields exist, so kinds go first whatever the order given.
    kinds = [path for path in changes if path.endswith("kind")]
    for path in kinds:
        _put(values, path, changes[path])
    if kinds:
        # The new kind of a changed choice may lack some fields of the old one.
        values = {key: _shared_fields(child, Scene, key) for key, child in values.items()}
    for path, value in changes.items():
        if path not in kinds:
            _put(values, path, value)
    return build(values)


def read_setting(text: str, option: str = "--set") -> tuple[str, Any]:
    """Split ``path.to.field=value``; a number may have a unit (``3kn``), another value that is not TOML is text."""
    path, equals, literal = text.partition("=")
    path = path.strip()
    if not equals or not path:
        example = "path.to.field=value; write for example sonar.range=75" if option == "--set" else "name=value"
        raise SceneError(f"{option} {text!r} is not of the form {example}")
    value = read_literal(literal)
    location = tuple(int(step) if is_count(step) else step for step in path.split("."))
    if isinstance(value, str) and (unit := unit_at(location, Scene)):
        number = parse_quantity(value, unit)
        value = value if number is None else number
    return path, value


def _put(values: dict[str, Any], path: str, value: Any) -> None:
    """Set one dotted path in nested plain values."""
    *parents, last = path.split(".")
    place: Any = values
    value = deepcopy(value)  # a later path may change a part of it
    for key in parents:
        child = _child(place, key, path)
        if not isinstance(child, (dict, list)):
            # A bare name stands for a table.
            child = {"name" if key == "material" else "kind": child} if isinstance(child, str) else {}
            place[key if isinstance(place, dict) else int(key)] = child
        place = child
    if isinstance(place, list):
        _child(place, last, path)
        place[int(last)] = value
    elif value is None:
        place.pop(last, None)
    elif last == "kind" and place.get("kind") not in (None, value):
        place["kind"] = _Switched(value, place["kind"])
    else:
        place[last] = value


class _Switched(str):
    """Name of a new kind, with the name of the kind that it replaces."""

    before: str

    def __new__(cls, kind: str, before: str) -> Self:
        """Return the name of a kind, and the name of the kind it replaces."""
        switched = super().__new__(cls, kind)
        switched.before = before
        return switched


def _child(place: Any, key: str, path: str) -> Any:
    if isinstance(place, dict):
        return place.get(key)
    if not is_count(key) or int(key) >= len(place):
        raise SceneError(f"{path}: there is no item {key!r}; the list has {len(place)}, numbered from 0")
    return place[int(key)]


def _shared_fields(value: Any, parent: type[BaseModel], key: str) -> Any:
    models = models_of(parent, key)
    if isinstance(value, list):
        return [_shared_fields(item, parent, key) for item in value]
    if not isinstance(value, dict):
        return value
    kind = value.get("kind")
    model = _model_of_kind(models, kind) or (models[0] if models else None)
    if model is None:
        return value
    foreign = _foreign_fields(models, model, kind) if isinstance(kind, _Switched) else frozenset()
    kept = {name: _shared_fields(child, model, name) for name, child in value.items() if name not in foreign}
    return kept | {"kind": str(kind)} if isinstance(kind, _Switched) else kept


def _foreign_fields(models: tuple[type[Declaration], ...], model: type[Declaration], kind: _Switched) -> frozenset[str]:
    """Fields of the previous kind that the new one lacks, or that are columns of a different table."""
    before = _model_of_kind(models, kind.before)
    if before is None:
        return frozenset()
    lacking = frozenset(before.model_fields.keys() - model.model_fields.keys())
    return lacking if before.table == model.table else lacking | before.table | model.table


def _model_of_kind(models: tuple[type[Declaration], ...], kind: Any) -> type[Declaration] | None:
    return next((model for model in models if kind_name(model) == kind), None)


def part_at(scene: Declaration, path: str) -> Any:
    """Part of a scene, or of a part of one, at a dotted path; the whole for an empty one, None if there is none."""
    place: Any = scene
    for step in filter(None, path.split(".")):
        is_position = isinstance(place, tuple) and is_count(step) and int(step) < len(place)
        place = place[int(step)] if is_position else getattr(place, step, None)
    return place
