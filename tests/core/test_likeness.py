"""What the likeness of records measures: speckle, spectra and shadows of known size; a real record; the sheet."""

import numpy as np
import pytest
import xarray as xr
from PIL import Image
from scipy.signal import periodogram

from insonify.accuracy.comparison_page import draw_comparison
from insonify.cli import main
from insonify.io.records import read_record, write_record
from insonify.scene import SceneError, edit, load_scene
from insonify.simulation import simulate
from insonify.statistics import record_statistics
from insonify.statistics.record_statistics import AmplitudeSpectrum, measure_statistics
from level_records import level_record

PINGS, BINS = 320, 512
STEP, BIN = 0.25, 0.05


def record(intensity: np.ndarray) -> xr.Dataset:
    return level_record(intensity, BIN, 2.0, STEP, title="made up")


def lambert() -> np.ndarray:
    """An even bed, as a recorder with some gain of its own would show it."""
    r = (np.arange(BINS) + 0.5) * BIN
    return np.broadcast_to((2.0 / np.maximum(r, 2.0)) ** 2 * np.exp(-r / 9.0) * 1e7, (2, PINGS, BINS))


def speckle(seed: int) -> np.ndarray:
    return np.random.default_rng(seed).exponential(size=(2, PINGS, BINS))


def test_speckle_varies_as_a_rayleigh_envelope_with_a_white_spectrum():
    found = measure_statistics(record(lambert() * speckle(1)))
    assert np.median(found.variation) == pytest.approx(np.sqrt(4.0 / np.pi - 1.0), abs=0.01)
    assert np.isnan(found.shadow_depth)
    for spectrum, step in ((found.along, STEP), (found.across, BIN)):
        assert spectrum.frequency[-1] < 0.5 / step
        # White noise of variance 4/π - 1 between zero and the highest frequency.
        np.testing.assert_allclose(spectrum.power.mean(), (4.0 / np.pi - 1.0) * 2.0 * step, rtol=0.05)
        assert abs(spectrum.slope()) < 0.06


def test_periodograms_are_those_of_scipy():
    segments = np.random.default_rng(1).exponential(size=(7, 128)) + np.linspace(0.0, 3.0, 128)
    _, power = periodogram(segments, 1.0 / STEP, window="hann", detrend="linear", axis=-1)
    found = record_statistics._periodograms(segments, STEP)
    np.testing.assert_allclose(found[:, 1:-1], power[:, 1:-1], rtol=1e-9)


def test_an_even_bed_has_no_variation_and_gain_changes_nothing():
    assert measure_statistics(record(lambert())).variation.max() < 0.05
    bed = lambert() * speckle(2)
    one, other = (measure_statistics(record(gain * bed)).variation for gain in (1e-6, 1.0))
    np.testing.assert_allclose(one, other, rtol=1e-4)


