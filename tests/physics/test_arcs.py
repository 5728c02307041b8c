"""Rays through layers and sections against closed forms, printed numbers and small steps; all that join two points."""

import csv
import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from insonify.acoustics.rays import find_shadows, follow_paths, join_points
from insonify.acoustics.water import SoundSpeedField
from insonify.compiler.jit import kernel
from insonify.kernels.refraction.arcs import HIGH, RANGE
from insonify.kernels.refraction.eigenray_search import ANGLE, COSINE, GRAZED, SINE, TIME, TUBE, TURNS
from insonify.kernels.refraction.eigenrays import FOUND, NONE, follow_to_range
from insonify.kernels.refraction.ray_paths import ON_BED, RayLimits
from insonify.kernels.refraction.section_arcs import SectionPlane, speed_in_section
from water import NO_CEILING, NO_FLOOR, followed, gradient, joined, launched, layers, shot, water_of

BELLHOP = Path(__file__).parents[3] / "shared/data/bellhop"


def rows(name):
    if not BELLHOP.is_dir():
        pytest.skip(f"{BELLHOP} is absent")
    with (BELLHOP / name).open() as file:
        return list(csv.DictReader(file))


def test_rays_are_the_exact_ones_beside_bellhop():
    water = layers([0, 10, 20, 60], [1520, 1520, 1500, 1498])
    for row in rows("layered_bottom_hits.csv"):
        _, ray = shot(water, 5.0, float(row["launch_deg_down"]), bottom=60.0)
        assert ray.x == pytest.approx(float(row["r_exact_m"]), abs=1e-8)
        assert ray.time == pytest.approx(float(row["t_exact_s"]), abs=1e-12)
        assert ray.q == pytest.approx(float(row["q_exact_m_per_rad"]), rel=1e-11)
        assert math.degrees(math.asin(-ray.sine)) == pytest.approx(float(row["grazing_deg_exact"]), abs=1e-10)
    for row in rows("linear_ray_points.csv"):
        status, ray = shot(gradient(1500.0, 0.05), 500.0, float(row["launch_deg_down"]), x_end=float(row["r_m"]))
        assert status == RANGE
        assert -ray.z == pytest.approx(float(row["z_exact_m"]), abs=1e-6)
        assert ray.time == pytest.approx(float(row["t_exact_s"]), abs=1e-9)
        assert ray.q == pytest.approx(float(row["q_exact_abs_m_per_rad"]), rel=1e-9)


def test_a_ray_turns_and_comes_back_after_a_cycle():
    water = gradient(1500.0, 0.016)
    status, ray = shot(water, 0.0, 5.0, surface=0.0)
    assert status == HIGH
    assert ray.x == pytest.approx(16404.1244, abs=6e-5)
    assert ray.time == pytest.approx(10.92217950, abs=6e-9)
    _, ray = shot(water, 0.0, 5.0, x_end=ray.x / 2)
    assert ray.x == pytest.approx(8202.0622, abs=6e-5)
    assert -ray.z == pytest.approx(358.1098, abs=6e-5)
    assert ray.sine == pytest.approx(0.0, abs=1e-14)


@pytest.mark.parametrize(
    ("slope", "degrees", "time"), [(-0.5, 10.35189837, 0.068211383364), (0.5, 12.26160208, 0.067758190053)]
)
def test_the_ray_between_two_points_is_as_printed(slope, degrees, time):
    c0, x, dz = 1500.0, 100.0, 20.0
    status, ray, angle = joined(gradient(c0, slope, 40.0), 0.0, x, dz)
    assert status == FOUND
    assert angle == pytest.approx(degrees, abs=6e-9)
    assert ray.time == pytest.approx(time, abs=6e-13)
    c1 = c0 + slope * dz
    assert ray.time == pytest.approx(math.acosh(1 + slope**2 * (x**2 + dz**2) / (2 * c0 * c1)) / abs(slope), abs=1e-12)


