"""Every method with its settings."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.kernels.types import Bed, Poses, Problem, still_water
from insonify.tracers import march, rays, sweep

STEPS = (16.0, 4.0, 1.0, 0.5)  # of a march, in cells of the bed
RAYS = (250, 1000, 4000, 16000)
PLANES = (1, 2, 4, 8, 16, 32, 64)
STILL_RAYS, STILL_PLANES = (16000,), (4, 16, 64)
COARSER = {2: "2nd", 4: "4th"}  # nodes of the bed
COARSE_PLANES = (4, 16)

Record = NDArray[np.float32]


class Name(NamedTuple):
    """What tells one contender from another.

    Attributes
    ----------
    method : str
        How echoes are found.
    setting : str
        As a person reads it.
    targets : bool
        Whether the scene's targets are there.
    """

    method: str
    setting: str
    targets: bool


class Contender(NamedTuple):
    """One method with one setting.

    Attributes
    ----------
    method : str
        How echoes are found.
    setting : str
        As a person reads it.
    size : float
        The setting as a number: metres a step, rays a side, planes.
    trace : callable
        Traces poses on one thread.
    """

    method: str
    setting: str
    size: float
    trace: Callable[[Poses], Record]


def contenders(problem: Problem) -> list[Contender]:
    """List every method with its settings, all on one thread.

    Parameters
    ----------
    problem : Problem
        The scene as kernels see it.

    Returns
    -------
    list of Contender
        Methods one after the other, each from its coarsest setting to its finest.
    """
    if problem.bounces:
        return _rays("rays", problem, RAYS)
    out = _marches(problem) + _rays("rays", problem, RAYS)
    if problem.water.station.size == 1:  # the sweep hears no water that differs along the level
        out += _sweeps("sweep", problem, PLANES)
        for every, ordinal in COARSER.items():
            if (coarse := coarser(problem.bed, every)) is not None:
                out += _sweeps(f"sweep, every {ordinal} node", problem._replace(bed=coarse), COARSE_PLANES)
    if problem.water.bent:
        still = problem._replace(water=still_water(problem.water.reference, problem.water.surface))
        out += _rays("rays, straight", still, STILL_RAYS) + _sweeps("sweep, straight", still, STILL_PLANES)
    return out


def coarser(bed: Bed, every: int) -> Bed | None:
    """Keep every so many nodes of a bed; None where it would no longer repeat as it does, or be no bed."""
    heights = np.ascontiguousarray(bed.heights[::every, ::every])
    finite = heights[np.isfinite(heights)]
    if min(heights.shape) < 2 or finite.size == 0 or (bed.periodic and any(n % every for n in bed.heights.shape)):
        return None
    return bed._replace(
        heights=heights,
        transposed=np.ascontiguousarray(heights.T),
        materials=np.ascontiguousarray(bed.materials[::every, ::every]),
        spacing=bed.spacing * every,
        low=float(finite.min()),
        high=float(finite.max()),
    )


def _marches(problem: Problem) -> list[Contender]:
    """As many rays a side as there are bins, as in the paper's day."""
    steps = [cells * problem.bed.spacing for cells in STEPS]
    return [
        Contender("march", f"{step:.3g} m", step, _bound(march.trace, problem, step=step, rays=problem.bins))
        for step in steps
    ]


def _rays(method: str, problem: Problem, counts: tuple[int, ...]) -> list[Contender]:
    return [Contender(method, f"{count:,} rays", count, _bound(rays.trace, problem, rays=count)) for count in counts]


def _sweeps(method: str, problem: Problem, counts: tuple[int, ...]) -> list[Contender]:
    """Fans of planes; a knife has one."""
    return [
        Contender(method, f"{planes} plane{'s' * (planes > 1)}", planes, _bound(sweep.trace, problem, planes=planes))
        for planes in (counts if problem.half_width > 0.0 else (1,))
    ]


def _bound(trace: Callable[..., Record], problem: Problem, **settings: float) -> Callable[[Poses], Record]:
    return partial(trace, problem, threads=1, **settings)
