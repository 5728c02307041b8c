"""Rays through layered water against closed forms and printed numbers; those that join two points, all and exactly."""

import csv
import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from insonify.acoustics.rays import find_shadows, follow_paths, join_points
from insonify.kernels.refraction.arcs import HIGH, RANGE
from insonify.kernels.refraction.eigenray_search import ANGLE, COSINE, GRAZED, SINE, TIME, TUBE, TURNS
from insonify.kernels.refraction.eigenrays import FOUND, NONE, follow_to_range
from insonify.kernels.refraction.ray_paths import RayLimits
from water import NO_CEILING, NO_FLOOR, followed, gradient, joined, launched, layers, shot, water_of

BELLHOP = Path(__file__).parents[3] / "shared/data/bellhop"
LAYERED = layers([0, 10, 20, 60], [1520, 1520, 1500, 1498])


def rows(name):
    if not BELLHOP.is_dir():
        pytest.skip(f"{BELLHOP} is absent")
    with (BELLHOP / name).open() as file:
        return list(csv.DictReader(file))


def test_rays_through_layers_are_the_exact_ones_beside_bellhop():
    for row in rows("layered_bottom_hits.csv"):
        _, ray = shot(LAYERED, 5.0, float(row["launch_deg_down"]), bottom=60.0)
        assert ray.x == pytest.approx(float(row["r_exact_m"]), abs=1e-8)
        assert ray.time == pytest.approx(float(row["t_exact_s"]), abs=1e-12)
        assert ray.q == pytest.approx(float(row["q_exact_m_per_rad"]), rel=1e-11)
        assert math.degrees(math.asin(-ray.sine)) == pytest.approx(float(row["grazing_deg_exact"]), abs=1e-10)


def test_rays_through_one_gradient_are_the_exact_ones_beside_bellhop():
    water = gradient(1500.0, 0.05)
    for row in rows("linear_ray_points.csv"):
        status, ray = shot(water, 500.0, float(row["launch_deg_down"]), x_end=float(row["r_m"]))
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


@st.composite
def waters(draw):
    """Layers whose speeds differ by up to 15 m/s."""
    speeds = [draw(st.floats(1490.0, 1505.0)) for _ in HEIGHT]
    return HEIGHT, np.array(speeds)


def every_ray(water, z_from, z_to, x, most=0):
    return join_points(water_of(*water), z_from, z_to, x, -60.0, 0.0, most)


def speed_at(water, z):
    return float(np.interp(z, *water))


@settings(max_examples=60, deadline=None)
@given(waters(), st.floats(-59.0, -1.0), st.floats(-85.0, 85.0), st.floats(0.5, 400.0))
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
@given(waters(), st.floats(-59.0, -1.0), st.floats(-59.0, -1.0), st.floats(0.5, 400.0))
@example(ALONG_AN_EDGE, -38.0, -43.5, 400.0)
def test_every_ray_goes_both_ways_in_the_same_time_with_the_same_spreading(water, z_from, z_to, x):
    there, back = every_ray(water, z_from, z_to, x), every_ray(water, z_to, z_from, x)
    assert len(there) == len(back)
    there, back = there[there[:, TIME].argsort()], back[back[:, TIME].argsort()]
    np.testing.assert_allclose(there[:, TIME], back[:, TIME], rtol=0, atol=1e-13)
    sound = (there[:, GRAZED] == 0.0) & (np.abs(there[:, TUBE]) > 1e-2 * x)
    apart = np.diff(there[:, TIME], prepend=-1.0, append=9.0)
    sound &= (apart[1:] > 1e-9) & (apart[:-1] > 1e-9)
    ours = there[sound, TUBE] * speed_at(water, z_from)
    np.testing.assert_allclose(ours, back[sound, TUBE] * speed_at(water, z_to), rtol=1e-5)


@settings(max_examples=30, deadline=None)
@given(waters(), st.floats(-59.0, -1.0), st.floats(-59.0, -1.0), st.floats(20.0, 400.0))
def test_no_ray_of_a_fine_fan_is_lost(water, z_from, z_to, x):
    """The slow twin: between two neighbours of a fan that pass on either side of the point there is a ray to it."""
    angles = np.linspace(-60.0, 60.0, 4001)
    fan, _ = followed(water_of(*water), -z_from, angles, [x], bottom=60.0, surface=0.0)
    miss = np.where(fan.x[:, 0] == x, fan.z[:, 0] - z_to, np.nan)
    # Neighbours that are far apart have the brink of a shadow between them.
    near = np.abs(np.diff(miss)) < 0.5
    between = np.flatnonzero((miss[:-1] * miss[1:] < 0.0) & near)
    found = -np.degrees(every_ray(water, z_from, z_to, x)[:, ANGLE])
    for k in between:
        assert ((found > angles[k] - 1e-9) & (found < angles[k + 1] + 1e-9)).any()
    steep = found[np.abs(found) < 60.0]
    for angle in steep:
        status, ray = shot(water, -z_from, angle, x_end=x, bottom=60.0, surface=0.0)
        assert status == RANGE
        assert ray.z == pytest.approx(z_to, abs=1e-6 + 1e-9 * abs(ray.q))


@settings(max_examples=60, deadline=None)
@given(waters(), st.floats(-59.0, -1.0), st.floats(-59.0, -1.0), st.floats(0.5, 300.0))
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
