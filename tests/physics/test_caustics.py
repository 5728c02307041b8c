"""Caustics against closed forms: n²-linear water, a gradient below even water, the Airy function.

At three frequencies: the exact field of n²-linear water, conservation of energy, records against waves.
"""

import itertools
import math
from functools import partial

import numpy as np
import pytest
from scipy.special import airy

import insonify
from beds import arrays_of, poses_of
from insonify.acoustics.paths import airy_pressure
from insonify.kernels.common.scattering import backscatter_strength
from insonify.kernels.common.types import SONAR
from insonify.kernels.rays.caustics import AIRY_SQUARES, FAR, OCTAVE, STEPS, airy_field
from insonify.kernels.refraction.arcs import HIGH, LOW
from insonify.kernels.refraction.eigenrays import follow_to_range
from insonify.scene.water.layered import ProfileWater
from insonify.tracers import ray_sheets
from water import layers, shot, water_of

# Pedersen and Gordon's water: 1/c² = (1 + 2.4 z/1550)/1550² over depth; source at 1000 m, receiver at 800 m.
SURFACE, SOURCE, RECEIVER = 1550.0, 1000.0, 800.0
STEEPNESS = 2.4 / SURFACE**3
CAUSTIC, LAUNCH = 3085.190882, 46.85453


def speed(depth):
    return SURFACE / np.sqrt(1.0 + 2.4 * np.asarray(depth) / SURFACE)


def n2_linear(degrees_up, depth, way=1.0):
    """Range, time and tube at a depth met going down again, or up (way -1): x = ξσ, z = z0 + ζ0 σ + bσ²/4."""
    c0, angle = float(speed(SOURCE)), math.radians(degrees_up)
    xi, zeta = math.cos(angle) / c0, -math.sin(angle) / c0
    sigma = 2.0 * (-zeta + way * math.sqrt(zeta**2 - STEEPNESS * (SOURCE - depth))) / STEEPNESS
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


def test_layers_put_the_caustic_where_n2_linear_water_has_it_as_printed():
    assert n2_linear(LAUNCH, RECEIVER)[0] == pytest.approx(CAUSTIC, abs=1e-6)
    assert n2_linear(LAUNCH, RECEIVER)[2] == pytest.approx(0.0, abs=1e-3)
    assert farthest(partial(n2_linear, depth=RECEIVER))[1] == pytest.approx(CAUSTIC, rel=1e-7)
    misses = []
    for count in (121, 481, 1921):
        angle, x = farthest(partial(layered, cut(count)))
        misses.append(abs(x - CAUSTIC) / CAUSTIC)
        assert abs(angle - LAUNCH) < 0.3
    assert misses[-1] < 1e-5
    # The layer in which rays turn sets the pace: its thickness to the power of 3/2.
    slope = np.polyfit(np.log([1.0, 0.25, 0.0625]), np.log(misses), 1)[0]
    assert slope == pytest.approx(1.5, abs=0.15)


@pytest.mark.parametrize("degrees_up", [30.0, 46.85453, 50.0])
def test_rays_through_fine_layers_are_those_of_n2_linear_water(degrees_up):
    exact, fine = n2_linear(degrees_up, RECEIVER), layered(cut(1921), degrees_up)
    assert fine[:2] == pytest.approx(exact[:2], rel=3e-5)


@pytest.mark.parametrize("degrees_up", [20.0, 50.0, 80.0])
def test_the_tube_through_fine_layers_is_that_of_n2_linear_water_until_rays_turn(degrees_up):
    depth = SOURCE - 60.0
    exact, errors = n2_linear(degrees_up, depth, -1.0)[2], []
    for count in (241, 481, 961):
        _, ray = shot(cut(count), SOURCE, -degrees_up, surface=-depth)
        errors.append(abs(ray.q / exact - 1.0))
    assert errors[-1] < 2e-5
    assert np.polyfit(np.log([4.0, 2.0, 1.0]), np.log(errors), 1)[0] == pytest.approx(2.0, abs=0.2)


