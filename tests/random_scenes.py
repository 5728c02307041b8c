"""Random scenes from a seed, on which methods and plans are judged; their files go into a folder.

Dense ones are full of targets that hide one another, planned ones have all effects that a plan chooses about, and wide
ones reach as far as the sliders do. Short ones are wide ones of one to eight pings.
"""

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from beds import BOX_FACES, box_corners, icosphere
from insonify.acoustics.beam_patterns import is_patterned
from insonify.scene import Scene, edit

Spec = dict[str, Any]
Random = np.random.Generator
Place = tuple[float, float]
DEPTH = 30.0
NODES = 512  # of a period
SUBSTANCES = ("silt", "fine_sand", "medium_sand", "coarse_sand", "sandy_gravel", "cobble", "rock", "concrete", "steel")
MANY = 5  # halvings of an icosahedron that make 20,480 triangles
MANY_IN = 7  # the only scene with that many
MOST_SHORT = 8  # pings of a short track
WIDE_PINGS, OVER, ACROSS = 400, 16, 8  # of a wide scene, and those by which it is judged


def dense_scene(seed: int, folder: Path, *, bent: bool = False) -> tuple[Scene, np.ndarray]:
    """Scene of a seed and the pings that cross its targets. Its water may bend sound."""
    rng = np.random.default_rng([20261121, seed])
    heading, altitude, reach = rng.uniform(-180.0, 180.0), rng.uniform(3.0, 15.0), rng.uniform(20.0, 30.0)
    places = _dense_places(rng, altitude, reach)
    start = rng.uniform(-3.0, 3.0, 2)
    seabed = _dense_seabed(rng, folder, seed)
    halvings = MANY if seed == MANY_IN else 2
    targets = [_target(rng, _moved(start, heading, place), folder, halvings) for place in places]
    sonar = {
        "beam": "knife" if rng.random() < 0.5 else {"kind": "fan", "width": rng.uniform(0.5, 3.0)},
        "law": "light" if rng.random() < 0.3 else "sonar",
        "range": reach,
        "bins": int(rng.integers(300, 601)),
    }
    track = {"start": tuple(start), "heading": heading, "altitude": altitude, "speed": 1.0, "pings": 200}
    water = _steep_thermocline(seed) if bent else {"kind": "uniform"}
    scene = _scene(f"random {seed}", seed, seabed=seabed, water=water, targets=targets, sonar=sonar, track=track)
    return scene, _crossing(rng, places, 4, 0.8)


def planned_scene(seed: int, folder: Path) -> tuple[Scene, np.ndarray]:
    """Scene of a seed, and the pings by which it is judged."""
    rng = np.random.default_rng([20261123, seed])
    heading, altitude = rng.uniform(-180.0, 180.0), rng.uniform(3.0, 15.0)
    reach = min(max(altitude * rng.uniform(2.0, 7.0), 15.0), 80.0)
    places = _dense_places(rng, altitude, reach) if rng.random() < 0.5 else []
    start = rng.uniform(-3.0, 3.0, 2)
    water = _planned_water(rng)
    sonar = {
        "beam": _beam(rng, (0.25, 0.55, 0.1, 0.1), lengths=(0.1, 0.6), widths=(0.3, 5.0)),
        "law": "light" if rng.random() < 0.2 else "sonar",
        "range": reach,
        "bins": int(np.clip(reach / _log(rng, 0.03, 0.4), 100, 1200)),
        "ping_rate": 5.0,
    }
    seabed = _planned_seabed(rng, folder, seed)
    targets = [_target(rng, _moved(start, heading, place), folder) for place in places]
    track = {"start": tuple(start), "heading": heading, "altitude": altitude, "speed": 0.5, "pings": 200}
    scene = _scene(f"planned {seed}", seed, seabed=seabed, water=water, targets=targets, sonar=sonar, track=track)
    # Rays through a beam with a pattern, bent sound or a sea are slow.
    pings = 1 if is_patterned(scene) or scene.water.kind != "uniform" or scene.water.surface.kind != "none" else 3
    return scene, _crossing(rng, places, pings, 0.5) if places else np.sort(rng.integers(0, 200, pings))


