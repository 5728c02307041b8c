"""Bodies in closed form: where rays meet them, with which normals, and many rays at once as one by one."""

import math

import numpy as np
import pytest

import brute_force
import naive
from beds import arrays_of, poses_of, solids_of
from insonify.compiler.jit import kernel
from insonify.kernels.common.types import FRUSTUM, LIGHT, SONAR, SPHERE
from insonify.kernels.geometry.solids import (
    distance_to_solid,
    exit_solid,
    find_enclosing_solid,
    intersect_solid,
    reach_of_solid,
)
from insonify.kernels.targets.angular_zbuffer import meet_body
from insonify.kernels.targets.apparent_targets import ApparentSource
from insonify.kernels.targets.primitives import Primitive, meet_primitive
from insonify.tracers import march, rays

FLAT = np.zeros((8, 8))
TIP = ((0.0, 0.0, 0.0), (0.0, 0.0, 4.0), 2.0, 0.0)  # a cone that stands on its base
PLUG = ((3.0, -2.0, 5.0), (5.0, 1.0, 6.5), 0.4, 1.7)


@kernel
def meet_all(solids, k, origins, directions, leaving, out):
    for n in range(origins.shape[0]):
        x, y, z = origins[n]
        dx, dy, dz = directions[n]
        if leaving:
            out[n] = exit_solid(solids, k, x, y, z, dx, dy, dz)
        else:
            out[n] = intersect_solid(solids, k, x, y, z, dx, dy, dz)


def meet(body, origins, directions, *, leaving=False):
    starts, ways = np.broadcast_arrays(np.atleast_2d(origins).astype(float), np.atleast_2d(directions).astype(float))
    ways = ways / np.linalg.norm(ways, axis=1, keepdims=True)
    out = np.empty((len(ways), 4))
    meet_all(solids_of([body]), 0, np.ascontiguousarray(starts), ways, leaving, out)
    return out[:, 0], out[:, 1:]


def aimed(rng, centre, size, count, distance):
    """Rays from all sides at a ball around a body."""
    origins = rng.normal(size=(count, 3))
    origins *= distance / np.linalg.norm(origins, axis=1, keepdims=True)
    goals = centre + rng.uniform(-size, size, (count, 3))
    return centre + origins, goals - centre - origins


def test_a_cone_where_arithmetic_is_easy_along_its_side_and_far_away_in_a_map_grid():
    slope = np.array([2.0, 0.0, 1.0]) / math.sqrt(5.0)  # a side that falls 4 m over 2 m
    origins = [(9, 0, 2), (0, 0, 9), (0, 0, -3), (9, 0, 5), (-9, 0, 0.5), (0.5, 0, 9)]
    directions = [(-1, 0, 0), (0, 0, -1), (0, 0, 1), (-1, 0, 0), (1, 0, 0), (0, 0, -1)]
    distance, normal = meet(TIP, origins, directions)
    np.testing.assert_allclose(distance, [8.0, 5.0, 3.0, math.inf, 7.25, 6.0], atol=1e-12)
    expected = [slope, (0, 0, 1), (0, 0, -1), slope * (-1, 1, 1), slope]
    np.testing.assert_allclose(normal[[0, 1, 2, 4, 5]], expected, atol=1e-12)
    inside = [(0, 0, 1), (1.4, 0, 1), (0, 0.05, 3.8)]
    outside = [(1.6, 0, 1), (0, 0.2, 3.8), (0, 0, 4.1), (0, 0, -0.1)]
    found = [find_enclosing_solid(solids_of([TIP]), *np.array([point], float).T) for point in inside + outside]
    assert found == [0] * 3 + [-1] * 4
    # Along a line of the side itself, a little off to either hand; then from below, steeper than the side.
    along = np.array([-1.0, 0.0, 2.0])
    origins = [(3.1, 0, -2.0), (2.9, 0, -2.0), (0.5, 0, -1.0), (0.5, 0, 9.0)]
    distance, normal = meet(TIP, origins, [along, along, (0, 0, 1), (0.1, 0, -1)])
    assert math.isinf(distance[0])
    assert distance[1] == pytest.approx(math.sqrt(5.0), abs=1e-12)
    np.testing.assert_allclose(normal[1], (0, 0, -1), atol=1e-12)
    assert distance[2] == pytest.approx(1.0, abs=1e-12)
    # 0.5 + 0.1 t = (4 − 9 + t) ... at the side the radius is (4 − z) / 2.
    t = (0.5 + 0.5 * 5.0) / 0.4
    assert distance[3] == pytest.approx(t * math.sqrt(1.01), abs=1e-12)
    body = ((500_000.0, 5_800_000.0, 3.0), (500_004.0, 5_800_000.0, 3.0), 0.5, 1.5)
    origin = np.array([500_002.0, 5_800_000.0 - 10_000.0, 3.0])
    distance, normal = meet(body, origin, (0, 1, 0))
    # The section at x = 2 is a hyperbola's vertex: |y| = 1 at the axis' height.
    assert distance[0] == pytest.approx(10_000.0 - 1.0, abs=1e-8)
    np.testing.assert_allclose(normal[0], np.array([-0.25, -1.0, 0.0]) / math.sqrt(1.0625), atol=1e-8)


