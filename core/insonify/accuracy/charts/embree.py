"""Embree over a scene of triangles, where it is installed: the same rays with another surface and engine."""

import math
from importlib.util import find_spec
from typing import Any

import numpy as np

from insonify.arrays import Floats, Integers, Singles
from insonify.kernels.common.types import BED, SPHERE, Bed, Poses, SceneArrays, Solids
from insonify.kernels.rays.cast import add_echoes, aim_straight, arrive_straight, echo_rays, unaimed
from insonify.kernels.rays.cell_walk import NO_HIT, Hits, RayBundle, empty_bundle, empty_hits
from insonify.kernels.rays.launch import orient_beam, rotate_to_world
from insonify.scene import SceneError

MOST_TRIANGLES = 8_000_000
# Chords of a circle of radius R then lie up to 3e-4 R beneath it, and their normals are up to 1.4 degrees off.
FACETS_AROUND = 128
# An icosahedron divided five times has edges of up to 2.3 degrees: 20,480 triangles, as fine as those chords.
DIVISIONS_OF_SPHERE = 5


def explain_omission(arrays: SceneArrays, poses: Poses) -> str:
    """Explain in one line why Embree does not trace a scene; empty if it does."""
    if find_spec("embreex") is None:
        return "embree: left out, embreex is not installed (pip install 'insonify[embree]')"
    if arrays.water.bent or arrays.multipath.enabled or arrays.bounces or arrays.pattern.tabulated:
        return "embree: left out, it traces only first echoes along straight rays of a level knife or fan"
    columns, rows = (last - first for first, last in _nodes(arrays, poses))
    if 2 * columns * rows > MOST_TRIANGLES:
        return f"embree: left out, the bed beneath these pings has {2 * columns * rows:,} triangles"
    return ""


class TriangulatedScene:
    """Bed beneath some pings and all targets as flat triangles: two per cell of the bed, bodies as tessellated."""

    def __init__(self, arrays: SceneArrays, poses: Poses) -> None:
        if reason := explain_omission(arrays, poses):
            raise SceneError(reason)
        from embreex.mesh_construction import TriangleMesh
        from embreex.rtcore_scene import EmbreeScene

        self._arrays = arrays
        spans = _nodes(arrays, poses)
        # Single precision is fine near an origin amid the bed.
        x, y = (arrays.bed.spacing * 0.5 * (first + last - 1) for first, last in spans)
        self._origin = np.array([arrays.bed.x0 + x, arrays.bed.y0 + y, 0.0])
        nodes, cells, cell_material = _bed_triangles(arrays.bed, *(np.arange(*span) for span in spans))
        solid, row = tessellate_solids(arrays.solids)
        meshed = arrays.solids.shape.size + np.arange(len(arrays.mesh.corners))
        self._body = np.concatenate([np.full(len(cells), BED), row, meshed])
        self._material = np.concatenate([cell_material, arrays.solids.material[row], arrays.mesh.material])
        corners = np.concatenate([solid, arrays.mesh.corners]).reshape(-1, 3)
        vertices = (np.concatenate([nodes, corners]) - self._origin).astype(np.float32)
        numbers = np.concatenate([cells, len(nodes) + np.arange(len(corners)).reshape(-1, 3)])
        self._scene: Any = EmbreeScene()
        self._triangles = TriangleMesh(self._scene, vertices, numbers.astype(np.int32))

    def cast(self, bundle: RayBundle) -> Hits:
        """Find the first triangle that each ray meets."""
        hits = empty_hits(bundle.x.size)
        origins = np.column_stack([bundle.x, bundle.y, bundle.z]) - self._origin
        ways = np.column_stack([bundle.dx, bundle.dy, bundle.dz])
        found = self._scene.run(origins.astype(np.float32), ways.astype(np.float32), output=1)
        met = (found["primID"] >= 0) & (found["tfar"] < self._arrays.bins * self._arrays.bin_length)
        triangle = np.where(met, found["primID"], 0)
        hits.distance[:] = np.where(met, found["tfar"], math.inf)
        hits.body[:] = np.where(met, self._body[triangle], NO_HIT)
        hits.material[:] = self._material[triangle]
        normal = found["Ng"].astype(np.float64)
        normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300)
        # Normals of the bed point up; those of a target point to the side of the ray.
        turned = np.where(hits.body == BED, normal[:, 2] < 0.0, np.einsum("ij,ij->i", normal, ways) > 0.0)
        hits.nx[:], hits.ny[:], hits.nz[:] = np.where(turned, -normal.T, normal.T)
        return hits

    def trace(self, poses: Poses, *, rays: int) -> Singles:
        """Trace pings ray by ray."""
        arrays = self._arrays
        out = np.zeros((poses.x.size, 2, arrays.bins), dtype=np.float32)
        aim, bundle, sums = unaimed(rays), empty_bundle(rays), np.empty(arrays.bins)
        near = np.empty(arrays.solids.shape.size, np.int64)
        for ping in range(poses.x.size):
            for side in range(2):
                beam = orient_beam(arrays, poses, ping, side)
                _, aim = aim_straight(arrays, beam, 0.0, near, aim)
                rotate_to_world(aim.launch, beam, bundle)
                sums[:] = 0.0
                landed = arrive_straight(bundle, self.cast(bundle), arrays.water.reference)
                add_echoes(arrays, echo_rays(arrays, landed, aim.launch.weight), sums)
                out[ping, side] = sums * arrays.range_factor
        return out


