"""Noise, reverberation and crosstalk are waves: they add to the echo before detection, for every speckle."""

import math
from functools import lru_cache, partial
from unittest.mock import Mock

import numpy as np
import pytest
from scipy import special

from insonify.receiver import Reception, receive
from insonify.receiver.water_column import WaterColumn
from insonify.scene import edit, load_scene
from insonify.scene.receiver.noises import thermal_noise, wind_noise
from insonify.simulation import simulate
from receptions import RAYLEIGH, correlation, reception, variation

PINGS, BINS = 500, 200
ECHO = 1e-9
RATIOS = (-20.0, -10.0, -3.0, 0.0, 3.0, 10.0, 20.0)  # dB, of noise to echo


def ready(speckle, bins=BINS, **changes) -> Reception:
    # 5 m a ping: neither speckle nor the bed's texture is correlated from ping to ping.
    kind = {"receiver__speckle": SPECKLES[speckle][0], "sonar__pulse": "ideal", "track__speed": 50.0}
    settings = {"altitude": 100.0, "depth": 100.0, "half_width": math.radians(0.5), "spreading": True}
    return reception(bins, **settings, **kind | changes)


def even(pings=PINGS, bins=BINS) -> np.ndarray:
    return np.full((pings, 2, bins), ECHO, np.float32)


def rice(noise: float) -> tuple[float, float]:
    """Means of amplitude and energy of a wave of energy 1 in Gaussian noise (Rice 1944)."""
    k = 0.5 / noise
    mean = math.sqrt(math.pi * noise) / 2.0 * ((1.0 + 2.0 * k) * special.i0e(k) + 2.0 * k * special.i1e(k))
    return mean, 1.0 + noise


def speckled(looks: int, shape: float | None, noise: float) -> tuple[float, float]:
    """Means of amplitude and energy: √(gamma number of ``looks``) over a mean that itself is gamma-distributed."""
    root = math.exp(special.gammaln(looks + 0.5) - special.gammaln(looks)) / math.sqrt(looks)
    if shape is None:
        return root * math.sqrt(1.0 + noise), 1.0 + noise
    # By quantiles, whose density needs no care near 0.
    strength = special.gammaincinv(shape, (np.arange(200_000) + 0.5) / 200_000) / shape
    return root * float(np.sqrt(strength + noise).mean()), 1.0 + noise


SPECKLES = {  # kinds, and what noise makes of their moments
    "none": ("none", rice),
    "rayleigh": ("rayleigh", partial(speckled, 1, None)),
    "looks": ({"kind": "rayleigh", "looks": 4}, partial(speckled, 4, None)),
    "k": ({"kind": "k", "shape": 1.5}, partial(speckled, 1, 1.5)),
    "k_looks": ({"kind": "k", "shape": 3.0, "looks": 2}, partial(speckled, 2, 3.0)),
}


@pytest.mark.parametrize("ratio", RATIOS)
@pytest.mark.parametrize("speckle", SPECKLES)
def test_noise_adds_before_detection(speckle, ratio):
    noise = {"kind": "ambient", "level": 10.0 * math.log10(ECHO) + ratio}
    record = receive(ready(speckle, receiver__noise=noise), even(), np.arange(PINGS)).astype(float) / ECHO
    amplitude, energy = SPECKLES[speckle][1](10.0 ** (ratio / 10.0))
    assert record.mean() == pytest.approx(energy, abs=4.0 * record.std() / math.sqrt(record.size))
    wanted = math.sqrt(energy / amplitude**2 - 1.0)
    assert variation(record) == pytest.approx(wanted, abs=0.004 if speckle == "rayleigh" else 0.006)
    if speckle == "rayleigh":  # the sum of two waves of this distribution has it, too
        assert wanted == pytest.approx(RAYLEIGH)


@pytest.mark.parametrize("ratio", RATIOS)
@pytest.mark.parametrize("crosstalk", [None, -10.0])
def test_reverberation_adds_before_detection(ratio, crosstalk):
    # The echo is made to stand in that ratio to the reverberation of every bin.
    receiver = ready("rayleigh", receiver__reverberation="volume", receiver__crosstalk=crosstalk)
    reverberation = receiver.find(WaterColumn).reverberation
    water = reverberation * 10.0 ** (-ratio / 10.0)
    traced = np.broadcast_to(water.astype(np.float32), (PINGS, 2, BINS)).copy()
    record = receive(receiver, traced, np.arange(PINGS)).astype(float)
    total = (water + reverberation) * (1.0 if crosstalk is None else 1.1)
    assert (record / total).mean() == pytest.approx(1.0, abs=4.0 / math.sqrt(record.size / 2))
    assert variation(record / total) == pytest.approx(RAYLEIGH, abs=0.004)


def test_the_bed_s_texture_is_not_that_of_the_water():
    receiver = ready("k", receiver__reverberation="volume")
    record = receive(receiver, 0.0 * even(), np.arange(PINGS)) / receiver.find(WaterColumn).reverberation
    assert variation(record) == pytest.approx(RAYLEIGH, abs=0.004)
    assert record.mean() == pytest.approx(1.0, abs=4.0 / math.sqrt(record.size))


@pytest.mark.parametrize("ratio", RATIOS)
def test_crosstalk_adds_before_detection(ratio):
    # The share leaks from a side that is louder or softer, so that both sides' waves stand in that ratio.
    share = 10.0**-2
    traced = even()
    traced[:, 1] *= 10.0 ** (ratio / 10.0) / share
    record = receive(ready("rayleigh", receiver__crosstalk=-20.0), traced, np.arange(PINGS)).astype(float)[:, 0]
    total = ECHO * (1.0 + 10.0 ** (ratio / 10.0))
    assert record.mean() == pytest.approx(total, rel=4.0 / math.sqrt(record.size))
    assert variation(record) == pytest.approx(RAYLEIGH, abs=0.006)


