"""Random scenes of every sort that a plan has something to choose about, from a seed."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from insonify.acoustics.beam_patterns import is_patterned
from insonify.scene import Scene
from random_scenes import DEPTH, SUBSTANCES, _ground_material, _moved, _places, _ridges, _target

Spec = dict[str, Any]
Random = np.random.Generator
CELLS = 512
PINGS = 3


def planned_scene(seed: int, folder: Path) -> tuple[Scene, np.ndarray]:
    """Scene of a seed, and the pings by which it is judged; its files go into a folder."""
    rng = np.random.default_rng([20261123, seed])
    heading, altitude = rng.uniform(-180.0, 180.0), rng.uniform(3.0, 15.0)
    reach = min(max(altitude * rng.uniform(2.0, 7.0), 15.0), 80.0)
    places = _places(rng, altitude, reach) if rng.random() < 0.5 else []
    start = rng.uniform(-3.0, 3.0, 2)
    water = _water(rng)
    sonar = {
        "beam": _beam(rng),
        "law": "light" if rng.random() < 0.2 else "sonar",
        "pulse": "ideal",
        "range": reach,
        "bins": int(np.clip(reach / _log(rng, 0.03, 0.4), 100, 1200)),
        "ping_rate": 5.0,
    }
    scene = Scene.model_validate(
        {
            "title": f"planned {seed}",
            "seed": seed,
            "seabed": _seabed(rng, folder, seed),
            "water": water,
            "targets": [_target(rng, _moved(start, heading, place), folder, -1) for place in places],
            "sonar": sonar,
            "track": {"start": tuple(start), "heading": heading, "altitude": altitude, "speed": 0.5, "pings": 200},
        }
    )
    # What rays hear one by one takes them long.
    pings = 1 if is_patterned(scene) or scene.water.kind != "uniform" or scene.water.surface.kind != "none" else PINGS
    if not places:
        return scene, np.sort(rng.integers(0, 200, pings))
    along = np.array([places[k][0] for k in rng.integers(0, len(places), pings)]) + rng.uniform(-0.5, 0.5, pings)
    return scene, np.unique(np.rint(along * 10.0).astype(np.int64))


def _log(rng: Random, low: float, high: float) -> float:
    return float(math.exp(rng.uniform(math.log(low), math.log(high))))


def _beam(rng: Random) -> Any:
    kind = rng.choice(["knife", "fan", "gaussian", "array"], p=[0.25, 0.55, 0.1, 0.1])
    if kind == "knife":
        return "knife"
    beam: Spec = {"kind": str(kind)}
    if kind == "array":
        beam |= {"length": _log(rng, 0.1, 0.6)}
    else:
        beam |= {"width": _log(rng, 0.3, 5.0)}
    if rng.random() < 0.1:
        beam["squint"] = rng.uniform(-10.0, 10.0)
    return beam


def _seabed(rng: Random, folder: Path, seed: int) -> Spec:
    spacing = float(rng.choice([0.05, 0.1, 0.2, 0.4]))
    material = _ground_material(rng) if rng.random() < 0.3 else str(rng.choice(SUBSTANCES))
    kinds: list[Callable[[Random, float], Spec]] = [_fractal, _power_law, _von_karman, _ripples, _correlated, _cascade]
    draw = rng.random()
    if draw < 0.1:
        relief: Spec = {"kind": "flat"}
    elif draw < 0.15:
        spacing = 0.2
        relief = {"kind": "dem", "path": str(_ridges(rng, folder, seed, spacing))}
    else:
        relief = kinds[rng.choice(len(kinds), p=[0.5, 0.12, 0.12, 0.1, 0.1, 0.06])](rng, spacing)
        relief["period"] = CELLS * spacing
    return {"depth": DEPTH, "spacing": spacing, "relief": relief, "material": material}


def _fractal(rng: Random, spacing: float) -> Spec:
    peak = [float(rng.uniform(0, 30)), float(rng.uniform(0, 30))] if rng.random() < 0.5 else [0.0, 0.0]
    beta = rng.uniform(1.0, 2.4)
    return {"kind": "fractal", "beta": beta, "peaks": [peak], "rms": spacing * _log(rng, 0.03, 0.6)}


def _power_law(rng: Random, _: float) -> Spec:
    return {"kind": "power_law", "strength": _log(rng, 5e-4, 0.03), "exponent": rng.uniform(2.6, 3.7)}


def _von_karman(rng: Random, spacing: float) -> Spec:
    across = spacing * _log(rng, 10.0, 60.0)
    shape = {"across": across, "along": across * rng.uniform(1.0, 4.0), "hurst": rng.uniform(0.3, 1.2)}
    return {"kind": "von_karman", "rms": spacing * _log(rng, 0.05, 0.8), "heading": rng.uniform(-180.0, 180.0)} | shape


def _ripples(rng: Random, spacing: float) -> Spec:
    wave = spacing * _log(rng, 5.0, 30.0)
    return {
        "kind": "ripples",
        "wavelength": wave,
        "height": wave * _log(rng, 0.02, 0.12),
        "heading": rng.uniform(0, 90),
    }


def _correlated(rng: Random, spacing: float) -> Spec:
    function = {"kind": str(rng.choice(["exponential", "gaussian"])), "length": spacing * _log(rng, 4.0, 30.0)}
    return {"kind": "autocorrelation", "rms": spacing * _log(rng, 0.05, 0.6), "function": function}


def _cascade(rng: Random, spacing: float) -> Spec:
    return {"kind": "cascade", "rms": spacing * _log(rng, 0.1, 0.6), "hurst": rng.uniform(0.4, 1.2)}


def _water(rng: Random) -> Spec:
    """Even, bending a little or a lot, or even with a sea above it."""
    draw = rng.random()
    if draw < 0.2:
        return {"kind": "uniform", "surface": _surface(rng)}
    if draw < 0.7:
        return {"kind": "uniform"}
    change = rng.choice([-1.0, 1.0]) * _log(rng, 0.01, 12.0)
    top, thickness = rng.uniform(5.0, DEPTH - 3.0), rng.uniform(1.0, 8.0)
    depth = [0.0, top, top + thickness, DEPTH + 10.0]
    return {"kind": "profile", "depth": depth, "sound_speed": [1500.0, 1500.0, 1500.0 + change, 1500.0 + change]}


def _surface(rng: Random) -> Spec:
    if rng.random() < 0.5:
        return {"kind": "flat"}
    return {"kind": "rough", "wind_speed": rng.uniform(1.0, 10.0)}
