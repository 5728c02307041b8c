"""Sections of editable fields, described from the field metadata of the scene; without widgets."""

import inspect
import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cache
from typing import Any, Literal, NamedTuple, get_args, get_origin

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from insonify.acoustics.water import absorption_coefficient, speed_at_sonar
from insonify.explanation.words import name_part
from insonify.files import bundled_sonars
from insonify.scene import Scene, SceneError
from insonify.scene.base import Declaration, kind_name, models_of
from insonify.scene.edit import part_at
from insonify.scene.receiver.gains import PowerTvg
from insonify.scene.seabed.materials import Material
from insonify.scene.seabed.materials.catalogue import MATERIALS
from insonify.scene.seabed.materials.pattern import PatternMap
from insonify.scene.seabed.reliefs.random_relief import RandomRelief
from insonify.scene.sonar.presets import NO_PRESET
from insonify.scene.targets import Target
from insonify.scene.water import WaterKind
from insonify.scene.water.absorptions import NEPER_PER_DB
from insonify_viewer.state.fields import PLACES, ChoiceField, FileField, NumberField, Parameter, name_field, spell

SECTIONS = ("sonar", "seabed", "track", "targets", "volumes", "water", "receiver", "receiver.recorder")
# Order of the pose fields of a target, after those of its shape.
POSED_LAST = ("heading", "pitch", "roll", "gap", "material")
# Order of the fields that all generated reliefs share, after their own.
OF_ALL_RELIEF = ("period", "extent", "mask")
PINNED = "controls"
MOST_FOUND = 16
PLACE_REACH = 100.0
USUAL_SPEED = 1500.0  # m/s, if a cast cannot be read


@dataclass(frozen=True)
class FieldSection:
    """Fields under one heading; the section of a target or a volume can be removed, that of a target locked."""

    key: str
    title: str
    parameters: tuple[Parameter, ...]
    removable: bool = False
    locked: bool = False

    @property
    def structure(self) -> tuple[Any, ...]:
        """Everything that the widgets depend on, except the values."""
        return self.locked, tuple((type(p), p.path, p.label, p.rare, _widgets(p)) for p in self.parameters)


def _widgets(parameter: Parameter) -> Any:
    """Everything that the widgets of one row depend on, except the value."""
    if isinstance(parameter, ChoiceField):
        return parameter.options
    return isinstance(parameter, NumberField) and parameter.slider is None


def sections_of(scene: Scene) -> tuple[FieldSection, ...]:
    """Describe every editable field of a scene."""
    found: list[FieldSection] = []
    for name in SECTIONS:
        part = part_at(scene, name)
        if isinstance(part, tuple):
            found += _sections_of_items(scene, name, part)
            continue
        owner, _, field = name.rpartition(".")
        parameters = tuple(_of_declaration(scene, part_at(scene, owner), field, name, 0))
        if name == "seabed":
            parameters += tuple(_of_field(scene, scene, "seed", "", 0))
        found.append(FieldSection(name, name.rpartition(".")[2].capitalize(), _named_in(scene, parameters)))
    return tuple(one for one in found if one.parameters)


class _KnownItems(NamedTuple):
    """Targets or volumes of the scene that was described last, and their sections."""

    around: tuple[Any, ...]  # what the fields of one depend on beside itself
    items: tuple[Any, ...]
    sections: tuple[FieldSection, ...]


_KNOWN: dict[str, _KnownItems] = {}  # by the name of the list


def _sections_of_items(scene: Scene, name: str, items: tuple[Any, ...]) -> tuple[FieldSection, ...]:
    """Sections of targets or volumes; those of thousands that an edit leaves as they are stay the same objects."""
    around = scene.sonar, scene.receiver, scene.seabed.depth, scene.altitude, tuple(item.kind for item in items)
    known = _KNOWN.get(name)
    before = known if known is not None and known.around == around else _KnownItems(around, (None,) * len(items), ())
    sections = tuple(
        before.sections[k] if item == before.items[k] else _section_of_item(scene, name, item, k)
        for k, item in enumerate(items)
    )
    _KNOWN[name] = _KnownItems(around, items, sections)
    return sections


def _section_of_item(scene: Scene, items: str, item: Any, index: int) -> FieldSection:
    path, title = f"{items}.{index}", name_part(item, index)
    title = title[0].upper() + title[1:]
    rows = _named_in(scene, _inside(scene, item, path, 0))
    return FieldSection(path, title, rows, removable=True, locked=getattr(item, "locked", False))


