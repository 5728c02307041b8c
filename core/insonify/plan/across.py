"""Planes across the beam, and single rays: how many a tolerance asks for."""

from __future__ import annotations

import math
from typing import NamedTuple

from insonify.plan import laws
from insonify.plan.view import View
from insonify.scene import Scene
from insonify.scene.fractal import Fractal
from insonify.scene.materials import Material
from insonify.scene.reliefs import Flat
from insonify.scene.sonar import Knife
from insonify.scene.targets import AnyTarget, Box, MeshFile


class Demand(NamedTuple):
    """What asks for planes."""

    error: float  # that a single plane would make, as a share of the record
    of_what: str


def demand_of(scene: Scene, view: View) -> Demand | None:
    """Return what of a scene asks for most planes; nothing of a knife, nor of a level bed without targets."""
    if isinstance(scene.sonar.beam, Knife):
        return None
    return max([*_of_bed(scene, view), *_of_targets(scene, view)], default=None)


def planes_for(demand: Demand | None, error: float, *, knife: bool) -> int:
    """Return the fewest planes that keep to an error."""
    if knife:
        return 1
    if demand is None:
        return 2
    if error <= 0.0:
        return laws.MOST_PLANES
    return min(laws.MOST_PLANES, 2 * max(1, math.ceil(math.sqrt(demand.error / error) / 2.0)))


def error_of_planes(demand: Demand | None, planes: int) -> float:
    """Return the error that planes leave, as a share of the record."""
    return 0.0 if demand is None else demand.error / planes**2


def rays_for(scene: Scene, error: float) -> int:
    """Return the fewest rays a side that keep to an error."""
    at_thousand, order = _ray_law(scene)
    return min(max(1000, math.ceil(1000.0 * (at_thousand / max(error, 1e-6)) ** (1.0 / order))), 1 << 22)


def error_of_rays(scene: Scene, rays: int) -> float:
    """Return the error that rays leave, as a share of the record."""
    at_thousand, order = _ray_law(scene)
    return at_thousand * (1000.0 / rays) ** order


def _ray_law(scene: Scene) -> tuple[float, float]:
    return laws.KNIFE_RAYS if isinstance(scene.sonar.beam, Knife) else laws.FAN_RAYS


def _of_bed(scene: Scene, view: View) -> list[Demand]:
    """Demand of the bed's detail; none of a level bed of one material."""
    relief, spacing = scene.seabed.relief, view.spacing
    if isinstance(relief, Flat) and isinstance(scene.seabed.material, Material):
        return []
    beta, rms = laws.OTHER_BETA, laws.LAW_RMS
    if isinstance(relief, Fractal) and isinstance(scene.seabed.material, Material):
        beta, rms = min(relief.exponents), relief.rms / spacing
    at_one_cell = laws.ERROR_AT_ONE_CELL * 10.0 ** ((laws.LAW_BETA - beta) / laws.BETA_PER_DECADE) * rms / laws.LAW_RMS
    return [Demand(at_one_cell * (view.width / spacing) ** 2, f"a cell of the bed is {spacing:.3g} m")]


def _of_targets(scene: Scene, view: View) -> list[Demand]:
    """Demand of every target."""
    return [
        Demand(laws.ERROR_AT_ONE_RADIUS * (view.width / radius) ** 2, f"target {number} has a radius of {radius:.3g} m")
        for number, radius in enumerate(map(_radius, scene.targets))
    ]


def _radius(target: AnyTarget) -> float:
    """Radius of a target, half the smallest side of a box, what the thin parts of a mesh are taken to have."""
    if isinstance(target, Box):
        return min(target.size) / 2.0
    return laws.THIN if isinstance(target, MeshFile) else target.radius
