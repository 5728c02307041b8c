"""Reverberation, noise and time-varied gain, against the sonar equation."""

import itertools
import math
from functools import partial

import numpy as np
import pytest

from beds import arrays_of, tabulated_pattern
from insonify.acoustics.resolution_cell import coherence_angle, surface_echo, volume_echo
from insonify.display.normalisation import LevelBed, normalise
from insonify.kernels.common.types import TOP_HAT
from insonify.simulation import prepare
from receptions import decibels, received, reception, scene_with

BINS, BIN_LENGTH = 1000, 0.05
R = (np.arange(BINS) + 0.5) * BIN_LENGTH
FAN = math.radians(2.0)  # full width
TONE = {"kind": "tone", "duration": 2e-4}  # 15 cm, 3 bins


def arrays(width=FAN, bins=BINS, **options):
    return arrays_of(
        np.zeros((4, 4)), bins=bins, bin_length=BIN_LENGTH, half_width=0.5 * width, spreading=True, **options
    )


ready = partial(reception, BINS, half_width=0.5 * FAN, spreading=True)
record_of = partial(received, half_width=0.5 * FAN, spreading=True)
SILENCE = np.zeros((1, 2, BINS), np.float32)


def test_volume_reverberation_is_the_sonar_equation():
    # In the open: neither bed nor surface within range, so that Ψ is half a turn of the beam's sines.
    volume = {"kind": "volume", "volume_strength": -65.0}
    declared = {"receiver__reverberation": volume, "sonar__pulse": TONE}
    record = record_of(SILENCE, altitude=100.0, depth=100.0, **declared)[0, 0, 200:]
    solid_angle = 2.0 * math.sin(0.5 * FAN) * math.pi
    level = -65.0 + decibels(solid_angle * R[200:] ** 2 * 0.15) - 40.0 * np.log10(R[200:])
    # The pulse holds echoes of the 15 cm nearer, 7.5 cm on the average, where spreading is a little less.
    np.testing.assert_allclose(decibels(record), level, atol=0.07)
    assert np.abs(decibels(record[600:]) - level[600:]).max() < 0.02


def test_only_water_within_the_beam_reverberates():
    # A knife takes in a slab 1 m thick: per metre of range, half of its ring.
    np.testing.assert_allclose(volume_echo(arrays(0.0), 100.0, 100.0), math.pi * R * BIN_LENGTH / R**4, rtol=1e-9)
    # The shell between a surface 8 m above and a bed 5 m below, by Monte Carlo over directions of one side.
    rng = np.random.default_rng(0)
    echo = volume_echo(arrays(math.radians(20.0)), 5.0, 8.0)
    for k in (50, 130, 400, 900):
        along = rng.uniform(-1.0, 1.0, 1_000_000)
        up = np.sqrt(1.0 - along**2) * np.sin(rng.uniform(-0.5 * math.pi, 0.5 * math.pi, along.size))
        inside = (np.abs(along) < math.sin(math.radians(10.0))) & (up * R[k] < 8.0) & (up * R[k] > -5.0)
        expected = 2.0 * math.pi * inside.mean() * BIN_LENGTH / R[k] ** 2
        assert echo[k] == pytest.approx(expected, rel=0.02)


@pytest.mark.parametrize("width", [0.0, 0.02, 0.5])
def test_surface_reverberation_comes_from_the_ring_within_the_beam(width):
    depth = 12.34
    echo = surface_echo(arrays(width), depth) * R**4
    first = int(depth / BIN_LENGTH)
    assert not echo[:first].any()
    assert (echo[first:] > 0.0).all()
    # The ring's share within the cone |sin φ_b| = cos θ |sin φ| <= sin(w/2), finely summed.
    r = (np.arange(BINS * 200) + 0.5) * BIN_LENGTH / 200
    x = np.sqrt(np.maximum(r**2 - depth**2, 1e-12))
    azimuth = 2.0 * np.arcsin(np.minimum(math.sin(0.5 * width) * r / x, 1.0))
    density = np.where(r > depth, r * azimuth if width > 0.0 else r / x, 0.0) * BIN_LENGTH / 200
    expected = density.reshape(BINS, 200).sum(axis=1)
    # But for the bin in which the cone ceases to take in all azimuths.
    ratio = np.delete(echo[first + 2 :] / expected[first + 2 :], np.argmax(echo[first + 2 :]) if width else 0)
    np.testing.assert_allclose(ratio, 1.0, rtol=0.01)
    assert echo.sum() == pytest.approx(expected.sum(), rel=0.003)