@pytest.mark.parametrize("depths", [[0, 60], [0, 25, 60], [5, 25, 50]])
@pytest.mark.parametrize("stations", [1, 3])
def test_a_tube_keeps_to_its_neighbours_when_mirrored_where_speed_has_a_gradient(depths, stations):
    """Bed and surface lie on nodes, and off them."""
    height, speed = layers(depths, np.interp(depths, [0, 25, 60], [1500, 1520, 1490]))
    water = water_of(height, np.tile(speed, (stations, 1)), np.arange(stations) * 100.0)
    ranges, apart = np.linspace(10.0, 250.0, 13), 1e-5
    limits = RayLimits(250.0, -60.0, 0.0, True, True)
    for degrees in (-40.0, -25.0, 20.0, 35.0, 50.0):
        angles = np.radians([degrees, degrees - apart, degrees + apart])
        points, _ = follow_paths(water, -20.0, angles, ranges, limits)
        across = points.cosine[0] * (points.z[2] - points.z[1]) / (2.0 * math.radians(apart))
        turned = (-1.0) ** (points.tops[0] + points.bottoms[0])
        np.testing.assert_allclose((turned * points.q[0])[:-1], across[:-1], rtol=1e-5)
        assert points.tops[0].max() > 0
        assert points.bottoms[0].max() > 0


@pytest.mark.parametrize("degrees", [-8.0, 1.0, 12.0, 70.0])
def test_a_ray_sent_back_comes_back(degrees):
    x = 60.0 if degrees == 70.0 else 150.0
    water = layers([0, 10, 20, 60, 300], [1520, 1520, 1500, 1498, 1503])
    _, there = shot(water, 30.0, degrees, x_end=x)
    back = launched(*water, there.z, there.cosine, -there.sine)
    status, home = follow_to_range(*water, back, x, NO_FLOOR, NO_CEILING)
    assert status == RANGE
    assert -home.z == pytest.approx(30.0, abs=1e-9)
    assert home.time == pytest.approx(there.time, abs=1e-14)
    assert home.sine == pytest.approx(math.sin(math.radians(degrees)), abs=1e-12)
    assert home.q * back.speed == pytest.approx(there.q * 1499.5, rel=1e-9)


HEIGHT = np.array([-60.0, -52.0, -40.0, -33.0, -18.0, -7.0, 0.0])
SPEEDS, HEIGHTS = st.floats(1490.0, 1505.0), st.floats(-59.0, -1.0)
WATERS = st.tuples(st.just(HEIGHT), st.tuples(*[SPEEDS] * HEIGHT.size).map(np.array))


def every_ray(water, z_from, z_to, x):
    return join_points(water_of(*water), z_from, z_to, x, -60.0, 0.0, 0)


@settings(max_examples=60, deadline=None)
@given(WATERS, HEIGHTS, st.floats(-85.0, 85.0), st.floats(0.5, 400.0))
def test_a_ray_that_was_sent_is_found_again(water, z_from, degrees, x):
    status, sent = shot(water, -z_from, degrees, x_end=x, bottom=60.0, surface=0.0)
    if status != RANGE or abs(sent.q) < 1e-2 * x or sent.grazed:
        return  # it has left the water, or is as good as on a caustic
    found = every_ray(water, z_from, sent.z, x)
    nearest = found[np.abs(np.degrees(found[:, ANGLE]) + degrees).argmin()]
    assert math.degrees(nearest[ANGLE]) == pytest.approx(-degrees, abs=1e-8)
    assert nearest[TIME] == pytest.approx(sent.time, abs=1e-12)


# A ray that runs flat along the edge of a gradient: its tube is 1.8e8 m/rad wide.
ALONG_AN_EDGE = HEIGHT, np.array([1500.25, 1500.0, *[1490.0] * 5])

BELOW_A_GRADIENT = HEIGHT, np.array([1491.0, *[1490.0] * 6])  # where rays between nearly equal heights turn at once


@settings(max_examples=60, deadline=None)
@given(WATERS, HEIGHTS, HEIGHTS, st.floats(0.5, 400.0))
@example(ALONG_AN_EDGE, -38.0, -43.5, 400.0)
def test_every_ray_goes_both_ways_in_the_same_time_with_the_same_spreading(water, z_from, z_to, x):
    there, back = every_ray(water, z_from, z_to, x), every_ray(water, z_to, z_from, x)
    assert len(there) == len(back)
    there, back = there[there[:, TIME].argsort()], back[back[:, TIME].argsort()]
    np.testing.assert_allclose(there[:, TIME], back[:, TIME], rtol=0, atol=1e-13)
    sound = (there[:, GRAZED] == 0.0) & (np.abs(there[:, TUBE]) > 1e-2 * x)
    apart = np.diff(there[:, TIME], prepend=-1.0, append=9.0)
    sound &= (apart[1:] > 1e-9) & (apart[:-1] > 1e-9)
    ours, theirs = (rays[sound, TUBE] * np.interp(z, *water) for rays, z in ((there, z_from), (back, z_to)))
    np.testing.assert_allclose(ours, theirs, rtol=1e-5)


