"""Speckle, and fluctuation from ping to ping: distributions and how far they keep together, against closed forms."""

import itertools
import math

import numpy as np
import pytest
from scipy import stats

from insonify.acoustics.pulses import coherence
from insonify.kernels.speckle.random_fields import transform_distribution
from insonify.receiver import receive
from insonify.receiver.fluctuation import Fluctuation
from insonify.receiver.speckle import FIRST_COLUMN, PER_DOUBLING, Speckle, shape_table
from insonify.scene import edit, load_scene
from insonify.scene.sonar.pulses import Chirp
from insonify.simulation import prepare
from receptions import RAYLEIGH, correlation, field_correlation, reception, variation

BINS, BIN_LENGTH, WIDTH = 400, 0.05, 1.0
WAVELENGTH = 1500.0 / 400e3


def speckle(pings=400, half_width=WIDTH / 2.0, speckle="rayleigh", **changes):
    """Numbers that an even record is multiplied by, (pings, 2, bins)."""
    ready = reception(BINS, altitude=5.0, half_width=math.radians(half_width), receiver__speckle=speckle, **changes)
    return ready.find(Speckle).factors(np.arange(pings)).astype(float)


def effective(pings, bins, correlation_along=1.0, correlation_across=1.0):
    """Number of independent samples among correlated ones: all, over both correlation intervals."""
    return 2.0 * pings * bins / (correlation_along * correlation_across)


# In bins, Σ|ρ|² of a tone of 0.1 ms (1.5 bins): 1 + 2 (1/3)².
TONE = 1.0 + 2.0 / 9.0


@pytest.mark.parametrize("speed", [2.0, 0.1, 0.02])
@pytest.mark.parametrize("pulse", ["ideal", "tone", "chirp"])
def test_correlated_or_not_it_is_exponential_throughout(pulse, speed):
    # Every 40th bin and 100th ping are independent whatever the correlation.
    intensity = speckle(4001, sonar__pulse=pulse, track__speed=speed)[::100, :, ::40].ravel()
    # Kolmogorov-Smirnov, at one in a thousand.
    assert stats.kstest(intensity, "expon").statistic < 1.95 / math.sqrt(intensity.size)


@pytest.mark.parametrize("looks", [1, 2, 4, 16])
def test_one_look_is_rayleigh_and_more_average(looks):
    intensity = speckle(speckle={"kind": "rayleigh", "looks": looks})
    n = effective(400, BINS, correlation_across=TONE)
    assert intensity.mean() == pytest.approx(1.0, abs=3.0 / math.sqrt(looks * n))
    # The variance of a contrast 1/√L of gamma numbers is (1 + 1/L)/2L a sample.
    sigma = math.sqrt(0.5 * (1.0 + 1.0 / looks) / looks / n)
    assert intensity.std() / intensity.mean() == pytest.approx(1.0 / math.sqrt(looks), abs=3.0 * sigma)
    if looks == 1:  # the estimate of the variation of amplitudes scatters by 0.47/√n
        assert variation(intensity) == pytest.approx(RAYLEIGH, abs=3 * 0.47 / n**0.5)


def test_neighbouring_bins_correlate_as_the_pulse_covers_both_and_those_of_a_chirp_by_its_bandwidth():
    for duration in (1e-4, 2e-4, 5e-4):
        intensity = speckle(3000, sonar__pulse={"kind": "tone", "duration": duration})
        length = 0.5 * 1500.0 * duration / BIN_LENGTH
        n = effective(3000, BINS, correlation_across=length)
        for lag in range(1, math.ceil(length) + 2):
            wanted = max(0.0, 1.0 - lag / length) ** 2
            assert correlation(intensity, lag, 2) == pytest.approx(wanted, abs=4.0 / math.sqrt(n)), (duration, lag)
    pulse = Chirp(duration=1e-3, bandwidth=6e3)
    intensity, wanted = speckle(3000, sonar__pulse=pulse.model_dump()), coherence(pulse, 1500.0, BIN_LENGTH) ** 2
    n = effective(3000, BINS, correlation_across=3.0)
    for lag in range(1, 6):
        assert correlation(intensity, lag, 2) == pytest.approx(wanted[lag], abs=4.0 / math.sqrt(n))


