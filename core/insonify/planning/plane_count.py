"""Planes across the beam, and single rays: what error they leave, and how many a tolerance asks for."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.acoustics.error_range import ERROR_ALTITUDES
from insonify.planning import fitted_laws
from insonify.planning.scene_summary import SceneSummary
from insonify.planning.target_errors import ObservedTarget, observe_target
from insonify.scene import Scene
from insonify.scene.seabed import Seabed

FAINTEST = 1e-12  # error that is none, and sum of squares
FLATTEST = 0.01  # square of a cosine


class TargetDemand(NamedTuple):
    """What a scene's targets ask of the planes."""

    error: float  # that a single plane would make of pings across them, as a share of the record
    least: float = 0.0  # that the planes are to be kept to however faint a target is, so that none is heard as a comb
    most: ObservedTarget | None = None  # the target to which most of it is due


def predict_target_demand(scene: Scene, view: SceneSummary, targets: tuple[int, ...], bed: float) -> TargetDemand:
    """Foretell the error that a single plane would make of the pings that go out at a scene's targets.

    Planes W / K apart at a target, over which its sides are so and so long, miss so much of what the sides return, and
    their shadows hide; in each ping what its own target adds and those beside it, over all that it hears.

    Parameters
    ----------
    scene : Scene
    view : View
        Its lengths.
    targets : tuple of int
        Numbers of those that are modelled.
    bed : float
        Mean square of the bed's echo over that of an even bed of its mean strength.

    Returns
    -------
    Demand

    Raises
    ------
    SceneError
        If a mesh cannot be read.
    """
    if not targets or view.half_width == 0.0:
        return TargetDemand(0.0)
    seen = [one for one in (observe_target(scene, view, number) for number in targets) if one is not None]
    if not seen:
        return TargetDemand(0.0)
    strength = _strength(scene.seabed)
    bins = 2.0 * max(view.bins * (1.0 - ERROR_ALTITUDES * view.altitude / view.reach), 1.0)
    loud = max(bins * bed * strength**2, FAINTEST)
    missed, energy = np.array([_returns(one, view, strength) for one in seen]).T
    beside = _beside(seen)
    errors = (beside @ missed) / (loud + beside @ energy)
    worth = fitted_laws.WORTH[view.beam] ** -fitted_laws.TARGET_ORDER
    shortest = max(one.width / one.length for one in seen)
    return TargetDemand(
        error=worth * math.sqrt(errors.mean()),
        least=fitted_laws.UNHEARD * shortest**fitted_laws.TARGET_ORDER,
        most=seen[int(np.argmax(missed / (loud + energy)))],
    )


def _returns(seen: ObservedTarget, view: SceneSummary, strength: float) -> tuple[float, float]:
    """Return what one plane misses of a target's echoes and shadow, and the echoes: sums of squares over bins.

    Echoes are over those of a level Lambert bed there: σ cos θ / sin² θ per metre of slant range, of light 1 / sin θ.
    """
    missed = energy = 0.0
    over = seen.grazing if view.light else seen.grazing**2 / math.sqrt(max(1.0 - seen.grazing**2, FLATTEST))
    of_body = seen.combed * (fitted_laws.COMBED_LIGHT if view.light else 1.0)
    for side in seen.sides:
        if view.light and side.depth == 0.0:
            continue  # light is even over slant range, of which a glint has none
        shown = min(side.along / seen.width, 1.0)
        loudness = side.echo / (side.along * over) * (fitted_laws.LIGHT_ECHO if view.light else 1.0)
        depth = math.hypot(side.depth, view.bin_length) + side.turn * min(seen.width / side.along, 1.0)
        square = (loudness * shown) ** 2 / (view.bin_length * depth)
        energy += square
        missed += square * (of_body * _comb(seen.width, side.along, side.turn, view.bin_length)) ** 2
    hidden = strength**2 * seen.shadow / view.bin_length * min(seen.length / seen.width, 1.0) ** 2
    return missed + hidden * (
        fitted_laws.COMBED_SHADOW * _comb(seen.width, seen.length, 0.0, view.bin_length)
    ) ** 2, energy


