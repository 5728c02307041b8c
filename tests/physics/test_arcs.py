"""Rays through layered water against closed forms and printed numbers."""

import csv
import math
from pathlib import Path

import numpy as np
import pytest

from insonify.acoustics.rays import follow_paths
from insonify.kernels.refraction.arcs import HIGH, RANGE
from insonify.kernels.refraction.eigenrays import FOUND, follow_to_range
from insonify.kernels.refraction.ray_paths import RayLimits
from water import NO_CEILING, NO_FLOOR, gradient, joined, launched, layers, shot, water_of

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