@pytest.mark.parametrize(
    "body",
    [((0.0, 0.0, 0.0), (6.0, 0.0, 0.0), 0.5), PLUG, (PLUG[1], PLUG[0], 1.7, 0.4), TIP, ((1.0, 2.0, 3.0), 1.5)],
)
def test_rays_go_in_where_brute_force_has_it_and_come_out(body):
    rng = np.random.default_rng(2)
    centre = np.array(body[0]) if len(body) == 2 else 0.5 * np.add(body[0], body[1])
    origins, directions = aimed(rng, centre, 2.5, 4000, 12.0)
    near, normal_in = meet(body, origins, directions)
    ways = directions / np.linalg.norm(directions, axis=1, keepdims=True)
    meet_body = brute_force.solid(solids_of([body]), 0)
    twin = [meet_body(origin, way[None]) for origin, way in zip(origins, ways)]
    np.testing.assert_allclose(near, [t[0][0] for t in twin], rtol=1e-11)
    hit = np.isfinite(near)
    assert 0.1 < hit.mean() < 0.9
    np.testing.assert_allclose(-(normal_in * ways).sum(1)[hit], np.array([t[1][0] for t in twin])[hit], atol=1e-7)
    np.testing.assert_allclose(np.linalg.norm(normal_in[hit], axis=1), 1.0, atol=1e-14)
    # Seen from behind, a ray leaves where it would enter, and no ray that enters stays inside.
    far, normal_out = meet(body, origins, ways, leaving=True)
    np.testing.assert_array_equal(hit, np.isfinite(far))
    assert (far[hit] > near[hit]).all()
    back, normal_back = meet(body, origins + 40.0 * ways, -ways)
    np.testing.assert_allclose(40.0 - back[hit], far[hit], atol=1e-9)
    np.testing.assert_allclose(normal_back[hit], normal_out[hit], atol=1e-6)
    assert ((normal_in * ways).sum(1)[hit] < 0.0).all()
    assert ((normal_out * ways).sum(1)[hit] > 0.0).all()


def test_no_ray_slips_in_at_a_rim():
    # Aimed exactly at both rims of a frustum, from all around: each enters the disc or the side or passes outside.
    rng = np.random.default_rng(4)
    body = ((0.0, 0.0, 0.0), (0.0, 0.0, 1.0), 2.0, 1.0)
    angle = rng.uniform(0.0, 2.0 * math.pi, 20_000)
    rim = np.column_stack([np.cos(angle), np.sin(angle), np.ones_like(angle)])
    # Towards a point well inside, through the rim: met either way, at the rim.
    inner = rng.uniform((-0.5, -0.5, 0.2), (0.5, 0.5, 0.8), (20_000, 3))
    way = (inner - rim) / np.linalg.norm(inner - rim, axis=1, keepdims=True)
    distance, _ = meet(body, rim - 7.0 * way, way)
    np.testing.assert_allclose(distance, 7.0, atol=1e-6)


