"""Planes across the beam and single rays: error by their number, and the number that a tolerance requires."""

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

FAINTEST = 1e-12  # error that counts as zero, and least sum of squares
FLATTEST = 0.01  # least squared cosine of the grazing angle


class TargetDemand(NamedTuple):
    """Error of a single plane across a scene's targets, from which the required planes follow."""

    error: float  # of a single plane in pings across them, as a share of the record
    least: float = 0.0  # assumed however faint a target is, so that several planes cross each
    most: ObservedTarget | None = None  # target that causes most of the error


def predict_target_demand(scene: Scene, view: SceneSummary, targets: tuple[int, ...], bed: float) -> TargetDemand:
    """Predict the error of a single plane in the pings abreast of a scene's targets.

    The error of K planes W / K apart follows from the length of a target's sides and shadow along the track. Each ping
    sums the errors of the target abreast and of those beside it, relative to the energy of the whole ping.

    Parameters
    ----------
    scene : Scene
    view : SceneSummary
        Lengths of the scene.
    targets : tuple of int
        Indices of the targets that are modelled.
    bed : float
        Mean square of the bed's echo over the square of its mean.

    Returns
    -------
    TargetDemand

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
    """Return the error of one plane in a target's echoes and shadow, and the echoes: sums of squares over bins.

    Echoes are relative to those of a level Lambert bed at the target: σ cos θ / sin² θ per metre of slant range, with
    the law of light 1 / sin θ.
    """
    missed = energy = 0.0
    over = seen.grazing if view.light else seen.grazing**2 / math.sqrt(max(1.0 - seen.grazing**2, FLATTEST))
    of_body = seen.combed * (fitted_laws.COMBED_LIGHT if view.light else 1.0)
    for side in seen.sides:
        if view.light and side.depth == 0.0:
            continue  # light spreads evenly over slant range, and a glint has no extent in it
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
    """Strength of a bed's echo relative to a perfect Lambert bed, outside the specular lobe."""
    of = seabed.material.materials
    return sum(one.reflectivity.diffuse for one in of) / len(of)


def _comb(width: float, along: float, turn: float, bin_length: float) -> float:
    """Error of one plane across a part of a target: greater for short parts and for parts that span many bins."""
    lines = 1.0 + (fitted_laws.CURVED * along + turn) / bin_length
    return width / along * (1.0 + bin_length / along) * lines**fitted_laws.TURNED


def _beside(seen: list[ObservedTarget]) -> NDArray[np.float64]:
    """Share of each target (columns) within the beam of a ping abreast of another (rows), without occlusion."""
    place, length, width = (np.array(values) for values in zip(*((one.place, one.length, one.width) for one in seen)))
    overlap = 0.5 * (length + width) - np.abs(place[:, None] - place)
    return np.clip(overlap / np.minimum(length, width), 0.0, 1.0)


class PlaneErrors:
    """Errors by number of planes, which never increase with that number.

    Parameters
    ----------
    bed : (n,) float64
        Error over the bed for each plane count in ``fitted_laws.COUNTS``.
    demand : TargetDemand
        Error of a single plane across the targets.
    most : int
        Greatest number of planes that may be chosen.
    """

    def __init__(self, bed: NDArray[np.float64], demand: TargetDemand, most: int = fitted_laws.MOST_PLANES) -> None:
        self._most = most
        self._bed = np.maximum.accumulate(bed[::-1])[::-1]
        self._targets = demand.error
        fewer = np.asarray(fitted_laws.COUNTS, dtype=np.float64) ** -fitted_laws.TARGET_ORDER
        wary = np.hypot(fitted_laws.MARGIN * self._bed, fitted_laws.MARGIN_OF_TARGETS * demand.error * fewer)
        self._wary = np.maximum(wary, demand.least * fewer)

    def error(self, planes: int) -> float:
        """Predicted error of a number of planes, as a share of the record."""
        return math.hypot(interpolate_over_counts(self._bed, planes), self._targets * planes**-fitted_laws.TARGET_ORDER)

    def wary(self, planes: int) -> float:
        """Error of a number of planes with margins, which one scene in a hundred may reach."""
        return float(self._wary[fitted_laws.COUNTS.index(planes)])

    def fewest(self, error: float, besides: NDArray[np.float64]) -> int:
        """Fewest planes whose error with margins, together with ``besides``, keeps to a bound; the most if none do."""
        kept = np.flatnonzero(np.hypot(self._wary, besides) <= error)
        return min(fitted_laws.COUNTS[int(kept[0])], self._most) if kept.size else self._most


def interpolate_over_counts(errors: NDArray[np.float64], planes: int) -> float:
    """Error of a number of planes from those of ``fitted_laws.COUNTS``, interpolated as a power of that number."""
    logs = np.log(np.maximum(errors, FAINTEST))
    found = math.exp(float(np.interp(math.log(planes), np.log(fitted_laws.COUNTS), logs)))
    return found if found > 2.0 * FAINTEST else 0.0


def count_rays(scene: Scene, error: float) -> int:
    """Return the fewest rays per side whose predicted error keeps to a bound."""
    at_thousand, order = _ray_law(scene)
    return min(max(1000, math.ceil(1000.0 * (at_thousand / max(error, 1e-6)) ** (1.0 / order))), 1 << 22)


def predict_ray_error(scene: Scene, rays: int) -> float:
    """Return the predicted error of a number of rays per side, as a share of the record."""
    at_thousand, order = _ray_law(scene)
    return at_thousand * (1000.0 / rays) ** order


def _ray_law(scene: Scene) -> tuple[float, float]:
    return fitted_laws.FAN_RAYS if scene.sonar.beam.has_width else fitted_laws.KNIFE_RAYS
