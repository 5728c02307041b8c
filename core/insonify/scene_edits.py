"""Dependent edits: the further fields that an edit of a scene must change to keep the scene valid and meaningful."""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from insonify.acoustics.water import make_sound_speed_field, speed_at_sonar
from insonify.scene import Scene, SceneError, edit
from insonify.scene.edit import part_at
from insonify.scene.receiver.noises import NOISES, NoiseKind
from insonify.scene.seabed.materials import MATERIAL_MAPS, Material, MaterialMap
from insonify.scene.seabed.materials.catalogue import MATERIALS, Reflectivity
from insonify.scene.seabed.materials.pattern import PatternMap
from insonify.scene.seabed.reliefs.fractal import Fractal
from insonify.scene.seabed.reliefs.mimic import Mimic, mean_diffuse
from insonify.scene.seabed.reliefs.random_relief import RandomRelief
from insonify.scene.seabed.reliefs.sum import SumOfReliefs
from insonify.scene.track.motions import Straight, SumOfMotions

Changes = dict[str, Any]
SOURCE_LEVEL = 210.0  # dB re 1 µPa at 1 m, usual for a side-scan sonar
SLOWEST = 1e-3  # Hz, a ping rate that any range allows
SWINGS = ("surge", "sway", "heave", "yaw", "pitch", "roll")
RELIEF = "seabed.relief"
SMOOTH = ("isotropic", "elliptic")


def add_dependent_edits(scene: Scene, changes: Mapping[str, Any]) -> tuple[Changes, str]:
    """Add the dependent edits to an edit."""
    complete: Changes = {}
    remarks = []
    for rule in (
        _ping_rate,
        _sonar_height,
        _exponents_of_decay,
        _endless_options,
        _common_period,
        _parts_of_sum,
        _named_numbers,
        _shares,
        _material_map,
        _dunes,
        _sum,
        _law,
        _source_level,
    ):
        extra, remark = rule(scene, changes)
        complete |= extra
        if remark:
            remarks.append(remark)
    return complete | dict(changes), "; ".join(remarks)


def _ping_rate(scene: Scene, changes: Mapping[str, Any]) -> tuple[Changes, str]:
    """Lower the ping rate so that echoes from the full range arrive before the next ping."""
    if not any(path.startswith(("sonar.range", "water", "track")) for path in changes):
        return {}, ""
    try:
        if all(path.startswith("track") for path in changes) and np.ptp(make_sound_speed_field(scene.water).speed) == 0:
            return {}, ""  # the sonar moves in water that is everywhere the same
        after = edit(scene, {**changes, "sonar.ping_rate": SLOWEST})
        reach, fastest = after.sonar.range, speed_at_sonar(after) / (2.0 * after.sonar.range)
    except SceneError:
        return {}, ""  # the edit itself reports the error
    if scene.sonar.ping_rate <= fastest:
        return {}, ""
    # Three significant digits, rounded down.
    step = 10.0 ** (math.floor(math.log10(fastest)) - 2)
    rate = round(math.floor(fastest / step) * step, 12)
    return {"sonar.ping_rate": rate}, f"ping rate lowered to {rate:g} Hz, so that echoes from {reach:.4g} m can return"


def _sonar_height(scene: Scene, changes: Mapping[str, Any]) -> tuple[Changes, str]:
    """Clear the depth when the altitude is set, and the altitude when the depth is set."""
    if "track.altitude" in changes and scene.track.depth is not None:
        return {"track.depth": None}, ""
    if "track.depth" in changes and scene.track.terrain_following:
        return {
            "track.altitude": None,
            "track.terrain_following": False,
        }, "the depth is fixed: terrain following is off"
    if "track.depth" in changes and scene.track.altitude is not None:
        return {"track.altitude": None}, ""
    if changes.get("track.terrain_following") is True and scene.track.depth is not None:
        return {"track.depth": None, "track.altitude": scene.altitude}, ""
    return {}, ""


