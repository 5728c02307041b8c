"""What to set for each field of a scene to move its record, and what it needs to be there at all."""

import re
from collections.abc import Callable
from typing import Any

from insonify.scene import Scene, edit
from insonify.scene.base import kind_name, models_of
from insonify.scene.seabed import Seabed
from insonify.scene.water.surfaces import WAYS
from insonify.scene_edits import add_dependent_edits

Values = dict[str, Any]
# Path of a field, the kinds on the way in brackets -> (what the scene needs to have it, what changes it).
Changes = dict[str, tuple[Values, Values]]
RELIEFS = [kind_name(model) for model in models_of(Seabed, "relief") if kind_name(model) != "dem"]


def with_relief(scene: Scene, **changes: Any) -> Scene:
    """Scene whose relief is changed as the window does it: two underscores in a name stand for a dot."""
    named = {f"seabed.relief.{name.replace('__', '.')}": value for name, value in changes.items()}
    return edit(scene, add_dependent_edits(scene, named)[0])


def fields(path: str, needs: Values, place: str | None = None, /, **values: Any) -> Changes:
    """What changes the fields of a declaration, which stands at the path without its kinds if at no other place."""
    place = place or re.sub(r"\[\w+\]", "", path)
    return {f"{path}.{name}": (needs, {f"{place}.{name}": value}) for name, value in values.items()}


MATERIAL = {"name": "rock", "diffuse": 0.1, "specular": 0.1, "shininess": 3.0}
PERIOD, PATCHY = 16.0, {"kind": "patches", "size": 3.0}
# Every kind of made relief: what it needs, and what changes it; a mask and a period belong to all.
FRACTAL = {"kind": "fractal", "period": PERIOD, "beta": 1.6, "peaks": [[6.0, 3.0]], "rms": 0.1}
MADE: dict[str, tuple[Values, Values]] = {
    "fractal": (FRACTAL, {}),
    "power_law": ({}, {"strength": 0.02, "exponent": 3.0}),
    "von_karman": (
        {"across": 2.0, "along": 5.0, "rms": 0.1},
        {"rms": 0.11, "across": 3.0, "along": 4.0, "heading": 20.0, "hurst": 0.5},
    ),
    "ripples": (
        {"wavelength": 2.0, "height": 0.2},
        {"wavelength": 2.5, "heading": 50.0, "height": 0.22, "sharpness": 0.3}
        | {"bandwidth": 0.2, "bandwidth_along": 0.2},
    ),
    "cascade": ({"rms": 0.1}, {"rms": 0.11, "intermittency": 0.3, "hurst": 0.9}),
    "marks": (
        {"length": 3.0, "share": 0.1},
        {"height": -0.4, "size": 1.5, "length": 4.0, "heading": 20.0, "share": 0.2},
    ),
    "strata": ({}, {"height": 0.7, "interval": 5.0, "heading": 90.0, "bends": 2.0, "scarp": 0.3}),
    "autocorrelation": ({"rms": 0.1}, {"rms": 0.11, "function": "gaussian"}),
}
CORRELATIONS = [
    ("exponential", "length", 1.0, 1.5),
    ("gaussian", "length", 1.0, 1.5),
    ("table", "points", [[0.0, 1.0], [1.0, 0.4], [3.0, 0.0]], [[0.0, 1.0], [1.0, 0.3], [3.0, 0.0]]),
    ("file", "path", "CORRELATION", "OTHER_CORRELATION"),
]
ENDLESS_FRACTAL = {"extent": "endless", "clamp": "soft", "coefficients": "gaussian"}
# Names in capitals stand for files, which the test writes.
DETAIL = {"kind": "fractal", "period": 12.8}