def test_what_leaks_is_the_other_side_s_own_wave():
    traced = even()
    traced[:, 1] = 0.0
    record = receive(ready("rayleigh", receiver__crosstalk=-20.0), traced, np.arange(PINGS))
    np.testing.assert_allclose(record[:, 1], 0.01 * record[:, 0], rtol=1e-5)
    alone = receive(ready("rayleigh"), traced, np.arange(PINGS))
    np.testing.assert_allclose(record[:, 0], alone[:, 0], rtol=1e-5)


def test_without_speckle_echoes_have_no_phase_and_their_mean_energies_add():
    receiver = ready("none", receiver__reverberation="volume", receiver__crosstalk=-10.0)
    record = receive(receiver, even(), np.arange(PINGS))
    total = 1.1 * (ECHO + receiver.find(WaterColumn).reverberation)
    np.testing.assert_allclose(record, np.broadcast_to(total, record.shape), rtol=1e-5)


@pytest.mark.parametrize("pulse", [{"kind": "tone", "duration": 2e-4}, {"kind": "chirp", "bandwidth": 6e3}])
def test_the_sum_is_correlated_as_its_parts(pulse):
    # Echo and noise pass the same filter: of any two waves of one correlation, so is the sum's.
    noise = {"kind": "ambient", "level": 10.0 * math.log10(3.0 * ECHO)}
    receivers = (ready("rayleigh", sonar__pulse=pulse, receiver__noise=kind) for kind in (noise, "none"))
    records = [receive(receiver, even(3000), np.arange(3000))[:, :, 20:].astype(float) for receiver in receivers]
    for lag in (1, 2, 3):
        found, wanted = (correlation(record / record.mean(), lag, 2) for record in records)
        assert found == pytest.approx(wanted, abs=4.0 * math.sqrt(3.0 / records[0].size))


@pytest.mark.parametrize("speckle", SPECKLES)
def test_a_shorter_record_of_the_same_bins_begins_a_longer_one(speckle):
    changes = {"sonar__pulse": "tone", "receiver__crosstalk": -10.0}
    changes["receiver__noise"] = {"kind": "ambient", "level": -90.0}
    changes["receiver__reverberation"] = {"kind": "volume", "volume_strength": -30.0}
    changes["receiver__fluctuation"] = {"kind": "lognormal", "travel_time": 1e-4}
    short, whole = (receive(ready(speckle, bins, **changes), even(40, bins), np.arange(40)) for bins in (150, BINS))
    np.testing.assert_allclose(short[:, :, :140], whole[:, :, :140], rtol=1e-5)


def test_no_wave_is_made_where_none_is_declared(monkeypatch):
    refuse = Mock(side_effect=AssertionError("noise is drawn for a receiver without any"))
    monkeypatch.setattr("insonify.receiver.waves.add_filtered_waves", refuse)
    for speckle in SPECKLES:
        receive(ready(speckle), even(4), np.arange(4))
    monkeypatch.setattr("insonify.receiver.waves.fill_white_noise", refuse)
    receive(ready("none", receiver__crosstalk=-10.0), even(4), np.arange(4))


@lru_cache
def scatterers_alone(bins):
    """A scene of scatterers that interfere, and its record without noise."""
    bed = {"seabed.relief": "flat", "seabed.spacing": 0.5, "seabed.material": {"diffuse": 0.5, "specular": 0.0}}
    sonar = {"receiver.speckle": "coherent", "track.speed": 50.0, "track.pings": 100, "sonar.bins": bins}
    scene = edit(load_scene("default"), bed | sonar | {"targets": []})
    return scene, simulate(scene).intensity.values.astype(float)


@pytest.mark.parametrize(
    ("bins", "ratio"),
    [
        *((1000, ratio) for ratio in (-10.0, 0.0, 10.0)),
        (200, 0.0),
        *(pytest.param(200, ratio, marks=pytest.mark.slow) for ratio in (-10.0, 10.0)),
    ],
)
def test_scatterers_interfere_with_noise(bins, ratio):
    # With 200 bins each holds the mean over several resolution cells, in the noise as in the echo.
    scene, alone = scatterers_alone(bins)
    first, last = int(0.5 * bins), int(0.6 * bins)
    level = alone[:, :, first:last].mean()
    noisy = edit(scene, {"receiver.noise": {"kind": "ambient", "level": 10.0 * math.log10(level) + ratio}})
    record = simulate(noisy).intensity.values.astype(float)[:, :, first:last]
    curve = alone[:, :, first:last].mean(axis=(0, 1))
    total = curve + level * 10.0 ** (ratio / 10.0)
    assert (record / total).mean() == pytest.approx(1.0, abs=4.0 / math.sqrt(record.size / 2))
    still = variation(alone[:, :, first:last] / curve)
    assert variation(record / total) == pytest.approx(still, abs=0.015)
    if bins == 1000:
        assert still == pytest.approx(RAYLEIGH, abs=0.015)


def test_thermal_noise_exceeds_that_of_the_wind_from_39_kilohertz_in_a_calm_and_65_in_three_knots():
    """37 log f = 170 + √(21 u), f in Hz and u in knots: Wenz (1962), Mellen (1952)."""
    for knots, crossing in ((0.0, 39.3e3), (3.1, 65.0e3)):
        found = 10.0 ** ((170.0 + np.sqrt(21.0 * knots)) / 37.0)
        assert found == pytest.approx(crossing, rel=5e-3)
        assert wind_noise(found, knots * 0.514444) == pytest.approx(thermal_noise(found), abs=1e-3)