def test_a_cylinder_is_a_frustum_without_taper():
    rng = np.random.default_rng(5)
    origins, directions = aimed(rng, np.array([2.0, 0.0, 0.0]), 1.0, 4000, 30.0)
    ends = (0.0, 0.0, 0.0), (4.0, 0.5, 0.3)
    one, normal = meet((*ends, 0.5), origins, directions)
    other, other_normal = meet((*ends, 0.5, 0.5 + 1e-13), origins, directions)
    assert (np.isfinite(one) == np.isfinite(other)).mean() > 0.999
    both = np.isfinite(one) & np.isfinite(other)
    np.testing.assert_allclose(one[both], other[both], atol=1e-6)
    np.testing.assert_allclose(normal[both], other_normal[both], atol=1e-5)


@pytest.mark.parametrize("law", [LIGHT, SONAR])
def test_a_record_of_a_cone_agrees_with_brute_force(law):
    cone = ((1.0, 14.0, 0.0), (1.0, 15.0, 3.0), 1.2, 0.1)
    arrays = arrays_of(FLAT, 4.0, periodic=True, solids=[cone], law=law, bins=250, bin_length=0.1)
    record = rays.trace(arrays, poses_of(0.9, 0.0, 7.0), rays=1 << 17)[0]
    twin = naive.naive_ping(arrays, 0.9, 0.0, 7.0, 0.0, samples_per_cell=4000)
    assert np.linalg.norm(record - twin) < 0.01 * np.linalg.norm(twin)
    marched = march.trace(arrays, poses_of(0.9, 0.0, 7.0), step=0.002, rays=1 << 12)[0]
    coarse = rays.trace(arrays, poses_of(0.9, 0.0, 7.0), rays=1 << 12)[0]
    assert np.linalg.norm(marched - coarse) < 0.05 * np.linalg.norm(coarse)


@kernel
def measure_distances(solids, points, out):
    """Distances from each point to the nearest place of the first body, and to a bound on the farthest."""
    for n in range(points.shape[0]):
        x, y, z = points[n]
        out[n] = distance_to_solid(solids, 0, x, y, z), reach_of_solid(solids, 0, x, y, z)


@pytest.mark.parametrize("body", [(PLUG[0], 0.7), ((0.0, 0.0, 0.0), (6.0, 0.0, 0.0), 0.5), PLUG, TIP])
def test_the_nearest_place_of_a_body_and_a_bound_on_its_farthest(body):
    rng, solids = np.random.default_rng(5), solids_of([body])
    centre = solids.start[0] + 0.5 * solids.length[0] * solids.axis[0]
    inside = centre + rng.uniform(-4.0, 4.0, (200_000, 3))
    inside = inside[naive.body_depth(solids, 0, inside) < 0.0]
    points = np.concatenate([centre + rng.normal(size=(40, 3)) * 6.0, inside[:40]])
    outside = naive.body_depth(solids, 0, points) > 0.0
    assert [find_enclosing_solid(solids, *point[:, None]) < 0 for point in points] == outside.tolist()
    points = points[outside]
    found = np.empty((len(points), 2))
    measure_distances(solids, points, found)
    sampled = np.linalg.norm(points[:, None] - inside[None], axis=2)
    assert np.all(found[:, 0] <= sampled.min(axis=1) + 1e-12)
    np.testing.assert_allclose(found[:, 0], sampled.min(axis=1), atol=0.25)
    assert np.all((found[:, 1] >= sampled.max(axis=1)) & (found[:, 1] < sampled.max(axis=1) + 3.0))


STRAIGHT = ApparentSource(False, 1.0, 0.0, 1.0, 0.0, 1.0, 0.0, 1.0, 1.0, 1.0, 0.0, 0.0)
RAYS = 257


@kernel
def meet_together(body, cosine, sine, distance, incidence, lean):
    distance[:], incidence[:] = cosine, sine
    meet_body(body, cosine.size, True, distance, incidence, lean)


@kernel
def meet_each(body, cosine, sine, distance, incidence, lean):
    for i in range(cosine.size):
        distance[i], incidence[i], lean[i] = meet_primitive(body, cosine[i], sine[i])