def wide_scene(seed: int, folder: Path) -> tuple[Scene, np.ndarray, np.ndarray]:
    """Scene of a seed, and the pings by which it is judged: over the track, and across its targets."""
    rng = np.random.default_rng([20261125, seed])
    reach = _log(rng, 5.0, 1000.0)
    altitude = min(max(reach * _log(rng, 0.04, 0.5), 1.0), 200.0)
    spacing = reach * _log(rng, 1.0 / 2000.0, 1.0 / 100.0)
    depth = altitude * _log(rng, 1.1, 8.0)
    heading = float(rng.choice([0.0, 90.0, rng.uniform(-180.0, 180.0)]))
    speed = _log(rng, 0.2, 3.0)
    rate = min(5.0, 1400.0 / (2.0 * reach))
    start = rng.uniform(-3.0, 3.0, 2)
    seabed = _wide_seabed(rng, folder, seed, spacing, depth)
    # Holes of a measured bed carry no targets.
    is_measured = seabed["relief"]["kind"] == "dem"
    places = [] if is_measured else _wide_places(rng, altitude, reach, WIDE_PINGS * speed / rate)
    water = _wide_water(rng, depth)
    targets = [_target(rng, _moved(start, heading, place), folder) for place in places]
    sonar = {
        "beam": _beam(rng, (0.2, 0.5, 0.15, 0.15), lengths=(0.1, 1.0), widths=(0.2, 10.0)),
        "vertical": _vertical(rng),
        "law": "light" if rng.random() < 0.15 else "sonar",
        "range": reach,
        "bins": int(_log(rng, 100.0, 1200.0)),
        "ping_rate": rate,
    }
    track = {"start": tuple(start), "heading": heading, "altitude": altitude, "speed": speed, "pings": WIDE_PINGS}
    track["motion"] = _motion(rng, altitude)
    scene = _scene(f"wide {seed}", seed, seabed=seabed, water=water, targets=targets, sonar=sonar, track=track)
    over = rng.integers(0, WIDE_PINGS, OVER)
    along = np.array([places[k][0] for k in rng.integers(0, len(places), ACROSS)] if places else []) * rate / speed
    across = np.rint(along + rng.uniform(-1.0, 1.0, along.size)).astype(np.int64)
    return scene, np.unique(over), np.unique(np.clip(across, 0, WIDE_PINGS - 1))


def short_scene(seed: int, folder: Path) -> tuple[Scene, np.ndarray]:
    """Wide scene of a seed with a track of few pings, all judged, near a target; some targets glint."""
    scene, over, across = wide_scene(seed, folder)
    rng = np.random.default_rng([20261128, seed])
    count, middle = int(rng.integers(1, MOST_SHORT + 1)), int(rng.choice(across if across.size else over))
    step, heading = scene.track.speed / scene.sonar.ping_rate, math.radians(scene.track.heading)
    along = (middle - int(rng.integers(0, count))) * step
    x, y = scene.track.start
    changes: Spec = {"title": f"short {seed}", "track.pings": count}
    changes["track.start"] = [x + along * math.cos(heading), y + along * math.sin(heading)]
    for number in range(len(scene.targets)):
        if rng.random() < 0.5:
            diffuse = rng.uniform(0.0, 0.5)
            specular, shininess = rng.uniform(0.0, 1.0 - diffuse), _log(rng, 1.0, 1000.0)
            material = {"diffuse": diffuse, "specular": specular, "shininess": shininess}
            changes[f"targets.{number}.material"] = material
    return edit(scene, changes), np.arange(count)


def _scene(title: str, seed: int, *, sonar: Spec, water: Spec, **parts: Any) -> Scene:
    if water["kind"] != "uniform" or "surface" in water:
        sonar = sonar | {"law": "sonar"}  # light goes straight, and returns once
    parts["water"] = water
    return Scene.model_validate({"title": title, "seed": seed, "sonar": {"pulse": "ideal", **sonar}, **parts})


def _crossing(rng: Random, places: list[Place], count: int, off: float) -> np.ndarray:
    """Pings, ten a metre, that cross some of the places, or pass so many metres off."""
    along = np.array([places[k][0] for k in rng.integers(0, len(places), count)]) + rng.uniform(-off, off, count)
    return np.unique(np.rint(along * 10.0).astype(np.int64))


