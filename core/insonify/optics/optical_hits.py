"""What rays of sight meet: the first surface, and what is seen in mirrors and through clear bodies."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.kernels.common.types import SceneArrays
from insonify.optics.cutaway import Vectors
from insonify.tracers.rays import PathHits, cast, follow

SHORT = 1e-5  # m before a hit, from where its surface is looked at
LONG = 400.0  # m after which a ray through mirrors is given up


class Glances(NamedTuple):
    """Surfaces seen by rays.

    Attributes
    ----------
    ray : (n,) int64
        Number of the ray.
    where, way, normal : (n, 3) float64
        Place, direction of the ray there, and the surface's unit normal on its side; zero if seen from within.
    what : (n,) int64
        Index of the target, or ``BED`` (-1).
    share : (n,) float64
        Share of the surface's light that reaches the eye.
    escaped : (n,) float64
        Share of the ray that goes on from here and meets nothing but water.
    """

    ray: NDArray[np.int64]
    where: Vectors
    way: Vectors
    normal: Vectors
    what: NDArray[np.int64]
    share: NDArray[np.float64]
    escaped: NDArray[np.float64]


def glances(arrays: SceneArrays, starts: Vectors, ways: Vectors, reach: NDArray[np.float64], of_bed: int) -> Glances:
    """Find what rays meet, the first hit of each within its own reach.

    Parameters
    ----------
    problem : Problem
        The scene as kernels see it; its bounces are followed.
    starts, ways : (n, 3) float64
        Where the rays start, in the water, and their unit directions.
    reach : (n,) float64
        Metres.
    of_bed : int
        Rows of the reflectivity table that are the bed's.

    Returns
    -------
    Glances
    """
    distance, what, normal = cast(arrays, starts, ways, reach=float(reach.max(initial=0.0)))
    ray = np.flatnonzero(distance <= reach)
    if arrays.bounces > 0:
        return _followed(arrays, starts[ray], ways[ray], ray, of_bed)
    where = starts[ray] + distance[ray, None] * ways[ray]
    ones = np.ones(ray.size)
    return Glances(ray, where, ways[ray], normal[ray], what[ray], ones, 0.0 * ones)


def _followed(arrays: SceneArrays, starts: Vectors, ways: Vectors, ray: NDArray[np.int64], of_bed: int) -> Glances:
    """Follow rays that are known to meet something."""
    paths = follow(arrays, starts, ways, arrays.bounces, reach=LONG)
    before = _before(paths)
    whence = np.where(paths.bounce[:, None] == 0, starts[paths.ray], paths.position[before])
    way = paths.position - whence
    way /= np.linalg.norm(way, axis=1, keepdims=True)
    # From just before it a hit has a normal if it is seen from the water.
    near, _, normal = cast(arrays, paths.position - SHORT * way, way, reach=2.0 * SHORT)
    within = np.isinf(near)
    share = np.where(within, 0.0, paths.throughput)
    escaped = _escaped(arrays, paths, before, within, of_bed)
    return Glances(ray[paths.ray], paths.position, way, normal, paths.what, share, escaped)


def _before(paths: PathHits) -> NDArray[np.int64]:
    """Find the hit before each, which is the last one listed with a bounce less; its own number for a first hit."""
    numbers = np.arange(paths.ray.size)
    before = numbers.copy()
    for bounce in range(1, int(paths.bounce.max(initial=0)) + 1):
        last = np.maximum.accumulate(np.where(paths.bounce == bounce - 1, numbers, 0))
        these = paths.bounce == bounce
        before[these] = last[these]
    return before


def _escaped(
    arrays: SceneArrays, paths: PathHits, before: NDArray[np.int64], within: NDArray[np.bool_], of_bed: int
) -> NDArray[np.float64]:
    """Share of every hit's ray that goes on from there and meets nothing."""
    rows = material_rows(arrays, paths.position, paths.what, of_bed)
    share, mirrored = paths.throughput, arrays.interface[rows, 0] ** 2
    later = paths.bounce > 0
    parent, arrived = before[later], share[later]
    # A refracted ray always meets the far side of its body; of those from the water only mirrored ones are lost.
    is_mirrored = np.isclose(arrived, share[parent] * mirrored[parent], rtol=1e-6)
    counts = within[parent] | is_mirrored
    met = np.zeros(share.size)
    np.add.at(met, parent[counts], arrived[counts])
    return np.maximum(np.where(within, share, share * mirrored) - met, 0.0)


def material_rows(arrays: SceneArrays, where: Vectors, what: NDArray[np.int64], of_bed: int) -> NDArray[np.int64]:
    """Return the rows of the reflectivity table at places of the bed and of targets, whose rows follow the bed's."""
    bed = arrays.bed
    ny, nx = bed.materials.shape
    i = np.floor((where[:, 0] - bed.x0) / bed.spacing).astype(np.int64) % nx
    j = np.floor((where[:, 1] - bed.y0) / bed.spacing).astype(np.int64) % ny
    return np.where(what < 0, bed.materials[j, i], of_bed + what)