def _named_in(scene: Scene, parameters: tuple[Parameter, ...]) -> tuple[Parameter, ...]:
    """Fields with their full names."""
    return tuple(replace(each, name=name_field(scene, each.path)) for each in parameters)


def pinned_section(scene: Scene, sections: tuple[FieldSection, ...]) -> FieldSection | None:
    """Section of the fields that a scene is about; None if it names none that it has at present."""
    there = {
        parameter.path: parameter for section in sections if not section.locked for parameter in section.parameters
    }
    pinned = tuple(alone(there[path]) for path in scene.controls if path in there)
    return FieldSection(PINNED, "This scene", pinned) if pinned else None


def found_section(scene: Scene, sections: tuple[FieldSection, ...], words: str) -> FieldSection:
    """Section of the fields that match a search; fields with the words in their names come first."""
    wanted = words.lower().split()
    found = []
    for parameter in (each for section in sections if not section.locked for each in section.parameters):
        name = parameter.name
        text = f"{name} {parameter.path} {parameter.tooltip}".lower()
        if all(word in text for word in wanted):
            found.append((not all(word in name.lower() for word in wanted), alone(parameter)))
    parameters = tuple(parameter for _, parameter in sorted(found, key=lambda pair: pair[0])[:MOST_FOUND])
    return FieldSection("found", "Found" if parameters else f"No parameter is named “{words}”", parameters)


def alone(parameter: Parameter) -> Parameter:
    """Field as it is shown outside of its section, by its full name."""
    return replace(parameter, label=parameter.name, indent=0, rare=False)


def needs_file(scene: Scene, path: str, value: Any) -> bool:
    """Whether a value of the choice at a dotted path is a kind that is read from a file."""
    owner, _, name = path.removesuffix(".kind").rpartition(".")
    if not path.endswith(".kind"):
        return False
    part: BaseModel = part_at(scene, owner)
    models = models_of(type(part), name)
    return any(kind_name(model) == value and "path" in model.model_fields for model in models)


def _inside(scene: Scene, part: BaseModel, path: str, indent: int) -> tuple[Parameter, ...]:
    """Fields of one declaration."""
    names = [name for name in type(part).model_fields if name != "kind" and not _stands_aside(scene, part, name, path)]
    last = POSED_LAST if isinstance(part, Target) else OF_ALL_RELIEF if isinstance(part, RandomRelief) else ()
    names.sort(key=lambda name: last.index(name) if name in last else -1)
    if isinstance(part, WaterKind):
        names.sort(key=lambda name: name in WaterKind.model_fields)  # the speed first
    return tuple(parameter for name in names for parameter in _of_field(scene, part, name, path, indent))


def _of_field(scene: Scene, part: BaseModel, name: str, path: str, indent: int) -> Iterator[Parameter]:
    """Rows of one field: itself, or the fields of its declaration; those of a rare one are all rare."""
    extra = type(part).model_fields[name].json_schema_extra
    rare = isinstance(extra, dict) and bool(extra.get("rare"))
    for parameter in _rows(scene, part, name, path, indent):
        yield replace(parameter, rare=True) if rare else parameter


def _rows(scene: Scene, part: BaseModel, name: str, path: str, indent: int) -> Iterator[Parameter]:
    field = type(part).model_fields[name]
    value = getattr(part, name)
    path = f"{path}.{name}" if path else name
    label = spell(name)
    tooltip = field.description or ""
    if isinstance(value, BaseModel) or (value is None and models_of(type(part), name)):
        yield from _of_declaration(scene, part, name, path, indent)
    elif isinstance(part, Material) and name == "name":
        yield ChoiceField(path, label if indent else "material", tooltip, indent, value, tuple(MATERIALS))
    elif path == "sonar.preset":
        yield ChoiceField(path, label, tooltip, indent, value or NO_PRESET, (NO_PRESET, *bundled_sonars()))
    elif get_origin(field.annotation) is Literal:
        options = get_args(field.annotation)
        if len(options) > 1:
            yield ChoiceField(path, label, tooltip, indent, value, options)
    elif isinstance(value, bool):
        yield ChoiceField(path, label, tooltip, indent, value, (False, True))
    elif isinstance(value, tuple):
        yield from _of_tuple(scene, field, value, name, path, indent)
    elif name == "path":
        yield FileField(path, "file", tooltip, indent, value)
    elif not isinstance(value, str):
        applies = value_that_applies(scene, part, name) if value is None else value
        if applies is not None:
            number = _number(field, path, label, indent, applies, most=_most(scene, path))
            yield replace(number, idle=_idle(scene, path))


