"""A problem less what is not modelled."""

from __future__ import annotations

from collections.abc import Collection
from typing import Any

import numpy as np
from numpy.typing import NDArray

from insonify.kernels.tree import make_mesh
from insonify.kernels.types import Bed, Problem, Solids
from insonify.scene.surface import WAYS


def lessened(problem: Problem, *, bed: Bed, ways: Collection[str], bounces: int, targets: Collection[int]) -> Problem:
    """Leave out what is not modelled.

    Parameters
    ----------
    problem : Problem
        With all that the scene declares.
    bed : Bed
        With as many nodes as are modelled.
    ways : collection of str
        Ways by the sea surface that are heard.
    bounces : int
        Mirror-like bounces followed.
    targets : collection of int
        Targets that are there, by their places in the scene; the others leave their numbers behind.

    Returns
    -------
    Problem
    """
    ghosts = problem.ghosts
    heard: dict[str, Any] = {way: getattr(ghosts, way) and way in ways for way in WAYS}
    problem = problem._replace(ghosts=ghosts._replace(heard=any(heard.values()), **heard), bounces=bounces, bed=bed)
    kept = np.asarray(sorted(targets), dtype=np.int64)
    return _without_others(problem, np.isin(problem.solids.target, kept), np.isin(problem.mesh.target, kept))


def _without_others(problem: Problem, solids: NDArray[np.bool_], triangles: NDArray[np.bool_]) -> Problem:
    """Keep some bodies and triangles."""
    if solids.all() and triangles.all():
        return problem
    mesh = problem.mesh
    columns: list[Any] = [column[solids] for column in problem.solids]
    return problem._replace(
        solids=Solids(*columns),
        mesh=make_mesh(mesh.corners[triangles], mesh.material[triangles], mesh.target[triangles]),
    )