def _named_numbers(scene: Scene, changes: Mapping[str, Any]) -> tuple[Changes, str]:
    """Clear the numbers of a material when its name changes, so that the numbers of the name apply."""
    owners = [path.removesuffix(".name") for path in changes if path.endswith(".name")]
    of_beds = {f"{owner}.{number}": None for owner in owners if "material" in owner for number in Reflectivity._fields}
    return of_beds | {f"{owner}.diffuse": None for owner in owners if owner.startswith("seabed.relief.of")}, ""


def _shares(scene: Scene, changes: Mapping[str, Any]) -> tuple[Changes, str]:
    """Lower the specular share when the diffuse one grows, or the other way round, so that their sum is at most 1."""
    for path, share in changes.items():
        owner, _, name = path.rpartition(".")
        if name not in ("diffuse", "specular") or not isinstance(share, (int, float)) or not 0.0 < share <= 1.0:
            continue
        other = "specular" if name == "diffuse" else "diffuse"
        material = part_at(scene, owner)
        room = round(1.0 - share, 12)
        if isinstance(material, Material) and getattr(material.reflectivity, other) > room:
            return {f"{owner}.{other}": room}, f"{other} share lowered to {room:.4g}: the sum is at most 1"
    return {}, ""


def _law(scene: Scene, changes: Mapping[str, Any]) -> tuple[Changes, str]:
    """Turn off what the law of light does not model: scattering in the water, the sea surface and bent rays."""
    if changes.get("sonar.law") != "light":
        return {}, ""
    water, off = scene.water, list[str]()
    extra: Changes = {}
    if scene.receiver.reverberation.echoes:
        extra["receiver.reverberation"] = "none"
        off.append("reverberation is off")
    if any(water.surface.paths):
        extra["water.surface"] = "none"
        off.append("the sea surface is off")
    if water.only_speed is None:
        extra["water.kind"] = "uniform"
        off.append("the water has one sound speed")
    if scene.sonar.bounces > 0:
        extra["sonar.bounces"] = 0
        off.append("later echoes are off")
    return extra, f"{', '.join(off)}: the law of light does not model it" if off else ""


def _source_level(scene: Scene, changes: Mapping[str, Any]) -> tuple[Changes, str]:
    """Give a source level to noise in dB re 1 µPa, which needs one."""
    kind = NOISES.models(NoiseKind).get(str(changes.get("receiver.noise.kind", changes.get("receiver.noise"))))
    if kind is None or not kind.absolute or scene.receiver.source_level > 0.0:
        return {}, ""
    return {"receiver.source_level": SOURCE_LEVEL}, f"the noise is in dB re 1 µPa: source level {SOURCE_LEVEL:g} dB"


def _material_map(scene: Scene, changes: Mapping[str, Any]) -> tuple[Changes, str]:
    """Give a new map of materials the two materials that it needs, and a uniform bed the first one of the map."""
    kind = changes.get("seabed.material.kind")
    material = scene.seabed.material
    if kind is None or kind == material.kind:
        return {}, ""
    if kind == "uniform":
        return {"seabed.material.name": material.materials[0].name}, ""
    model = MATERIAL_MAPS.models(MaterialMap).get(kind)
    if len(material.materials) > 1 or model is None or "of" not in model.model_fields:
        return {}, ""
    name = material.materials[0].name
    other = "rock" if name != "rock" else next(iter(MATERIALS))
    return {"seabed.material.of": [name, other]}, ""


def _sum(scene: Scene, changes: Mapping[str, Any]) -> tuple[Changes, str]:
    """Start a sum of motions with the present motion and every oscillation, so that each has its sliders."""
    motion = scene.track.motion
    if changes.get("track.motion.kind") != "sum" or isinstance(motion, SumOfMotions):
        return {}, ""
    before = [] if isinstance(motion, Straight) else [motion.model_dump()]
    return {"track.motion.of": [*before, *({"kind": kind} for kind in SWINGS if kind != motion.kind)]}, ""


