"""Targets in a plane: primitives that cross, turn a corner or come out of the bed, facets, and what they hide.

Of a line at distance d from the sonar a Lambert surface returns the radiance d/r, and ∫ d/r dr = d ln(r₂/r₁).
"""

import math

import numpy as np
import pytest

from beds import arrays_of, poses_of
from insonify.kernels.common.types import LIGHT
from insonify.kernels.geometry.bvh import build_mesh
from insonify.kernels.sweep.bed_stretches import SegmentLine, launch_angle
from insonify.kernels.sweep.facets import Facet, along_curve, facet_curve, is_facet_met
from insonify.kernels.targets.occlusion import Occlusion, is_hidden, next_visible
from insonify.kernels.targets.primitives import measure_directions
from insonify.scene.targets.shape import block
from insonify.tracers import rays, sweep

HEIGHT = 10.0
POSE = poses_of(0.0, 0.0, HEIGHT)  # heading along x, so that y is the ground range to port
NO_BED = np.full((4, 4), -500.0)


def lit(arrays):
    """Radiance times slant range, all bins of the port side together."""
    return float(sweep.trace(arrays, POSE)[0, 0].sum(dtype=float)) * arrays.bin_length


def line(start, end):
    """∫ of the radiance of a line between two points (ground range, height)."""
    (x0, z0), (x1, z1) = (start[0], start[1] - HEIGHT), (end[0], end[1] - HEIGHT)
    distance = abs(x0 * z1 - x1 * z0) / math.hypot(x1 - x0, z1 - z0)
    return distance * abs(math.log(math.hypot(x1, z1) / math.hypot(x0, z0)))


def mesh(corners, closed=True):
    rows = np.zeros(len(corners), np.int64)
    return build_mesh(corners, rows, rows, np.full(len(corners), closed))


def scene(heights=NO_BED, **options):
    return arrays_of(heights, 100.0, x0=-150.0, y0=-150.0, law=LIGHT, bins=800, bin_length=0.05, **options)


@pytest.mark.parametrize("level", [9.0, 5.0, 0.0])
def test_a_cylinder_seen_end_on_turns_at_its_rim(level):
    # Through its axis a plane cuts it in a rectangle: the end, then the top.
    arrays = scene(solids=[((0.0, 20.0, level - 1.0), (0.0, 26.0, level - 1.0), 1.0)])
    expected = line((20.0, level - 2.0), (20.0, level)) + line((20.0, level), (26.0, level))
    assert lit(arrays) == pytest.approx(expected, rel=1e-4)


def test_a_mast_that_runs_into_a_deck_is_heard_from_the_deck_on():
    deck = np.add(block((9.0, 4.0, 2.0)), (0.0, 22.0, 5.0))
    mast = np.add(block((9.0, 0.2, 3.3)), (0.0, 22.0, 6.35))
    arrays = scene(mesh=mesh(np.concatenate([deck, mast])))
    # The top of the mast hides all of the deck behind it.
    corners = [(20.0, 4.0), (20.0, 6.0), (21.9, 6.0), (21.9, 8.0), (22.1, 8.0)]
    assert lit(arrays) == pytest.approx(sum(map(line, corners, corners[1:])), rel=1e-4)


def test_two_balls_one_in_the_other_part_where_they_cross():
    arrays = scene(solids=[((0.0, 20.0, 5.0), 1.0), ((0.0, 20.3, 5.9), 0.8)])
    right = rays.trace(arrays, POSE, rays=1 << 20)[0, 0]
    record = sweep.trace(arrays, POSE)[0, 0]
    assert np.abs(record - right).max() < 0.01 * right.max()
    assert record.sum() == pytest.approx(right.sum(), rel=3e-3)


def test_only_an_open_body_is_seen_from_behind():
    sides = block((9.0, 4.0, 2.0)) + np.array([0.0, 22.0, 1.0])
    towards = (sides[..., 1].max(axis=1) < 21.0) | (sides[..., 2].min(axis=1) > 1.0)  # the sonar
    outside = line((20.0, 0.0), (20.0, 2.0)) + line((20.0, 2.0), (24.0, 2.0))
    inside = line((24.0, 0.0), (24.0, 2.0)) + line((20.0, 0.0), (24.0, 0.0))
    assert lit(scene(mesh=mesh(sides))) == pytest.approx(outside, rel=1e-4)
    assert lit(scene(mesh=mesh(sides, closed=False))) == pytest.approx(outside, rel=1e-4)
    assert lit(scene(mesh=mesh(sides[~towards], closed=False))) == pytest.approx(inside, rel=1e-4)
    assert lit(scene(mesh=mesh(sides[~towards]))) == 0.0