def _reliefs(path: str, place: str, within: Callable[..., Values]) -> Changes:
    """What changes reliefs at a place of the seabed, given how one comes to stand there."""
    found: Changes = {}
    for kind, (given, changes) in MADE.items():
        base, here = {"kind": kind, "period": PERIOD, **given}, f"{path}[{kind}]"
        found |= fields(here, within(base), place, mask=PATCHY, **changes)
        found[f"{here}.period"] = (within(base), within(base | {"period": 20.0}))
        masked = within(base | {"mask": PATCHY})
        found |= fields(f"{here}.mask[patches]", masked, f"{place}.mask", share=0.3, size=4.0, softness=1.0)
        if kind not in ("cascade", "marks", "strata"):
            softly = ENDLESS_FRACTAL if kind == "fractal" else {}
            found |= fields(here, within(base | softly | {"extent": "periodic"}), place, extent="endless")
    for kind, name, before, after in CORRELATIONS:
        correlated = {"kind": "autocorrelation", "period": PERIOD, "rms": 0.1, "function": {"kind": kind, name: before}}
        here = f"{path}[autocorrelation].function[{kind}]"
        found |= fields(here, within(correlated), f"{place}.function", **{name: after})
    without_beta = {name: value for name, value in FRACTAL.items() if name != "beta"}
    rotated = within(without_beta | {"beta_x": 1.2, "beta_y": 1.6, "decay": "rotated"})
    two_peaks = within(FRACTAL | {"peaks": [[6.0, 3.0], [4.0, -2.0]]})
    here, plain = f"{path}[fractal]", within(FRACTAL)
    found |= fields(here, plain, place, beta=1.7, rms=0.11, quadrants=4, clamp="soft", coefficients="gaussian")
    found |= fields(here, plain, place, peaks=[[6.0, 4.0]])
    found |= fields(here, rotated, place, beta_x=1.3, beta_y=1.7, decay="elliptic")
    found |= fields(here, two_peaks, place, combine="max")
    dem = {"kind": "dem", "path": "BED"}
    for needs, changes in (
        ({}, {"path": "OTHER", "scale": 1.1}),
        ({"datum": -60.0}, {"positive": "down"}),
    ):
        found |= fields(f"{path}[dem]", within(dem | needs, DETAIL) | {"targets": []}, place, **changes)
    return found | fields(f"{path}[dem]", within(dem, DETAIL) | {"targets": []} | BY_DEPTH, place, datum=-1.0)


def _alone(relief: Values, *_: Values) -> Values:
    return {"seabed.relief": relief}


def _summed(*of: Values) -> Values:
    return {"seabed.relief": {"kind": "sum", "of": list(of)}}


BY_DEPTH: Values = {"track.altitude": None, "track.depth": 22.0}  # an altitude counts from the bed's own mean
DARK, BRIGHT = {"diffuse": 0.3, "specular": 0.0}, {"diffuse": 0.5, "specular": 0.0}
MIMIC = {"seabed.relief": {"kind": "mimic", "of": {"of": [DARK, BRIGHT]}, "altitude": 7.0, "reach": 30.0}}
DUNES = {"kind": "fractal", "period": PERIOD}
CHANGES: Changes = {
    "seed": ({}, {"seed": 2}),
    "world.origin": (_alone({"kind": "dem", "path": "MAP"}) | {"targets": []}, {"world.origin": [1003.0, 2001.0]}),
    **fields("seabed", {}, depth=31.0, spacing=0.25, relief="flat"),
    **_reliefs("seabed.relief", "seabed.relief", _alone),
    **_reliefs("seabed.relief[sum].of", "seabed.relief.of.0", _summed),
    **fields("seabed.relief[sum]", _summed(DUNES), of=[DUNES, {"kind": "power_law", "period": PERIOD}]),
    **fields("seabed.relief[mimic]", MIMIC, of={"of": [DARK, BRIGHT, DARK]}, altitude=9.0, reach=20.0, law="sonar"),
    **fields("seabed.relief[mimic].of[pattern]", MIMIC, of=[BRIGHT, DARK], shape="waves", period=6.0),
    **fields("seabed.relief[mimic].of[pattern].of[uniform]", MIMIC, "seabed.relief.of.of.0", diffuse=0.4),
}