def _of_declaration(scene: Scene, part: BaseModel, name: str, path: str, indent: int) -> Iterator[Parameter]:
    """Rows of a nested declaration, after its kind if there are several."""
    value: BaseModel | None = getattr(part, name)
    models = [model for model in models_of(type(part), name) if kind_name(model)]
    kinds = tuple(kind_name(model) or "" for model in models)
    label = spell(name)
    if len(kinds) > 1:
        tooltip = type(part).model_fields[name].description or ""
        meanings = tuple(map(_meaning, models))
        picked = "none" if value is None else kind_name(type(value)) or ""
        yield ChoiceField(f"{path}.kind", label, tooltip, indent, picked, kinds, meanings=meanings)
    if value is not None:
        yield from _inside(scene, value, path, indent + 1 if len(kinds) > 1 else indent)


@cache
def _meaning(kind: type[BaseModel]) -> str:
    """First line of the docstring of a kind's declaration."""
    return (inspect.getdoc(kind) or "").partition("\n")[0]


def _of_tuple(
    scene: Scene, field: FieldInfo, value: tuple[Any, ...], name: str, path: str, indent: int
) -> Iterator[Parameter]:
    """Rows of a list of declarations, of pairs, or of coordinates."""
    single = name.removesuffix("s")
    axes = PLACES.get(name, tuple(str(i + 1) for i in range(len(value))))
    for index, item in enumerate(value):
        place = f"{path}.{index}"
        if isinstance(item, BaseModel):
            for parameter in _inside(scene, item, place, indent + 1):
                is_name = isinstance(parameter, ChoiceField) and parameter.path.endswith(".name")
                what = "" if isinstance(item, Material) else _named(value, index)
                yield (
                    replace(parameter, label=f"material {index + 1}", indent=indent)
                    if is_name
                    else replace(parameter, label=f"{what}{parameter.label}")
                )
        elif isinstance(item, tuple):
            for k, number in enumerate(item):
                between = _neighbours(value, index) if name == "gap" and k == 0 else None
                row = _number(field, f"{place}.{k}", f"{single} {index + 1} {axes[k]}", indent, number, ends=between)
                yield replace(row, slider=None, unit="") if axes[k] in ("from", "at") else row
        else:
            if name == "size":
                yield _number(field, place, PLACES["size"][index], indent, item)
                continue
            about_origin = (min(-PLACE_REACH, item), max(PLACE_REACH, item))
            yield _number(field, place, f"{name} {axes[index]}", indent, item, ends=about_origin)


def _named(parts: tuple[Any, ...], index: int) -> str:
    """Kind of a part, with its number among those of the same kind if there are several."""
    kind = kind_name(type(parts[index]))
    places = [place for place, part in enumerate(parts) if kind_name(type(part)) == kind]
    return f"{kind} {places.index(index) + 1} " if len(places) > 1 else f"{kind} "


def _number(
    field: FieldInfo,
    path: str,
    label: str,
    indent: int,
    value: float,
    *,
    ends: tuple[float, float] | None = None,
    most: float = math.inf,
) -> NumberField:
    """Describe a number by its field's metadata; ``ends`` replaces the slider range, ``most`` limits its upper end."""
    extra = field.json_schema_extra if isinstance(field.json_schema_extra, dict) else {}
    useful: Any = ends or extra.get("slider")
    slider = None if useful is None else (float(useful[0]), max(min(float(useful[1]), most), float(useful[0]) * 1.001))
    return NumberField(
        path=path,
        label=label,
        tooltip=field.description or "",
        unit=str(extra.get("unit", "")),
        indent=indent,
        value=float(value),
        slider=slider,
        log=bool(extra.get("log")) and ends is None,
        integer=field.annotation is int,
        bounds=_bounds(field),
    )


def _bounds(field: FieldInfo) -> tuple[float | None, float | None]:
    """Smallest and largest value that a field accepts; None where it declares no bound."""
    found: dict[str, float] = {}
    for rule in field.metadata:
        for bound in ("ge", "gt", "le", "lt"):
            if hasattr(rule, bound):
                found[bound[0]] = float(getattr(rule, bound))
    return found.get("g"), found.get("l")


