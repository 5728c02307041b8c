"""Planes across the beam, and single rays: what error they leave, and how many a tolerance asks for."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from insonify.plan import laws
from insonify.plan.view import View
from insonify.scene import Scene
from insonify.scene.sonar import Knife
from insonify.scene.targets import AnyTarget, Box, MeshFile

FAINTEST = 1e-12  # error that is none


def target_demand(scene: Scene, view: View, targets: tuple[int, ...]) -> float:
    """Return the error that a single plane would make of a scene's targets, as a share of the record."""
    if not targets or view.half_width == 0.0:
        return 0.0
    radius = min(radius_of(scene.targets[k]) for k in targets)
    light = laws.TARGET_LIGHT if view.light else 1.0
    worth = laws.WORTH[view.beam] ** -laws.TARGET_ORDER
    return laws.TARGET_PLANES * view.width**laws.TARGET_WIDTH * radius**laws.TARGET_RADIUS * light * worth


def radius_of(target: AnyTarget) -> float:
    """Radius of a target, half the smallest side of a box, what the thin parts of a mesh are taken to have."""
    if isinstance(target, Box):
        return min(target.size) / 2.0
    return laws.THIN if isinstance(target, MeshFile) else target.radius


class Planes:
    """Errors of planes by their number, never greater with more of them.

    Parameters
    ----------
    bed : (n,) float64
        What each of ``laws.COUNTS`` leaves of the bed.
    targets : float
        What a single plane would make of the targets.
    most : int
        Planes that may be chosen.
    """

    def __init__(self, bed: NDArray[np.float64], targets: float, most: int = laws.MOST_PLANES) -> None:
        self._most = most
        self._bed = np.maximum.accumulate(bed[::-1])[::-1]
        self._targets = targets
        of_targets = targets * np.asarray(laws.COUNTS, dtype=np.float64) ** -laws.TARGET_ORDER
        self._wary = np.hypot(laws.MARGIN * self._bed, laws.MARGIN_OF_TARGETS * of_targets)

    def error(self, planes: int) -> float:
        """Error of so many planes, as a share of the record."""
        return math.hypot(among_counts(self._bed, planes), self._targets * planes**-laws.TARGET_ORDER)

    def wary(self, planes: int) -> float:
        """Error that one scene in a hundred may have instead."""
        return float(self._wary[laws.COUNTS.index(planes)])

    def fewest(self, error: float, besides: NDArray[np.float64]) -> int:
        """Fewest planes that keep to an error even then, besides another by their number; the most if none do."""
        kept = np.flatnonzero(np.hypot(self._wary, besides) <= error)
        return min(laws.COUNTS[int(kept[0])], self._most) if kept.size else self._most


def among_counts(errors: NDArray[np.float64], planes: int) -> float:
    """Take the error of so many planes from one for each of ``laws.COUNTS``, between which it falls as a power."""
    logs = np.log(np.maximum(errors, FAINTEST))
    found = math.exp(float(np.interp(math.log(planes), np.log(laws.COUNTS), logs)))
    return found if found > 2.0 * FAINTEST else 0.0


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