def test_pings_keep_together_over_half_an_array_and_a_broad_beam_decorrelates_sooner():
    # λ/2θ, at any range: pings so close that so many lie within it.
    length = 0.5 * WAVELENGTH / (2.0 * math.sin(math.radians(WIDTH / 2.0)))
    for within in (3.0, 8.0, 30.0):
        intensity = speckle(6000, track__speed=10.0 * length / within, sonar__pulse="ideal")
        for part in (intensity[:, :, :200], intensity[:, :, 200:]):
            n, lags = effective(6000, 200, correlation_along=within), math.ceil(2.2 * within)
            sigma = within * math.sqrt(2.0 * lags / within) / math.sqrt(n)
            interval = 1.0 + 2.0 * sum(correlation(part, lag, 0) for lag in range(1, lags))  # ∫|ρ|², in pings
            # A triangle of a few pings, sampled at pings, has its interval to 3 %.
            assert interval == pytest.approx(within, rel=0.03, abs=4.0 * sigma)
    narrow, broad = (speckle(400, half_width=w, track__speed=0.2, sonar__pulse="ideal") for w in (0.25, 1.0))
    # 0.21 m and 0.05 m, in pings 2 cm apart.
    assert correlation(narrow, 2, 0) > 0.7
    assert correlation(broad, 4, 0) < 0.05


@pytest.mark.parametrize(
    ("frequency", "length", "taper", "ways", "advance"),
    [
        (400e3, 0.6, "uniform", 2, 0.05),
        (900e3, 1.0, "uniform", 2, 0.02),  # in the near field to 600 m
        (600e3, 0.9, "cosine", 2, 0.011),  # 82 pings within the array
        (850e3, 1.3, "hamming", 2, 0.2),
        (300e3, 0.4, "hamming", 1, 0.03),
        (455e3, 0.8, "cosine", 1, 0.02),
        (120e3, 0.3, "uniform", 2, 0.5),  # pings farther apart than the array is long
    ],
)
def test_near_and_far_pings_keep_together_as_the_field_of_an_array_does(frequency, length, taper, ways, advance):
    beam = {"kind": "array", "length": length, "taper": taper, "two_way": ways == 2}
    changes = {"sonar__frequency": frequency, "sonar__beam": beam, "track__speed": 2.0 * advance}
    changes |= {"sonar__range": 150.0, "sonar__ping_rate": 2.0, "sonar__pulse": "ideal"}
    ready = reception(300, 0.5, receiver__speckle="rayleigh", **changes)
    field, lags = ready.find(Speckle).field, advance * np.arange(math.ceil(1.1 * length / advance) + 1)
    intensity = field.energies(np.arange(1500)).astype(float) - 1.0
    for r in (2.25, 7.25, 21.25, 60.25, 140.25):
        row = np.searchsorted(field.edges, int(r / 0.5), side="right") - 1
        weights = np.pad(field.filters.weights[row], (0, lags.size))
        found = np.correlate(weights, weights[: -lags.size], "valid")[: lags.size]
        wanted = field_correlation(1500.0 / frequency, length, taper, ways, r, lags)
        # A one-way grain is in proportion to r, which is rounded to 2 %.
        np.testing.assert_allclose(np.abs(found), wanted, atol=0.02)
        grain, exact = (1.0 + 2.0 * (each[1:] ** 2).sum() for each in (found, wanted))
        assert grain == pytest.approx(exact, rel=0.03), r
        # The factors of a record, in the bins that share the correlation.
        part = intensity[:, :, field.edges[row] : field.edges[row + 1]]
        samples = part.size / grain
        measured = [(part[lag:] * part[: 1500 - lag]).mean() for lag in range(lags.size)]
        np.testing.assert_allclose(measured, found**2, atol=0.02 + 5.0 / math.sqrt(samples))


def test_of_an_ideal_pulse_bins_sides_and_other_pings_are_independent():
    intensity = speckle(400, sonar__pulse="ideal") - 1.0
    bound = 4.0 / math.sqrt(intensity.size)
    assert abs((intensity[1:] * intensity[:-1]).mean()) < bound
    assert abs((intensity[:, :, 1:] * intensity[:, :, :-1]).mean()) < bound
    assert abs((intensity[:, 0] * intensity[:, 1]).mean()) < 1.5 * bound


def k(shape, **more):
    return {"kind": "k", "shape": shape, **more}