# Maps of materials, which are materials like any other.
MAPS: dict[str, tuple[Values, Values]] = {
    "patches": ({"size": 4.0}, {"size": 3.0}),
    "fractal": ({}, {"beta": 1.2, "softness": 0.5}),
    "pattern": ({"shape": "checks", "period": 5.0}, {"shape": "waves", "period": 4.0, "heading": 60.0}),
    "image": ({"path": "PICTURE", "width": 12.0}, {"path": "NEGATIVE", "width": 8.0}),
    "backscatter": ({"path": "MAP"}, {"path": "OTHER_MAP", "levels": [-30.15]}),
}
for kind, (given, changes) in MAPS.items():
    needs = {"seabed.material": {"kind": kind, "of": ["silt", "rock"], **given}}
    needs |= {"world.origin": [1002.0, 2002.0]} if kind == "backscatter" else {}
    CHANGES |= fields(f"seabed.material[{kind}]", needs, of=["silt", "cobble"], **changes)
    CHANGES |= fields(
        f"seabed.material[{kind}].of[uniform]", needs, "seabed.material.of.1", **MATERIAL | {"name": "cobble"}
    )
CHANGES |= fields("seabed", {}, material={"kind": "patches", "of": ["silt", "rock"], "size": 4.0})
CHANGES |= fields("seabed.material[uniform]", {}, name="silt", diffuse=0.2, specular=0.1)
CHANGES |= fields("seabed.material[uniform]", {"seabed.material.specular": 0.1}, shininess=4.0)
K = {"receiver.speckle": "k"}
CHANGES |= fields("seabed.material[uniform]", K, speckle_shape=0.3)

# A pipe and a sphere of the base; others each alone on port, turned somewhat and dull enough to glint everywhere.
TURNED = {"position": [1.0, 12.0], "heading": 20.0, "pitch": 10.0, "roll": 5.0}
TURNED |= {"material": {"name": "steel", "shininess": 4.0}}
OF_TURNED = {"position": [1.0, 13.0], "heading": 50.0, "pitch": 30.0, "roll": 40.0}
SUNK = {"seed": 2, "broken": 0.5, "buried": 0.3, "growth": 0.1, "scour": 0.5, "current": 40.0, "fish": 30}
BODIES: dict[str, tuple[Values | None, Values]] = {
    "pipe": (None, {"position": [2.0, 13.0], "radius": 0.6, "length": 3.0, "heading": 20.0, "pitch": 10.0}),
    "sphere": (None, {"position": [1.0, -13.0], "radius": 0.6}),
    "box": ({"size": [3.0, 1.5, 1.0]}, OF_TURNED | {"size": [3.0, 1.5, 1.2]}),
    "cone": ({"radius": 0.8, "height": 1.5}, OF_TURNED | {"radius": 0.9, "height": 1.2}),
    "mesh": ({"path": "tetrapod"}, OF_TURNED | {"path": "SHAPE", "scale": 1.2}),
    "wreck": (
        {"length": 6.0, "decay": 0.4, "broken": 0.2, "scour": 0.2},
        OF_TURNED | SUNK | {"form": "dinghy", "length": 7.0, "beam": 3.0, "timber": True, "decay": 0.6},
    ),
    "aircraft": (
        {"length": 6.0, "porosity": 0.3, "broken": 0.2, "scour": 0.2},
        OF_TURNED
        | SUNK
        | {"plan": "delta", "length": 7.0, "span": 5.0, "engines": 2, "tail": "twin", "porosity": 0.5, "crumpled": 0.4},
    ),
    "person": (
        {"length": 3.0, "clothing": 0.5},
        OF_TURNED
        | {"form": "sack", "length": 2.0, "spread": 0.9, "bent": 0.6, "clothing": 1.0, "rope": 2.0, "buried": 0.5}
        | {"seed": 2},
    ),
}
for kind, (body, changes) in BODIES.items():
    needs = {} if body is None else {"targets": [{"kind": kind, **TURNED, **body}]}
    place, material = f"targets.{int(kind == 'sphere')}", MATERIAL if body is None else MATERIAL | {"shininess": 2.0}
    CHANGES |= fields(f"targets[{kind}]", needs, place, material="concrete", gap=0.5, **changes)
    CHANGES |= fields(f"targets[{kind}].material[uniform]", needs, f"{place}.material", **material)
