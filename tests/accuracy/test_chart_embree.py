"""Embree over a scene of triangles, beside exact rays over the bilinear bed and the bodies themselves."""

import math

import numpy as np
import pytest

from beds import BOX_FACES, NO_MESH, arrays_of, box_corners, mesh_of, poses_of, rough_arrays, solids_of
from insonify.accuracy.charts.embree import TriangulatedScene, explain_omission
from insonify.kernels.rays.cell_walk import RayBundle, empty_hits, find_first_hits
from insonify.scene import SceneError
from insonify.statistics.record_errors import compare_records
from insonify.tracers import rays

pytest.importorskip("embreex")
POSES = poses_of([0.0, 3.7], 1.3, 8.0, [0.3, 1.9])
FAN = math.radians(1.0)


@pytest.mark.parametrize("half_width", [0.0, FAN])
def test_over_a_level_bed_every_ray_returns_the_same(half_width):
    # Triangles and bilinear cells are then one surface: only single precision is left.
    arrays = arrays_of(np.zeros((64, 64)), 1.0, periodic=True, half_width=half_width, bins=300, bin_length=0.1)
    record, right = TriangulatedScene(arrays, POSES).trace(POSES, rays=3000), rays.trace(arrays, POSES, rays=3000)
    assert compare_records(arrays, POSES, record, right).beyond < 0.01
    assert abs(compare_records(arrays, POSES, record, right).energy_bias) < 1e-5


def test_over_a_rough_bed_the_surface_differs_as_its_cells_are_cut():
    arrays = rough_arrays(FAN)
    bed = TriangulatedScene(arrays, POSES)
    own, many = bed.trace(POSES, rays=1 << 17), rays.trace(arrays, POSES, rays=1 << 17)
    surface = compare_records(arrays, POSES, own, many).beyond
    sampling = compare_records(arrays, POSES, bed.trace(POSES, rays=4000), own).beyond
    single = compare_records(arrays, POSES, rays.trace(arrays, POSES, rays=4000), many).beyond
    assert 0.005 < surface < 0.2
    assert sampling == pytest.approx(single, rel=0.5)


def test_a_bed_with_an_edge_and_a_hole_is_silent_there():
    arrays = rough_arrays(FAN, periodic=False)
    heights = arrays.bed.heights.copy()
    heights[60:80, 20:60] = np.nan
    arrays = arrays._replace(bed=arrays.bed._replace(heights=heights))
    poses = poses_of(4.0, 4.0, 6.0)
    record, right = TriangulatedScene(arrays, poses).trace(poses, rays=20_000), rays.trace(arrays, poses, rays=20_000)
    heard, dark = right > 0.0, (right == 0.0) & (record > 0.0)
    assert heard.any()
    assert dark.sum() < 0.03 * heard.sum()


def hits_about(target, wide, arrays, count=20_000):
    """First hits of rays from the first pose to places about a target, by Embree and by the exact walk."""
    origin = np.array([POSES.x[0], POSES.y[0], POSES.z[0]])
    ways = np.asarray(target) + np.random.default_rng(3).uniform(-wide, wide, (count, 3)) - origin
    ways /= np.linalg.norm(ways, axis=1, keepdims=True)
    bundle = RayBundle(*(np.full(count, value) for value in origin), *np.ascontiguousarray(ways.T))
    exact, bodies, reach = empty_hits(count), np.arange(arrays.solids.shape.size), arrays.bins * arrays.bin_length
    find_first_hits(arrays.bed, arrays.solids, bodies, bodies.size, arrays.mesh, bundle, reach, exact)
    return TriangulatedScene(arrays, POSES).cast(bundle), exact


BOX = (-1.0, 8.0, 0.0), (1.0, 9.5, 1.2)
BOX_ASIDE = (2.0, 8.0, 0.0), (4.0, 9.5, 1.2)
FACES = BOX_FACES[:10]  # the box stands on the bed
TARGETS = {
    "sphere": ({"solids": [((0.3, 9.0, 0.8), 0.7)]}, 2.0),
    "pipe": ({"solids": [((-3.0, 8.0, 0.5), (4.0, 10.0, 0.9), 0.4), ((4.0, 10.0, 0.9), 0.4)]}, 2.0),
    "cone": ({"solids": [((0.0, 9.0, 0.0), (0.0, 9.0, 1.8), 1.0, 0.0)]}, 2.0),
    "box": ({"mesh": mesh_of(box_corners(*BOX), FACES)}, 0.0),
}


@pytest.mark.parametrize(("name", "degrees"), [(name, degrees) for name, (_, degrees) in TARGETS.items()])
def test_a_target_is_hit_where_the_exact_walk_hits_it(name, degrees):
    # Chords lie up to 3e-4 of the radius beneath the surface: nearly edge-on a ray that the body stops may pass it.
    found, right = hits_about((0.5, 9.0, 0.6), 1.5, rough_arrays(FAN, **TARGETS[name][0]))
    target = right.body >= 0
    assert target.mean() > 0.03
    assert np.mean((found.body >= 0) != target) < 1e-3
    both = target & (found.body >= 0)
    cosine = np.einsum("ij,ij->j", *(np.stack([hits.nx, hits.ny, hits.nz])[:, both] for hits in (found, right)))
    assert np.quantile(cosine, 0.01) > math.cos(math.radians(max(degrees, 0.1)))
    assert np.quantile(np.abs(found.distance - right.distance)[both], 0.99) < 5e-3
    assert np.median(np.abs(found.distance - right.distance)[both]) < (3e-4 if degrees else 2e-6)


def test_every_triangle_has_the_body_and_the_material_of_what_it_is_cut_from():
    arrays = rough_arrays(FAN, solids=TARGETS["sphere"][0]["solids"], mesh=mesh_of(box_corners(*BOX_ASIDE), FACES))
    arrays = arrays._replace(
        solids=arrays.solids._replace(material=np.array([1])),
        mesh=arrays.mesh._replace(material=np.full(len(FACES), 2)),
    )
    found, right = hits_about((1.5, 9.0, 0.6), 3.0, arrays)
    assert set(found.material) == {0, 1, 2}
    assert np.mean(found.material != right.material) < 1e-3
    assert np.mean(found.body != right.body) < 2e-3  # on the edge of two triangles either is right


def test_a_record_with_targets_is_that_of_exact_rays_but_for_the_surface():
    level = arrays_of(
        np.zeros((64, 64)), 1.0, periodic=True, half_width=FAN, bins=300, bin_length=0.1,
        solids=TARGETS["sphere"][0]["solids"], mesh=mesh_of(box_corners(*BOX_ASIDE), FACES),
    )  # fmt: skip
    poses = poses_of([0.3, 3.0], 0.0, 8.0, [0.0, 0.2])
    record, right = TriangulatedScene(level, poses).trace(poses, rays=1 << 17), rays.trace(level, poses, rays=1 << 17)
    bare = rays.trace(level._replace(solids=solids_of(), mesh=NO_MESH), poses, rays=1 << 17)
    assert compare_records(level, poses, record, right).beyond < 0.01
    assert compare_records(level, poses, bare, right).beyond > 0.1  # the targets do matter


def test_what_it_is_not_asked_for_is_said():
    bounces = rough_arrays(FAN)._replace(bounces=1)
    assert "straight" in explain_omission(bounces, POSES)
    with pytest.raises(SceneError, match="straight"):
        TriangulatedScene(bounces, POSES)
