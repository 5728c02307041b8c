"""The ray tracer: closed forms first, then slow twins, then invariants; and the march beside it."""

import math
import sys

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import naive
from beds import arrays_of, poses_of, rough
from commands import run_python
from exact_rays import order
from insonify import parallel
from insonify.acoustics.flat_bed import flat_bed_curve
from insonify.kernels.common.types import BED, LIGHT, SONAR
from insonify.kernels.rays.cell_walk import empty_hits
from insonify.kernels.rays.march import march_hits
from insonify.scene.seabed.materials.catalogue import Reflectivity
from insonify.statistics.record_errors import compare_records
from insonify.tracers import march, rays, sweep

NOTHING = -2
FLAT = np.zeros((8, 8))
MATERIAL = Reflectivity(0.6, 0.3, 5.0)
GLOSSY = (0.6, 0.3, 6.0)


def flat(**options):
    return arrays_of(FLAT, 4.0, periodic=True, **options)


@pytest.mark.parametrize("law", [LIGHT, SONAR])
@pytest.mark.parametrize("half_width", [0.0, math.radians(1.25), math.radians(15.0)])
def test_flat_bed_is_its_closed_form(law, half_width):
    arrays = flat(law=law, half_width=half_width, reflectivity=[MATERIAL])
    port, starboard = rays.trace(arrays, poses_of(3.0, 5.0, 10.0, 0.7), rays=8000)[0]
    curve = flat_bed_curve(arrays, 10.0, MATERIAL)
    # The curve takes a bin's middle for all of it, which nadir's first metre outruns.
    np.testing.assert_allclose(port[220:], curve[220:], rtol=2e-4)
    np.testing.assert_allclose(port[201:220], curve[201:220], rtol=2e-2)
    np.testing.assert_allclose(starboard, port, rtol=1e-5, atol=1e-9)
    assert not port[:200].any()


def test_fan_adds_up_to_the_beam():
    # Everything inside r on a level bed: a strip of constant sin φ_b about the track, capped by the disc.
    half_width, altitude, reach = math.radians(20.0), 10.0, 50.0
    arrays = flat(half_width=half_width, reflectivity=[(math.pi, 0.0, 1.0)])
    record = rays.trace(arrays, poses_of(0.0, 0.0, altitude), rays=1 << 16)[0, 0]
    r = np.linspace(altitude, reach, 2_000_001)
    r = 0.5 * (r[1:] + r[:-1])
    widest = np.arcsin(np.minimum(math.sin(half_width) / np.sqrt(1.0 - (altitude / r) ** 2), 1.0))
    # dA = r dr dφ, σ = cos²α.
    truth = np.sum(2.0 * widest * r * (altitude / r) ** 2) * (reach - altitude) / r.size
    assert record.sum() == pytest.approx(truth, rel=2e-4)


def test_vertical_ray_and_rays_along_grid_lines():
    heights = rough(32, 32, 0.4, seed=3)
    arrays = arrays_of(heights, 0.5, periodic=True)
    z = arrays.bed.heights.astype(float)
    # Exactly over a knot, over a line, in a cell; then along x = node, along y = node, through knots diagonally.
    origins = [(4.0, 6.0, 9.0), (4.0, 6.2, 9.0), (4.1, 6.3, 9.0), (4.0, 6.0, 3.0), (4.0, 6.0, 3.0), (4.0, 6.0, 3.0)]
    directions = [(0, 0, -1), (0, 0, -1), (0, 0, -1), (0.0, 1.0, -0.3), (-1.0, 0.0, -0.3), (1.0, -1.0, -0.3)]
    distance, what, _ = rays.cast(arrays, origins, directions)
    assert (what == BED).all()
    assert distance[0] == pytest.approx(9.0 - z[12, 8], abs=1e-12)
    for k in range(6):
        unit = np.array(directions[k]) / np.linalg.norm(directions[k])
        x, y, height = np.array(origins[k]) + distance[k] * unit
        assert naive.height(arrays.bed, x, y) == pytest.approx(height, abs=1e-9)
        assert distance[k] == pytest.approx(naive.cast(arrays, origins[k], directions[k], 0.003)[0], abs=1e-8)