def test_k_has_its_moments_and_is_rayleigh_of_many_scatterers():
    for shape, looks in itertools.product((0.5, 1.0, 3.0, 20.0), (1, 4)):
        # 5 m a ping, so that cells never overlap.
        intensity = speckle(1500, speckle=k(shape, looks=looks), sonar__pulse="ideal", track__speed=50.0)
        # I = Gamma × Exp: E I² = (1 + 1/ν)(1 + 1/L), and likewise to the eighth moment for the scatter of the second.
        moment = [math.prod((1.0 + j / shape) * (1.0 + j / looks) for j in range(m)) for m in range(9)]
        variance, second = moment[2] - 1.0, moment[4] - moment[2] ** 2
        assert intensity.mean() == pytest.approx(1.0, abs=3.0 * math.sqrt(variance / intensity.size))
        assert (intensity**2).mean() == pytest.approx(moment[2], abs=3.0 * math.sqrt(second / intensity.size))
        assert looks > 1 or variance == pytest.approx(1.0 + 2.0 / shape)
    intensity = speckle(200, speckle=k(1e4), sonar__pulse="ideal", track__speed=50.0)[::10, :, ::10].ravel()
    assert stats.kstest(intensity, "expon").statistic < 1.95 / math.sqrt(intensity.size)


@pytest.mark.parametrize("shape", [0.1, 0.7, 1.0, 4.0, 300.0])
def test_the_table_turns_exponential_numbers_into_gamma_ones(shape):
    exponential = np.random.default_rng(0).exponential(size=(1, 2, 1000)).astype(np.float32)
    made = exponential.copy()
    place = np.full(made.shape, 8.0 * math.log2(shape / 0.05), np.float32)
    transform_distribution(made, shape_table(), FIRST_COLUMN, PER_DOUBLING, place)
    survival = stats.gamma.sf(made.astype(float), shape, scale=1.0 / shape)
    np.testing.assert_allclose(survival, np.exp(-exponential), atol=3e-4)


def test_k_grows_more_even_with_range_and_pulse():
    # ν in proportion to the cell r·θ·cτ/2: 2 at 0.0131 m².
    for duration, bins in ((1e-4, slice(90, 110)), (1e-4, slice(380, 400)), (4e-4, slice(90, 110))):
        tone = {"kind": "tone", "duration": duration}
        intensity = speckle(4000, speckle=k(2.0, cell=0.0131), track__speed=50.0, sonar__pulse=tone)
        r = 0.5 * (bins.start + bins.stop) * BIN_LENGTH
        shape = 2.0 * r * math.radians(WIDTH) * 0.5 * 1500.0 * duration / 0.0131
        found = intensity[:, :, bins].var()
        n = effective(4000, 20, correlation_across=1.0 + duration / 1e-4)
        assert found == pytest.approx(1.0 + 2.0 / shape, abs=3.0 * math.sqrt(60.0 / n))


def test_the_strength_of_the_bed_keeps_together_as_cells_overlap():
    # Cells of 0.17 m and 0.35 m, and pings 2 cm apart; 16 looks bring the texture out.
    intensity = speckle(8000, speckle=k(1.0, looks=16), sonar__pulse="ideal", track__speed=0.2, half_width=0.5)
    for bins in (slice(190, 210), slice(380, 400)):
        cell = 0.5 * (bins.start + bins.stop) * BIN_LENGTH * math.radians(WIDTH) / 0.02
        part = intensity[:, :, bins]
        # Speckle adds 2/16 to a variance of 1, and keeps together over 0.1 m.
        found = sum(correlation(part, lag, 0) for lag in range(1, math.ceil(2.2 * cell))) * 2.0 + 1.0
        assert found == pytest.approx(cell, rel=0.15)


def test_each_material_has_its_own_shape():
    rocks = [{"name": "rock", "speckle_shape": shape} for shape in (0.7, 20.0)]
    stripes = {"kind": "pattern", "shape": "stripes", "period": 8.0, "of": rocks}
    bed = {"seabed.relief": "flat", "seabed.material": stripes, "targets": []}
    sonar = {"sonar.pulse": "ideal", "sonar.bins": 500, "track.speed": 50.0, "receiver.speckle": k(3.0)}
    spiky = edit(load_scene("default"), bed | sonar)
    simulation, plain = prepare(spiky), prepare(edit(spiky, {"receiver.speckle": "none"}))
    pings = np.arange(1500)
    ratio = simulation.intensity(pings) / np.maximum(plain.intensity(pings), 1e-30)
    kind = plain.truth(pings[:1]).material[0]
    # Bins well within a stripe of 4 m.
    inside = (np.abs(np.arange(500) * 0.1 - 30.0) < 15.0) & (np.roll(kind[0], 5) == np.roll(kind[0], -5))
    for row, shape in ((0, 0.7), (1, 20.0)):
        found = ratio[:, 0, inside & (kind[0] == row)].astype(float)
        assert found.mean() == pytest.approx(1.0, abs=0.02)
        assert found.var() == pytest.approx(1.0 + 2.0 / shape, rel=0.05)