@settings(max_examples=30, deadline=None)
@given(WATERS, HEIGHTS, HEIGHTS, st.floats(20.0, 400.0))
def test_no_ray_of_a_fine_fan_is_lost(water, z_from, z_to, x):
    """The slow twin: between two neighbours of a fan that pass on either side of the point there is a ray to it."""
    angles = np.linspace(-60.0, 60.0, 4001)
    fan, _ = followed(water_of(*water), -z_from, angles, [x], bottom=60.0, surface=0.0)
    miss = np.where(fan.x[:, 0] == x, fan.z[:, 0] - z_to, np.nan)
    # Neighbours that are far apart have the brink of a shadow between them.
    near = np.abs(np.diff(miss)) < 0.5
    found = -np.degrees(every_ray(water, z_from, z_to, x)[:, ANGLE])
    for k in np.flatnonzero((miss[:-1] * miss[1:] < 0.0) & near):
        assert ((found > angles[k] - 1e-9) & (found < angles[k + 1] + 1e-9)).any()
    for angle in found[np.abs(found) < 60.0]:
        status, ray = shot(water, -z_from, angle, x_end=x, bottom=60.0, surface=0.0)
        assert status == RANGE
        assert ray.z == pytest.approx(z_to, abs=1e-6 + 1e-9 * abs(ray.q))


@settings(max_examples=60, deadline=None)
@given(WATERS, HEIGHTS, HEIGHTS, st.floats(0.5, 300.0))
@example(BELOW_A_GRADIENT, -58.99999999999999, -59.0, 1.0)
@example(BELOW_A_GRADIENT, -58.99999999999, -59.0, 1.0)
def test_the_direct_ray_is_one_of_all(water, z_from, z_to, x):
    status, _, angle = joined(water, -z_from, x, -z_to)
    every = join_points(water_of(*water), z_from, z_to, x, -math.inf, math.inf, 0)
    if status == FOUND:
        assert np.abs(np.degrees(every[:, ANGLE]) + angle).min() < 1e-8
    else:
        assert status == NONE
        assert len(every) == 0


def test_an_object_below_a_thermocline_is_heard_along_three_rays():
    """h below a layer of gradient g a ray comes back at x = 2h/tanθ + 2 tanθ c/g: twice beyond 4 √(hc/g)."""
    water, h, g = layers([0, 10, 20, 60], [1520, 1520, 1500, 1500]), 5.0, 2.0
    nearest = 4.0 * math.sqrt(h * 1500.0 / g)
    assert len(every_ray(water, -25.0, -25.0, nearest - 0.01)) == 1
    x = nearest + 10.0
    found = every_ray(water, -25.0, -25.0, x)
    half = math.sqrt((x * g / 4.0 / 1500.0) ** 2 - h * g / 1500.0)
    slopes = [0.0, x * g / 6000.0 - half, x * g / 6000.0 + half]
    np.testing.assert_allclose(np.tan(found[:, ANGLE]), slopes, rtol=0, atol=1e-10)


def test_a_ray_that_turns_at_a_critical_angle_is_found():
    """It grazes the node: its neighbours pass above it on one side and turn below it on the other."""
    water = layers([0, 20, 40, 60], [1530, 1520, 1505, 1500])
    critical = math.degrees(math.acos(1505.0 / 1520.0))
    for x in (150.0, 260.0, 300.0):
        status, sent = shot(water, 40.0, -critical, x_end=x, bottom=60.0, surface=0.0)
        if status == RANGE and sent.sine < 0.0:
            found = every_ray(water, -40.0, sent.z, x)
            assert np.abs(np.degrees(found[:, ANGLE]) - critical).min() < 1e-8


@pytest.mark.parametrize(("g", "limit"), [(0.05, 1095.63), (0.5, 346.99), (5.0, 111.36)])
def test_sound_bent_upwards_leaves_the_bed_at_the_limiting_range(g, limit):
    shadows = find_shadows(water_of(*gradient(1500.0, g, 20.0)), 0.0, -20.0, -20.0, math.inf, 5000.0)
    assert shadows[0] == pytest.approx([limit, 5000.0], rel=1e-4)
    radius = (1500.0 + 20.0 * g) / g
    assert shadows[0, 0] == pytest.approx(math.sqrt(2.0 * radius * 20.0 - 400.0), rel=2e-5)


