"""Scenes drawn at random from the declarations themselves: every field, within its own bounds, now and then beyond."""

import math
import typing
from collections.abc import Callable, Iterable
from typing import Any, Literal

from hypothesis import strategies as st
from pydantic import BaseModel
from pydantic.fields import FieldInfo

from insonify.files import bundled_meshes
from insonify.scene import Scene
from insonify.scene.base import KindOf, kind_name
from insonify.scene.seabed.materials.catalogue import MATERIALS

Draw = Callable[[st.SearchStrategy[Any]], Any]
CELLS = (3, 200)  # of a period, and likewise of a range
FARTHEST, FARTHEST_BENT = 1000, 300  # cells of a range; a ping may take 64,000 rays where water refracts
MOST_RAYS_ON = 3  # bounces; every one may split a ray
DENSEST = 40.0  # scatterers per m²
# Kinds that are read from files, which a drawn scene has none of.
FILES = {"dem", "image", "backscatter", "recorded", "cast", "file"}
# One in so many numbers comes from the whole of its bounds, the others from where its slider moves.
RARELY = 12


@st.composite
def scenes(draw: Draw) -> dict[str, Any]:
    """Plain values of a small scene, most of which are valid."""
    values: dict[str, Any] = draw(declared(Scene))
    seabed, sonar, track = (values.setdefault(part, {}) for part in ("seabed", "sonar", "track"))
    spacing = seabed["spacing"] = draw(log_floats(0.05, 2.0))
    uniform = values.get("water", {}).get("kind", "uniform") == "uniform"
    reach = sonar["range"] = spacing * draw(st.integers(5, FARTHEST if uniform else FARTHEST_BENT))
    sonar["bins"] = draw(st.integers(1, 96))
    sonar["bounces"] = draw(st.integers(0, MOST_RAYS_ON)) if draw(one_in(6)) else 0
    track["pings"] = draw(st.integers(1, 3))
    _fit_period(draw, seabed.get("relief", {}), spacing * draw(st.integers(*CELLS)))
    speckle = values.get("receiver", {}).get("speckle", {})
    if speckle.get("kind") == "coherent":
        speckle["density"] = draw(st.floats(0.01, DENSEST))
    values["targets"] = values.get("targets", [])[:3]
    if not draw(one_in(RARELY)):
        sonar["ping_rate"] = draw(st.floats(0.05, 1.0)) * min(650.0 / reach, 1e4)
        _fit_height(draw, seabed, track)
        _fit_materials(draw, values)
        _fit_sonar(sonar, values.get("receiver", {}))
        if sonar.get("law") == "light":
            values.pop("volumes", None)
            values["water"] = {"kind": "uniform"}
        _fit_tables(draw, sonar.get("vertical", {}), values.get("receiver", {}))
        _fit_water(draw, values.get("water", {}))
        for target in values["targets"]:
            _fit_target(draw, target, reach)
    return values


def _fit_materials(draw: Draw, value: Any) -> None:
    """Let no material return more than arrives."""
    for part in value.values() if isinstance(value, dict) else value if isinstance(value, list) else ():
        _fit_materials(draw, part)
    if isinstance(value, dict) and {"diffuse", "specular"} & set(value):
        value["diffuse"] = draw(st.floats(0.0, 1.0))
        value["specular"] = (1.0 - value["diffuse"]) * draw(st.floats(0.0, 1.0))


def _fit_water(draw: Draw, water: dict[str, Any]) -> None:
    """Let depths go downwards, and have a speed each."""
    count = draw(st.integers(2, 6))
    tables = {"profile": ("sound_speed",), "hydrography": ("temperature",), "section": ()}
    kind = water.get("kind", "uniform")
    if kind not in tables:
        return
    water["depth"] = _ascending(draw, count, 0.0, 60.0)
    speeds = st.lists(st.floats(1400.0, 1600.0), min_size=count, max_size=count)
    if kind == "section":
        water["distance"] = _ascending(draw, draw(st.integers(2, 3)), -300.0, 300.0)
        water["sound_speed"] = [draw(speeds) for _ in water["distance"]]
    elif kind == "profile":
        water["sound_speed"] = draw(speeds)
    else:
        water["temperature"] = draw(st.lists(st.floats(-2.0, 30.0), min_size=count, max_size=count))
        water["salinity"] = draw(st.floats(0.0, 40.0))


def _ascending(draw: Draw, count: int, first: float, most: float) -> list[float]:
    """Places, each after the one before."""
    steps = draw(st.lists(log_floats(1e-3, most), min_size=count, max_size=count))
    return [first + sum(steps[:k]) for k in range(count)]


def _fit_target(draw: Draw, target: dict[str, Any], reach: float) -> None:
    """Put a target within reach, its height given by its place or by its gap."""
    across = draw(st.floats(0.0, 1.1)) * reach * draw(st.sampled_from([-1.0, 1.0]))
    target["position"] = [draw(st.floats(-3.0, 3.0)), across, *target["position"][2:]]
    if len(target["position"]) == 3:
        target.pop("gap", None)