CHANGES |= fields("targets[pipe].material[uniform]", K, "targets.0.material", speckle_shape=0.3)
CHANGES["targets"] = ({}, {"targets": []})

OF_VOLUMES: dict[str, Values] = {
    "school": {"length": 4.0, "width": 3.0, "height": 2.0},
    "plume": {"height": 4.0, "radius": 2.0, "drift": 5.0},
}
for kind, own in OF_VOLUMES.items():
    needs = {"volumes": [{"kind": kind, "position": [2.0, 8.0, -25.0]}]}
    common = {"position": [2.0, 12.0, -25.0], "strength": -30.0, "heading": 50.0}
    CHANGES |= fields(f"volumes[{kind}]", needs, "volumes.0", **common | own)
    CHANGES["volumes"] = ({}, needs)

# Waters: what each needs, and what changes it beside what all have.
WATERS: dict[str, tuple[Values, Values]] = {
    "uniform": ({}, {"sound_speed": 1450.0}),
    "profile": (
        {"depth": [5.0, 22.0, 26.0], "sound_speed": [1520.0, 1518.0, 1500.0]},
        {"depth": [5.0, 23.0, 26.0], "sound_speed": [1515.0, 1518.0, 1500.0], "interpolation": "pchip"},
    ),
    "hydrography": (
        {"depth": [5.0, 22.0, 26.0], "temperature": [18.0, 17.0, 10.0], "salinity": [34.0, 34.5, 36.0]},
        {"depth": [5.0, 23.0, 26.0], "temperature": [18.0, 17.0, 8.0], "salinity": 34.0, "equation": "paper"},
    ),
    "cast": ({"path": "CAST"}, {"path": "OTHER_CAST", "interpolation": "pchip", "equation": "paper"}),
    "section": (
        {"distance": [0.0, 10.0], "depth": [5.0, 26.0], "sound_speed": [[1520.0, 1500.0], [1505.0, 1501.0]]},
        {"distance": [0.0, 20.0], "depth": [5.0, 25.0], "sound_speed": [[1520.0, 1500.0], [1505.0, 1510.0]]}
        | {"heading": 90.0},
    ),
}
FRANCOIS_GARRISON = {"temperature": 4.0, "salinity": 20.0, "acidity": 7.5}
for kind, (given, changes) in WATERS.items():
    plain, absorbing, sea = (
        {"water": {"kind": kind, **given, **more}}
        for more in ({}, {"absorption": 50.0}, {"absorption": "francois_garrison"})
    )
    CHANGES |= fields(f"water[{kind}]", plain, reference_speed=1450.0, absorption=40.0, **changes)
    CHANGES |= fields(f"water[{kind}].absorption[constant]", absorbing, coefficient=60.0)
    CHANGES |= fields(f"water[{kind}].absorption[francois_garrison]", sea, **FRANCOIS_GARRISON)
# A sea so shallow that all ghosts are within range.
SHALLOW = {"seabed.depth": 10.0}
CHANGES |= fields("water[uniform]", SHALLOW, surface="flat")
for kind, own in {"flat": {}, "rough": {"wind_speed": 7.0, "gravity": 3.7}}.items():
    needs = SHALLOW | {"water.surface": kind}
    CHANGES |= fields(f"water[uniform].surface[{kind}]", needs, **dict.fromkeys(WAYS, False), **own)