def test_the_surface_is_heard_from_its_own_distance_and_adds_to_the_volume():
    surface = {"kind": "surface", "surface_strength": -20.0}
    record = record_of(SILENCE, depth=20.0, receiver__reverberation=surface, sonar__pulse="ideal")[0, 0]
    assert np.flatnonzero(record)[0] == 400
    # Far off, a strip r·θ wide and Δr long: -20 dB of it.
    expected = -20.0 + decibels(R * 2.0 * math.sin(0.5 * FAN) * BIN_LENGTH) - 40.0 * np.log10(R)
    assert decibels(record[-1]) == pytest.approx(expected[-1] + decibels(1.0 / math.sqrt(1.0 - 0.16)), abs=0.5)
    # For one depth in some 1500, the square of a float and the same square in an array differ in their last bit.
    for depth in np.random.default_rng(5).uniform(60.0, 600.0, 2000).tolist():
        assert not surface_echo(arrays(bins=8), depth).any(), "beyond the record"
    each = [record_of(SILENCE, receiver__reverberation=kind) for kind in ("volume", "surface", "both")]
    np.testing.assert_allclose(each[0] + each[1], each[2], rtol=1e-6)


@pytest.mark.parametrize("source_level", [0.0, 220.0])
def test_noise_is_exponential_about_its_level_whatever_the_source_that_scales_the_echo(source_level):
    silence, noise = np.zeros((200, 2, BINS), np.float32), {"kind": "ambient", "level": 55.0}
    record = record_of(silence, receiver__noise=noise, receiver__source_level=source_level).astype(float)
    n = record.size / (1.0 + 2.0 / 9.0)
    assert decibels(record.mean()) == pytest.approx(55.0, abs=3.0 * decibels(math.e) / math.sqrt(n))
    assert record.std() / record.mean() == pytest.approx(1.0, abs=3.0 * math.sqrt(2.0 / n))
    traced = np.full((1, 2, 50), 1e-9, np.float32)
    echo = record_of(traced, receiver__source_level=source_level, sonar__pulse="ideal").astype(float)
    np.testing.assert_allclose(decibels(echo), source_level - 90.0, atol=1e-4)


def tvg(spreading=30.0, absorption=0.0):
    return {"kind": "power", "spreading": spreading, "absorption": absorption}


def test_the_gain_is_spreading_log_r_and_2_alpha_r_of_the_water_where_left_out():
    traced = np.full((1, 2, BINS), 1e-6, np.float32)
    for spreading, absorption in itertools.product((20.0, 30.0, 40.0), (0.0, 120.0)):
        record = record_of(traced, receiver__tvg=tvg(spreading, absorption), sonar__pulse="ideal")[0, 0]
        expected = spreading * np.log10(R) + 2.0 * absorption * R / 1e3
        np.testing.assert_allclose(decibels(record.astype(float)) + 60.0, expected, atol=1e-4)
    own, given = ready(water__absorption=97.0, receiver__tvg="power"), ready(receiver__tvg=tvg(30.0, 97.0))
    np.testing.assert_allclose(own.gain, given.gain, rtol=1e-12)


def test_the_gain_that_fits_the_bed_makes_it_even():
    # A fan over a level Lambert bed falls by 50 log r far out, so 50 log r is what it takes.
    level = {"seabed__relief": "flat", "seabed__material": {"diffuse": 0.5, "specular": 0.0}, "targets": []}
    simulation = prepare(scene_with(**level, track__altitude=2.0, receiver__tvg=tvg(50.0)))
    record = simulation.intensity(np.arange(1))[0, 0, 300:]
    assert np.ptp(decibels(record)) < 0.2


