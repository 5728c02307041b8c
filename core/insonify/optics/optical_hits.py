"""Surfaces hit by rays of sight: the first one, and those seen in mirrors and through clear bodies."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.kernels.common.types import SceneArrays
from insonify.optics.cutaway import Vectors
from insonify.tracers.rays import PathHits, cast, follow

SHORT = 1e-5  # m before a hit, where the ray starts that finds its normal
LONG = 400.0  # m after which a ray through mirrors ends


class OpticalHits(NamedTuple):
    """Hits of rays of sight, with the share of light that each returns."""

    ray: NDArray[np.int64]  # (n,) number of the ray
    # (n, 3) place of the hit, direction of the ray, and unit normal on the ray's side; the normal is zero inside
    # a body.
    where: Vectors
    way: Vectors
    normal: Vectors
    what: NDArray[np.int64]  # (n,) index of the target, or ``BED`` (-1)
    share: NDArray[np.float64]  # (n,) share of the surface's light that reaches the eye
    escaped: NDArray[np.float64]  # (n,) share of the ray that continues from here and hits nothing


def find_optical_hits(
    arrays: SceneArrays, starts: Vectors, ways: Vectors, reach: NDArray[np.float64], of_bed: int
) -> OpticalHits:
    """Trace rays to their first hit within reach, and further where the scene follows bounces."""
    distance, what, normal = cast(arrays, starts, ways, reach=float(reach.max(initial=0.0)))
    ray = np.flatnonzero(distance <= reach)
    if arrays.bounces > 0:
        return _followed(arrays, starts[ray], ways[ray], ray, of_bed)
    where = starts[ray] + distance[ray, None] * ways[ray]
    ones = np.ones(ray.size)
    return OpticalHits(ray, where, ways[ray], normal[ray], what[ray], ones, 0.0 * ones)


def _followed(arrays: SceneArrays, starts: Vectors, ways: Vectors, ray: NDArray[np.int64], of_bed: int) -> OpticalHits:
    """Follow rays, each of which hits something, through their bounces."""
    paths = follow(arrays, starts, ways, arrays.bounces, reach=LONG)
    before = _before(paths)
    whence = np.where(paths.bounce[:, None] == 0, starts[paths.ray], paths.position[before])
    way = paths.position - whence
    way /= np.linalg.norm(way, axis=1, keepdims=True)
    # A ray from just before the hit finds the normal only if it runs in the water.
    near, _, normal = cast(arrays, paths.position - SHORT * way, way, reach=2.0 * SHORT)
    within = np.isinf(near)
    share = np.where(within, 0.0, paths.throughput)
    escaped = _escaped(arrays, paths, before, within, of_bed)
    return OpticalHits(ray[paths.ray], paths.position, way, normal, paths.what, share, escaped)


def _before(paths: PathHits) -> NDArray[np.int64]:
    """Index of the hit before each: the last one listed with one bounce less; a first hit has its own index."""
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
    """Fraction of a ray's energy that escapes after each hit without hitting anything again."""
    rows = material_rows(arrays, paths.position, paths.what, of_bed)
    share, mirrored = paths.throughput, arrays.interface[rows, 0] ** 2
    later = paths.bounce > 0
    parent, arrived = before[later], share[later]
    # A refracted ray always hits the far side of its body; rays from the water leave only by reflection.
    is_mirrored = np.isclose(arrived, share[parent] * mirrored[parent], rtol=1e-6)
    counts = within[parent] | is_mirrored
    met = np.zeros(share.size)
    np.add.at(met, parent[counts], arrived[counts])
    return np.maximum(np.where(within, share, share * mirrored) - met, 0.0)


def material_rows(arrays: SceneArrays, where: Vectors, what: NDArray[np.int64], of_bed: int) -> NDArray[np.int64]:
    """Row of the reflectivity table at each hit; the rows of targets follow those of the bed."""
    bed = arrays.bed
    ny, nx = bed.materials.shape
    i = np.floor((where[:, 0] - bed.x0) / bed.spacing).astype(np.int64) % nx
    j = np.floor((where[:, 1] - bed.y0) / bed.spacing).astype(np.int64) % ny
    return np.where(what < 0, bed.materials[j, i], of_bed + what)