def _log(rng: Random, low: float, high: float) -> float:
    return float(math.exp(rng.uniform(math.log(low), math.log(high))))


def _dense_places(rng: Random, altitude: float, reach: float) -> list[Place]:
    """Targets along and athwart the track; half of them in front of, behind or within one before."""
    farthest = 0.9 * math.sqrt(reach * reach - altitude * altitude)
    places: list[Place] = []
    for _ in range(rng.integers(1, 7)):
        side = rng.choice([-1.0, 1.0])
        along, across = rng.uniform(1.0, 6.0), side * rng.uniform(0.25 * farthest + 1.0, farthest)
        if places and rng.random() < 0.6:
            along, across = places[-1]
            along += rng.uniform(-0.5, 0.5)
            across += math.copysign(rng.uniform(0.0, 3.0), across)
            if abs(across) > farthest:
                across = math.copysign(farthest - rng.uniform(0.0, 3.0), across)
        places.append((along, across))
    return places


def _wide_places(rng: Random, altitude: float, reach: float, length: float) -> list[Place]:
    """Up to five targets along and athwart the track."""
    if rng.random() < 0.5:
        return []
    farthest = 0.9 * math.sqrt(reach**2 - altitude**2)
    near = min(3.0, 0.5 * farthest)
    return [
        (rng.uniform(0.1, 0.9) * length, rng.choice([-1.0, 1.0]) * rng.uniform(near, farthest))
        for _ in range(rng.integers(1, 6))
    ]


def _moved(start: np.ndarray, heading: float, place: Place) -> Place:
    """World coordinates of a place along and to port of the track."""
    c, s = math.cos(math.radians(heading)), math.sin(math.radians(heading))
    return start[0] + place[0] * c - place[1] * s, start[1] + place[0] * s + place[1] * c


def _beam(rng: Random, shares: tuple[float, ...], lengths: tuple[float, float], widths: tuple[float, float]) -> Any:
    kind = str(rng.choice(["knife", "fan", "gaussian", "array"], p=shares))
    if kind == "knife":
        return "knife"
    beam: Spec = {"kind": kind}
    beam |= {"length": _log(rng, *lengths)} if kind == "array" else {"width": _log(rng, *widths)}
    if rng.random() < 0.1:
        beam["squint"] = rng.uniform(-10.0, 10.0)
    return beam


def _vertical(rng: Random) -> Any:
    if rng.random() < 0.7:
        return "uniform"
    kind = str(rng.choice(["fan", "gaussian"]))
    return {"kind": kind, "width": rng.uniform(20.0, 90.0), "tilt": rng.uniform(10.0, 50.0)}


def _motion(rng: Random, altitude: float) -> Any:
    if rng.random() < 0.6:
        return "straight"
    kind = str(rng.choice(["heave", "sway", "yaw", "pitch", "roll"]))
    amplitude = 0.1 * altitude if kind in ("heave", "sway") else rng.uniform(0.5, 6.0)
    return {"kind": kind, "amplitude": amplitude, "period": _log(rng, 3.0, 30.0)}


def _dense_seabed(rng: Random, folder: Path, seed: int) -> Spec:
    spacing = float(rng.choice([0.1, 0.2]))
    peak = _peak(rng)
    relief: Spec = {"kind": "fractal", "beta": rng.uniform(1.2, 2.0), "peaks": [peak], "period": NODES * spacing}
    relief["rms"] = spacing * rng.uniform(0.05, 0.5)
    if rng.random() < 0.25:
        relief = {"kind": "dem", "path": str(_ridges(rng, folder, seed, spacing))}
    return {"depth": DEPTH, "spacing": spacing, "relief": relief, "material": _ground_material(rng)}


