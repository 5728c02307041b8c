"""Embree over a triangulated bed, where it is installed: the same rays with another surface and engine."""

from __future__ import annotations

import math
from importlib.util import find_spec
from typing import Any

import numpy as np
from numpy.typing import NDArray

from insonify.kernels.common.types import BED, PORT, Poses, SceneArrays
from insonify.kernels.rays.cell_walk import NOTHING, RayBundle
from insonify.kernels.rays.first_echoes import deposit_hits, empty_bundle, empty_hits, empty_launch
from insonify.kernels.rays.launch import RayLaunch, SideBeam, aim_rays, highest_elevation, rotate_to_world
from insonify.scene import SceneError

MOST_TRIANGLES = 8_000_000

Record = NDArray[np.float32]


def explain_omission(arrays: SceneArrays, poses: Poses) -> str:
    """Explain in one line why Embree does not trace a scene; empty if it does."""
    if find_spec("embreex") is None:
        return "embree: left out, embreex is not installed (pip install 'insonify[embree]')"
    if arrays.water.bent or arrays.multipath.enabled or arrays.bounces or arrays.pattern.tabulated:
        return "embree: left out, it traces only first echoes along straight rays of a level knife or fan"
    if arrays.solids.shape.size or arrays.mesh.skip.size:
        return "embree: left out with targets, it traces only the bed"
    columns, rows = (last - first for first, last in _nodes(arrays, poses))
    if 2 * columns * rows > MOST_TRIANGLES:
        return f"embree: left out, the bed beneath these pings has {2 * columns * rows:,} triangles"
    return ""


class TriangulatedBed:
    """Bed beneath some pings as triangles, two per cell.

    Parameters
    ----------
    arrays : SceneArrays
        Scene without targets and multipath, in water of constant sound speed.
    poses : Poses
        Poses of all pings that will be traced.

    Raises
    ------
    SceneError
        If it cannot be traced, see `explain_omission`.
    """

    def __init__(self, arrays: SceneArrays, poses: Poses) -> None:
        if reason := explain_omission(arrays, poses):
            raise SceneError(reason)
        from embreex.mesh_construction import TriangleMesh
        from embreex.rtcore_scene import EmbreeScene

        self._arrays = arrays
        bed, (columns, rows) = arrays.bed, (np.arange(*span) for span in _nodes(arrays, poses))
        ny, nx = bed.heights.shape
        heights = bed.heights[np.ix_(rows % ny, columns % nx)]
        # Single precision is fine near an origin amid the bed.
        self._origin = bed.x0 + bed.spacing * columns.mean(), bed.y0 + bed.spacing * rows.mean()
        x, y = np.meshgrid(
            bed.x0 + bed.spacing * columns - self._origin[0], bed.y0 + bed.spacing * rows - self._origin[1]
        )
        vertices = np.column_stack([x.ravel(), y.ravel(), np.nan_to_num(heights).ravel()]).astype(np.float32)
        numbers = np.arange(heights.size).reshape(heights.shape)
        here, right, above, across = numbers[:-1, :-1], numbers[:-1, 1:], numbers[1:, :-1], numbers[1:, 1:]
        solid = np.isfinite(heights)
        whole = solid[:-1, :-1] & solid[:-1, 1:] & solid[1:, :-1] & solid[1:, 1:]
        corners = np.stack([here, right, across, here, across, above], axis=-1)[whole].reshape(-1, 3)
        cells = bed.materials[np.ix_(rows[:-1] % ny, columns[:-1] % nx)]
        self._materials = np.repeat(cells[whole].astype(np.int64), 2)
        self._scene: Any = EmbreeScene()
        self._mesh = TriangleMesh(self._scene, vertices, corners.astype(np.int32))

    def trace(self, poses: Poses, *, rays: int) -> Record:
        """Trace pings ray by ray.

        Parameters
        ----------
        poses : Poses
            Where the sonar is, n pings.
        rays : int
            Rays per side and ping, aimed as `tracers.rays` aims them.

        Returns
        -------
        (n, 2, bins) float32
            Intensity of the two channels, port first.
        """
        arrays = self._arrays
        out = np.zeros((poses.x.size, 2, arrays.bins), dtype=np.float32)
        launch, bundle, sums = empty_launch(rays), empty_bundle(rays), np.empty(arrays.bins)
        aimed_at = math.nan
        for ping, z in enumerate(poses.z):
            if z != aimed_at:
                self._aim(launch, float(z))
                aimed_at = z
            for side in range(2):
                rotate_to_world(launch, _beam(arrays, poses, ping, side), bundle)
                self._sum(bundle, launch, sums)
                out[ping, side] = sums * arrays.range_factor
        return out

    def _aim(self, launch: RayLaunch, z: float) -> None:
        arrays, reach = self._arrays, self._arrays.bins * self._arrays.bin_length
        top = highest_elevation(arrays.bed.high - z, 0.0, reach)
        aim_rays(launch, z, top, reach, arrays.half_width, arrays.law, False)

    def _sum(self, bundle: RayBundle, launch: RayLaunch, sums: NDArray[np.float64]) -> None:
        """Cast a bundle of rays and sum its echoes."""
        arrays, hits = self._arrays, empty_hits(bundle.x.size)
        origins = np.column_stack([bundle.x - self._origin[0], bundle.y - self._origin[1], bundle.z])
        ways = np.column_stack([bundle.dx, bundle.dy, bundle.dz])
        found = self._scene.run(origins.astype(np.float32), ways.astype(np.float32), output=1)
        reach = arrays.bins * arrays.bin_length
        met = (found["primID"] >= 0) & (found["tfar"] < reach)
        hits.distance[:] = np.where(met, found["tfar"], math.inf)
        hits.body[:] = np.where(met, BED, NOTHING)
        hits.material[:] = self._materials[np.where(met, found["primID"], 0)]
        normal = found["Ng"].astype(np.float64)
        normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300) * np.sign(normal[:, 2:] + 1e-300)
        hits.nx[:], hits.ny[:], hits.nz[:] = normal.T
        fan = arrays.half_width > 0.0
        deposit_hits(bundle, hits, launch.weight, arrays.reflectivity, arrays.law, fan, arrays.bin_length, sums)


