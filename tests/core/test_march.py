"""The march: right where a ray meets one smooth surface, and wrong as a march is wrong."""

import math

import numpy as np
import pytest

from beds import arrays_of, poses_of, rough
from exact_rays import order
from insonify.kernels.common.types import BED, LIGHT, SONAR
from insonify.kernels.rays.cell_walk import empty_hits
from insonify.kernels.rays.march import march_hits
from insonify.statistics.record_errors import compare_records
from insonify.tracers import march, rays

FLAT = np.zeros((8, 8))


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
    arrays = arrays_of(FLAT, 4.0, periodic=True, law=law, half_width=0.01)
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
    leaks = [
        compare_records(arrays, poses, march.trace(arrays, poses, step=step, rays=1 << 14), right).energy_bias
        for step in steps
    ]
    assert (np.array(leaks) < 0.0).all()
    assert order(1.0 / steps, np.abs(leaks)) == pytest.approx(1.0, rel=0.1)


def test_bodies_are_met_where_they_are_and_small_ones_stepped_over():
    bodies = [((0.0, 9.0, 2.0), 1.0), ((5.0, 0.0, 3.0), (9.0, 0.0, 3.0), 0.5)]
    arrays = arrays_of(FLAT, 4.0, periodic=True, solids=bodies)
    directions = [(0.0, 1.0, 0.0), (0.05, 1.0, 0.02), (1.0, 0.0, 0.2), (1.0, 0.02, 0.15), (0.0, -1.0, 0.1)]
    exact, what, normals = rays.cast(arrays, (0.0, 0.0, 2.0), directions)
    hits = hits_of(arrays, (0.0, 0.0, 2.0), directions, 1e-3)
    assert what[:4].tolist() == hits.body[:4].tolist() == [0, 0, 1, 1]
    np.testing.assert_allclose(hits.distance[:4], exact[:4], atol=1e-5)
    np.testing.assert_allclose(np.column_stack([hits.nx, hits.ny, hits.nz])[:4], normals[:4], atol=1e-4)
    assert math.isinf(hits.distance[4])
    small = arrays_of(FLAT, 4.0, periodic=True, solids=[((0.0, 9.25, 2.0), 0.1)])
    for step, body in ((0.05, 0), (0.5, -2)):
        assert hits_of(small, (0.0, 0.0, 2.0), [(0.0, 1.0, 0.0)], step).body[0] == body
    heights = np.zeros((21, 21))
    heights[10, 10] = np.nan  # no bed where a node is missing
    hits = hits_of(arrays_of(heights, 1.0), (10.5, 10.5, 5.0), [(0, 0, -1), (0.3, 0, -1), (0, 3, -1)], 0.1)
    assert hits.body.tolist() == [-2, BED, -2]