@pytest.mark.filterwarnings("error")
def test_a_shadow_is_as_deep_as_it_is():
    for depth in (15.0, 24.0):
        bed = lambert().copy()
        bed[1, 96:112, 192:448] *= 10.0 ** (-depth / 10.0)
        assert measure_statistics(record(bed)).shadow_depth == pytest.approx(depth, abs=0.3)
    assert "shadows without any echo" in measure_statistics(record(shadowed(lambert()))).lines()
    silent = lambert() * speckle(1)
    silent[:, : 3 * PINGS // 4] = 0.0  # most of the record
    assert "no shadows" in measure_statistics(record(silent)).lines()


@pytest.mark.parametrize(("along", "across"), [(0.5, 0.0), (0.0, 2.5)])
def test_ripples_show_at_their_frequency(along, across):
    phase = along * STEP * np.arange(PINGS)[:, None] + across * BIN * np.arange(BINS)
    found = measure_statistics(record(lambert() * (1.0 + 0.3 * np.sin(2.0 * np.pi * phase)) ** 2))
    spectrum, frequency = (found.along, along) if along else (found.across, across)
    assert spectrum.frequency[spectrum.power.argmax()] == pytest.approx(frequency, rel=0.1)
    # A sine of amplitude 0.3 holds a variance of 0.045; half its band is a Hann window's leakage.
    held = np.trapezoid(spectrum.power, spectrum.frequency) * np.log(2.0)
    assert held == pytest.approx(0.045, rel=0.1)


def shadowed(intensity: np.ndarray) -> np.ndarray:
    """Cast a shadow over some blocks of a bed."""
    dark = intensity.copy()
    dark[1, 96:112, 192:448] = 0.0
    return dark


def noise(seed: int, level: float) -> np.ndarray:
    """Noise so many decibels below an even bed, amplified with it."""
    return lambert() * 10.0 ** (level / 10.0) * speckle(seed)


def converted(intensity: np.ndarray, full_scale: float) -> np.ndarray:
    """Amplitudes rounded to eight bits of full scale."""
    return np.rint(np.minimum(np.sqrt(intensity / full_scale), 1.0) * 255.0) ** 2


@pytest.mark.parametrize("level", [-20.0, -12.0, -8.0, -6.0])
def test_shadows_end_at_the_noise_floor_however_high(level):
    # Bed and noise have independent phases: energies add on the average.
    wanted = 10.0 * np.log10(1.0 + 10.0 ** (-level / 10.0))
    found = measure_statistics(record(shadowed(lambert() * speckle(1)) + noise(2, level)))
    assert found.shadow_depth == pytest.approx(wanted, abs=0.5)


def test_a_noise_floor_that_rises_with_range_is_followed():
    rising = 10.0 ** (np.linspace(-40.0, -6.0, BINS) / 10.0)
    found = measure_statistics(record(shadowed(lambert() * speckle(1)) + lambert() * rising * speckle(2)))
    shadow = 10.0 * np.log10(1.0 + 1.0 / rising[192:448])
    assert found.shadow_depth == pytest.approx(np.median(shadow), abs=1.5)


@pytest.mark.parametrize("level", [-40.0, -8.0, 3.0])
def test_noise_and_spiky_speckle_are_no_shadows(level):
    texture = np.random.default_rng(3).gamma(2.0, 0.5, size=(2, PINGS, BINS))
    for bed in (lambert(), lambert() * texture):
        found = measure_statistics(record(bed * speckle(1) + noise(2, level)))
        assert np.isnan(found.shadow_depth)


def test_eight_bits_measure_as_the_amplitudes_that_they_round_and_tell_how_deep_a_silent_shadow_is_at_least():
    even = speckle(1) * 1e4
    fine = record(shadowed(even) + 1e4 * 10.0**-1.5 * speckle(2))
    coarse = fine.assign(intensity=(fine.intensity.dims, converted(fine.intensity.values, 2e5).astype(np.float32)))
    one, other = measure_statistics(fine), measure_statistics(coarse)
    assert other.shadow_depth == pytest.approx(one.shadow_depth, abs=0.3)
    assert np.median(other.variation) == pytest.approx(np.median(one.variation), abs=0.01)
    # The bed's median amplitude is about 44 steps, so that half a step lies 39 dB below.
    silent = measure_statistics(record(converted(shadowed(speckle(1)), 25.0)))
    median = np.sqrt(np.log(2.0) / 25.0) * 255.0
    assert silent.shadow_depth == pytest.approx(20.0 * np.log10(2.0 * median), abs=2.0)
    assert f"shadows at least {silent.shadow_depth:.1f} dB deep" in silent.lines()


def test_what_clips_or_falls_below_the_steps_is_not_counted_as_even():
    r = (np.arange(BINS) + 0.5) * BIN
    bed = speckle(1) * 1e4 * 10.0 ** (-r / 5.0)  # 51 dB from near to far: clipped here, one step there
    found = measure_statistics(record(converted(bed, 2e3)))
    assert np.median(found.variation) == pytest.approx(np.sqrt(4.0 / np.pi - 1.0), abs=0.02)
    assert np.isnan(found.shadow_depth)


def test_too_little_bed_is_one_sentence():
    with pytest.raises(SceneError, match="made up: has too little bed to measure; give at least 128 pings"):
        measure_statistics(record(lambert()[:, :100]))
    for bins, pings in ((1, 200), (20, 200), (400, 1), (400, 3)):
        with pytest.raises(SceneError, match="too little bed"):
            measure_statistics(record(lambert()[:, :pings, :bins]))
    still = record(lambert())
    still["platform_x"][:] = 0.0
    with pytest.raises(SceneError, match="pings that move on"):
        measure_statistics(still)


def test_a_real_recording(real_recording):
    found = measure_statistics(read_record(real_recording))
    low, middle, high = np.percentile(found.variation, [10.0, 50.0, 90.0])
    assert 0.25 < low < middle < high < 0.55
    assert found.shadow_depth == pytest.approx(24.0, abs=2.0)


def test_powers_beyond_what_axes_show_are_left_out(tmp_path):
    scene = edit(load_scene("pipe-span"), {"track.pings": 140, "sonar.bins": 200})
    record, frequency = simulate(scene), np.geomspace(0.1, 5.0, 63)
    found = measure_statistics(record)
    for power in (1e308, 1e-308, np.inf):
        wild = found._replace(along=AmplitudeSpectrum(frequency, np.full(63, power)))
        draw_comparison((record, record), (found, wild)).savefig(tmp_path / "page.png", dpi=20)


def test_compare_draws_a_sheet_and_says_the_numbers(tmp_path, capsys):
    for number in (1, 2):
        write_record(tmp_path / f"{number}.npz", [record(lambert() * speckle(number))])
    names = [str(tmp_path / "1.npz"), str(tmp_path / "2.npz")]
    assert main(["compare", *names, "-o", str(tmp_path / "sheet.png")]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.partition(": ")[0] for line in lines[:2]] == names
    assert "variation of amplitude in even patches 0.52" in lines[0]
    with Image.open(tmp_path / "sheet.png") as picture:
        assert min(picture.size) > 900
