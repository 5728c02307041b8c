"""Exact rays, one by one: the reference for the other methods."""

import math
from typing import Any, ClassVar, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from insonify.arrays import Floats, Integers, Singles
from insonify.kernels.common.types import BED, Poses, SceneArrays
from insonify.kernels.multipath.multipath_rays import trace_multipath
from insonify.kernels.rays.cell_walk import NO_HIT, RayBundle, empty_hits, find_first_hits
from insonify.kernels.rays.pings import trace_refracted_pings, trace_straight_pings
from insonify.kernels.rays.refracted_hits import empty_arrivals, find_refracted_hits
from insonify.kernels.rays.specular_paths import follow_specular_paths
from insonify.packing.packed_scene import SURFACE_ECHO, Model
from insonify.parallel import count_threads
from insonify.scene import Scene, SceneError
from insonify.tracers.base import Ladder, Tracer, trace_blocks

WALK = 0.0  # step that stands for an exact walk
STRAIGHT, REFRACTED = 64, 256  # bytes that a thread holds of every ray of both sides
MEMORY = 2**29  # bytes that all threads may hold; one thread holds what it needs
RAY, REFRACTED_RAY = 20.0, 300.0  # work of a ray, in knots of the sweep


class Rays(Tracer):
    """Exact rays, one by one."""

    name, rank, automatic = "rays", 2, True
    fineness: ClassVar[tuple[str, ...]] = ("rays",)
    ladder: ClassVar[Ladder | None] = Ladder("rays per side", 1000, 1000 << 12)
    follows_bounces = True

    def settings(self, model: Model) -> dict[str, Any]:
        """Rays per side."""
        return {"rays": model.rays}

    def work(self, scene: Scene, arrays: SceneArrays, model: Model) -> float:
        """Work of all rays by all paths and bounces."""
        paths = len(model.ways - {SURFACE_ECHO})
        return 2.0 * model.rays * self.work_of_ray(arrays, model) * (1.0 + paths) * (1.0 + model.bounces)

    def work_of_ray(self, arrays: SceneArrays, model: Model) -> float:
        """Work of one ray up to its first hit."""
        return REFRACTED_RAY if model.bent else RAY

    def trace(self, arrays: SceneArrays, poses: Poses, **settings: Any) -> Singles:
        """Trace pings by the settings of this method."""
        return trace(arrays, poses, **settings)


def trace(arrays: SceneArrays, poses: Poses, *, rays: int = 4000, threads: int | None = None) -> Singles:
    """Trace pings ray by ray: an exact walk over the cells of the bilinear bed, exact hits of the bodies."""
    return trace_rays(arrays, poses, rays, WALK, threads)


def trace_surface_paths(arrays: SceneArrays, poses: Poses, *, rays: int = 4000, threads: int | None = None) -> Singles:
    """Trace ray by ray only the echoes by way of the sea surface, which `trace` adds to the first echoes."""

    def block(part: Poses, out: Singles) -> None:
        if arrays.multipath.enabled:
            trace_multipath(arrays, part, int(rays), out)

    return trace_blocks(arrays, poses, block, _affordable(rays, STRAIGHT, threads))


def cast(
    arrays: SceneArrays, origins: ArrayLike, directions: ArrayLike, *, reach: float | None = None
) -> tuple[Floats, Integers, Floats]:
    """Find the first thing that each ray meets, along arcs where the water bends sound."""
    bundle = _bundle(origins, directions)
    hits = empty_hits(bundle.x.size)
    farthest = arrays.bins * arrays.bin_length if reach is None else float(reach)
    if arrays.water.bent:
        find_refracted_hits(arrays, bundle, farthest, WALK, hits, empty_arrivals(bundle.x.size))
    else:
        bodies = np.arange(arrays.solids.shape.size)
        find_first_hits(arrays.bed, arrays.solids, bodies, bodies.size, arrays.mesh, bundle, farthest, hits)
    return hits.distance, _targets(arrays)[hits.body], np.column_stack([hits.nx, hits.ny, hits.nz])


class PathHits(NamedTuple):
    """Every hit of followed rays, ray by ray; the parts of a split one after the other, the reflected one first."""

    ray: Integers  # (n,) number of the ray
    bounce: Integers  # (n,) bounces and passages before this hit
    position: Floats  # (n, 3) of the hit: local x and y, height above the datum, in metres
    length: Floats  # (n,) of the path up to here, in metres of water that take as long
    throughput: Floats  # (n,) share of the ray's energy that arrives
    what: Integers  # (n,) index of the target, or ``BED`` (-1)


def follow(
    arrays: SceneArrays, origins: ArrayLike, directions: ArrayLike, bounces: int, *, reach: float = math.inf
) -> PathHits:
    """Follow rays through mirrors and bodies."""
    _refuse_bends(arrays, bounces)
    whole, real = follow_specular_paths(
        arrays._replace(bounces=int(bounces)), _bundle(origins, directions), float(reach)
    )
    return PathHits(whole[0], whole[1], np.ascontiguousarray(real[:3].T), real[3], real[4], _targets(arrays)[whole[2]])


def _bundle(origins: ArrayLike, directions: ArrayLike) -> RayBundle:
    """Bundle of rays; origins and directions broadcast together, directions are of any length."""
    starts, ways = np.broadcast_arrays(
        np.atleast_2d(np.asarray(origins, dtype=np.float64)), np.atleast_2d(np.asarray(directions, dtype=np.float64))
    )
    ways = ways / np.linalg.norm(ways, axis=1, keepdims=True)
    return RayBundle(*(np.ascontiguousarray(column) for column in (*starts.T, *ways.T)))


def _targets(arrays: SceneArrays) -> Integers:
    """Index of the target of every body; the last element stands for the bed, the one before it for nothing."""
    return np.concatenate([arrays.solids.target, arrays.mesh.target, [NO_HIT, BED]])


def trace_rays(arrays: SceneArrays, poses: Poses, rays: int, step: float, threads: int | None) -> Singles:
    """Trace pings by an exact walk, or by a march if ``step`` is positive."""
    if rays < 1:
        raise SceneError(f"rays: {rays} is too few; give at least 1 ray per side")
    _refuse_bends(arrays, arrays.bounces)
    trace = trace_refracted_pings if arrays.water.bent else trace_straight_pings

    def block(part: Poses, out: Singles) -> None:
        trace(arrays, part, int(rays), float(step), out)
        if arrays.multipath.enabled:
            trace_multipath(arrays, part, int(rays), out)

    return trace_blocks(arrays, poses, block, _affordable(rays, REFRACTED if arrays.water.bent else STRAIGHT, threads))


def _affordable(rays: int, size: int, threads: int | None) -> int:
    """Return the number of threads, fewer where their rays would take too much memory."""
    return min(count_threads(threads), max(MEMORY // (size * int(rays)), 1))


def _refuse_bends(arrays: SceneArrays, bounces: int) -> None:
    """Refuse to follow bounces along arcs."""
    if arrays.water.bent and bounces > 0:
        raise SceneError(
            f"sonar.bounces: {bounces} bounces are traced along straight lines only, but this water refracts sound; "
            "set it to 0 or water.kind to uniform"
        )
