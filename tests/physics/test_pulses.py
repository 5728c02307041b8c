"""Pulses: resolution, sidelobes and energy, against closed forms."""

import math

import numpy as np
import pytest

from insonify.acoustics.pulses import coherence, coherent_taps, envelope, pulse_taps
from insonify.scene.sonar.pulses import Chirp, Ideal, Tone
from receptions import received

SPEED = 1500.0
BANDWIDTH = 30e3
CELL = SPEED / (2.0 * BANDWIDTH)  # 2.5 cm
WINDOWS = ["uniform", "hamming", "hann"]
# ∫W² B / (∫W)² of each window: 1, 1 + b²/2a².
ENERGY = {"uniform": 1.0, "hamming": 1.0 + 0.5 * (0.46 / 0.54) ** 2, "hann": 1.5}


def chirp(window, duration=2e-3):
    return Chirp(duration=duration, bandwidth=BANDWIDTH, window=window)


def width(r, energy):
    """Extent of where the energy of the main lobe is above half its greatest."""
    return np.ptp(r[energy >= 0.5 * energy.max()])


@pytest.mark.parametrize(
    ("window", "cells", "sidelobe"), [("uniform", 0.886, -13.26), ("hamming", 1.30, -42.7), ("hann", 1.44, -31.5)]
)
def test_a_chirp_is_as_sharp_as_its_bandwidth(window, cells, sidelobe):
    r = np.linspace(0.0, 12.0 * CELL, 120_001)
    energy = envelope(chirp(window), r, SPEED) ** 2
    assert 2.0 * width(r, energy) / CELL == pytest.approx(cells, rel=3e-3)
    # The main lobe ends at the first null: 1 cell for a uniform spectrum, 2 for the tapered ones.
    null = 1.0 if window == "uniform" else 2.0
    assert energy[round(null * 10_000)] < 1e-30
    assert 10.0 * math.log10(energy[r > null * CELL].max()) == pytest.approx(sidelobe, abs=0.1)


@pytest.mark.parametrize("window", WINDOWS)
@pytest.mark.parametrize("bin_length", [0.003, 0.05, 0.4])
def test_taps_of_a_chirp_hold_its_energy(window, bin_length):
    taps = pulse_taps(chirp(window), SPEED, bin_length)
    # All but the sidelobes beyond the pulse's length.
    assert taps.weights.sum() * bin_length / CELL == pytest.approx(ENERGY[window], rel=2e-3)
    assert (taps.weights >= 0.0).all()
    np.testing.assert_allclose(taps.weights, taps.weights[::-1], atol=1e-15)
    assert taps.weights.size == 2 * taps.before + 1


def test_taps_of_a_chirp_are_integrals_over_bins():
    pulse, bin_length = chirp("hamming", 2e-4), 0.02
    taps = pulse_taps(pulse, SPEED, bin_length)
    # Echoes anywhere in their bin, heard anywhere in another.
    within, bins = (np.arange(400) + 0.5) / 400, np.arange(-taps.before, taps.before + 1)
    for k, weight in zip(bins, taps.weights):
        offset = (k + within - within[:, None]) * bin_length
        assert weight == pytest.approx((envelope(pulse, offset, SPEED) ** 2).mean(), abs=2e-5)


def point(bins, at):
    """One ping with an echo in one bin."""
    traced = np.zeros((1, 2, bins), np.float32)
    traced[:, :, at] = 1.0
    return traced


def test_the_record_of_a_point_is_the_response_of_the_pulse():
    bin_length, bins = 0.0005, 8000
    record = received(point(bins, 4000), bin_length, sonar__pulse=chirp("uniform", 1e-3).model_dump())[0, 0]
    r = (np.arange(bins) - 4000) * bin_length
    assert np.argmax(record) == 4000
    assert width(r, record) / CELL == pytest.approx(0.886, abs=0.02)
    lobes = record[np.abs(r) > CELL].max() / record.max()
    assert 10.0 * math.log10(lobes) == pytest.approx(-13.26, abs=0.05)
    # Nothing is heard beyond the pulse's own length, c·1 ms/2 = 0.75 m either way.
    assert not record[np.abs(r) > 0.75 + bin_length].any()


@pytest.mark.parametrize("duration", [2e-5, 1e-4, 3.3e-4])
def test_a_tone_resolves_half_its_length(duration):
    bin_length, bins = 0.0005, 2000
    record = received(point(bins, 100), bin_length, sonar__pulse={"kind": "tone", "duration": duration})[0, 0]
    assert np.count_nonzero(record > 0.5) * bin_length == pytest.approx(0.5 * SPEED * duration, abs=1.5 * bin_length)
    # The envelope, as a function of two-way time, has its first spectral null at 1/τ.
    time = 2.0 * bin_length / SPEED * np.arange(bins)
    frequencies = np.linspace(0.1, 1.9, 1801) / duration
    spectrum = np.abs(np.exp(-2j * np.pi * frequencies[:, None] * time) @ np.sqrt(record))
    null = np.argmin(spectrum)
    assert frequencies[null] * duration == pytest.approx(1.0, abs=2.0 * bin_length / SPEED / duration)
    assert (np.diff(spectrum[:null]) < 0.0).all()


