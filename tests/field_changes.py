"""What to set for each field of a scene to move its record, and what it needs to be there at all."""

from __future__ import annotations

from insonify.scene.water.surfaces import WAYS
from relief_fields import PERIOD, alone, of_fractals, of_made, summed

DEM = {"seabed.relief": {"kind": "dem", "path": "BED"}, "targets": []}
DETAILED = {
    "seabed.relief": {"kind": "sum", "of": [{"kind": "dem", "path": "BED"}, {"kind": "fractal", "period": 12.8}]},
    "targets": [],
}
BY_DEPTH = {"track.altitude": None, "track.depth": 22.0}  # an altitude counts from the bed's own mean
PATCHES = {"seabed.material": {"kind": "patches", "of": ["silt", "rock"], "size": 4.0}}
BANDS = {"seabed.material": {"kind": "fractal", "of": ["silt", "rock"]}}
PATTERN = {"seabed.material": {"kind": "pattern", "of": ["silt", "rock"], "shape": "checks", "period": 5.0}}
RASTER = {
    "world.origin": [1002.0, 2002.0],
    "seabed.material": {"kind": "backscatter", "path": "MAP", "of": ["silt", "rock"]},
}
PICTURE = {"seabed.material": {"kind": "image", "path": "PICTURE", "of": ["silt", "rock"], "width": 12.0}}
DARK, BRIGHT = {"diffuse": 0.3, "specular": 0.0}, {"diffuse": 0.5, "specular": 0.0}
MIMIC = {"seabed.relief": {"kind": "mimic", "of": {"of": [DARK, BRIGHT]}, "altitude": 7.0, "reach": 30.0}}
BELL = {"sonar.beam": {"kind": "gaussian", "width": 4.0}}
ARRAY = {"sonar.beam": {"kind": "array", "length": 0.1}}
SCHOOLS = {"volumes": [{"kind": "school", "position": [2.0, 8.0, -25.0]}]}
UPRIGHT = {"sonar.vertical": {"kind": "array", "height": 0.01}}
SEA = {"water.absorption": "francois_garrison"}
THERMOCLINE = {"depth": [5.0, 22.0, 26.0], "sound_speed": [1520.0, 1518.0, 1500.0]}
WATERS = {
    "uniform": {},
    "profile": THERMOCLINE,
    "hydrography": {"depth": [5.0, 22.0, 26.0], "temperature": [18.0, 17.0, 10.0], "salinity": [34.0, 34.5, 36.0]},
    "cast": {"path": "CAST"},
    "section": {
        "distance": [0.0, 10.0],
        "depth": [5.0, 26.0],
        "sound_speed": [[1520.0, 1500.0], [1505.0, 1501.0]],
    },
}
CHIRP = {"sonar.pulse": {"kind": "chirp", "bandwidth": 6e3}}
RAYLEIGH = {"receiver.speckle": "rayleigh"}
K = {"receiver.speckle": "k"}
COHERENT = {"receiver.speckle": "coherent"}
FLUCTUATION = {"receiver.fluctuation": "lognormal"}
VOLUME = {"receiver.reverberation": {"kind": "volume", "volume_strength": -30.0}}
SURFACE = {"receiver.reverberation": "surface", **BY_DEPTH}
BOTH = {**SURFACE, "receiver.reverberation": {"kind": "both", "volume_strength": -30.0}}
NOISE = {"receiver.noise": "ambient"}
PRESET = {"sonar.preset": "kayak-455"}
LOUD = {"receiver.source_level": 200.0}
WHITE = LOUD | {"receiver.noise": "density"}
SEA_NOISE = LOUD | {"sonar.frequency": 5e4, "receiver.noise": {"kind": "sea", "wind": 20.0}}
SNR = {"receiver.noise": {"kind": "snr", "at": 20.0}}
TVG = {"receiver.tvg": "power"}
TABLE = {"receiver.tvg": {"kind": "table", "by": "bin", "gains": [[0.0, 0.0], [100.0, 20.0]]}}
RINGING = {"receiver.ringing": "decay"}
FOREIGN = {"receiver.interference": {"kind": "sonar", "ping_rate": 20.0, "duration": 5e-3}}
TURN = {"track.motion": {"kind": "turn", "rate": 20.0, "begin": 0.2, "duration": 0.5}}
SUM = {"track.motion": {"kind": "sum", "of": ["straight", "heave"]}}
RECORDED = {"track.motion": {"kind": "recorded", "path": "TOW"}}