def _fit_period(draw: Draw, relief: dict[str, Any], period: float) -> None:
    """Let reliefs repeat after so many metres, all of a sum alike, and heights be of the order of cells."""
    kind = relief.get("kind", "flat")
    for part in [relief, *relief.get("of", [])] if kind == "sum" else [relief]:
        if part.get("kind", "flat") not in ("flat", "sum", "mimic"):
            part["period"] = period
            part.pop("extent", None)
    if kind == "mimic":
        relief["reach"] = 0.5 * period
        relief.pop("of", None)
    if draw(one_in(RARELY)):
        return
    for part in [relief, *relief.get("of", [])] if kind == "sum" else [relief]:
        if part.get("kind") == "fractal":
            _fit_fractal(draw, part)
        if part.get("kind") == "ripples":
            part["wavelength"] = draw(st.floats(0.1, 0.45)) * period


def _fit_fractal(draw: Draw, relief: dict[str, Any]) -> None:
    """Let exponents be those of the decay, and peaks lie below the Nyquist frequency."""
    relief["peaks"] = [[x / 64.0, y / 64.0] for x, y in relief.get("peaks", [[0.0, 0.0]])]
    for name in ("beta", "beta_x", "beta_y"):
        relief.pop(name, None)
    names = ("beta",) if relief.get("decay", "isotropic") == "isotropic" else ("beta_x", "beta_y")
    relief.update({name: draw(st.floats(0.0, 3.0)) for name in names})


def _fit_height(draw: Draw, seabed: dict[str, Any], track: dict[str, Any]) -> None:
    """Put the sonar between the surface and the bed."""
    depth = seabed["depth"] = draw(log_floats(1.0, 200.0))
    track.pop("depth", None)
    track["altitude"] = depth * draw(st.floats(0.01, 1.0))
    room = min(track["altitude"], depth - track["altitude"])
    motion = track.get("motion", {})
    for part in [motion, *motion.get("of", [])]:
        if part.get("kind") == "heave":
            part["amplitude"] = 0.2 * room


def _fit_sonar(sonar: dict[str, Any], receiver: dict[str, Any]) -> None:
    """Let a chirp be long enough, and what needs energy or a beam's width have it."""
    pulse = sonar.get("pulse", {})
    if pulse.get("kind") == "chirp":
        pulse["duration"], pulse["bandwidth"] = 1e-3, max(pulse.get("bandwidth", 30e3), 1e3)
    if sonar.get("law") == "light":
        receiver.pop("reverberation", None)
        sonar["bounces"] = 0
    coherent = receiver.get("speckle", {}).get("kind") == "coherent"
    if coherent and (sonar.get("law") == "light" or sonar["beam"]["kind"] == "knife" or sonar["bounces"] > 0):
        receiver.pop("speckle")


def _fit_tables(draw: Draw, vertical: dict[str, Any], receiver: dict[str, Any]) -> None:
    holders = (receiver.get("tvg", {}), "gains"), (receiver.get("recorder", {}), "gain"), (vertical, "levels")
    for holder, key in holders:
        pairs = holder.get(key)
        if isinstance(pairs, list):
            levels = [level for _, level in pairs] or [0.0]
            holder[key] = [[place, level] for place, level in zip(_ascending(draw, len(levels), 0.0, 50.0), levels)]


def declared(model: type[BaseModel]) -> st.SearchStrategy[dict[str, Any]]:
    """Plain values of a declaration: some fields given, the others left to their defaults."""
    fields = model.model_fields.items()
    needed = {name: field for name, field in fields if field.is_required() or _is_choice(field.annotation)}
    free = {name: field for name, field in model.model_fields.items() if name not in needed and name != "kind"}
    kind = {"kind": st.just(kind_name(model))} if kind_name(model) is not None else {}
    return st.fixed_dictionaries(
        kind | {name: of_field(model, name, field) for name, field in needed.items()},
        optional={name: of_field(model, name, field) for name, field in free.items()},
    )


def of_field(model: type[BaseModel], name: str, field: FieldInfo) -> st.SearchStrategy[Any]:
    if name == "name":
        return st.sampled_from(sorted(MATERIALS))
    if name == "path":
        return st.sampled_from(sorted(bundled_meshes()))
    if name in ("title", "description", "crs"):
        return st.text(st.characters(exclude_categories=["Cs"]), max_size=20)
    if name == "schema_version":
        return st.just(1)
    if any(isinstance(entry, KindOf) for entry in field.metadata):
        return of_kinds(field.metadata)
    return of_type(field.annotation, _bounds(field.metadata), field.json_schema_extra or {})