def _planned_seabed(rng: Random, folder: Path, seed: int) -> Spec:
    spacing = float(rng.choice([0.05, 0.1, 0.2, 0.4]))
    material = _ground_material(rng) if rng.random() < 0.3 else str(rng.choice(SUBSTANCES))
    draw = rng.random()
    if draw < 0.1:
        relief: Spec = {"kind": "flat"}
    elif draw < 0.15:
        spacing = 0.2
        relief = {"kind": "dem", "path": str(_ridges(rng, folder, seed, spacing))}
    else:
        relief = _planned_relief(rng, spacing) | {"period": NODES * spacing}
    return {"depth": DEPTH, "spacing": spacing, "relief": relief, "material": material}


def _wide_seabed(rng: Random, folder: Path, seed: int, spacing: float, depth: float) -> Spec:
    draw = rng.random()
    material: Any = _ground_material(rng) if rng.random() < 0.3 else str(rng.choice(SUBSTANCES))
    if draw > 0.7 and isinstance(material, str):
        diffuse, specular = rng.uniform(0.05, 0.5), rng.uniform(0.05, 0.5)
        lobe = {"specular": specular, "shininess": _log(rng, 1.0, 1000.0)}
        material = {"name": material, "diffuse": diffuse} | lobe
    if draw < 0.07:
        relief: Spec = {"kind": "flat"}
    elif draw < 0.17:
        relief = {"kind": "dem", "path": str(_cliffs(rng, folder, seed, spacing, depth))}
    else:
        relief = _wide_relief(rng, spacing) | {"period": NODES * spacing}
    return {"depth": depth, "spacing": spacing, "relief": relief, "material": material}


def _planned_relief(rng: Random, spacing: float) -> Spec:
    kinds = ("fractal", "power_law", "von_karman", "ripples", "autocorrelation", "cascade")
    kind = kinds[rng.choice(len(kinds), p=[0.5, 0.12, 0.12, 0.1, 0.1, 0.06])]
    if kind == "fractal":
        peak, beta = _peak(rng), rng.uniform(1.0, 2.4)
        return {"kind": kind, "beta": beta, "peaks": [peak], "rms": spacing * _log(rng, 0.03, 0.6)}
    if kind == "power_law":
        return {"kind": kind, "strength": _log(rng, 5e-4, 0.03), "exponent": rng.uniform(2.6, 3.7)}
    if kind == "cascade":
        return {"kind": kind, "rms": spacing * _log(rng, 0.1, 0.6), "hurst": rng.uniform(0.4, 1.2)}
    if kind == "ripples":
        return _ripples(rng, spacing, 0.12)
    if kind == "von_karman":
        shape = _ellipse(rng, spacing)
        return shape | {"rms": spacing * _log(rng, 0.05, 0.8), "heading": rng.uniform(-180.0, 180.0)}
    return {"kind": kind, "function": _correlation(rng, spacing), "rms": spacing * _log(rng, 0.05, 0.6)}


def _wide_relief(rng: Random, spacing: float) -> Spec:
    rms = spacing * _log(rng, 0.02, 3.0)
    kind = str(rng.choice(["fractal", "von_karman", "autocorrelation", "cascade", "ripples"]))
    shapes: dict[str, Callable[[], Spec]] = {
        "fractal": lambda: {"beta": rng.uniform(1.0, 2.4)},
        "von_karman": lambda: _ellipse(rng, spacing) | {"heading": rng.uniform(-180.0, 180.0)},
        "autocorrelation": lambda: {"function": _correlation(rng, spacing)},
        "cascade": lambda: {"hurst": rng.uniform(0.4, 1.2)},
    }
    return {"kind": kind, "rms": rms} | shapes[kind]() if kind in shapes else _ripples(rng, spacing, 0.3)


def _peak(rng: Random) -> list[float]:
    return [float(rng.uniform(0, 30)), float(rng.uniform(0, 30))] if rng.random() < 0.5 else [0.0, 0.0]


def _ellipse(rng: Random, spacing: float) -> Spec:
    across = spacing * _log(rng, 10.0, 60.0)
    along, hurst = across * rng.uniform(1.0, 4.0), rng.uniform(0.3, 1.2)
    return {"kind": "von_karman", "across": across, "along": along, "hurst": hurst}


def _correlation(rng: Random, spacing: float) -> Spec:
    return {"kind": str(rng.choice(["exponential", "gaussian"])), "length": spacing * _log(rng, 4.0, 30.0)}


