"""Caustics at three frequencies: the exact field of n²-linear water, conservation of energy, records against waves."""

import itertools
import math
from functools import partial

import numpy as np
import pytest
from scipy.special import airy
from test_caustics import LAUNCH, RECEIVER, SOURCE, STEEPNESS, n2_linear, speed

from beds import arrays_of, poses_of
from insonify.kernels.common.scattering import backscatter_strength
from insonify.kernels.common.types import SONAR
from insonify.kernels.rays.caustics import AIRY_SQUARES, FAR, OCTAVE, STEPS, airy_field
from insonify.tracers import ray_sheets
from water import water_of

FREQUENCIES = [12e3, 120e3, 1e6]
NODES, WEIGHTS = np.polynomial.hermite_e.hermegauss(24)
RATIOS, WEIGHTS = np.exp(OCTAVE * NODES), WEIGHTS / WEIGHTS.sum()  # of the frequencies over which fringes are averaged


def averaged(intensity, frequency):
    """Intensity averaged over the octave that the program averages."""
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
    angle = NEAREST + np.linspace(-1.0, 1.0, 8_001) * min(half, 0.45)
    reached, time = lifted(angle)
    snell, window = np.cos(angle) / SPEED, np.cos(0.5 * np.pi * np.linspace(-1.0, 1.0, angle.size) ** 9)
    x = float(lifted(NEAREST)[0]) + np.linspace(low, high, 121) / math.cos(NEAREST)

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