def test_the_shape_of_a_bin_is_the_mean_of_what_it_hears():
    changes = {"receiver__speckle": k(2.0), "track__speed": 50.0, "sonar__pulse": "ideal"}
    ready = reception(200, altitude=5.0, half_width=0.01, **changes)
    traced, pings = np.ones((4000, 2, 200), np.float32), np.arange(4000)
    own, same = receive(ready, traced, pings), receive(ready, traced, pings, 0.5 * traced)
    np.testing.assert_allclose(same, own, rtol=1e-5)
    # Half the echo of shape 1 and half of shape 1/3: 1/ν = 2.
    mixed = receive(ready, traced, pings, np.float32(0.5 * 1.0 + 0.5 * 3.0) * traced).astype(float)
    assert mixed.var() == pytest.approx(1.0 + 2.0 * 2.0, rel=0.05)


FEW = 60
PINGS = 200_000


def ready(**fluctuation):
    kind = {"kind": "lognormal", **fluctuation}
    return reception(FEW, altitude=1.0, sonar__pulse="ideal", receiver__fluctuation=kind)


@pytest.mark.parametrize("time", [0.05, 0.3, 1.0, 7.7, 60.0])
def test_the_level_has_its_deviation_and_its_memory(time):
    gain = ready(level=2.0, correlation_time=time).find(Fluctuation).gains(np.arange(PINGS)).ravel().astype(float)
    level = 10.0 * np.log10(gain)
    samples = PINGS / max(1.5 * 10.0 * time, 1.0)
    variance = math.exp((2.0 * math.log(10.0) / 10.0) ** 2) - 1.0
    assert gain.mean() == pytest.approx(1.0, abs=3.0 * math.sqrt(variance / samples))
    # A lognormal gain of mean 1: the mean level lies below 0 by ln(10)/20 times the variance.
    assert level.mean() == pytest.approx(-math.log(10.0) / 20.0 * 4.0, abs=3.0 * 2.0 / math.sqrt(samples))
    assert level.std() == pytest.approx(2.0, rel=3.0 / math.sqrt(2.0 * samples))
    centred = level - level.mean()
    lag = round(10.0 * time)
    if lag >= 3:
        correlation = (centred[lag:] * centred[:-lag]).mean() / centred.var()
        # Sampled at a few nodes, the triangle's correlation is its own to 3 %.
        assert correlation == pytest.approx(math.exp(-1.0), abs=0.03 + 3.0 / math.sqrt(samples))
        # Three correlation times apart pings are independent.
        assert abs((centred[3 * lag :] * centred[: -3 * lag]).mean() / centred.var()) < 4.0 / math.sqrt(samples)


def test_both_sides_of_a_ping_and_all_its_bins_share_a_gain_and_a_shift_that_keeps_their_energy():
    traced = np.random.default_rng(0).random((50, 2, FEW), np.float32) + 0.1
    ratio = receive(ready(level=3.0), traced, np.arange(50)) / traced
    np.testing.assert_allclose(ratio, ratio[:, :1, :1] * np.ones((1, 2, FEW)), rtol=1e-5)
    assert np.ptp(ratio) > 0.1
    traced = np.zeros((4000, 2, FEW), np.float32)
    traced[:, :, 30] = 1.0
    # 0.1 ms is 7.5 cm of slant range, 1.5 bins.
    shifting = ready(level=0.0, travel_time=1e-4, correlation_time=0.05)
    record = receive(shifting, traced, np.arange(4000)).astype(float)
    np.testing.assert_allclose(record.sum(axis=2), 1.0, rtol=1e-5)
    delay = record @ np.arange(FEW) - 30.0
    np.testing.assert_allclose(delay[:, 0], delay[:, 1], atol=1e-4)
    assert delay.mean() == pytest.approx(0.0, abs=3.0 * 1.5 / math.sqrt(4000))
    assert delay.std() == pytest.approx(1.5, rel=3.0 / math.sqrt(8000))
    # An echo that falls between two bins is shared by them and no others.
    assert (np.count_nonzero(record, axis=2) <= 2).all()
    # An even bed stays even to the last bin.
    traced[:, :, 20:] = 1.0
    record = receive(shifting, traced[:50], np.arange(50))
    np.testing.assert_allclose(record[:, :, 30:], 1.0, rtol=1e-6)
    assert not record[:, :, :10].any()