def _strength(seabed: Seabed) -> float:
    """Strength of a bed's echo over that of a perfect Lambert bed, beyond where its lobe is heard."""
    of = seabed.material.materials
    return sum(one.reflectivity.diffuse for one in of) / len(of)


def _comb(width: float, along: float, turn: float, bin_length: float) -> float:
    """Error of one plane over a part: the coarser the shorter it is, and the fewer of its lines share a bin."""
    lines = 1.0 + (fitted_laws.CURVED * along + turn) / bin_length
    return width / along * (1.0 + bin_length / along) * lines**fitted_laws.TURNED


def _beside(seen: list[ObservedTarget]) -> NDArray[np.float64]:
    """Share of each target (columns) that a ping hears which goes out at another (rows), none hiding another."""
    place, length, width = (np.array(values) for values in zip(*((one.place, one.length, one.width) for one in seen)))
    overlap = 0.5 * (length + width) - np.abs(place[:, None] - place)
    return np.clip(overlap / np.minimum(length, width), 0.0, 1.0)


class PlaneErrors:
    """Errors of planes by their number, never greater with more of them.

    Parameters
    ----------
    bed : (n,) float64
        What each of ``laws.COUNTS`` leaves of the bed.
    demand : Demand
        What the targets ask.
    most : int
        Planes that may be chosen.
    """

    def __init__(self, bed: NDArray[np.float64], demand: TargetDemand, most: int = fitted_laws.MOST_PLANES) -> None:
        self._most = most
        self._bed = np.maximum.accumulate(bed[::-1])[::-1]
        self._targets = demand.error
        fewer = np.asarray(fitted_laws.COUNTS, dtype=np.float64) ** -fitted_laws.TARGET_ORDER
        wary = np.hypot(fitted_laws.MARGIN * self._bed, fitted_laws.MARGIN_OF_TARGETS * demand.error * fewer)
        self._wary = np.maximum(wary, demand.least * fewer)

    def error(self, planes: int) -> float:
        """Error of so many planes, as a share of the record."""
        return math.hypot(interpolate_over_counts(self._bed, planes), self._targets * planes**-fitted_laws.TARGET_ORDER)

    def wary(self, planes: int) -> float:
        """Error that one scene in a hundred may have instead."""
        return float(self._wary[fitted_laws.COUNTS.index(planes)])

    def fewest(self, error: float, besides: NDArray[np.float64]) -> int:
        """Fewest planes that keep to an error even then, besides another by their number; the most if none do."""
        kept = np.flatnonzero(np.hypot(self._wary, besides) <= error)
        return min(fitted_laws.COUNTS[int(kept[0])], self._most) if kept.size else self._most


def interpolate_over_counts(errors: NDArray[np.float64], planes: int) -> float:
    """Take the error of so many planes from one for each of ``laws.COUNTS``, between which it falls as a power."""
    logs = np.log(np.maximum(errors, FAINTEST))
    found = math.exp(float(np.interp(math.log(planes), np.log(fitted_laws.COUNTS), logs)))
    return found if found > 2.0 * FAINTEST else 0.0


def count_rays(scene: Scene, error: float) -> int:
    """Return the fewest rays a side that keep to an error."""
    at_thousand, order = _ray_law(scene)
    return min(max(1000, math.ceil(1000.0 * (at_thousand / max(error, 1e-6)) ** (1.0 / order))), 1 << 22)


def predict_ray_error(scene: Scene, rays: int) -> float:
    """Return the error that rays leave, as a share of the record."""
    at_thousand, order = _ray_law(scene)
    return at_thousand * (1000.0 / rays) ** order


def _ray_law(scene: Scene) -> tuple[float, float]:
    return fitted_laws.FAN_RAYS if scene.sonar.beam.has_width else fitted_laws.KNIFE_RAYS