STEP = np.zeros((40, 40))
STEP[20:, :] = 5.0
CLIFF = np.zeros((3, 202))
CLIFF[:, 130:] = 8.0
HOLE = np.zeros((21, 21))
HOLE[10, 10] = np.nan
# Scene, origins, directions; targets, and some of the distances and normals.
CASTS = {
    "upward and level over a step": (
        arrays_of(STEP, 1.0),
        (20.0, 10.0, 2.0),
        [(0, 0, 1), (0, 1, 0), (0, 1, 0.2), (0, 1, 0.5), (0, -1, 0), (0, 0, -1)],
        [NOTHING, BED, BED, NOTHING, NOTHING, BED],
        {0: math.inf, 1: 9.4, 2: 47.0 / 4.8 * math.hypot(1, 0.2)},
        {0: (0, 0, 0), 1: np.array([0, -5, 1]) / math.sqrt(26.0)},
    ),
    "cliff from x = 12.9 to 13.0": (
        arrays_of(CLIFF, 0.1, y0=-0.1, bins=400),
        (5.0, 0.0, 4.0),
        [(1.0, 0.0, 0.0), (1.0, 0.0, 0.4)],
        [BED, BED],
        {0: 7.95, 1: 636.0 / 79.6 * math.hypot(1.0, 0.4)},
        {0: np.array([-80.0, 0.0, 1.0]) / math.hypot(1.0, 80.0)},
    ),
    "down on a bed with a missing node": (
        arrays_of(HOLE, 1.0),
        [(x, y, 5.0) for x, y in ((10.5, 10.5), (9.5, 9.5), (8.5, 10.5), (25.0, 3.0), (11.5, 10.0))],
        (0, 0, -1),
        [NOTHING, NOTHING, BED, NOTHING, BED],
        {2: 5.0, 4: 5.0},
        {2: (0, 0, 1), 4: (0, 0, 1)},
    ),
    "through the hole, and into its far side from below": (
        arrays_of(HOLE, 1.0),
        (9.2, 10.2, 0.05),
        [(1, 0, -0.1), (1, 0, -0.01)],
        [NOTHING, BED],
        {1: 5.0 * math.hypot(1.0, 0.01)},
        {1: (0, 0, 1)},
    ),
    "nearest of several bodies": (
        flat(solids=[((0, 9, 2), 1.0), ((0, 6, 2), 1.0), ((-1, 12, 2), (1, 12, 2), 1.0)]),
        (0, 0, 2),
        [(0, 1, 0), (1, 0, 0), (0, 1, 0.3)],
        [1, NOTHING, NOTHING],
        {0: 5.0},
        {0: (0, -1, 0)},
    ),
    "cylinder from all sides": (
        flat(solids=[((2.0, 0.0, 5.0), (6.0, 0.0, 5.0), 0.5)]),
        [(0, 0, 5), (9, 0.3, 5), (4, 3, 5), (4, 0, 9), (0, 0, 5), (1.0, 0.0, 6.0)],
        [(1, 0, 0), (-1, 0, 0), (0, -1, 0), (0, 0, -1), (1, 0, 0.3), (1, 0, -0.6)],
        [0, 0, 0, 0, NOTHING, 0],
        {0: 2.0, 1: 3.0, 2: 2.5, 3: 3.5},
        {0: (-1, 0, 0), 1: (1, 0, 0), 2: (0, 1, 0), 3: (0, 0, 1), 5: (-1, 0, 0)},
    ),
}


@pytest.mark.parametrize("case", CASTS)
def test_rays_meet_what_is_nearest(case):
    arrays, origins, directions, targets, distances, normals = CASTS[case]
    distance, what, normal = rays.cast(arrays, origins, directions)
    assert what.tolist() == targets
    np.testing.assert_allclose(distance[[*distances]], [*distances.values()], rtol=1e-9)
    np.testing.assert_allclose(normal[[*normals]], [*normals.values()], atol=1e-12)


RISING = np.zeros((3, 400))
RISING[:, 200:] = np.linspace(0.0, 30.0, 200)
VALLEY = np.tile(np.abs(np.arange(61) - 30.0)[:, None] - 20.0, (1, 5))  # 20 m deep, and the sonar below the datum
BODIES = [((3.0, 12.0, 0.6), 0.5), ((0.0, -20.0, 0.5), (8.0, -22.0, 0.6), 0.4)]
WITH_BODIES = {"periodic": True, "bins": 250, "bin_length": 0.1, "solids": BODIES, "reflectivity": [GLOSSY]}
# Scene, pose, and samples of each cell by which brute force is that fine.
BRUTE = {
    "bed above the fish": (arrays_of(RISING, 0.1, y0=-0.1, bins=600), (10.0, 0.0, 5.0, -math.pi / 2), 200),
    "ball above the fish": (flat(solids=[((0.0, 15.0, 14.0), 1.0)], bins=300, bin_length=0.1), (0, 0, 10.0, 0), 4000),
    "fish in a valley": (arrays_of(VALLEY, 1.0, bins=500, bin_length=0.1), (2.0, 30.3, -12.0, 0.0), 1000),
    "bodies on a rough bed": (arrays_of(rough(64, 64, 0.15), 0.5, **WITH_BODIES), (3.05, 2.2, 6.0, 0.1), 200),
}