def _bed_triangles(bed: Bed, columns: Integers, rows: Integers) -> tuple[Floats, Integers, Integers]:
    """Nodes of a part of the bed, the corners by number of the triangles of its whole cells, and their materials."""
    ny, nx = bed.heights.shape
    heights = bed.heights[np.ix_(rows % ny, columns % nx)]
    x, y = np.meshgrid(bed.x0 + bed.spacing * columns, bed.y0 + bed.spacing * rows)
    numbers = np.arange(heights.size).reshape(heights.shape)
    here, right, above, across = numbers[:-1, :-1], numbers[:-1, 1:], numbers[1:, :-1], numbers[1:, 1:]
    solid = np.isfinite(heights)
    whole = solid[:-1, :-1] & solid[:-1, 1:] & solid[1:, :-1] & solid[1:, 1:]
    corners = np.stack([here, right, across, here, across, above], axis=-1)[whole].reshape(-1, 3)
    materials = bed.materials[np.ix_(rows[:-1] % ny, columns[:-1] % nx)][whole].astype(np.int64)
    nodes = np.column_stack([x.ravel(), y.ravel(), np.nan_to_num(heights).ravel()]).astype(np.float64)
    return nodes, corners, np.repeat(materials, 2)


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


def tessellate_solids(solids: Solids) -> tuple[Floats, Integers]:
    """Triangles inscribed in spheres, cylinders and cones, (m, 3, 3), and the solid of each."""
    import trimesh.creation  # slow to import, and needed only with Embree

    ball = trimesh.creation.icosphere(subdivisions=DIVISIONS_OF_SPHERE).triangles
    parts = [np.empty((0, 3, 3))]
    for k, start in enumerate(solids.start):
        radius, length = float(solids.radius[k]), float(solids.length[k])
        if solids.shape[k] == SPHERE:
            parts.append(start + radius * ball)
            continue
        outline = np.array([[0.0, 0.0], [radius, 0.0], [radius + solids.taper[k] * length, length], [0.0, length]])
        turn = trimesh.geometry.align_vectors([0.0, 0.0, 1.0], solids.axis[k])[:3, :3]  # type: ignore[no-untyped-call]
        parts.append(start + trimesh.creation.revolve(outline, sections=FACETS_AROUND).triangles @ turn.T)
    return np.concatenate(parts), np.repeat(np.arange(-1, len(parts) - 1), [len(part) for part in parts])