def of_kinds(metadata: Iterable[Any]) -> st.SearchStrategy[Any]:
    """Values of every kind that a field accepts, but those read from files."""
    models = [model for entry in metadata if isinstance(entry, KindOf) for model in entry.models]
    return st.one_of([declared(model) for model in models if kind_name(model) not in FILES])


def of_type(annotation: Any, bounds: dict[str, Any], extra: Any) -> st.SearchStrategy[Any]:
    """Values of a type within bounds."""
    origin, arguments = typing.get_origin(annotation), typing.get_args(annotation)
    if origin is typing.Annotated and any(isinstance(entry, KindOf) for entry in arguments[1:]):
        return of_kinds(arguments[1:])
    if origin is typing.Annotated:
        infos = [info for info in arguments[1:] if isinstance(info, FieldInfo)]
        nested = _bounds([entry for info in infos for entry in info.metadata])
        return of_type(arguments[0], bounds | nested, extra)
    if origin is Literal:
        return st.sampled_from(arguments)
    if origin is tuple:
        return _of_tuple(arguments, bounds, extra)
    if arguments:
        return st.one_of([of_type(one, bounds, extra) for one in arguments])
    if annotation is type(None):
        return st.none()
    if annotation is bool:
        return st.booleans()
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return declared(annotation)
    return _numbers(annotation, bounds, extra)


def _of_tuple(arguments: tuple[Any, ...], bounds: dict[str, Any], extra: Any) -> st.SearchStrategy[Any]:
    if arguments[-1] is not Ellipsis:
        return st.tuples(*(of_type(one, bounds, extra) for one in arguments)).map(list)
    least = bounds.get("min_length", 0)
    return st.lists(of_type(arguments[0], {}, extra), min_size=least, max_size=max(least, 4))


def _numbers(annotation: Any, bounds: dict[str, Any], extra: Any) -> st.SearchStrategy[Any]:
    """Numbers where the slider moves, and now and then anywhere within the bounds."""
    low, high = bounds.get("ge", bounds.get("gt", -1e6)), bounds.get("le", bounds.get("lt", 1e6))
    near, far = extra.get("slider", (max(low, -1e3), min(high, 1e3)))
    near, far = max(near, low), min(far, high)
    if annotation is int:
        return st.integers(math.ceil(near), math.floor(far)) | st.integers(math.ceil(low), math.floor(high))
    usual = log_floats(near, far) if extra.get("log") and near > 0.0 else st.floats(near, far)
    whole = st.floats(low, high, exclude_min="gt" in bounds, exclude_max="lt" in bounds, allow_subnormal=False)
    return st.integers(1, RARELY).flatmap(lambda number: whole if number == RARELY else usual)


def _bounds(metadata: list[Any]) -> dict[str, Any]:
    """Bounds by their names, as pydantic keeps them."""
    names = ("gt", "ge", "lt", "le", "min_length", "max_length")
    return {name: getattr(entry, name) for entry in metadata for name in names if hasattr(entry, name)}


def _is_choice(annotation: Any) -> bool:
    """Whether a field holds a declaration of its own, or one of several kinds."""
    if isinstance(annotation, type):
        return issubclass(annotation, BaseModel)
    return any(_is_choice(one) for one in typing.get_args(annotation))


def log_floats(low: float, high: float) -> st.SearchStrategy[float]:
    """Numbers evenly spread over their logarithm."""
    return st.floats(math.log(low), math.log(high)).map(lambda x: min(max(math.exp(x), low), high))


def one_in(times: int) -> st.SearchStrategy[bool]:
    return st.integers(1, times).map(lambda number: number == times)


JUNK: tuple[Any, ...] = (
    math.nan, math.inf, -math.inf, -1.0, 0, 0.0, 1e-300, 1e308, -1e308, 2**70, -(2**70), True, None,
    "", "whale", "nan", [], [1.0], [[math.nan]], [None], {}, {"kind": "whale"}, {"kind": None}, {"kind": []}, {"": 1},
)  # fmt: skip


@st.composite
def spoiled_scenes(draw: Draw) -> dict[str, Any]:
    """Plain values of a scene with a mistake: of a wrong kind, no number, huge, misspelt, or left out."""
    values = draw(scenes())
    inside, key = draw(st.sampled_from(_places(values)))
    how = draw(st.integers(1, 8))
    if how == 1 and isinstance(inside, dict):
        inside[f"{key}s"] = inside.pop(key)
    elif how == 2:
        del inside[key]
    else:
        inside[key] = draw(st.sampled_from(JUNK))
    return values


def _places(value: Any) -> list[tuple[Any, Any]]:
    """Every value within others, by what holds it and its key."""
    if not isinstance(value, dict | list):
        return []
    keys = list(value) if isinstance(value, dict) else list(range(len(value)))
    return [(value, key) for key in keys] + [place for key in keys for place in _places(value[key])]