def _nodes(arrays: SceneArrays, poses: Poses) -> tuple[tuple[int, int], tuple[int, int]]:
    """Range of the nodes within reach of any ping, by columns and by rows; ends exclusive."""
    bed, reach = arrays.bed, arrays.bins * arrays.bin_length
    ny, nx = bed.heights.shape
    ahead = reach * math.sin(arrays.half_width)
    spans = []
    for places, low, count, c in ((poses.x, bed.x0, nx, np.cos), (poses.y, bed.y0, ny, np.sin)):
        side = np.sin if c is np.cos else np.cos
        wide = reach * np.abs(side(poses.heading)) + ahead * np.abs(c(poses.heading)) + 2.0 * bed.spacing
        first = math.floor((float((places - wide).min()) - low) / bed.spacing)
        last = math.ceil((float((places + wide).max()) - low) / bed.spacing) + 1
        spans.append((first, last) if bed.periodic else (max(first, 0), min(last, count)))
    return spans[0], spans[1]


def _beam(arrays: SceneArrays, poses: Poses, ping: int, side: int) -> SideBeam:
    """Beam of one side of one level ping."""
    ahead_x, ahead_y = math.cos(poses.heading[ping]), math.sin(poses.heading[ping])
    to_side = 1.0 if side == PORT else -1.0
    x, y, z = float(poses.x[ping]), float(poses.y[ping]), float(poses.z[ping])
    side_x, side_y, s = -to_side * ahead_y, to_side * ahead_x, math.sin(arrays.half_width)
    return SideBeam(
        x, y, z, ahead_x, ahead_y, side_x, side_y, ahead_x, ahead_y, 0.0, -s, s,
        side_x, side_y, 0.0, 0.0, 0.0, 1.0, arrays.bins * arrays.bin_length,
    )  # fmt: skip