def _of_motions(path: str, needs: dict) -> dict[str, tuple[dict, dict]]:
    """What changes each kind of motion, alone or as the last of a sum."""
    place = "track.motion.of.1" if needs else "track.motion"

    def within(changes: dict) -> dict:
        return needs | {key.replace("track.motion", place): value for key, value in changes.items()}

    found = {}
    for kind in ("surge", "sway", "heave", "yaw", "pitch", "roll"):
        # A roll is heard by a vertical beam alone.
        swinging = within({"track.motion": {"kind": kind, "amplitude": 2.0}}) | {"sonar.vertical": "gaussian"}
        for name, value in (("amplitude", 3.0), ("period", 4.0), ("phase", 90.0)):
            found[f"{path}[{kind}].{name}"] = (swinging, {f"{place}.{name}": value})
    for name, value in (("rate", -20.0), ("begin", 0.4), ("duration", 0.3)):
        found[f"{path}[turn].{name}"] = (within(TURN), {f"{place}.{name}": value})
    found[f"{path}[recorded].path"] = (within(RECORDED), {f"{place}.path": "OTHER_TOW"})
    return found


# Path of a field, the kinds on the way in brackets -> (what the scene needs to have it, what changes it).
CHANGES: dict[str, tuple[dict, dict]] = {
    "seed": ({}, {"seed": 2}),
    "world.origin": ({**DEM, "seabed.relief.path": "MAP"}, {"world.origin": [1003.0, 2001.0]}),
    "seabed.depth": ({}, {"seabed.depth": 31.0}),
    "seabed.spacing": ({}, {"seabed.spacing": 0.25}),
    "seabed.relief": ({}, {"seabed.relief": "flat"}),
    **of_made("seabed.relief", "seabed.relief", alone),
    **of_fractals("seabed.relief", "seabed.relief", alone),
    "seabed.relief[sum].of": (
        summed({"kind": "fractal", "period": PERIOD}),
        {"seabed.relief.of": [{"kind": "fractal", "period": PERIOD}, {"kind": "power_law", "period": PERIOD}]},
    ),
    **of_made("seabed.relief[sum].of", "seabed.relief.of.0", summed),
    **of_fractals("seabed.relief[sum].of", "seabed.relief.of.0", summed),
    "seabed.relief[dem].path": (DEM, {"seabed.relief.path": "OTHER"}),
    "seabed.relief[dem].positive": ({**DEM, "seabed.relief.datum": -60.0}, {"seabed.relief.positive": "down"}),
    "seabed.relief[dem].datum": ({**DEM, **BY_DEPTH}, {"seabed.relief.datum": -1.0}),
    "seabed.relief[dem].scale": (DEM, {"seabed.relief.scale": 1.1}),
    "seabed.relief[sum].of[dem].path": (DETAILED, {"seabed.relief.of.0.path": "OTHER"}),
    "seabed.relief[sum].of[dem].positive": (
        {**DETAILED, "seabed.relief.of.0.datum": -60.0},
        {"seabed.relief.of.0.positive": "down"},
    ),
    "seabed.relief[sum].of[dem].datum": ({**DETAILED, **BY_DEPTH}, {"seabed.relief.of.0.datum": -1.0}),
    "seabed.relief[sum].of[dem].scale": (DETAILED, {"seabed.relief.of.0.scale": 1.1}),
    "seabed.material": ({}, PATCHES),
    "seabed.material[uniform].name": ({}, {"seabed.material.name": "silt"}),
    "seabed.material[uniform].diffuse": ({}, {"seabed.material.diffuse": 0.2}),
    "seabed.material[uniform].specular": ({}, {"seabed.material.specular": 0.1}),
    "seabed.material[uniform].shininess": ({}, {"seabed.material.shininess": 4.0}),
    "seabed.material[uniform].speckle_shape": (K, {"seabed.material.speckle_shape": 0.3}),
    "seabed.material[patches].of": (PATCHES, {"seabed.material.of.1": "cobble"}),
    "seabed.material[patches].size": (PATCHES, {"seabed.material.size": 3.0}),
    "seabed.material[fractal].of": (BANDS, {"seabed.material.of.1": "cobble"}),
    "seabed.material[pattern].of": (PATTERN, {"seabed.material.of.1": "cobble"}),
    "seabed.material[pattern].shape": (PATTERN, {"seabed.material.shape": "waves"}),
    "seabed.material[pattern].period": (PATTERN, {"seabed.material.period": 4.0}),
    "seabed.material[pattern].heading": (PATTERN, {"seabed.material.heading": 60.0}),
    "seabed.material[image].path": (PICTURE, {"seabed.material.path": "NEGATIVE"}),
    "seabed.material[image].of": (PICTURE, {"seabed.material.of.1": "cobble"}),
    "seabed.material[image].width": (PICTURE, {"seabed.material.width": 8.0}),
    "seabed.material[backscatter].path": (RASTER, {"seabed.material.path": "OTHER_MAP"}),
    "seabed.material[backscatter].of": (RASTER, {"seabed.material.of.1": "cobble"}),
    "seabed.material[backscatter].levels": (RASTER, {"seabed.material.levels": [-30.15]}),
    "seabed.relief[mimic].of": (MIMIC, {"seabed.relief.of": {"of": [DARK, BRIGHT, DARK]}}),
    "seabed.relief[mimic].of[pattern].of": (MIMIC, {"seabed.relief.of.of": [BRIGHT, DARK]}),
    "seabed.relief[mimic].of[pattern].of[uniform].diffuse": (MIMIC, {"seabed.relief.of.of.0.diffuse": 0.4}),
    "seabed.relief[mimic].of[pattern].shape": (MIMIC, {"seabed.relief.of.shape": "waves"}),
    "seabed.relief[mimic].of[pattern].period": (MIMIC, {"seabed.relief.of.period": 6.0}),
    "seabed.relief[mimic].altitude": (MIMIC, {"seabed.relief.altitude": 9.0}),
    "seabed.relief[mimic].reach": (MIMIC, {"seabed.relief.reach": 20.0}),
    "seabed.relief[mimic].law": (MIMIC, {"seabed.relief.law": "sonar"}),
    "seabed.material[fractal].beta": (BANDS, {"seabed.material.beta": 1.2}),
    "targets": ({}, {"targets": []}),
    "targets[pipe].position": ({}, {"targets.0.position": [2.0, 13.0]}),
    "targets[pipe].material": ({}, {"targets.0.material": "concrete"}),
    "targets[pipe].material[uniform].name": ({}, {"targets.0.material.name": "rock"}),
    "targets[pipe].material[uniform].diffuse": ({}, {"targets.0.material.diffuse": 0.1}),
    "targets[pipe].material[uniform].specular": ({}, {"targets.0.material.specular": 0.1}),
    "targets[pipe].material[uniform].shininess": ({}, {"targets.0.material.shininess": 3.0}),
    "targets[pipe].material[uniform].speckle_shape": (K, {"targets.0.material.speckle_shape": 0.3}),
    "targets[pipe].radius": ({}, {"targets.0.radius": 0.6}),
    "targets[pipe].length": ({}, {"targets.0.length": 3.0}),
    "targets[pipe].heading": ({}, {"targets.0.heading": 20.0}),
    "targets[pipe].pitch": ({}, {"targets.0.pitch": 10.0}),
    "targets[pipe].gap": ({}, {"targets.0.gap": 0.5}),
    "targets[sphere].position": ({}, {"targets.1.position": [1.0, -13.0]}),
    "targets[sphere].material": ({}, {"targets.1.material": "concrete"}),
    "targets[sphere].material[uniform].name": ({}, {"targets.1.material.name": "rock"}),
    "targets[sphere].material[uniform].diffuse": ({}, {"targets.1.material.diffuse": 0.1}),
    "targets[sphere].material[uniform].specular": ({}, {"targets.1.material.specular": 0.1}),
    "targets[sphere].material[uniform].shininess": ({}, {"targets.1.material.shininess": 3.0}),
    "targets[sphere].radius": ({}, {"targets.1.radius": 0.6}),
    "targets[sphere].gap": ({}, {"targets.1.gap": 0.5}),
    "volumes": ({}, SCHOOLS),
    **{
        f"volumes[{kind}].{field}": (
            {"volumes": [{"kind": kind, "position": [2.0, 8.0, -25.0]}]},
            {f"volumes.0.{field}": v},
        )
        for kind, own in {
            "school": {"length": 4.0, "width": 3.0, "height": 2.0},
            "plume": {"height": 4.0, "radius": 2.0, "drift": 5.0},
        }.items()
        for field, v in ({"position": [2.0, 12.0, -25.0], "strength": -30.0, "heading": 50.0} | own).items()
    },
    "water[uniform].sound_speed": ({}, {"water.sound_speed": 1450.0}),
    "sonar.frequency": (SEA, {"sonar.frequency": 100e3}),
    "sonar.beam": ({}, {"sonar.beam": "knife"}),
    "sonar.beam[fan].width": ({}, {"sonar.beam.width": 3.0}),
    "sonar.beam[fan].squint": ({}, {"sonar.beam.squint": 3.0}),
    "sonar.beam[gaussian].width": (BELL, {"sonar.beam.width": 3.0}),
    "sonar.beam[gaussian].squint": (BELL, {"sonar.beam.squint": 3.0}),
    "sonar.beam[gaussian].two_way": (BELL, {"sonar.beam.two_way": False}),
    "sonar.beam[array].length": (ARRAY, {"sonar.beam.length": 0.2}),
    "sonar.beam[array].taper": (ARRAY, {"sonar.beam.taper": "hamming"}),
    "sonar.beam[array].squint": (ARRAY, {"sonar.beam.squint": 3.0}),
    "sonar.beam[array].two_way": (ARRAY, {"sonar.beam.two_way": False}),
    "sonar.vertical": ({}, {"sonar.vertical": "gaussian"}),
    "sonar.vertical[fan].width": ({"sonar.vertical": "fan"}, {"sonar.vertical.width": 40.0}),
    "sonar.vertical[fan].tilt": ({"sonar.vertical": "fan"}, {"sonar.vertical.tilt": 40.0}),
    "sonar.vertical[gaussian].width": ({"sonar.vertical": "gaussian"}, {"sonar.vertical.width": 40.0}),
    "sonar.vertical[gaussian].tilt": ({"sonar.vertical": "gaussian"}, {"sonar.vertical.tilt": 40.0}),
    "sonar.vertical[array].height": (UPRIGHT, {"sonar.vertical.height": 0.02}),
    "sonar.vertical[array].taper": (UPRIGHT, {"sonar.vertical.taper": "hamming"}),
    "sonar.vertical[array].tilt": (UPRIGHT, {"sonar.vertical.tilt": 40.0}),
    "sonar.vertical[table].levels": ({"sonar.vertical": "table"}, {"sonar.vertical.levels.1.1": -6.0}),
    "sonar.vertical[table].tilt": ({"sonar.vertical": "table"}, {"sonar.vertical.tilt": 40.0}),
    "sonar.pulse": ({}, {"sonar.pulse": "ideal"}),
    "sonar.pulse[tone].duration": ({}, {"sonar.pulse.duration": 2e-4}),
    "sonar.pulse[chirp].duration": ({**CHIRP, "sonar.pulse.window": "uniform"}, {"sonar.pulse.duration": 3e-4}),
    "sonar.pulse[chirp].bandwidth": (CHIRP, {"sonar.pulse.bandwidth": 5e3}),
    "sonar.pulse[chirp].window": (CHIRP, {"sonar.pulse.window": "hann"}),
    "sonar.range": ({}, {"sonar.range": 25.0}),
    "sonar.bins": ({}, {"sonar.bins": 100}),
    "sonar.ping_rate": ({}, {"sonar.ping_rate": 5.0}),
    "sonar.law": ({}, {"sonar.law": "light"}),
    "sonar.bounces": ({}, {"sonar.bounces": 1}),
    "track.start": ({}, {"track.start": [0.5, 0.0]}),
    "track.heading": ({}, {"track.heading": 10.0}),
    "track.altitude": ({}, {"track.altitude": 8.0}),
    "track.depth": ({}, BY_DEPTH),
    "track.speed": ({}, {"track.speed": 1.0}),
    "track.pings": ({}, {"track.pings": 11}),
    "track.terrain_following": ({}, {"track.terrain_following": True}),
    "track.motion": ({}, {"track.motion": "heave"}),
    **_of_motions("track.motion", {}),
    "track.motion[sum].of": (SUM, {"track.motion.of": ["straight", "sway"]}),
    **_of_motions("track.motion[sum].of", SUM),
    "sonar.preset": ({}, PRESET),
    "receiver.speckle": ({}, RAYLEIGH),
    "receiver.speckle[rayleigh].looks": (RAYLEIGH, {"receiver.speckle.looks": 2}),
    "receiver.speckle[k].shape": (K, {"receiver.speckle.shape": 1.0}),
    "receiver.speckle[k].looks": (K, {"receiver.speckle.looks": 2}),
    "receiver.speckle[coherent].density": (COHERENT, {"receiver.speckle.density": 50.0}),
    "receiver.speckle[k].cell": (K, {"receiver.speckle.cell": 0.01}),
    "receiver.fluctuation": ({}, FLUCTUATION),
    "receiver.fluctuation[lognormal].level": (FLUCTUATION, {"receiver.fluctuation.level": 3.0}),
    "receiver.fluctuation[lognormal].correlation_time": (FLUCTUATION, {"receiver.fluctuation.correlation_time": 0.2}),
    "receiver.fluctuation[lognormal].travel_time": (FLUCTUATION, {"receiver.fluctuation.travel_time": 1e-4}),
    "receiver.reverberation": ({}, VOLUME),
    "receiver.reverberation[volume].volume_strength": (VOLUME, {"receiver.reverberation.volume_strength": -40.0}),
    "receiver.reverberation[surface].surface_strength": (SURFACE, {"receiver.reverberation.surface_strength": -20.0}),
    "receiver.reverberation[both].volume_strength": (BOTH, {"receiver.reverberation.volume_strength": -40.0}),
    "receiver.reverberation[both].surface_strength": (BOTH, {"receiver.reverberation.surface_strength": -10.0}),
    "receiver.noise": ({}, {"receiver.noise": {"kind": "ambient", "level": -80.0}}),
    "receiver.noise[ambient].level": (NOISE, {"receiver.noise.level": -80.0}),
    "receiver.noise[density].level": (WHITE, {"receiver.noise.level": 50.0}),
    "receiver.noise[sea].wind": (SEA_NOISE, {"receiver.noise.wind": 1.0}),
    "receiver.noise[sea].rain": (SEA_NOISE, {"receiver.noise.rain": "heavy"}),
    "receiver.noise[snr].value": (SNR, {"receiver.noise.value": 5.0}),
    "receiver.noise[snr].at": (SNR, {"receiver.noise.at": 15.0}),
    "receiver.source_level": ({}, {"receiver.source_level": 200.0}),
    "receiver.tvg": ({}, TVG),
    "receiver.tvg[power].spreading": (TVG, {"receiver.tvg.spreading": 40.0}),
    "receiver.tvg[power].absorption": (TVG, {"receiver.tvg.absorption": 100.0}),
    "receiver.tvg[table].by": (TABLE, {"receiver.tvg.by": "time"}),
    "receiver.tvg[table].gains": (TABLE, {"receiver.tvg.gains.1.1": 30.0}),
    "receiver.tvg[table].interpolation": (TABLE, {"receiver.tvg.interpolation": "steps"}),
    "receiver.crosstalk": ({}, {"receiver.crosstalk": -20.0}),
    "receiver.ringing": ({}, RINGING),
    "receiver.interference": ({}, FOREIGN),
    "receiver.interference[sonar].level": (FOREIGN, {"receiver.interference.level": -50.0}),
    "receiver.interference[sonar].ping_rate": (FOREIGN, {"receiver.interference.ping_rate": 13.0}),
    "receiver.interference[sonar].duration": (FOREIGN, {"receiver.interference.duration": 1e-2}),
    "receiver.recorder.gain": ({}, {"receiver.recorder.gain": [[0.0, 0.0], [0.5, 6.0]]}),
    "receiver.recorder.side_gain": ({}, {"receiver.recorder.side_gain": 3.0}),
    "receiver.recorder.bits": ({}, {"receiver.recorder.bits": 8}),
    "receiver.recorder.full_scale": ({}, {"receiver.recorder.full_scale": -60.0}),
    "receiver.recorder.dropped_pings": ({}, {"receiver.recorder.dropped_pings": 0.5}),
}
# Materials of a map are materials like any other.
CHANGES |= {
    f"seabed.material[{kind}].of[uniform].{field}": (needs, {f"seabed.material.of.1.{field}": value})
    for kind, needs in {
        "patches": PATCHES,
        "fractal": BANDS,
        "pattern": PATTERN,
        "image": PICTURE,
        "backscatter": RASTER,
    }.items()
    for field, value in {"name": "cobble", "diffuse": 0.1, "specular": 0.1, "shininess": 3.0}.items()
}
# Targets other than those of the base, each alone on port, turned somewhat and dull enough to glint everywhere.
SHEEN = {"name": "steel", "shininess": 4.0}
TURNED = {"position": [1.0, 12.0], "heading": 20.0, "pitch": 10.0, "roll": 5.0, "material": SHEEN}
BODIES = {
    "box": {"size": [3.0, 1.5, 1.0]},
    "cone": {"radius": 0.8, "height": 1.5},
    "mesh": {"path": "tetrapod"},
}
OF_BODIES = {
    "position": [1.0, 13.0],
    "gap": 0.5,
    "material": "concrete",
    "material[uniform].name": "rock",
    "material[uniform].diffuse": 0.1,
    "material[uniform].specular": 0.1,
    "material[uniform].shininess": 2.0,
    "heading": 50.0,
    "pitch": 30.0,
    "roll": 40.0,
}
OF_EACH = {
    "box": {"size": [3.0, 1.5, 1.2]},
    "cone": {"radius": 0.9, "height": 1.2},
    "mesh": {"path": "SHAPE", "scale": 1.2},
}
CHANGES |= {
    f"targets[{kind}].{field}": (
        {"targets": [{"kind": kind, **TURNED, **BODIES[kind]}]},
        {f"targets.0.{field.replace('[uniform]', '')}": value},
    )
    for kind in BODIES
    for field, value in {**OF_BODIES, **OF_EACH[kind]}.items()
}
# What all waters have, in each of them, and what each has of its own.
OF_WATERS = {
    "reference_speed": ({}, 1450.0),
    "absorption": ({}, 40.0),
    "absorption[constant].coefficient": ({"absorption": 50.0}, 60.0),
    "absorption[francois_garrison].temperature": ({"absorption": "francois_garrison"}, 4.0),
    "absorption[francois_garrison].salinity": ({"absorption": "francois_garrison"}, 20.0),
    "absorption[francois_garrison].acidity": ({"absorption": "francois_garrison"}, 7.5),
}
OF_EACH_WATER = {
    "profile": {
        "depth": [5.0, 23.0, 26.0],
        "sound_speed": [1515.0, 1518.0, 1500.0],
        "interpolation": "pchip",
    },
    "hydrography": {
        "depth": [5.0, 23.0, 26.0],
        "temperature": [18.0, 17.0, 8.0],
        "salinity": 34.0,
        "equation": "paper",
    },
    "cast": {"path": "OTHER_CAST", "interpolation": "pchip", "equation": "paper"},
    "section": {
        "distance": [0.0, 20.0],
        "depth": [5.0, 25.0],
        "sound_speed": [[1520.0, 1500.0], [1505.0, 1510.0]],
        "heading": 90.0,
    },
}
CHANGES |= {
    f"water[{kind}].{field}": (
        {"water": {"kind": kind, **WATERS[kind], **needs}},
        {f"water.{field.replace('[constant]', '').replace('[francois_garrison]', '')}": value},
    )
    for kind in WATERS
    for field, (needs, value) in (
        OF_WATERS | {name: ({}, v) for name, v in OF_EACH_WATER.get(kind, {}).items()}
    ).items()
}
# A sea so shallow that all ghosts are within range.
SHALLOW = {"seabed.depth": 10.0}
CHANGES |= {"water[uniform].surface": (SHALLOW, {"water.surface": "flat"})}
CHANGES |= {
    f"water[uniform].surface[{kind}].{field}": ({**SHALLOW, "water.surface": kind}, {f"water.surface.{field}": value})
    for kind in ("flat", "rough")
    for field, value in (dict.fromkeys(WAYS, False) | ({"wind_speed": 7.0} if kind == "rough" else {})).items()
}
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