def _ripples(rng: Random, spacing: float, steepest: float) -> Spec:
    wave = spacing * _log(rng, 5.0, 30.0)
    height = wave * _log(rng, 0.02, steepest)
    return {"kind": "ripples", "wavelength": wave, "height": height, "heading": rng.uniform(0, 90)}


def _ridges(rng: Random, folder: Path, seed: int, spacing: float) -> Path:
    """A measured bed: a slope with ridges, and in places none at all."""
    half = 40.0
    x = np.arange(-half, half, spacing)
    y = x[:, None]
    way, slope = rng.uniform(0.0, 2.0 * math.pi), math.tan(math.radians(rng.uniform(2.0, 12.0)))
    heights = slope * (x * math.cos(way) + y * math.sin(way))
    for _ in range(3):
        way, at, wide = rng.uniform(0.0, math.pi), rng.uniform(-20.0, 20.0), rng.uniform(1.0, 3.0)
        heights += rng.uniform(0.2, 0.8) * np.exp(-(((x * math.cos(way) + y * math.sin(way) - at) / wide) ** 2))
    heights += 0.1 * spacing * np.cos(6.0 * x + rng.uniform(0.0, 6.0)) * np.cos(5.0 * y + rng.uniform(0.0, 6.0))
    # Under the tow the bed keeps its depth, so that the fish stays clear of it.
    heights -= heights[np.hypot(x, y) < 6.0].mean() + DEPTH
    path = folder / f"bed-{seed}.npy"
    np.save(path, heights)
    return path


def _cliffs(rng: Random, folder: Path, seed: int, spacing: float, depth: float) -> Path:
    """A measured bed with a slope, a cliff and holes."""
    half = 256 * spacing
    x = np.arange(-half, half, spacing)
    y = x[:, None]
    way, slope = rng.uniform(0.0, 2.0 * math.pi), math.tan(math.radians(rng.uniform(0.0, 15.0)))
    heights = slope * 0.1 * (x * math.cos(way) + y * math.sin(way))
    at, high = rng.uniform(0.1, 0.4) * half, rng.uniform(0.02, 0.2) * depth
    heights = heights + high * (y + 0.2 * x > at)
    heights += 0.2 * spacing * rng.standard_normal(heights.shape)
    heights -= heights[np.hypot(x, y) < 0.1 * half].mean() + depth
    for _ in range(3):
        heights[np.hypot(x - rng.uniform(-half, half), y - rng.uniform(-half, half)) < 0.05 * half] = np.nan
    path = folder / f"cliffs-{seed}.npy"
    np.save(path, heights)
    return path


def _ground_material(rng: Random) -> Any:
    if rng.random() < 0.5:
        return str(rng.choice(SUBSTANCES))
    kind = str(rng.choice(["patches", "fractal", "pattern"]))
    of = [str(name) for name in rng.choice(SUBSTANCES, rng.integers(2, 4), replace=False)]
    if kind == "pattern":
        return {"kind": kind, "of": of, "shape": str(rng.choice(["stripes", "checks"])), "heading": rng.uniform(0, 90)}
    return {"kind": kind, "of": of}


def _steep_thermocline(seed: int) -> Spec:
    """A thermocline of 10 m/s, either way up, anywhere between the surface and the bed; gentle slopes beyond it."""
    rng = np.random.default_rng([20261122, seed])
    top, thickness = rng.uniform(5.0, DEPTH - 3.0), rng.uniform(1.0, 8.0)
    above = rng.uniform(1490.0, 1510.0)
    below = above + rng.choice([-10.0, 10.0])
    speeds = [above + 0.05 * rng.uniform(-top, top), above, below, below + rng.uniform(-1.0, 1.0)]
    return {"kind": "profile", "depth": [0.0, top, top + thickness, DEPTH + 10.0], "sound_speed": speeds}


def _planned_water(rng: Random) -> Spec:
    """Even, bending a little or a lot, or even with a sea above it."""
    draw = rng.random()
    if draw < 0.2:
        calm = rng.random() < 0.5
        sea: Spec = {"kind": "flat"} if calm else {"kind": "rough", "wind_speed": rng.uniform(1.0, 10.0)}
        return {"kind": "uniform", "surface": sea}
    if draw < 0.7:
        return {"kind": "uniform"}
    change = _change_of_speed(rng)
    top, thickness = rng.uniform(5.0, DEPTH - 3.0), rng.uniform(1.0, 8.0)
    return _thermocline([0.0, top, top + thickness, DEPTH + 10.0], change)