def test_a_gradient_above_even_water_sends_a_caustic_back_to_the_sources_depth():
    """There x = 2h/tanθ + 2 tanθ c/g is shortest: at tan²θ = hg/c."""
    h, g = 5.0, 2.0
    water = ProfileWater(depth=[0, 10, 20, 60], sound_speed=[1520, 1520, 1500, 1500])
    angle = -math.degrees(math.atan(math.sqrt(h * g / 1500.0)))
    found = insonify.caustics(water, 25.0, [angle, 5.0], max_range=1000.0, bottom=60.0)
    np.testing.assert_allclose(found.range, [4.0 * math.sqrt(h * 1500.0 / g)], rtol=1e-12)
    np.testing.assert_allclose(found.depth, [25.0], rtol=1e-12)
    np.testing.assert_allclose(found.angle, [angle])
    rays = insonify.eigenrays(water, 25.0, float(found.range[0]) + 1e-3, 25.0)
    assert abs(rays.time - float(found.time[0])).min() < 1e-6
    # On it spreading is endless, and no error.
    assert (insonify.eigenrays(water, 25.0, 4.0 * math.sqrt(h * 1500.0 / g) + 1e-9, 25.0).intensity > 0.0).all()


def test_many_caustics_are_all_found():
    water = ProfileWater(depth=[0, 30, 60], sound_speed=[1530, 1500, 1530])
    angles = -np.linspace(0.5, 10.0, 40)
    found = insonify.caustics(water, 25.0, angles, max_range=5000.0)
    paths = insonify.ray_paths(water, 25.0, angles, max_range=5000.0, ranges=np.linspace(1.0, 5000.0, 20_000))
    changes = (np.diff(np.signbit(paths.tube.values), axis=1) & np.isfinite(paths.tube.values[:, 1:])).sum()
    assert found.sizes["caustic"] == changes > 256


def test_the_airy_form_is_exact_where_sound_is_an_airy_function_and_two_waves_far_from_the_caustic():
    """∫exp i(s³/3 − ρs) ds = 2π Ai(−ρ): its two rays have the amplitude √π ρ^−¼ and are 4ρ^{3/2}/3 apart in phase."""
    rho, frequency = np.array([1e-6, 0.3, 1.0, 1.7, 30.0]), 100e3
    delay = 4.0 / 3.0 * rho**1.5 / (2.0 * math.pi * frequency)
    amplitude = math.sqrt(math.pi) * rho**-0.25
    pressure = airy_pressure(frequency, (0.0, delay), (amplitude, amplitude))
    np.testing.assert_allclose(pressure, 2.0 * math.pi * np.abs(airy(-rho)[0]), rtol=1e-4)
    delay = np.linspace(2e-3, 2.01e-3, 50)
    pressure = airy_pressure(frequency, (0.0, delay), (1.0, 0.4))
    # The ray that has touched the caustic is a quarter of a turn ahead.
    waves = np.abs(1.0 + 0.4 * np.exp(1j * (2.0 * math.pi * frequency * delay - math.pi / 2.0)))
    np.testing.assert_allclose(pressure, waves, atol=1e-3)


FREQUENCIES = [12e3, 120e3, 1e6]
NODES, WEIGHTS = np.polynomial.hermite_e.hermegauss(24)
RATIOS, WEIGHTS = np.exp(OCTAVE * NODES), WEIGHTS / WEIGHTS.sum()  # of the frequencies over which fringes are averaged


def averaged(intensity, frequency):
    return sum(weight * intensity(frequency * ratio) for ratio, weight in zip(RATIOS, WEIGHTS))