def _dunes(scene: Scene, changes: Mapping[str, Any]) -> tuple[Changes, str]:
    """Make dunes that imitate the present pattern of materials for this sonar, on a bed of uniform material."""
    if changes.get("seabed.relief.kind") != "mimic" or isinstance(scene.seabed.relief, Mimic):
        return {}, ""
    dunes = Mimic(altitude=scene.altitude, reach=scene.sonar.range, law=scene.sonar.law)
    if isinstance(scene.seabed.material, PatternMap):
        dunes = dunes.model_copy(update={"of": scene.seabed.material})
    mean = round(mean_diffuse(dunes.of), 6)
    return {
        "seabed.relief": dunes.model_dump(exclude_none=True),
        "seabed.material": {"diffuse": mean, "specular": 0.0},
    }, f"the bed now has one material, with a diffuse share of {mean:.4g}"


def _exponents_of_decay(scene: Scene, changes: Mapping[str, Any]) -> tuple[Changes, str]:
    """Give an isotropic decay one exponent, and the others two."""
    edits: Changes = {}
    for path, part in _parts(scene):
        decay = changes.get(f"{path}.decay")
        if decay is None or not isinstance(part, Fractal):
            continue
        along, across = part.exponents
        one = {"beta": along, "beta_x": None, "beta_y": None}
        two = {"beta": None, "beta_x": along, "beta_y": across}
        edits |= {f"{path}.{name}": value for name, value in (one if decay == "isotropic" else two).items()}
    return edits, ""


def _endless_options(scene: Scene, changes: Mapping[str, Any]) -> tuple[Changes, str]:
    """Give an endless fractal relief the options that it needs."""
    was = scene.seabed.endless
    kind = changes.get(f"{RELIEF}.kind")
    is_to_be = "endless" in [changes.get(f"{path}.extent") for path, _ in _parts(scene)]
    edits: Changes = {}
    if kind == "fractal" and was:
        edits = _soft(RELIEF, "isotropic")
    for path, part in _parts(scene):
        if is_to_be and isinstance(part, Fractal):
            edits |= _soft(path, part.decay)
            if part.decay not in SMOOTH:
                edits |= {f"{path}.beta": part.exponents[0], f"{path}.beta_x": None, f"{path}.beta_y": None}
    return edits, "an endless relief has a soft clamp and Gaussian coefficients" if edits else ""


def _common_period(scene: Scene, changes: Mapping[str, Any]) -> tuple[Changes, str]:
    """Give all parts of a sum the same period and extent."""
    places = _parts(scene)
    edits: Changes = {}
    for name in ("period", "extent"):
        moved = [changes[f"{path}.{name}"] for path, _ in places if f"{path}.{name}" in changes]
        others = [f"{path}.{name}" for path, part in places if hasattr(part, name)]
        if moved and len(places) > 1:
            edits |= dict.fromkeys(others, moved[-1])
    return edits, ""


def _parts_of_sum(scene: Scene, changes: Mapping[str, Any]) -> tuple[Changes, str]:
    """Start a sum with the present relief, and add ripples in patches."""
    relief = scene.seabed.relief
    if changes.get(f"{RELIEF}.kind") != "sum" or isinstance(relief, SumOfReliefs):
        return {}, ""
    first = relief if isinstance(relief, RandomRelief) else Fractal()
    ripples: Changes = {"kind": "ripples", "period": first.period, "mask": {"kind": "patches"}}
    if first.endless:
        ripples["extent"] = "endless"
    return {RELIEF: {"kind": "sum", "of": [first.model_dump(exclude_none=True), ripples]}}, ""


def _parts(scene: Scene) -> list[tuple[str, Any]]:
    """Reliefs that add up to the bed, with their paths."""
    relief = scene.seabed.relief
    if isinstance(relief, SumOfReliefs):
        return [(f"{RELIEF}.of.{number}", part) for number, part in enumerate(relief.of)]
    return [(RELIEF, relief)]


def _soft(path: str, decay: str) -> Changes:
    """Options of an endless fractal relief."""
    kept = decay if decay in SMOOTH else "isotropic"
    values = {"clamp": "soft", "coefficients": "gaussian", "combine": "rms", "decay": kept}
    return {f"{path}.{name}": value for name, value in values.items()}
