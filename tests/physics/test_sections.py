"""Rays through water that differs along their way."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from insonify.acoustics.water import SoundSpeedField
from insonify.compiler.jit import kernel
from insonify.kernels.refraction.ray_paths import ON_BED, RayLimits, RayPoints, trace_ray_paths
from insonify.kernels.refraction.section_arcs import SectionPlane, speed_in_section
from water import followed, water_of

RANGES = np.linspace(0.0, 2500.0, 26)


@pytest.mark.parametrize("station", [(-10.0, 33.3, 200.0), (0.0, 100.0), (-5e3, -4e3)])
def test_profiles_that_are_the_same_everywhere_are_layers(station):
    height, speed = np.array([-60.0, -20.0, -10.0, 0.0]), np.array([1498.0, 1500.0, 1520.0, 1520.0])
    angles = np.array([2.0, 10.0, 30.0, 60.0, 90.0, 0.0, -3.0, -20.0])
    options = {"bottom": 60.0, "surface": 0.0, "mirrored": True}
    ranges = np.linspace(0.0, 500.0, 51)
    layered, ends = followed(water_of(height, speed), 5.0, angles, ranges, **options)
    section = water_of(height, np.tile(speed, (len(station), 1)), station)
    points, section_ends = followed(section, 5.0, angles, ranges, **options)
    np.testing.assert_array_equal(section_ends, ends)
    assert (ends[:5] == ON_BED).all()
    for name, bound in {"x": 1e-9, "z": 1e-9, "time": 1e-12, "q": 1e-8, "sine": 1e-12}.items():
        np.testing.assert_allclose(getattr(points, name), getattr(layered, name), rtol=0, atol=bound)


@pytest.mark.parametrize(("gx", "gz"), [(0.03, 0.04), (-0.03, 0.04), (0.05, 0.0), (0.02, -0.05), (1e-12, 0.05)])
def test_a_tilted_gradient_is_one_gradient_turned(gx, gz):
    """Rotate the axes until speed depends on height alone: the circle through both points, its time and its tube."""
    station, height = np.array([-9e3, -130.0, 700.0, 9e3]), np.array([-14e3, -2e3, -1.2e3, -300.0, 500.0, 3e3])
    water = water_of(height, 1500.0 + gx * station[:, None] + gz * height, station)
    angles = np.radians([20.0, -30.0, 5.0, -60.0])
    points, _ = followed(water, 10.0, -np.degrees(angles), RANGES)
    g, tilt = math.hypot(gx, gz), math.atan2(gx, gz)
    rise = points.z + 10.0
    up = points.x * math.sin(tilt) + rise * math.cos(tilt)
    level = points.x * math.cos(tilt) - rise * math.sin(tilt)
    c0 = 1500.0 - 10.0 * gz
    square = (level**2 + up**2)[:, 1:-1]
    time = np.arccosh(1.0 + g**2 * square / (2.0 * c0 * (c0 + g * up[:, 1:-1]))) / g
    np.testing.assert_allclose(points.time[:, 1:-1], time, rtol=1e-10)
    launch = np.arctan2(up[:, 1:-1] + 0.5 * g * square / c0, level[:, 1:-1])
    turned = np.broadcast_to(angles[:, None] + tilt, launch.shape)
    there = np.isfinite(launch)
    np.testing.assert_allclose(launch[there], turned[there], rtol=0, atol=1e-11)
    tube = level[:, 1:-1] / np.cos(turned)
    np.testing.assert_allclose(points.q[:, 1:-1], tube, rtol=1e-9)


def test_a_tube_through_triangles_is_the_distance_between_neighbouring_rays():
    rng = np.random.default_rng(3)
    station, height = np.array([-50.0, 40.0, 90.0, 130.0, 300.0]), np.array([-50.0, -35.0, -22.0, -8.0, 0.0])
    water = water_of(height, 1500.0 + rng.uniform(-8.0, 8.0, (5, 5)), station)
    ranges, nearby = np.linspace(0.0, 200.0, 9), 1e-5
    for degrees in np.linspace(-25.0, 40.0, 14):
        three, _ = followed(water, 25.0, [degrees, degrees + nearby, degrees - nearby], ranges)
        across = three.cosine[0] * (three.z[2] - three.z[1]) / (2.0 * math.radians(nearby))
        # A ray may pass a corner of the lattice, and its neighbours on either side of it.
        close = np.isclose(across, three.q[0], rtol=1e-5, atol=1e-5) | np.isnan(across)
        assert close.mean() > 0.8, degrees


def through(water, plane, z, angle, x_end):
    """Follow a ray in any plane to a range."""
    shape = (1, 2)
    floats, counts = [np.full(shape, math.nan) for _ in range(6)], [np.zeros(shape, np.int64) for _ in range(3)]
    points = RayPoints(*floats, np.zeros(shape, np.bool_), *counts)
    limits = RayLimits(x_end, -math.inf, math.inf, False, False)
    trace_ray_paths(water, plane, z, np.array([angle]), np.array([x_end]), limits, points, np.zeros(1, np.int64))
    return points


@settings(max_examples=50, deadline=None)
@given(
    st.lists(st.floats(1490.0, 1505.0), min_size=20, max_size=20),
    st.floats(-0.7, 0.7),
    st.floats(-45.0, -5.0),
    st.floats(5.0, 200.0),
)
def test_a_ray_sent_back_through_a_section_comes_back(speeds, angle, z, x):
    station, height = np.array([-50.0, 40.0, 90.0, 130.0, 300.0]), np.array([-50.0, -35.0, -18.0, 0.0])
    water = water_of(height, np.reshape(speeds, (5, 4)), station)
    there = through(water, SectionPlane(0.0, 1.0), z, angle, x)
    direction = math.atan2(-there.sine[0, 0], there.cosine[0, 0])
    back = through(water, SectionPlane(x, -1.0), there.z[0, 0], direction, x)
    assert back.z[0, 0] == pytest.approx(z, abs=1e-7)
    assert back.time[0, 0] == pytest.approx(there.time[0, 0], abs=1e-11)
    # The tube is the same both ways but for the speeds at its ends.
    ends = [
        through(water, SectionPlane(place, 1.0), at, 0.1, 1e-9).time[0, 0]
        for place, at in ((0.0, z), (x, there.z[0, 0]))
    ]
    if not (there.grazed.any() or back.grazed.any()):
        ours, theirs = there.q[0, 0] * ends[1], back.q[0, 0] * ends[0]
        assert ours == pytest.approx(theirs, rel=1e-4, abs=1e-4 * x * ends[0])


@pytest.mark.parametrize("along", [0.5, -0.3, 1e-9, 0.0])
def test_an_oblique_plane_sees_the_stations_farther_apart(along):
    rng = np.random.default_rng(5)
    station, height = np.array([-50.0, 40.0, 90.0, 130.0, 300.0]), np.array([-50.0, -35.0, -22.0, 0.0])
    speed = 1500.0 + rng.uniform(-5.0, 5.0, (5, 4))
    oblique = through(water_of(height, speed, station), SectionPlane(60.0, along), -25.0, 0.1, 150.0)
    if abs(along) < 1e-6:
        share = (60.0 - 40.0) / 50.0
        # What the plane cuts of the two triangles of each cell: a node more, on the diagonal.
        nodes, profile = [], []
        for j in range(3):
            rising = abs(speed[2, j + 1] - speed[1, j]) <= abs(speed[2, j] - speed[1, j + 1])
            part = share if rising else 1.0 - share
            ends = (speed[1, j], speed[2, j + 1]) if rising else (speed[1, j + 1], speed[2, j])
            nodes += [height[j], height[j] + part * (height[j + 1] - height[j])]
            profile += [speed[1, j] + share * (speed[2, j] - speed[1, j]), ends[0] + share * (ends[1] - ends[0])]
        nodes, profile = [*nodes, 0.0], [*profile, speed[1, 3] + share * (speed[2, 3] - speed[1, 3])]
        same = through(water_of(nodes, profile), SectionPlane(0.0, 1.0), -25.0, 0.1, 150.0)
    else:
        stretched = np.sort((station - 60.0) / along)
        kept = speed if along > 0.0 else speed[::-1]
        same = through(water_of(height, kept, stretched), SectionPlane(0.0, 1.0), -25.0, 0.1, 150.0)
    assert oblique.z[0, 0] == pytest.approx(same.z[0, 0], abs=1e-6)
    assert oblique.time[0, 0] == pytest.approx(same.time[0, 0], abs=1e-10)
    assert oblique.q[0, 0] == pytest.approx(same.q[0, 0], rel=1e-5)


def speed_of_triangles(water, x, z):
    """Speed and its gradient at a point, the slow way: by the plane through the corners of its triangle."""
    i = int(np.clip(np.searchsorted(water.station, x) - 1, 0, water.station.size - 2))
    j = int(np.clip(np.searchsorted(water.height, z) - 1, 0, water.height.size - 2))
    corners = {(m, k): water.speed[i + m, j + k] for m in (0, 1) for k in (0, 1)}
    rising = abs(corners[1, 1] - corners[0, 0]) <= abs(corners[1, 0] - corners[0, 1])
    across = (x - water.station[i]) / (water.station[i + 1] - water.station[i])
    up = (z - water.height[j]) / (water.height[j + 1] - water.height[j])
    if rising:
        chosen = [(0, 0), (1, 1), (0, 1) if up > across else (1, 0)]
    else:
        chosen = [(1, 0), (0, 1), (1, 1) if up > 1.0 - across else (0, 0)]
    places = [[water.station[i + m], water.height[j + k], 1.0] for m, k in chosen]
    gx, gz, level = np.linalg.solve(places, [corners[corner] for corner in chosen])
    return gx * x + gz * z + level, gx, gz


def test_rays_through_triangles_are_those_of_the_ray_equations():
    """The twin: small steps of dx/ds = cosθ, dz/ds = sinθ, dθ/ds = (sinθ ∂c/∂x − cosθ ∂c/∂z)/c, dτ/ds = 1/c."""
    rng = np.random.default_rng(11)
    station, height = np.array([-20.0, 15.0, 40.0, 90.0]), np.array([-50.0, -30.0, -22.0, 0.0])
    water = water_of(height, 1500.0 + rng.uniform(-9.0, 9.0, (4, 4)), station)

    def rates(state):
        x, z, angle, _ = state
        c, gx, gz = speed_of_triangles(water, x, z)
        turn = (math.sin(angle) * gx - math.cos(angle) * gz) / c
        return np.array([math.cos(angle), math.sin(angle), turn, 1.0 / c])

    for angle in (-0.3, 0.05, 0.35):
        state, step = np.array([0.0, -25.0, angle, 0.0]), 0.02
        while state[0] < 60.0:
            middle = state + 0.5 * step * rates(state)
            state = state + step * rates(middle)
        ours = through(water, SectionPlane(0.0, 1.0), -25.0, angle, float(state[0]))
        # A step over a border errs by its length times the change of curvature: 0.02 m · 0.6 /s / c, some 8 µrad.
        assert ours.z[0, 0] == pytest.approx(state[1], abs=4e-4)
        assert ours.time[0, 0] == pytest.approx(state[3], abs=1e-7)
        assert ours.sine[0, 0] == pytest.approx(math.sin(state[2]), abs=1e-5)


@kernel
def speeds_across(height, speed, station, place, z, out):
    for k in range(out.size):
        out[k] = speed_in_section(height, speed, station, place[k], z[k])


@pytest.mark.parametrize("shape", [(4, 5), (2, 2), (1, 4), (3, 1)])
def test_speed_at_a_place_is_what_rays_have_there(shape):
    rng = np.random.default_rng(8)
    station, depth = np.sort(rng.uniform(0.0, 100.0, shape[0])), np.sort(rng.uniform(0.0, 60.0, shape[1]))
    laid = SoundSpeedField(depth, station, 1500.0 + rng.uniform(-9.0, 9.0, shape))
    place, below = rng.uniform(-20.0, 120.0, 500), rng.uniform(-10.0, 70.0, 500)
    ours = np.empty(500)
    speeds_across(-depth[::-1], np.ascontiguousarray(laid.speed[:, ::-1]), station, place, -below, ours)
    np.testing.assert_allclose(ours, laid.speed_at(place, 0.0, below), rtol=1e-13)
