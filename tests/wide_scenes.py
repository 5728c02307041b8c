"""Random scenes as wide as the sliders reach, from a seed: what plans are judged on."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np

from insonify.scene import Scene
from random_scenes import SUBSTANCES, _ground_material, _moved, _target

Spec = dict[str, Any]
Random = np.random.Generator
PINGS = 400
OVER, ACROSS = 16, 8  # judged pings


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
    seabed = _seabed(rng, folder, seed, spacing, depth)
    # Holes of a measured bed carry no targets.
    places = [] if seabed["relief"]["kind"] == "dem" else _places(rng, altitude, reach, PINGS * speed / rate)
    scene = Scene.model_validate(
        {
            "title": f"wide {seed}",
            "seed": seed,
            "seabed": seabed,
            "water": _water(rng, depth, reach),
            "targets": [_target(rng, _moved(start, heading, place), folder, -1) for place in places],
            "sonar": {
                "beam": _beam(rng),
                "vertical": _vertical(rng),
                "law": "light" if rng.random() < 0.15 else "sonar",
                "pulse": "ideal",
                "range": reach,
                "bins": int(_log(rng, 100.0, 1200.0)),
                "ping_rate": rate,
            },
            "track": {
                "start": tuple(start),
                "heading": heading,
                "altitude": altitude,
                "speed": speed,
                "pings": PINGS,
                "motion": _motion(rng, altitude),
            },
        }
    )
    over = rng.integers(0, PINGS, OVER)
    along = np.array([places[k][0] for k in rng.integers(0, len(places), ACROSS)] if places else []) * rate / speed
    across = np.rint(along + rng.uniform(-1.0, 1.0, along.size)).astype(np.int64)
    return scene, np.unique(over), np.unique(np.clip(across, 0, PINGS - 1))


def _log(rng: Random, low: float, high: float) -> float:
    return float(math.exp(rng.uniform(math.log(low), math.log(high))))


def _places(rng: Random, altitude: float, reach: float, length: float) -> list[tuple[float, float]]:
    """Up to five targets along and athwart the track."""
    if rng.random() < 0.5:
        return []
    farthest = 0.9 * math.sqrt(reach**2 - altitude**2)
    near = min(3.0, 0.5 * farthest)
    return [
        (rng.uniform(0.1, 0.9) * length, rng.choice([-1.0, 1.0]) * rng.uniform(near, farthest))
        for _ in range(rng.integers(1, 6))
    ]


def _beam(rng: Random) -> Any:
    kind = str(rng.choice(["knife", "fan", "gaussian", "array"], p=[0.2, 0.5, 0.15, 0.15]))
    if kind == "knife":
        return "knife"
    beam: Spec = {"kind": kind}
    beam |= {"length": _log(rng, 0.1, 1.0)} if kind == "array" else {"width": _log(rng, 0.2, 10.0)}
    if rng.random() < 0.1:
        beam["squint"] = rng.uniform(-10.0, 10.0)
    return beam


def _vertical(rng: Random) -> Any:
    if rng.random() < 0.7:
        return "uniform"
    return {
        "kind": str(rng.choice(["fan", "gaussian"])),
        "width": rng.uniform(20.0, 90.0),
        "tilt": rng.uniform(10.0, 50.0),
    }


def _motion(rng: Random, altitude: float) -> Any:
    if rng.random() < 0.6:
        return "straight"
    kind = str(rng.choice(["heave", "sway", "yaw", "pitch", "roll"]))
    amplitude = 0.1 * altitude if kind in ("heave", "sway") else rng.uniform(0.5, 6.0)
    return {"kind": kind, "amplitude": amplitude, "period": _log(rng, 3.0, 30.0)}


def _seabed(rng: Random, folder: Path, seed: int, spacing: float, depth: float) -> Spec:
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
        relief = _relief(rng, spacing) | {"period": 512 * spacing}
    return {"depth": depth, "spacing": spacing, "relief": relief, "material": material}


def _relief(rng: Random, spacing: float) -> Spec:
    rms = spacing * _log(rng, 0.02, 3.0)
    kind = str(rng.choice(["fractal", "von_karman", "autocorrelation", "cascade", "ripples"]))
    if kind == "fractal":
        return {"kind": kind, "beta": rng.uniform(1.0, 2.4), "rms": rms}
    if kind == "von_karman":
        across = spacing * _log(rng, 10.0, 60.0)
        shape = {"across": across, "along": across * rng.uniform(1.0, 4.0), "hurst": rng.uniform(0.3, 1.2)}
        return {"kind": kind, "rms": rms, "heading": rng.uniform(-180.0, 180.0)} | shape
    if kind == "autocorrelation":
        function = {"kind": str(rng.choice(["exponential", "gaussian"])), "length": spacing * _log(rng, 4.0, 30.0)}
        return {"kind": kind, "rms": rms, "function": function}
    if kind == "cascade":
        return {"kind": kind, "rms": rms, "hurst": rng.uniform(0.4, 1.2)}
    wave = spacing * _log(rng, 5.0, 30.0)
    return {"kind": kind, "wavelength": wave, "height": wave * _log(rng, 0.02, 0.3), "heading": rng.uniform(0, 90)}


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


def _water(rng: Random, depth: float, reach: float) -> Spec:
    draw = rng.random()
    if draw < 0.15:
        rough = {"kind": "rough", "wind_speed": rng.uniform(1.0, 10.0)}
        return {
            "kind": "uniform",
            "surface": ({"kind": "flat"} if rng.random() < 0.5 else rough) | {"surface_echo": False},
        }
    if draw < 0.75:
        return {"kind": "uniform"}
    change = rng.choice([-1.0, 1.0]) * _log(rng, 0.01, 12.0)
    top, below = rng.uniform(0.1, 0.9) * depth, 1.2 * depth + 10.0
    return {
        "kind": "profile",
        "depth": [0.0, top, min(top + 0.2 * depth, 1.1 * depth), below],
        "sound_speed": [1500.0, 1500.0, 1500.0 + change, 1500.0 + change],
    }