def _neighbours(stations: tuple[tuple[float, float], ...], index: int) -> tuple[float, float]:
    """Slider range of a station between its neighbours, which it must not pass."""
    low = stations[index - 1][0] if index else min(-PLACE_REACH, stations[0][0])
    high = stations[index + 1][0] if index + 1 < len(stations) else max(PLACE_REACH, stations[-1][0])
    margin = 0.01 * (high - low)
    return low + margin * (index > 0), high - margin * (index + 1 < len(stations))


def _most(scene: Scene, path: str) -> float:
    """Largest value that the rest of the scene allows."""
    if path == "sonar.ping_rate":
        return known_speed(scene) / (2.0 * scene.sonar.range)
    if scene.seabed.relief.measured:
        return math.inf
    return {"track.altitude": scene.seabed.depth, "track.depth": 0.999 * scene.seabed.depth}.get(path, math.inf)


def _idle(scene: Scene, path: str) -> str:
    """Reason why a number has no effect in this scene; empty if it has."""
    if path == "receiver.source_level":
        return _idle_source_level(scene)
    if path.endswith(".shininess"):
        return _idle_shininess(scene, path)
    return _idle_frequency(scene) if path == "sonar.frequency" else ""


def _idle_frequency(scene: Scene) -> str:
    """Reason why the frequency changes nothing."""
    beams, receiver = (scene.sonar.beam, scene.sonar.vertical), scene.receiver
    if any(part.by_frequency for part in (*beams, scene.water.absorption)) or receiver.speckle.speckled:
        return ""
    if scene.water.kind != "uniform":
        return ""  # where water focuses sound, the frequency limits the level
    materials = (*scene.seabed.material.materials, *(target.material for target in scene.targets))
    if scene.sonar.law != "light" and any(material.model is not None for material in materials):
        return ""
    return (
        "changes nothing here: it acts on a line-array beam, Francois-Garrison absorption, caustics, speckle and named "
        "sediments"
    )


def _idle_shininess(scene: Scene, path: str) -> str:
    """Reason why the exponent of a mirror lobe changes nothing."""
    material = part_at(scene, path.rpartition(".")[0])
    if not isinstance(material, Material) or material.value_in_force("specular", scene.sonar.scattering_frequency):
        return ""
    return "changes nothing here: the specular share is 0"


def _idle_source_level(scene: Scene) -> str:
    """Reason why the source level changes nothing that is seen: pictures are relative to the echo of a level bed."""
    receiver = scene.receiver
    if receiver.noise is not None or receiver.interference is not None or receiver.tvg.kind != "none":
        return ""
    return "changes nothing here: it acts beside noise, interference and time-varied gain"


def known_speed(scene: Scene) -> float:
    """Speed of sound at the sonar in m/s; a usual value if the cast of the water cannot be read."""
    try:
        return speed_at_sonar(scene)
    except SceneError:
        return USUAL_SPEED


def _stands_aside(scene: Scene, part: BaseModel, name: str, path: str) -> bool:
    """Whether a field is hidden: it is a section of its own, meaningless beside others, or shown as a curve."""
    if f"{path}.{name}" in SECTIONS:
        return True
    if isinstance(part, WaterKind) and name in part.table and isinstance(getattr(part, name), tuple):
        return True
    if path.startswith("seabed.relief.of") and isinstance(part, PatternMap | Material):
        # Dunes lie along the track and imitate a material without specular share.
        return name == "heading" or (isinstance(part, Material) and name not in ("name", "diffuse"))
    if isinstance(part, Material) and name in ("reflection", "speed_ratio"):
        return scene.sonar.bounces == 0
    if isinstance(part, Material) and name == "speckle_shape":
        return scene.receiver.speckle.texture is None
    if isinstance(part, Target) and name == "locked":
        return True
    return isinstance(part, Declaration) and name in part.idle_fields


def value_that_applies(scene: Scene, part: BaseModel, name: str) -> float | None:
    """Value that applies to a field that the scene leaves open."""
    if isinstance(part, PowerTvg):
        depth = scene.seabed.depth - scene.altitude
        return absorption_coefficient(scene.water.absorption, scene.sonar.frequency, depth) * 1e3 / NEPER_PER_DB
    if name in ("altitude", "depth"):
        return scene.altitude if name == "altitude" else scene.seabed.depth - scene.altitude
    if name == "reference_speed":
        return known_speed(scene)
    return part.value_in_force(name, scene.sonar.scattering_frequency) if isinstance(part, Declaration) else None