def body_of(kind, start, axis, length, radius, taper, azimuth, source=STRAIGHT):
    axis = np.asarray(axis, float) / np.linalg.norm(axis)
    level = math.cos(azimuth), math.sin(azimuth)
    return Primitive(kind, *map(float, start), *map(float, axis), length, radius, taper, *level, source)


def compare(body, angles):
    """Number of rays that meet the body, all of them alike."""
    ways, results = (np.cos(angles), np.sin(angles)), np.full((2, 3, angles.size), np.nan)
    for meet_rays, result in zip((meet_together, meet_each), results):
        meet_rays(body, *ways, *result)
    (distance, incidence, lean), (right, cosine, leaning) = results
    met = np.isfinite(right)
    np.testing.assert_array_equal(np.isfinite(distance), met)
    scale = float(np.hypot(body.x, np.hypot(body.y, body.z)))
    np.testing.assert_allclose(distance[met], right[met], rtol=0.0, atol=1e-9 * scale)
    # Near a body's edge the incidence changes as the root of the angle.
    np.testing.assert_allclose(incidence[met], cosine[met], rtol=0.0, atol=1e-6)
    np.testing.assert_allclose(lean[met], leaning[met], rtol=0.0, atol=1e-6)
    return int(met.sum())


def angles_at(rng, body):
    """Angles at a body from a little below it to a little above."""
    towards = math.atan2(body.z + 0.5 * body.length * body.az, math.hypot(body.x, body.y))
    wide = 1.2 * math.atan2(body.radius + body.length, math.hypot(body.x, body.y, body.z))
    return np.sort(np.clip(towards + rng.uniform(-wide, wide, RAYS), -1.57, 1.57))


@pytest.mark.parametrize("seed", range(40))
def test_random_bodies_are_met_as_one_by_one(seed):
    rng = np.random.default_rng(seed)
    found = 0
    for _ in range(60):
        away, azimuth = 10.0 ** rng.uniform(0.3, 3.0), rng.uniform(0.0, 2.0 * math.pi)
        start = away * math.cos(azimuth), away * math.sin(azimuth), rng.uniform(-away, 5.0)
        radius, length = away * 10.0 ** rng.uniform(-4.0, -0.7), away * 10.0 ** rng.uniform(-3.0, 0.0)
        taper = rng.choice([0.0, -radius / length, rng.uniform(-radius / length, 3.0)])
        kind = SPHERE if rng.random() < 0.25 else FRUSTUM
        aside = rng.uniform(-0.3, 0.3) * radius / away
        body = body_of(kind, start, rng.normal(size=3), length, radius, taper, azimuth + aside)
        found += compare(body, angles_at(rng, body))
    assert found > 60 * RAYS // 10


@pytest.mark.parametrize(
    ("axis", "taper"),
    [((1, 0, 0), 0.0), ((0, 1, 0), 0.0), ((0, 0, 1), 0.0), ((0, 0, 1), -0.25), ((1, 0, 0), -0.25), ((-1, 0, 0), 0.5)],
)
@pytest.mark.parametrize("start", [(20.0, 0.0, -8.0), (20.0, 0.0, 0.0), (18.0, -0.5, -8.0)])
def test_bodies_along_the_grid_are_met_as_one_by_one(axis, taper, start):
    # An end may lie in the plane, a ray along the axis or level with an end.
    body = body_of(FRUSTUM, start, axis, 4.0, 1.0, taper, 0.0)
    angles = np.concatenate([np.linspace(-1.5, 1.5, 3001), [0.0, math.atan2(-8.0, 20.0)]])
    assert compare(body, np.sort(angles)) > 0


def test_bodies_are_met_from_their_apparent_source():
    source = ApparentSource(
        True, 0.9, -math.sqrt(0.19), 0.85, -math.sqrt(1 - 0.85**2), 1.1, 0.4, 1.02, 1.0, 1.0, 0.1, 0.2
    )
    body = body_of(FRUSTUM, (20.0, 0.1, -12.0), (1.0, 0.2, 0.1), 4.0, 1.0, 0.0, 0.0, source)
    assert compare(body, np.linspace(-1.5, 1.5, 3001)) > 0
