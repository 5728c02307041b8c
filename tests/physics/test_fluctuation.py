"""Fluctuation from ping to ping: its distribution, its memory, and what it leaves alone."""

import math

import numpy as np
import pytest

from insonify.receiver import receive
from insonify.receiver.fluctuation import Fluctuation
from receptions import reception

BINS = 60
PINGS = 200_000


def ready(**fluctuation):
    kind = {"kind": "lognormal", **fluctuation}
    return reception(BINS, altitude=1.0, sonar__pulse="ideal", receiver__fluctuation=kind)


def levels(**fluctuation):
    """Level of every ping in dB, at 10 pings a second."""
    return 10.0 * np.log10(ready(**fluctuation).find(Fluctuation).gains(np.arange(PINGS)).ravel().astype(float))


@pytest.mark.parametrize("time", [0.05, 0.3, 1.0, 7.7, 60.0])
def test_the_level_has_its_deviation_and_its_memory(time):
    level = levels(level=2.0, correlation_time=time)
    samples = PINGS / max(1.5 * 10.0 * time, 1.0)
    # A lognormal gain of mean 1: the mean level lies below 0 by ln(10)/20 times the variance.
    assert level.mean() == pytest.approx(-math.log(10.0) / 20.0 * 4.0, abs=3.0 * 2.0 / math.sqrt(samples))
    assert level.std() == pytest.approx(2.0, rel=3.0 / math.sqrt(2.0 * samples))
    centred = level - level.mean()
    lag = round(10.0 * time)
    if lag >= 3:
        correlation = (centred[lag:] * centred[:-lag]).mean() / centred.var()
        # Sampled at a few nodes, the triangle's correlation is its own to 3 %.
        assert correlation == pytest.approx(math.exp(-1.0), abs=0.03 + 3.0 / math.sqrt(samples))


def test_pings_as_far_apart_as_three_correlation_times_are_independent():
    level = levels(level=1.0, correlation_time=1.0)
    centred = level - level.mean()
    assert abs((centred[30:] * centred[:-30]).mean()) < 4.0 / math.sqrt(PINGS / 15.0)


def test_the_mean_intensity_stays():
    gain = ready(level=3.0, correlation_time=0.05).find(Fluctuation).gains(np.arange(PINGS)).astype(float)
    variance = math.exp((3.0 * math.log(10.0) / 10.0) ** 2) - 1.0
    assert gain.mean() == pytest.approx(1.0, abs=3.0 * math.sqrt(variance / PINGS))


def test_both_sides_of_a_ping_and_all_its_bins_share_a_gain():
    traced = np.random.default_rng(0).random((50, 2, BINS), np.float32) + 0.1
    ratio = receive(ready(level=3.0), traced, np.arange(50)) / traced
    np.testing.assert_allclose(ratio, ratio[:, :1, :1] * np.ones((1, 2, BINS)), rtol=1e-5)
    assert np.ptp(ratio) > 0.1


def test_the_water_shifts_echoes_and_keeps_their_energy():
    traced = np.zeros((4000, 2, BINS), np.float32)
    traced[:, :, 30] = 1.0
    # 0.1 ms is 7.5 cm of slant range, 1.5 bins.
    shifting = ready(level=0.0, travel_time=1e-4, correlation_time=0.05)
    record = receive(shifting, traced, np.arange(4000)).astype(float)
    np.testing.assert_allclose(record.sum(axis=2), 1.0, rtol=1e-5)
    delay = record @ np.arange(BINS) - 30.0
    np.testing.assert_allclose(delay[:, 0], delay[:, 1], atol=1e-4)
    assert delay.mean() == pytest.approx(0.0, abs=3.0 * 1.5 / math.sqrt(4000))
    assert delay.std() == pytest.approx(1.5, rel=3.0 / math.sqrt(8000))
    # An echo that falls between two bins is shared by them and no others.
    assert (np.count_nonzero(record, axis=2) <= 2).all()


def test_a_shift_leaves_an_even_bed_even_to_the_last_bin():
    traced = np.zeros((50, 2, BINS), np.float32)
    traced[:, :, 20:] = 1.0
    record = receive(ready(level=0.0, travel_time=1e-4), traced, np.arange(50))
    np.testing.assert_allclose(record[:, :, 30:], 1.0, rtol=1e-6)
    assert not record[:, :, :10].any()
