"""Random scenes full of targets that hide one another, from a seed: what methods are judged on."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from beds import icosphere
from insonify.scene import Scene

Spec = dict[str, Any]
Random = np.random.Generator
DEPTH = 30.0
PINGS_PER_METRE = 10.0
SUBSTANCES = ("silt", "fine_sand", "medium_sand", "coarse_sand", "sandy_gravel", "cobble", "rock", "concrete", "steel")
MANY = 5  # halvings of an icosahedron that make 20,480 triangles
MANY_IN = 7  # the only scene with that many
BUOY = "buoy-{}.obj"


def random_scene(seed: int, folder: Path, *, bent: bool = False) -> tuple[Scene, np.ndarray]:
    """Scene of a seed and the pings that cross its targets; its files go into a folder. Its water may bend sound."""
    rng = np.random.default_rng([20261121, seed])
    heading, altitude, reach = rng.uniform(-180.0, 180.0), rng.uniform(3.0, 15.0), rng.uniform(20.0, 30.0)
    places = _places(rng, altitude, reach)
    start = rng.uniform(-3.0, 3.0, 2)
    scene = Scene.model_validate(
        {
            "title": f"random {seed}",
            "seed": seed,
            "seabed": _seabed(rng, folder, seed),
            "water": _water(seed) if bent else {"kind": "uniform"},
            "targets": [_target(rng, _moved(start, heading, place), folder, seed) for place in places],
            "sonar": {
                "beam": "knife" if rng.random() < 0.5 else {"kind": "fan", "width": rng.uniform(0.5, 3.0)},
                "law": "light" if rng.random() < 0.3 else "sonar",
                "pulse": "ideal",
                "range": reach,
                "bins": int(rng.integers(300, 601)),
            },
            "track": {
                "start": tuple(start),
                "heading": heading,
                "altitude": altitude,
                "speed": 1.0,
                "pings": 200,
            },
        }
    )
    chosen = rng.integers(0, len(places), 4)
    along = np.array([places[k][0] for k in chosen]) + rng.uniform(-0.8, 0.8, 4)
    return scene, np.unique(np.rint(along * PINGS_PER_METRE).astype(np.int64))


def _water(seed: int) -> Spec:
    """A thermocline of 10 m/s, either way up, anywhere between the surface and the bed; gentle slopes beyond it."""
    rng = np.random.default_rng([20261122, seed])
    top, thickness = rng.uniform(5.0, DEPTH - 3.0), rng.uniform(1.0, 8.0)
    above = rng.uniform(1490.0, 1510.0)
    below = above + rng.choice([-10.0, 10.0])
    speeds = [above + 0.05 * rng.uniform(-top, top), above, below, below + rng.uniform(-1.0, 1.0)]
    return {"kind": "profile", "depth": [0.0, top, top + thickness, DEPTH + 10.0], "sound_speed": speeds}


def _places(rng: Random, altitude: float, reach: float) -> list[tuple[float, float]]:
    """Targets along and athwart the track; half of them in front of, behind or within one before."""
    farthest = 0.9 * math.sqrt(reach * reach - altitude * altitude)
    places: list[tuple[float, float]] = []
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


def _moved(start: np.ndarray, heading: float, place: tuple[float, float]) -> tuple[float, float]:
    """World coordinates of a place along and to port of the track."""
    c, s = math.cos(math.radians(heading)), math.sin(math.radians(heading))
    return start[0] + place[0] * c - place[1] * s, start[1] + place[0] * s + place[1] * c


def _seabed(rng: Random, folder: Path, seed: int) -> Spec:
    spacing = float(rng.choice([0.1, 0.2]))
    peak = [[float(rng.uniform(0, 30)), float(rng.uniform(0, 30))]] if rng.random() < 0.5 else [[0.0, 0.0]]
    relief: Spec = {
        "kind": "fractal",
        "beta": rng.uniform(1.2, 2.0),
        "peaks": peak,
        "period": 512 * spacing,
        "rms": spacing * rng.uniform(0.05, 0.5),
    }
    if rng.random() < 0.25:
        relief = {"kind": "dem", "path": str(_ridges(rng, folder, seed, spacing))}
    return {"depth": DEPTH, "spacing": spacing, "relief": relief, "material": _ground_material(rng)}


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


def _ground_material(rng: Random) -> Any:
    if rng.random() < 0.5:
        return str(rng.choice(SUBSTANCES))
    kind = str(rng.choice(["patches", "fractal", "pattern"]))
    of = [str(name) for name in rng.choice(SUBSTANCES, rng.integers(2, 4), replace=False)]
    if kind == "pattern":
        return {"kind": kind, "of": of, "shape": str(rng.choice(["stripes", "checks"])), "heading": rng.uniform(0, 90)}
    return {"kind": kind, "of": of}


def _target(rng: Random, place: tuple[float, float], folder: Path, seed: int) -> Spec:
    """Any kind, resting, sunk, hanging or posed freely."""
    make: Callable[[Random], Spec] = [_pipe, _sphere, _box, _cone, _buoy, _wreck][rng.integers(0, 6)]
    target = make(rng)
    if target["kind"] == "mesh" and target["path"] != "wreck":
        target["path"] = str(_buoy_file(folder, MANY if seed == MANY_IN else 2))
    how = rng.random()
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


def _sphere(rng: Random) -> Spec:
    return {"kind": "sphere", "radius": rng.uniform(0.15, 1.2)}


def _box(rng: Random) -> Spec:
    return {"kind": "box", "size": tuple(rng.uniform(0.2, 3.0, 3))}


def _cone(rng: Random) -> Spec:
    return {"kind": "cone", "radius": rng.uniform(0.2, 1.2), "height": rng.uniform(0.4, 2.5)}


def _buoy(rng: Random) -> Spec:
    return {"kind": "mesh", "path": "", "scale": rng.uniform(0.3, 1.2)}


def _wreck(rng: Random) -> Spec:
    return {"kind": "mesh", "path": "wreck", "scale": rng.uniform(0.1, 0.35)}


def _buoy_file(folder: Path, halvings: int) -> Path:
    """A ball of triangles that a mast runs through: faces that cut one another."""
    path = folder / BUOY.format(halvings)
    if not path.exists():
        vertices, faces = icosphere(halvings)
        mast = np.array([[x, y, z] for x in (-0.05, 0.05) for y in (-0.05, 0.05) for z in (-0.5, 2.0)])
        sides = [(0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1)]
        sides += [(2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3)]
        rows = [f"v {x} {y} {z}" for x, y, z in np.concatenate([vertices, mast])]
        rows += [f"f {a} {b} {c}" for a, b, c in np.concatenate([faces, np.array(sides) + len(vertices)]) + 1]
        path.write_text("\n".join(rows))
    return path