@pytest.mark.parametrize("law", [LIGHT, SONAR])
@pytest.mark.parametrize("case", BRUTE)
def test_knife_agrees_with_brute_force(case, law):
    arrays, pose, samples = BRUTE[case]
    arrays = arrays._replace(law=law)
    twin = naive.naive_ping(arrays, *pose, samples_per_cell=samples)
    records = [(rays.trace(arrays, poses_of(*pose), rays=1 << 18)[0], 2)]
    if case == "bed above the fish":
        records.append((sweep.trace(arrays, poses_of(*pose))[0], 0))
    for record, apart in records:
        for one, other in zip(record, twin):
            assert other.any()
            assert np.linalg.norm(one - other) < 0.01 * np.linalg.norm(other)
            assert one.sum() == pytest.approx(other.sum(), rel=5e-3)
            assert np.flatnonzero(one)[-1] == pytest.approx(np.flatnonzero(other)[-1], abs=apart)


def test_leaving_ray_does_not_hit_where_it_starts():
    arrays = arrays_of(rough(32, 32, 0.3, seed=5), 0.5, periodic=True)
    rng = np.random.default_rng(0)
    down = np.column_stack([rng.uniform(0, 16, 500), rng.uniform(0, 16, 500), np.full(500, 900.0)])
    distance, _, normal = rays.cast(arrays, down, (0, 0, -1), reach=2000.0)
    on_bed = down + distance[:, None] * [0, 0, -1]
    again, what, _ = rays.cast(arrays, on_bed, normal)
    assert (again[what == BED] > 0.05).all()
    assert (what == NOTHING).mean() > 0.95


@given(
    seed=st.integers(0, 10_000),
    periodic=st.booleans(),
    bodies=st.booleans(),
    azimuth=st.floats(0.0, 6.3) | st.sampled_from([0.0, math.pi / 2, math.pi, math.pi / 4]),
    elevation=st.floats(-1.5, 0.2),
)
@settings(max_examples=60, deadline=None, derandomize=True)
def test_cast_agrees_with_tiny_steps(seed, periodic, bodies, azimuth, elevation):
    rng = np.random.default_rng(seed)
    heights = rng.normal(0.0, 0.5, (9, 11))
    if not periodic:
        heights[rng.integers(0, 9), rng.integers(0, 11)] = np.nan
    solids = [((3.0, 3.0, 1.0), 0.8), ((1.0, 5.0, 1.5), (7.0, 4.0, 2.0), 0.6)] if bodies else []
    arrays = arrays_of(heights, 1.0, periodic=periodic, solids=solids, bins=200, bin_length=0.1)
    origin = (rng.uniform(1, 9), rng.uniform(1, 7), 4.0)
    direction = (
        math.cos(azimuth) * math.cos(elevation), math.sin(azimuth) * math.cos(elevation), math.sin(elevation),
    )  # fmt: skip
    distance, what, _ = rays.cast(arrays, origin, direction)
    expected, target = naive.cast(arrays, origin, direction, 0.002)
    if math.isfinite(expected):
        x, y, _ = np.array(origin) + (expected - 1e-6) * np.array(direction)
        if math.isnan(naive.height(arrays.bed, x, y)):
            return  # it enters from the side: cut sides of a bed return nothing
    assert distance[0] <= expected + 1e-7
    if distance[0] < expected - 1e-7:
        # Small steps pass over a graze that the walk sees; it must be on a surface.
        point = np.array(origin) + distance[0] * np.array(direction)
        assert what[0] == BED
        assert naive.height(arrays.bed, point[0], point[1]) == pytest.approx(point[2], abs=1e-6)
    else:
        assert what[0] == target


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="memory is told in other units")
def test_a_million_rays_are_held_by_their_directions_alone():
    code = """
import resource
import numpy as np
from insonify.scene import edit, load_scene
from insonify.simulation import prepare
from insonify.tracers import rays, sweep
simulation = prepare(edit(load_scene("figure-4a"), {"sonar.bins": 100}))
def most(count):
    rays.trace(simulation.arrays, simulation.poses(np.arange(1)), rays=count)
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
print(most(4096), most(1_000_000))
"""
    few, many = map(int, run_python("-c", code, timeout=300)[1].split())
    assert 1000 * (many - few) / 1_000_000 < 1.3 * rays.STRAIGHT  # bytes a ray