@pytest.mark.parametrize(("g", "limit"), [(-0.1, 1642.35), (-0.5, 733.01)])
def test_sound_bent_downwards_leaves_the_surface_at_the_limiting_range(g, limit):
    water = water_of(*gradient(1500.0, g, 40.0))
    shadows = find_shadows(water, -10.0, -40.0, -40.0, 0.0, 5000.0)
    assert shadows[0] == pytest.approx([limit, 5000.0], rel=1e-4)
    assert len(join_points(water, -10.0, -40.0, limit - 1.0, -40.0, 0.0, 0)) == 1
    assert len(join_points(water, -10.0, -40.0, limit + 1.0, -40.0, 0.0, 0)) == 0


def test_reflected_rays_of_even_water_are_those_of_the_images():
    water = water_of([-50.0, 0.0], [1500.0, 1500.0])
    found = join_points(water, -30.0, -40.0, 75.0, -50.0, 0.0, 5)
    # Of the n-th pair of mirrored waters, 50 m deep: heights of the two images, and their reflections.
    pairs = [((-40.0 + 100.0 * n, 2 * abs(n)), (40.0 + 100.0 * n, abs(2 * n + 1))) for n in range(-4, 5)]
    images = sorted(math.hypot(75.0, to + 30.0) for pair in pairs for to, count in pair if count <= 5)
    np.testing.assert_allclose(np.sort(found[:, TIME]) * 1500.0, images, rtol=1e-12)
    np.testing.assert_allclose(np.sort(found[:, TUBE]), images, rtol=1e-9)


def test_rays_along_a_duct_turn_many_times():
    found = every_ray(layers([0, 30, 60], [1520, 1500, 1520]), -29.0, -31.0, 800.0)
    assert found[:, TURNS].max() >= 4
    assert (found[:, COSINE] > 0.0).all()
    np.testing.assert_allclose(found[:, COSINE] ** 2 + found[:, SINE] ** 2, 1.0, rtol=1e-12)


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
    points, _ = followed(water, 10.0, -np.degrees(angles), np.linspace(0.0, 2500.0, 26))
    g, tilt = math.hypot(gx, gz), math.atan2(gx, gz)
    rise = points.z + 10.0
    up = points.x * math.sin(tilt) + rise * math.cos(tilt)
    level = points.x * math.cos(tilt) - rise * math.sin(tilt)
    c0 = 1500.0 - 10.0 * gz
    square = (level**2 + up**2)[:, 1:-1]
    time = np.arccosh(1.0 + g**2 * square / (2.0 * c0 * (c0 + g * up[:, 1:-1]))) / g
    np.testing.assert_allclose(points.time[:, 1:-1], time, rtol=1e-10)
    launch = np.arctan2(up[:, 1:-1] + 0.5 * g * square / c0, level[:, 1:-1])
    turned = np.where(np.isfinite(launch), angles[:, None] + tilt, np.nan)
    np.testing.assert_allclose(launch, turned, rtol=0, atol=1e-11)
    np.testing.assert_allclose(points.q[:, 1:-1], level[:, 1:-1] / np.cos(turned), rtol=1e-9)


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
    limits = RayLimits(x_end, -math.inf, math.inf, False, False)
    return follow_paths(water, z, np.array([angle]), np.array([x_end]), limits, plane)[0]


@settings(max_examples=50, deadline=None)
@given(st.tuples(*[SPEEDS] * 20), st.floats(-0.7, 0.7), st.floats(-45.0, -5.0), st.floats(5.0, 200.0))
def test_a_ray_sent_back_through_a_section_comes_back(speeds, angle, z, x):
    station, height = np.array([-50.0, 40.0, 90.0, 130.0, 300.0]), np.array([-50.0, -35.0, -18.0, 0.0])
    water = water_of(height, np.reshape(speeds, (5, 4)), station)
    there = through(water, SectionPlane(0.0, 1.0), z, angle, x)
    direction = math.atan2(-there.sine[0, 0], there.cosine[0, 0])
    back = through(water, SectionPlane(x, -1.0), there.z[0, 0], direction, x)
    assert back.z[0, 0] == pytest.approx(z, abs=1e-7)
    assert back.time[0, 0] == pytest.approx(there.time[0, 0], abs=1e-11)
    # The tube is the same both ways but for the speeds at its ends.
    ends = ((0.0, z), (x, there.z[0, 0]))
    here, afar = (through(water, SectionPlane(place, 1.0), at, 0.1, 1e-9).time[0, 0] for place, at in ends)
    if not (there.grazed.any() or back.grazed.any()):
        assert there.q[0, 0] * afar == pytest.approx(back.q[0, 0] * here, rel=1e-4, abs=1e-4 * x * here)


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