@pytest.mark.parametrize("thick", [1e-3, 4.0])
def test_a_ramp_comes_out_of_the_bed_where_they_cross(thick):
    # One long segment of bed, one long face that rises out of it at 22 m and ends at 26 m.
    turn = math.atan(0.25)
    top = np.array([0.0, 22.0, 0.0])
    corners = block((9.0, 2.0 * math.hypot(4.0, 1.0), thick)) - [0.0, 0.0, 0.5 * thick]
    c, s = math.cos(turn), math.sin(turn)
    corners = corners @ np.array([[1.0, 0.0, 0.0], [0.0, c, s], [0.0, -s, c]]) + top
    arrays = scene(np.zeros((4, 4)), mesh=mesh(corners))
    reach = arrays.bins * arrays.bin_length
    far = math.sqrt(reach**2 - HEIGHT**2)
    expected = line((0.0, 0.0), (22.0, 0.0)) + line((22.0, 0.0), (26.0, 1.0))
    expected += line((26.0 * HEIGHT / (HEIGHT - 1.0), 0.0), (far, 0.0))
    assert lit(arrays) == pytest.approx(expected, rel=2e-5)
    record = sweep.trace(arrays, POSE)[0, 0]
    border = int(math.hypot(22.0, HEIGHT) / 0.05)
    near = np.array([HEIGHT / r for r in (np.arange(border) + 0.5) * 0.05])[400:]
    # A piece of one density is up to 2 % of its range long.
    np.testing.assert_allclose(record[400:border], near, rtol=6e-3)


def test_directions_of_launch_angles_are_those_of_the_library_and_never_point_back():
    angle = np.linspace(-0.5 * math.pi, 0.5 * math.pi, 10_001)
    cosine, sine = np.empty((2, angle.size))
    measure_directions(angle, cosine, sine)
    np.testing.assert_allclose(cosine, np.cos(angle), rtol=0.0, atol=4e-16)
    np.testing.assert_allclose(sine, np.sin(angle), rtol=0.0, atol=4e-16)
    assert cosine.min() > 0.0


def test_what_is_hidden_has_no_visible_stretch():
    edges = np.array([-0.9, -0.7, -0.6, -0.45, -0.4])
    nearness = np.array([0.12, 0.1, 0.0, 0.09])  # of targets square to the middle of each cell, per metre; one is empty
    middle = 0.5 * (edges[:-1] + edges[1:])
    cells = Occlusion(edges, np.cos(edges), np.sin(edges), nearness * np.cos(middle), nearness * np.sin(middle))
    rng, hidden, behind = np.random.default_rng(3), 0, 0
    for _ in range(4000):
        segment = SegmentLine(rng.uniform(-14.0, -2.0), rng.uniform(-0.2, 0.2))
        start = rng.uniform(1.0, 30.0)
        stop = start + rng.uniform(0.01, 3.0)
        low, high = launch_angle(segment, start), launch_angle(segment, stop)
        dark = low < high and next_visible(cells, segment, low, high)[0] >= high
        found = is_hidden(cells, segment, start, stop)
        assert dark or not found
        hidden, behind = hidden + found, behind + dark
    assert 0.9 * behind < hidden < 4000


def facet(near: float, centre: float, far: float) -> Facet:
    return Facet(0.1, 0.2, np.cos(0.15), np.sin(0.15), near, centre, far, 0.5, centre)


@pytest.mark.parametrize("share", [0.0, 0.25, 0.5, 0.75, 1.0])
def test_parts_lie_ahead_of_the_sonar_however_long_the_facet_is(share):
    for near, centre, far in ((10.0, 20.0, 1e4), (1e9, 30.0, 5.0), (0.0, 1.0, 1e6)):
        long = facet(near, centre, far)
        assert along_curve(long, facet_curve(long), share) >= 0.0
    short = facet(10.0, 10.1, 10.3)
    assert along_curve(short, facet_curve(short), 0.0) == pytest.approx(10.0)
    assert along_curve(short, facet_curve(short), 1.0) == pytest.approx(10.3)


@pytest.mark.parametrize("wrong", [-1.0, np.inf, np.nan])
def test_a_facet_behind_the_sonar_or_nowhere_is_not_met(wrong):
    assert is_facet_met(facet(10.0, 10.1, 10.3))
    for place in range(3):
        distances = [10.0, 10.1, 10.3]
        distances[place] = wrong
        assert not is_facet_met(facet(*distances))
