"""Caustics against closed forms: n²-linear water, a gradient below even water, the Airy function."""

import math

import numpy as np
import pytest
from pydantic import TypeAdapter
from scipy.special import airy

import insonify
from insonify.acoustics.paths import airy_pressure
from insonify.kernels.refraction.arcs import HIGH, LOW
from insonify.kernels.refraction.eigenrays import follow_to_range
from insonify.scene.water import AnyWater
from water import layers, shot

# Pedersen and Gordon's water: 1/c² = (1 + 2.4 z/1550)/1550² over depth; source at 1000 m, receiver at 800 m.
SURFACE, SOURCE, RECEIVER = 1550.0, 1000.0, 800.0
STEEPNESS = 2.4 / SURFACE**3
CAUSTIC, LAUNCH = 3085.190882, 46.85453


def speed(depth):
    return SURFACE / np.sqrt(1.0 + 2.4 * np.asarray(depth) / SURFACE)


def n2_linear(degrees_up, depth):
    """Range, time and tube at a depth met going down again: x = ξσ, z = z0 + ζ0 σ + bσ²/4."""
    c0, angle = float(speed(SOURCE)), math.radians(degrees_up)
    xi, zeta = math.cos(angle) / c0, -math.sin(angle) / c0
    sigma = 2.0 * (-zeta + math.sqrt(zeta**2 - STEEPNESS * (SOURCE - depth))) / STEEPNESS
    time = sigma / c0**2 + STEEPNESS * zeta * sigma**2 / 2.0 + STEEPNESS**2 * sigma**3 / 12.0
    return xi * sigma, time, float(speed(depth)) * sigma * (1.0 / c0**2 + STEEPNESS * zeta * sigma / 2.0)


def cut(count):
    depth = np.linspace(0.0, 1200.0, count)
    return layers(depth, speed(depth))


def layered(water, degrees_up):
    """Range, time and tube at the receiver's depth, met going down again."""
    status, up = shot(water, SOURCE, -degrees_up, surface=-RECEIVER)
    assert status == HIGH
    status, ray = follow_to_range(*water, up, math.inf, -RECEIVER, math.inf)
    assert status == LOW
    return ray.x, ray.time, ray.q


def farthest(trace):
    """Launch angle that comes farthest, and its range."""
    angles = np.linspace(46.6, 47.1, 251)
    ranges = [trace(angle)[0] for angle in angles]
    return angles[int(np.argmax(ranges))], max(ranges)


def test_the_caustic_of_n2_linear_water_is_where_it_is_printed():
    assert n2_linear(LAUNCH, RECEIVER)[0] == pytest.approx(CAUSTIC, abs=1e-6)
    assert n2_linear(LAUNCH, RECEIVER)[2] == pytest.approx(0.0, abs=1e-3)
    assert farthest(lambda angle: n2_linear(angle, RECEIVER))[1] == pytest.approx(CAUSTIC, rel=1e-7)


def test_layers_put_the_caustic_where_n2_linear_water_has_it():
    misses = []
    for count in (121, 481, 1921):
        water = cut(count)
        angle, x = farthest(lambda angle: layered(water, angle))  # noqa: B023
        misses.append(abs(x - CAUSTIC) / CAUSTIC)
        assert abs(angle - LAUNCH) < 0.3
    assert misses[-1] < 1e-5
    # The layer in which rays turn sets the pace: its thickness to the power of 3/2.
    slope = np.polyfit(np.log([1.0, 0.25, 0.0625]), np.log(misses), 1)[0]
    assert slope == pytest.approx(1.5, abs=0.15)


@pytest.mark.parametrize("degrees_up", [30.0, 46.85453, 50.0])
def test_rays_through_fine_layers_are_those_of_n2_linear_water(degrees_up):
    exact, fine = n2_linear(degrees_up, RECEIVER), layered(cut(1921), degrees_up)
    assert fine[0] == pytest.approx(exact[0], rel=3e-5)
    assert fine[1] == pytest.approx(exact[1], rel=3e-5)