ARRAY, BELL = {"sonar.beam": {"kind": "array", "length": 0.1}}, {"sonar.beam": {"kind": "gaussian", "width": 4.0}}
UPRIGHT = {"sonar.vertical": {"kind": "array", "height": 0.01}}
LEVELS = [[-60.0, -30.0], [-25.0, -6.0], [0.0, 0.0], [25.0, -3.0], [60.0, -30.0]]
CHIRP = {"kind": "chirp", "bandwidth": 6e3}
CHANGES |= {
    **fields("sonar", {"water.absorption": "francois_garrison"}, frequency=100e3),
    **fields("sonar", {}, range=25.0, bins=100, ping_rate=5.0, law="light", bounces=1),
    **fields("sonar", {}, beam="knife", vertical="gaussian", pulse="ideal"),
    **fields("sonar.beam[fan]", {}, width=3.0, squint=3.0),
    **fields("sonar.beam[gaussian]", BELL, width=3.0, squint=3.0, two_way=False),
    **fields("sonar.beam[array]", ARRAY, length=0.2, taper="hamming", squint=3.0, two_way=False),
    **fields("sonar.vertical[fan]", {"sonar.vertical": "fan"}, width=40.0, tilt=40.0),
    **fields("sonar.vertical[gaussian]", {"sonar.vertical": "gaussian"}, width=40.0, tilt=40.0),
    **fields("sonar.vertical[array]", UPRIGHT, height=0.02, taper="hamming", tilt=40.0),
    **fields("sonar.vertical[table]", {"sonar.vertical": "table"}, levels=LEVELS, tilt=40.0),
    **fields("sonar.pulse[tone]", {}, duration=2e-4),
    **fields("sonar.pulse[chirp]", {"sonar.pulse": CHIRP | {"window": "uniform"}}, duration=3e-4),
    **fields("sonar.pulse[chirp]", {"sonar.pulse": CHIRP}, bandwidth=5e3, window="hann"),
    **fields("track", {}, start=[0.5, 0.0], heading=10.0, altitude=8.0, speed=1.0, pings=11, terrain_following=True),
    **fields("track", {}, motion="heave"),
    "track.depth": ({}, BY_DEPTH),
}


def _motions(path: str, place: str, within: Callable[[Values], Values]) -> Changes:
    """What changes each kind of motion, alone or as the last of a sum."""
    found: Changes = {}
    for kind in ("surge", "sway", "heave", "yaw", "pitch", "roll"):
        # A roll is heard by a vertical beam alone.
        swinging = within({"kind": kind, "amplitude": 2.0}) | {"sonar.vertical": "gaussian"}
        found |= fields(f"{path}[{kind}]", swinging, place, amplitude=3.0, period=4.0, phase=90.0)
    turn = within({"kind": "turn", "rate": 20.0, "begin": 0.2, "duration": 0.5})
    found |= fields(f"{path}[turn]", turn, place, rate=-20.0, begin=0.4, duration=0.3)
    return found | fields(f"{path}[recorded]", within({"kind": "recorded", "path": "TOW"}), place, path="OTHER_TOW")


def _last_of_sum(motion: Values | str) -> Values:
    return {"track.motion": {"kind": "sum", "of": ["straight", motion]}}


CHANGES |= _motions("track.motion", "track.motion", lambda motion: {"track.motion": motion})
CHANGES |= _motions("track.motion[sum].of", "track.motion.of.1", _last_of_sum)
CHANGES |= fields("track.motion[sum]", _last_of_sum("heave"), of=["straight", "sway"])