def test_the_table_is_airys_function_over_an_octave():
    rho = np.linspace(-FAR, FAR, AIRY_SQUARES.size)
    exact = averaged(lambda ratio: airy(-rho * ratio ** (2.0 / 3.0))[0] ** 2 * ratio ** (1.0 / 3.0), 1.0)
    np.testing.assert_allclose(AIRY_SQUARES, exact, atol=2e-3)
    # Up to ρ rays bring √ρ/π of energy, and at FAR two rays are twice 1 / 4π√ρ.
    assert np.trapezoid(AIRY_SQUARES) / STEPS == pytest.approx(math.sqrt(FAR) / math.pi, rel=0.005)
    assert 2.0 * math.pi * math.sqrt(FAR) * AIRY_SQUARES[-1] == pytest.approx(1.0, abs=0.025)


def exact_field(frequency, x, half):
    """|p|² at the receiver of the sound that goes up and turns, relative to 1 m, by the integral over wave numbers.

    Only launch angles up to ``half`` from that of the caustic count. Over height both solutions are Airy functions of
    s = (ω²/c² - k²) / κ², κ³ = ω²b; Bi + i Ai goes downwards.
    """
    omega = 2.0 * math.pi * frequency
    kappa = (omega * omega * STEEPNESS) ** (1.0 / 3.0)
    angle = math.radians(LAUNCH) + np.linspace(-half, half, 8_001)
    k = omega * np.cos(angle) / float(speed(SOURCE))
    downwards = np.ones(k.size, complex)
    for depth in (SOURCE, RECEIVER):
        value, _, other, _ = airy(-((omega / float(speed(depth))) ** 2 - k * k) / kappa**2)
        downwards *= other + 1j * value
    window = np.cos(0.5 * np.pi * np.linspace(-1.0, 1.0, k.size) ** 7)
    spectrum = math.pi / kappa * downwards * np.sqrt(k / (2.0 * math.pi)) * window
    waves = spectrum * np.exp(1j * (k - k[k.size // 2]) * x[:, None]) / np.sqrt(x[:, None])
    return np.abs(np.trapezoid(waves, k, axis=1)) ** 2


def tube_and_change(degrees_up):
    """Range, tube on its own front, growth of the tube with the launch angle, and slowness across the ray."""
    step = 1e-4
    near, here, far = (np.array(n2_linear(degrees_up + math.degrees(a), RECEIVER)) for a in (-step, 0.0, step))
    first, second = (far[0] - near[0]) / (2.0 * step), (far[0] - 2.0 * here[0] + near[0]) / step**2
    snell = math.cos(math.radians(degrees_up)) / float(speed(SOURCE))
    sine = math.sqrt(1.0 - (snell * float(speed(RECEIVER))) ** 2)
    return here[0], first * sine, second * sine, -math.sin(math.radians(degrees_up)) / float(speed(SOURCE)) / sine


@pytest.mark.parametrize("frequency", FREQUENCIES)
def test_the_field_is_that_of_n2_linear_water(frequency):
    caustic, _, change, slowness = tube_and_change(LAUNCH)
    unit = airy_field(1.0, change, 2.0 * math.pi * frequency * slowness)[1]
    apart = math.degrees(unit / abs(change))
    # Of one intensity the pressure is greater where sound is faster.
    faster = float(speed(RECEIVER) / speed(SOURCE))
    found, places = [], []
    for rho, side in itertools.product((0.04, 0.3, 1.0), (-1.0, 1.0)):
        degrees_up = LAUNCH + side * apart * math.sqrt(rho)
        x, tube, change, slowness = tube_and_change(degrees_up)
        field, _ = airy_field(tube, change, 2.0 * math.pi * frequency * slowness)
        both = 2.0 * faster * math.cos(math.radians(degrees_up)) / (x * abs(tube)) * field.focus
        found += [both, both * field.dark]
        places += [x, 2.0 * caustic - x]
    exact = averaged(partial(exact_field, x=np.array(places), half=12.0 * math.radians(apart)), frequency)
    shares = np.reshape(np.array(found) / exact, (3, 2, 2)).mean(axis=1)
    assert (np.abs(shares - 1.0) <= np.array([[0.005], [0.01], [0.035]])).all(), shares


# Water that bends down whatever rises above 45 m over the bed, which has its caustic at tan²θ = hg/2c of even height h.
SONAR_HEIGHT, LAYER, EVEN, GRADIENT, SPEED = 40.0, 45.0, 50.0, 20.0, 1500.0
WATER = water_of([0.0, LAYER, LAYER + 100.0], [SPEED, SPEED, SPEED + 100.0 * GRADIENT], surface=LAYER + 100.0)
NEAREST = math.atan(math.sqrt(0.5 * EVEN * GRADIENT / SPEED))


def lifted(angle):
    """Ground range and time of rays that rise, turn in the gradient and come down to the bed."""
    x = EVEN / np.tan(angle) + 2.0 * np.tan(angle) * SPEED / GRADIENT
    return x, EVEN / (np.sin(angle) * SPEED) + 2.0 / GRADIENT * np.arctanh(np.sin(angle))


def wave_energy(frequency, low, high):
    """Energy from a level bed between two distances from the caustic, m of slant range, by an integral over angles.

    p = ∫ √(cosθ ω|ξ'| / 2πx sinγ) exp iω(T + ξ(x - X)) dθ is right on the caustic and off it (Maslov). A bed that a
    knife crosses, 1 m wide, returns ∫ σ |p|⁴ dx.
    """
    # Twelve times the angle over which a wave is in phase: ω ξ' x'' δ³ = 2.
    curvature = 2.0 * EVEN / math.tan(NEAREST) ** 3 / math.cos(NEAREST) ** 4
    half = 12.0 * (2.0 * SPEED / (2.0 * math.pi * frequency * math.sin(NEAREST) * curvature)) ** (1.0 / 3.0)
    angle = NEAREST + np.linspace(-1.0, 1.0, 4_001) * min(half, 0.45)
    reached, time = lifted(angle)
    snell, window = np.cos(angle) / SPEED, np.cos(0.5 * np.pi * np.linspace(-1.0, 1.0, angle.size) ** 9)
    x = float(lifted(NEAREST)[0]) + np.linspace(low, high, 81) / math.cos(NEAREST)

    def intensity(frequency):
        omega = 2.0 * math.pi * frequency
        amplitude = window * np.sqrt(np.cos(angle) * omega / SPEED / (2.0 * math.pi))
        waves = [amplitude * np.exp(1j * omega * (time + snell * (place - reached))) for place in x]
        return np.abs(np.trapezoid(waves, angle, axis=1)) ** 2 / x

    strength = backscatter_strength(math.sin(NEAREST), 1.0, 0.0, 1.0, SONAR)
    return float(np.trapezoid(strength * averaged(intensity, frequency) ** 2, x))


@pytest.mark.parametrize("frequency", FREQUENCIES)
def test_a_level_bed_echoes_as_waves_do_about_its_caustic(frequency):
    scale = (12e3 / frequency) ** (2.0 / 3.0)
    length = 0.02 * scale
    bins = int(190.0 / length)
    arrays = arrays_of(np.zeros((8, 8)), 8.0, periodic=True, bins=bins, bin_length=length, spreading=True)
    arrays = arrays._replace(water=WATER._replace(wavelength=SPEED / frequency))
    record = ray_sheets.trace(arrays, poses_of(0.0, 0.0, SONAR_HEIGHT), sheets=1, rays=4096)[0, 0].astype(float)
    caustic = SPEED * float(lifted(NEAREST)[1])
    for low, high, bound in ((-0.5 * scale, 0.0, 0.1), (0.0, scale, 0.03)):
        first, last = (round((caustic + at) / length) for at in (low, high))
        right = wave_energy(frequency, first * length - caustic, last * length - caustic)
        assert record[first:last].sum() == pytest.approx(right, rel=bound)
