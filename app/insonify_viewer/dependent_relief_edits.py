"""Dependent edits of the relief."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from insonify.scene import Scene
from insonify.scene.seabed.reliefs.fractal import Fractal
from insonify.scene.seabed.reliefs.random_relief import RandomRelief
from insonify.scene.seabed.reliefs.sum import SumOfReliefs

Changes = dict[str, Any]
RELIEF = "seabed.relief"
SMOOTH = ("isotropic", "elliptic")


def exponents_of_decay(scene: Scene, changes: Mapping[str, Any]) -> tuple[Changes, str]:
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


def endless_options(scene: Scene, changes: Mapping[str, Any]) -> tuple[Changes, str]:
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


def common_period(scene: Scene, changes: Mapping[str, Any]) -> tuple[Changes, str]:
    """Give all parts of a sum the same period and extent."""
    places = _parts(scene)
    edits: Changes = {}
    for name in ("period", "extent"):
        moved = [changes[f"{path}.{name}"] for path, _ in places if f"{path}.{name}" in changes]
        others = [f"{path}.{name}" for path, part in places if hasattr(part, name)]
        if moved and len(places) > 1:
            edits |= dict.fromkeys(others, moved[-1])
    return edits, ""


def parts_of_sum(scene: Scene, changes: Mapping[str, Any]) -> tuple[Changes, str]:
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