def _wide_water(rng: Random, depth: float) -> Spec:
    draw = rng.random()
    if draw < 0.15:
        rough = {"kind": "rough", "wind_speed": rng.uniform(1.0, 10.0)}
        sea = ({"kind": "flat"} if rng.random() < 0.5 else rough) | {"surface_echo": False}
        return {"kind": "uniform", "surface": sea}
    if draw < 0.75:
        return {"kind": "uniform"}
    change = _change_of_speed(rng)
    top, below = rng.uniform(0.1, 0.9) * depth, 1.2 * depth + 10.0
    return _thermocline([0.0, top, min(top + 0.2 * depth, 1.1 * depth), below], change)


def _change_of_speed(rng: Random) -> float:
    return float(rng.choice([-1.0, 1.0])) * _log(rng, 0.01, 12.0)


def _thermocline(depth: list[float], change: float) -> Spec:
    return {"kind": "profile", "depth": depth, "sound_speed": [1500.0, 1500.0, 1500.0 + change, 1500.0 + change]}


def _target(rng: Random, place: Place, folder: Path, halvings: int = 2) -> Spec:
    """Any kind, resting, sunk, hanging or posed freely."""
    make: Callable[[], Spec] = [
        lambda: _pipe(rng),
        lambda: {"kind": "sphere", "radius": rng.uniform(0.15, 1.2)},
        lambda: {"kind": "box", "size": tuple(rng.uniform(0.2, 3.0, 3))},
        lambda: {"kind": "cone", "radius": rng.uniform(0.2, 1.2), "height": rng.uniform(0.4, 2.5)},
        lambda: {"kind": "mesh", "path": str(_buoy_file(folder, halvings)), "scale": rng.uniform(0.3, 1.2)},
        lambda: {"kind": "mesh", "path": "wreck", "scale": rng.uniform(0.1, 0.35)},
    ][rng.integers(0, 6)]
    target, how = make(), rng.random()
    if "gap" not in target and how < 0.6:
        target["gap"] = rng.uniform(-0.4, -0.05) if how < 0.3 else rng.uniform(0.1, 1.5)
    if target["kind"] in ("box", "cone", "mesh"):
        target["heading"] = rng.uniform(-180.0, 180.0)
        if rng.random() < 0.6:
            target |= {"pitch": rng.uniform(-90.0, 90.0), "roll": rng.uniform(-90.0, 90.0)}
    return target | {"position": place, "material": str(rng.choice(SUBSTANCES))}


def _pipe(rng: Random) -> Spec:
    pipe: Spec = {"kind": "pipe", "radius": rng.uniform(0.1, 0.6), "length": rng.uniform(3.0, 15.0)}
    pipe["heading"] = rng.uniform(-180.0, 180.0)
    way = rng.random()
    if way < 0.4:
        along = np.sort(rng.uniform(-0.5, 0.5, 4)) * pipe["length"] + np.arange(4) * 0.01
        pipe["gap"] = [[float(a), float(g)] for a, g in zip(along, rng.uniform(-0.2, 1.0, 4))]
    elif way < 0.7:
        pipe["pitch"] = rng.uniform(-60.0, 60.0)
    return pipe


def _buoy_file(folder: Path, halvings: int) -> Path:
    """A ball of triangles that a mast runs through: faces that cut one another."""
    path = folder / f"buoy-{halvings}.obj"
    if not path.exists():
        vertices, faces = icosphere(halvings)
        mast, sides = box_corners((-0.05, -0.05, -0.5), (0.05, 0.05, 2.0)), BOX_FACES
        rows = [f"v {x} {y} {z}" for x, y, z in np.concatenate([vertices, mast])]
        rows += [f"f {a} {b} {c}" for a, b, c in np.concatenate([faces, np.array(sides) + len(vertices)]) + 1]
        path.write_text("\n".join(rows))
    return path