def test_the_gain_stops_where_the_bed_sinks_into_the_noise():
    noise = {"kind": "ambient", "level": -70.0}
    quiet, loud = (ready(receiver__tvg=tvg(40.0), receiver__noise=n) for n in ("none", noise))
    np.testing.assert_allclose(quiet.gain, R**4, rtol=1e-9)
    clipped = np.flatnonzero(loud.gain < quiet.gain)
    first = clipped[0]
    # Perfect Lambert bed: S_b + 10 log A − 40 log r, at grazing asin(10/r).
    bed = decibels((10.0 / R) ** 2 / math.pi * R * 2.0 * math.sin(0.5 * FAN) * 0.075) - 40.0 * np.log10(R)
    bed += decibels(R / np.sqrt(np.maximum(R**2 - 100.0, 1.0))) * (R > 10.1)
    assert 250 < first < 900
    assert bed[first] == pytest.approx(-70.0, abs=1.0)
    assert (loud.gain[first - 1 :] == loud.gain[first - 1]).all()
    np.testing.assert_array_equal(loud.gain[:first], quiet.gain[:first])
    # Beyond all bounds it is clipped too: 20 dB a metre of a water that takes nothing.
    traced = np.full((1, 2, BINS), 1e-4, np.float32)
    for source_level in (0.0, 300.0):
        record = record_of(traced, receiver__tvg=tvg(40.0, 1e4), receiver__source_level=source_level)
        assert np.isfinite(record).all()
        assert (np.diff(record[0, 0]) >= 0.0).all()


@pytest.mark.parametrize(
    "receiver",
    [
        {"tvg": {"kind": "power"}, "source_level": 210.0},
        {"tvg": {"kind": "power"}, "source_level": 210.0, "noise": {"kind": "ambient", "level": 100.0}},
        {"noise": {"kind": "ambient", "level": -85.0}},
    ],
)
def test_an_even_bed_still_looks_even(receiver):
    level = {"seabed__relief": "flat", "seabed__material": {"diffuse": 1.0, "specular": 0.0}, "targets": []}
    simulation = prepare(scene_with(**level, receiver=receiver))
    pings = np.arange(256)
    amplitude = normalise(simulation.intensity(pings), LevelBed(simulation).curves(pings))
    mean = (amplitude[:, :, 210:].astype(float) ** 2).mean(axis=(0, 1))
    np.testing.assert_allclose(mean, 1.0, atol=0.25)
    assert mean.reshape(-1, 79).mean(axis=1) == pytest.approx(1.0, abs=0.04)


def tabulated(width, columns=4001, **vertical):
    """A scene whose pattern is a table of the top-hat, twice as broad as it."""
    s, half = np.linspace(-1.0, 1.0, columns) * 2.0 * math.sin(0.5 * width), math.sin(0.5 * width)
    energy = np.clip((half - np.abs(s)) / (s[1] - s[0]) + 0.5, 0.0, 1.0)
    return arrays(width, pattern=tabulated_pattern(s[-1], energy, **vertical))


def test_a_tabled_beam_hears_what_its_top_hat_hears_and_a_vertical_one_its_share_of_the_water():
    table, plain = tabulated(0.05), arrays(0.05)
    np.testing.assert_allclose(coherence_angle(table), coherence_angle(plain), rtol=1e-3)
    np.testing.assert_allclose(volume_echo(table, 10.0, 20.0), volume_echo(plain, 10.0, 20.0), rtol=1e-3)
    one, other = surface_echo(table, 12.0)[245:], surface_echo(plain, 12.0)[245:]
    np.testing.assert_allclose(one, other, rtol=0.02)
    assert one.sum() == pytest.approx(other.sum(), rel=3e-3)
    # 40° about 30° below the horizontal: neither the surface nor 40/180 of the shell more.
    options = {"vertical": TOP_HAT, "tilt": math.radians(30.0), "s_vertical": math.sin(math.radians(20.0))}
    fan, open_water = tabulated(0.05, **options), 100.0
    assert not surface_echo(fan, 12.0).any()
    ratio = volume_echo(fan, open_water, open_water) / volume_echo(table, open_water, open_water)
    np.testing.assert_allclose(ratio, 40.0 / 180.0, rtol=2e-3)
