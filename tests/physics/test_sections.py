"""Rays through water that differs along their way."""

from __future__ import annotations

import math

import numpy as np
import pytest

from insonify.kernels.paths import ON_BED
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