GAINS = [[0.0, 0.0], [100.0, 20.0]]
TABLE = {"kind": "table", "by": "bin", "gains": GAINS}
FOREIGN = {"kind": "sonar", "ping_rate": 20.0, "duration": 5e-3}
VOLUME, NOISE = {"kind": "volume", "volume_strength": -30.0}, {"kind": "ambient", "level": -80.0}
OF_RECEIVER: list[tuple[str, Any, Values]] = [  # choice, what it is at first, what changes the fields of that kind
    ("speckle[rayleigh]", "rayleigh", {"looks": 2}),
    ("speckle[k]", "k", {"shape": 1.0, "looks": 2, "cell": 0.01}),
    ("speckle[coherent]", "coherent", {"density": 50.0}),
    ("fluctuation[lognormal]", "lognormal", {"level": 3.0, "correlation_time": 0.2, "travel_time": 1e-4}),
    ("reverberation[volume]", VOLUME, {"volume_strength": -40.0}),
    ("reverberation[surface]", "surface", {"surface_strength": -20.0}),
    ("reverberation[both]", VOLUME | {"kind": "both"}, {"volume_strength": -40.0, "surface_strength": -10.0}),
    ("noise[ambient]", "ambient", {"level": -80.0}),
    ("noise[snr]", {"kind": "snr", "at": 20.0}, {"value": 5.0, "at": 15.0}),
    ("tvg[power]", "power", {"spreading": 40.0, "absorption": 100.0}),
    ("tvg[table]", TABLE, {"by": "time", "gains": [GAINS[0], [100.0, 30.0]], "interpolation": "steps"}),
    ("interference[sonar]", FOREIGN, {"level": -50.0, "ping_rate": 13.0, "duration": 1e-2}),
]
for path, before, changes in OF_RECEIVER:
    choice = f"receiver.{path.partition('[')[0]}"
    needs = {choice: before} | (BY_DEPTH if path in ("reverberation[surface]", "reverberation[both]") else {})
    CHANGES |= fields(f"receiver.{path}", needs, **changes)
CHANGES |= fields("sonar", {}, preset="kayak-455")
LOUD = {"receiver.source_level": 200.0}
SEA_NOISE = LOUD | {"sonar.frequency": 5e4, "receiver.noise": {"kind": "sea", "wind": 20.0}}
CHANGES |= fields("receiver.noise[density]", LOUD | {"receiver.noise": "density"}, level=50.0)
CHANGES |= fields("receiver.noise[sea]", SEA_NOISE, wind=1.0, rain="heavy")
RECORDER = {"gain": [[0.0, 0.0], [0.5, 6.0]], "side_gain": 3.0, "bits": 8, "full_scale": -60.0, "dropped_pings": 0.5}
CHANGES |= fields("receiver", {}, speckle="rayleigh", fluctuation="lognormal", reverberation=VOLUME, noise=NOISE)
CHANGES |= fields(
    "receiver", {}, tvg="power", ringing="decay", interference=FOREIGN, source_level=200.0, crosstalk=-20.0
)
CHANGES |= fields("receiver.recorder", {}, **RECORDER)

PART = "a part that is all its own fields"
BALL = "turns a ball, which looks alike from all sides"
WHY_NOT = {
    "schema_version": "says how the file is to be read",
    "title": "is for people; it stands in the record's attributes",
    "description": "is for people; it stands in the record's attributes",
    "controls": "is for the viewer, which pins these fields on top",
    "partner": "names another scene, whose record is another one",
    "world.crs": "names the map that the origin belongs to; nothing is converted",
    "world": PART,
    "seabed": PART,
    "water": "is of several kinds, each of which has a line for every field",
    "sonar": PART,
    "track": PART,
    "receiver": PART,
    **{f"targets[sphere].{field}": BALL for field in ("heading", "pitch", "roll")},
    "targets[pipe].roll": "turns a pipe about its axis, where it looks alike",
    "receiver.recorder": PART,
    "seabed.relief[mimic].of[pattern].heading": "dunes lie along the track",
    "seabed.relief[mimic].of[pattern].of[uniform].name": "is for numbers not given; dunes have but a diffuse share",
    "seabed.relief[mimic].of[pattern].of[uniform].specular": "is 0: no slope imitates a mirror lobe",
    "seabed.relief[mimic].of[pattern].of[uniform].shininess": "is that of a mirror lobe, and dunes have none",
}
# Fields of every material, wherever it is.
WHY_NOT_OF_MATERIALS = {
    "reflection": "is for sound that bounces on",
    "speed_ratio": "is for sound that passes through",
    "speckle_shape": "is for K speckle, where the bed's and the pipe's are heard",
}
# What a field changes other than the intensity.
ELSEWHERE = {"seabed.depth": "platform_depth"}