@pytest.mark.parametrize("degrees_up", [20.0, 50.0, 80.0])
def test_the_tube_through_fine_layers_is_that_of_n2_linear_water_until_rays_turn(degrees_up):
    c0, angle = float(speed(SOURCE)), math.radians(degrees_up)
    zeta = -math.sin(angle) / c0
    depth = SOURCE - 60.0
    sigma = 2.0 * (-zeta - math.sqrt(zeta**2 - STEEPNESS * 60.0)) / STEEPNESS
    exact = float(speed(depth)) * sigma * (1.0 / c0**2 + STEEPNESS * zeta * sigma / 2.0)
    errors = []
    for count in (241, 481, 961):
        _, ray = shot(cut(count), SOURCE, -degrees_up, surface=-depth)
        errors.append(abs(ray.q / exact - 1.0))
    assert errors[-1] < 2e-5
    assert np.polyfit(np.log([4.0, 2.0, 1.0]), np.log(errors), 1)[0] == pytest.approx(2.0, abs=0.2)


def test_a_gradient_above_even_water_sends_a_caustic_back_to_the_sources_depth():
    """There x = 2h/tanθ + 2 tanθ c/g is shortest: at tan²θ = hg/c."""
    h, g = 5.0, 2.0
    fields = {"kind": "profile", "depth": [0, 10, 20, 60], "sound_speed": [1520, 1520, 1500, 1500]}
    water = TypeAdapter(AnyWater).validate_python(fields)
    angle = -math.degrees(math.atan(math.sqrt(h * g / 1500.0)))
    found = insonify.caustics(water, 25.0, [angle, 5.0], max_range=1000.0, bottom=60.0)
    np.testing.assert_allclose(found.range, [4.0 * math.sqrt(h * 1500.0 / g)], rtol=1e-12)
    np.testing.assert_allclose(found.depth, [25.0], rtol=1e-12)
    np.testing.assert_allclose(found.angle, [angle])
    rays = insonify.eigenrays(water, 25.0, float(found.range[0]) + 1e-3, 25.0)
    assert abs(rays.time - float(found.time[0])).min() < 1e-6


def test_many_caustics_are_all_found():
    fields = {"kind": "profile", "depth": [0, 30, 60], "sound_speed": [1530, 1500, 1530]}
    water = TypeAdapter(AnyWater).validate_python(fields)
    angles = -np.linspace(0.5, 10.0, 40)
    found = insonify.caustics(water, 25.0, angles, max_range=5000.0)
    paths = insonify.ray_paths(water, 25.0, angles, max_range=5000.0, ranges=np.linspace(1.0, 5000.0, 20_000))
    changes = (np.diff(np.signbit(paths.tube.values), axis=1) & np.isfinite(paths.tube.values[:, 1:])).sum()
    assert found.sizes["caustic"] == changes > 256


def test_the_airy_form_is_exact_where_sound_is_an_airy_function():
    """∫exp i(s³/3 − ρs) ds = 2π Ai(−ρ): its two rays have the amplitude √π ρ^−¼ and are 4ρ^{3/2}/3 apart in phase."""
    rho, frequency = np.array([1e-6, 0.3, 1.0, 1.7, 30.0]), 100e3
    delay = 4.0 / 3.0 * rho**1.5 / (2.0 * math.pi * frequency)
    amplitude = math.sqrt(math.pi) * rho**-0.25
    pressure = airy_pressure(frequency, (0.0, delay), (amplitude, amplitude))
    np.testing.assert_allclose(pressure, 2.0 * math.pi * np.abs(airy(-rho)[0]), rtol=1e-4)


def test_far_from_the_caustic_the_airy_form_is_two_waves():
    frequency, delay = 100e3, np.linspace(2e-3, 2.01e-3, 50)
    pressure = airy_pressure(frequency, (0.0, delay), (1.0, 0.4))
    # The ray that has touched the caustic is a quarter of a turn ahead.
    waves = np.abs(1.0 + 0.4 * np.exp(1j * (2.0 * math.pi * frequency * delay - math.pi / 2.0)))
    np.testing.assert_allclose(pressure, waves, atol=1e-3)