def test_more_rays_than_fit_in_memory_are_traced_by_fewer_threads(monkeypatch):
    given = []
    monkeypatch.setattr(parallel, "most_threads", lambda: 4)
    monkeypatch.setattr(rays, "trace_blocks", lambda *arguments: given.append(arguments[-1]))
    for count in (1000, 3 * rays.MEMORY // (10 * rays.STRAIGHT), rays.MEMORY):
        rays.trace(flat(), poses_of(0.0, 0.0, 4.0), rays=count, threads=4)
    assert given == [4, 3, 1]


# The march: right where a ray meets one smooth surface, and wrong as a march is wrong.


def hits_of(arrays, origin, directions, step):
    hits, bundle = empty_hits(len(directions)), rays._bundle(origin, directions)
    near = np.arange(arrays.solids.shape.size)
    reach = arrays.bins * arrays.bin_length
    march_hits(arrays.bed, arrays.solids, near, near.size, arrays.mesh, bundle, reach, step, hits)
    return hits


@pytest.mark.parametrize("law", [LIGHT, SONAR])
@pytest.mark.parametrize("step", [0.03, 0.7, 3.0])
def test_level_bed_is_exact_at_any_step(law, step):
    # A plane is linear along a ray, so that one interpolation finds it.
    arrays = flat(law=law, half_width=0.01)
    poses = poses_of(1.0, 2.0, 10.0, 0.3)
    one, other = march.trace(arrays, poses, step=step, rays=3200), rays.trace(arrays, poses, rays=3200)
    assert np.isclose(one, other, rtol=1e-5).mean() > 0.998
    assert one.sum() == pytest.approx(other.sum(), rel=1e-4)


def test_one_interpolation_is_of_second_order():
    # A single saddle: along an oblique ray the height above it is a parabola.
    arrays = arrays_of([[0.0, 3.0], [3.0, 0.0]], 40.0, bins=800, bin_length=0.1)
    directions = [(1.0, 0.9, -slope) for slope in np.linspace(0.4, 1.2, 400)]
    exact, what, _ = rays.cast(arrays, (2.0, 3.0, 12.0), directions)
    assert (what == BED).all()
    steps = np.array([0.8, 0.4, 0.2, 0.1])
    errors = [np.abs(hits_of(arrays, (2.0, 3.0, 12.0), directions, step).distance - exact).mean() for step in steps]
    assert order(1.0 / steps, errors) == pytest.approx(2.0, rel=0.1)


def test_steps_leak_through_crests_in_first_order():
    # Over kinked crests the share of rays that step across is proportional to the step.
    arrays = arrays_of(rough(256, 256, 0.05), 0.1, periodic=True, bins=500, bin_length=0.06)
    poses = poses_of(np.arange(4) * 0.9, 1.3, 8.0)
    right = rays.trace(arrays, poses, rays=1 << 14)
    steps = np.array([0.1, 0.05, 0.025, 0.0125])
    records = (march.trace(arrays, poses, step=step, rays=1 << 14) for step in steps)
    leaks = np.array([compare_records(arrays, poses, record, right).energy_bias for record in records])
    assert (leaks < 0.0).all()
    assert order(1.0 / steps, -leaks) == pytest.approx(1.0, rel=0.1)


def test_bodies_are_met_where_they_are_and_small_ones_stepped_over():
    bodies = [((0.0, 9.0, 2.0), 1.0), ((5.0, 0.0, 3.0), (9.0, 0.0, 3.0), 0.5)]
    arrays = flat(solids=bodies)
    directions = [(0.0, 1.0, 0.0), (0.05, 1.0, 0.02), (1.0, 0.0, 0.2), (1.0, 0.02, 0.15), (0.0, -1.0, 0.1)]
    exact, what, normals = rays.cast(arrays, (0.0, 0.0, 2.0), directions)
    hits = hits_of(arrays, (0.0, 0.0, 2.0), directions, 1e-3)
    assert what[:4].tolist() == hits.body[:4].tolist() == [0, 0, 1, 1]
    np.testing.assert_allclose(hits.distance[:4], exact[:4], atol=1e-5)
    np.testing.assert_allclose(np.column_stack([hits.nx, hits.ny, hits.nz])[:4], normals[:4], atol=1e-4)
    assert math.isinf(hits.distance[4])
    small = flat(solids=[((0.0, 9.25, 2.0), 0.1)])
    for step, body in ((0.05, 0), (0.5, -2)):
        assert hits_of(small, (0.0, 0.0, 2.0), [(0.0, 1.0, 0.0)], step).body[0] == body
    hits = hits_of(arrays_of(HOLE, 1.0), (10.5, 10.5, 5.0), [(0, 0, -1), (0.3, 0, -1), (0, 3, -1)], 0.1)
    assert hits.body.tolist() == [-2, BED, -2]