@pytest.mark.parametrize("pulse", [Ideal(), Tone(duration=1e-4), *(chirp(window) for window in WINDOWS)])
def test_an_even_bed_sums_what_a_point_sums(pulse):
    # A unit echo sums to the equivalent length in bins, and every bin of an even bed holds as much, to the last.
    total = pulse_taps(pulse, SPEED, 0.05).weights.sum()
    bed = np.ones((1, 2, 600), np.float32)
    settings = {"sonar__pulse": pulse.model_dump()}
    assert received(point(600, 300), 0.05, **settings)[0, 0].sum() == pytest.approx(total, rel=1e-5)
    np.testing.assert_allclose(received(bed, 0.05, **settings)[0, 0, 100:], total, rtol=1e-5)


def test_silence_stays_silent_beyond_the_pulse_and_nothing_is_negative():
    traced = np.zeros((2, 2, 500), np.float32)
    traced[:, :, 250:300] = np.random.default_rng(0).random((2, 2, 50))
    reached = np.abs(np.arange(500) - 274.5) < 40.0  # 1 ms reaches 15 bins either way
    for window in WINDOWS:
        record = received(traced, 0.05, sonar__pulse=chirp(window, 1e-3).model_dump())
        assert (record >= 0.0).all()
        np.testing.assert_array_equal(record > 0.0, np.broadcast_to(reached, record.shape))


CHIRPS = [chirp(window) for window in WINDOWS]


@pytest.mark.parametrize("pulse", [Ideal(), *(Tone(duration=t) for t in (1e-5, 1e-4, 2e-4, 1.1e-3)), *CHIRPS])
@pytest.mark.parametrize("bin_length", [0.005, 0.05, 0.5])
def test_filtered_noise_has_the_coherence_of_the_pulse(pulse, bin_length):
    taps, wanted = coherent_taps(pulse, SPEED, bin_length), coherence(pulse, SPEED, bin_length)
    assert (taps**2).sum() == pytest.approx(1.0, abs=1e-12)
    found = np.correlate(taps, taps, "full")[taps.size - 1 :]
    np.testing.assert_allclose(found, wanted, atol=2e-3)


@pytest.mark.parametrize("window", WINDOWS)
@pytest.mark.parametrize("cells", [1.0, 2.3, 6.0, 15.7])
def test_the_coherence_of_a_chirp_is_its_envelopes_own_correlation(window, cells):
    pulse, bin_length = chirp(window, cells / BANDWIDTH), CELL / 5.0
    found = coherence(pulse, SPEED, bin_length)
    # The plain sum, ten times as fine; nothing is heard beyond the pulse's length on either hand.
    r = (np.arange(-10_000, 10_000) + 0.5) * cells * CELL / 10_000
    response = envelope(pulse, r, SPEED)
    for lag in range(math.ceil(10.0 * cells) + 2):
        wanted = (response * envelope(pulse, r + lag * bin_length, SPEED)).sum() / (response**2).sum()
        assert (found[lag] if lag < found.size else 0.0) == pytest.approx(wanted, abs=5e-4)


@pytest.mark.parametrize(("window", "bound"), [("uniform", 0.036), ("hamming", 2e-3), ("hann", 1e-4)])
def test_faint_sidelobes_of_a_long_chirp_hardly_matter_for_its_coherence(window, bound):
    pulse, bin_length = chirp(window, 0.02), CELL / 10.0
    found = coherence(pulse, SPEED, bin_length)
    # The transform of the power spectrum (a + b cos 2πf/B)² over its band, of a pulse without end.
    a, b = {"uniform": (1.0, 0.0), "hamming": (0.54, 0.46), "hann": (0.5, 0.5)}[window]
    f = (np.arange(4000) + 0.5) / 4000 - 0.5
    power = (a + b * np.cos(2.0 * np.pi * f)) ** 2
    wanted = [(power * np.cos(2.0 * np.pi * f * lag / 10.0)).sum() / power.sum() for lag in range(found.size)]
    np.testing.assert_allclose(found, wanted, atol=bound)
    # Where neighbouring bins still have much in common, all of it is there.
    np.testing.assert_allclose(found[:8], wanted[:8], atol=bound / 3.0)
