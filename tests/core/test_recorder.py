"""Recorder, gain table, ringing and interference: each does what it says, is off by default, and costs no order."""

import math

import numpy as np
import pytest

from beds import arrays_of
from insonify.acoustics.flat_bed import flat_bed_curve
from insonify.cli import main
from insonify.io.records import read_record
from insonify.receiver import receive
from receptions import reception

BINS, BIN_LENGTH, ALTITUDE = 1000, 0.05, 10.0
BIN_TIME = 2.0 * BIN_LENGTH / 1500.0
RATE = 10.0  # pings per second of the default scene


def ready(bins=BINS, **changes):
    level = {"altitude": ALTITUDE, "half_width": math.radians(0.5), "spreading": True}
    return reception(bins, BIN_LENGTH, **level, **{"sonar__pulse": "ideal"} | changes)


def even(pings=4, bins=BINS, energy=1e-6):
    return np.full((pings, 2, bins), energy, np.float32)


def of(traced, pings=None, **changes):
    pings = np.arange(len(traced)) if pings is None else pings
    return receive(ready(traced.shape[2], **changes), traced, pings)


def test_all_is_off_by_default_and_float_clips_only_at_a_declared_full_scale():
    traced = even(energy=3.0)
    assert of(traced) is traced
    np.testing.assert_allclose(of(traced, receiver__recorder__full_scale=0.0), 1.0, rtol=1e-6)


@pytest.mark.parametrize(
    ("changes", "port", "starboard"),
    [
        ({"gain": 6.0}, 6.0, 6.0),
        ({"gain": [[1.0, 0.0], [2.0, 6.0], [2.5, -3.0]]}, *[np.repeat([0.0, 6.0, -3.0], [20, 5, 15])] * 2),
        ({"side_gain": 4.0}, 2.0, -2.0),  # half to either hand, so that the record is as loud in decibels
    ],
)
def test_gains_hold_from_their_time_on_and_between_sides(changes, port, starboard):
    record = of(even(40), receiver__recorder=changes)
    for side, expected in enumerate((port, starboard)):
        found = 10.0 * np.log10(record[:, side] / 1e-6)
        np.testing.assert_allclose(found, np.broadcast_to(np.atleast_1d(expected)[:, None], found.shape), atol=1e-5)


@pytest.mark.parametrize("bits", [8, 16])
def test_bits_round_the_amplitude_to_steps_of_full_scale(bits):
    traced = np.random.default_rng(0).exponential(1e-6, (4, 2, BINS)).astype(np.float32)
    full_scale = 10.0 * math.log10(4e-6)
    record = of(traced, receiver__recorder__bits=bits, receiver__recorder__full_scale=full_scale).astype(float)
    codes = np.sqrt(record / 4e-6) * (2**bits - 1)
    np.testing.assert_allclose(codes, np.rint(codes), atol=0.01)
    wanted = np.minimum(np.sqrt(traced.astype(float) / 4e-6), 1.0) * (2**bits - 1)
    assert np.abs(codes - wanted).max() < 0.51
    assert (traced > 4e-6).any()
    assert codes.max() == pytest.approx(2**bits - 1, rel=1e-6)


@pytest.mark.parametrize("bits", [8, 16])
def test_left_out_full_scale_holds_a_perfect_level_bed(bits):
    options = {"bins": BINS, "bin_length": BIN_LENGTH, "half_width": math.radians(0.5), "spreading": True}
    loudest = flat_bed_curve(arrays_of(np.zeros((4, 4)), **options), ALTITUDE).max()
    # The least power of two as step that holds it: up to 6 dB of headroom.
    step = 2.0 ** math.ceil(math.log2(math.sqrt(loudest) / (2**bits - 1)))
    full_scale = ((2**bits - 1) * step) ** 2
    assert loudest <= full_scale <= 4.0 * loudest
    # It follows source and time-varied gain; a gain of the recorder's own brings the record to clip.
    for energy, changes, expected, rtol in (
        (10.0 * full_scale, {}, full_scale, 1e-6),
        (0.5 * loudest, {"receiver__source_level": 20.0}, 50.0 * loudest, 0.015),
        (0.5 * full_scale, {"receiver__recorder__gain": 6.0}, full_scale, 1e-6),
    ):
        record = of(even(energy=energy), receiver__recorder__bits=bits, **changes)
        np.testing.assert_allclose(record, expected, rtol=rtol)


def test_dropped_pings_are_silent_and_so_many():
    record = of(even(20_000, 2), receiver__recorder__dropped_pings=0.1)
    lost = ~record.any(axis=(1, 2))
    assert lost.mean() == pytest.approx(0.1, abs=4.0 * math.sqrt(0.09 / 20_000))
    assert (record[~lost] == np.float32(1e-6)).all()
    # Each by chance of its own.
    both = (lost[1:] & lost[:-1]).mean()
    assert both == pytest.approx(0.01, abs=4.0 * math.sqrt(0.01 / 20_000))
    assert not of(even(), receiver__recorder__dropped_pings=1.0).any()


TABLE = {"kind": "table", "by": "bin", "gains": [[2.0, 0.0], [4.0, 10.0], [8.0, 50.0]]}
TIME = (np.arange(BINS) + 0.5) * BIN_TIME  # from transmission


@pytest.mark.parametrize(
    ("table", "expected"),
    [
        (TABLE, np.interp(np.arange(12), [2.0, 4.0, 8.0], [0.0, 10.0, 50.0])),
        (TABLE | {"interpolation": "steps"}, np.repeat([0.0, 10.0, 50.0], 4)),
        ({"kind": "table", "gains": [[0.0, 0.0], [0.06, 60.0]]}, np.minimum(1e3 * TIME, 60.0)),
    ],
    ids=["by bin", "steps", "by time"],
)
def test_a_gain_table(table, expected):
    record = of(even(bins=expected.size), receiver__tvg=table)[0, 0].astype(float)
    np.testing.assert_allclose(10.0 * np.log10(record / 1e-6), expected, atol=1e-5 if "by" in table else 1e-4)


def test_a_gain_table_goes_on_beyond_the_noise():
    changes = {"receiver__tvg": {"kind": "table", "by": "bin", "gains": [[0, 0.0], [999, 40.0]]}}
    loud = ready(receiver__noise={"kind": "ambient", "level": 0.0}, **changes)
    np.testing.assert_allclose(10.0 * np.log10(loud.gain), np.arange(BINS) * 40.0 / 999.0, atol=1e-9)


def test_ringing_decays_after_transmission_and_is_a_wave_beside_the_speckled_echo():
    ringing = {"kind": "decay", "level": -30.0, "time": 2e-3}
    record = of(np.zeros((2, 2, BINS), np.float32), receiver__ringing=ringing, receiver__source_level=100.0)
    expected = 70.0 - 10.0 / math.log(10.0) * TIME / 2e-3
    np.testing.assert_allclose(10.0 * np.log10(record[1, 1]), expected, atol=1e-3)
    ringing = {"kind": "decay", "level": -60.0, "time": 1.0}
    record = of(even(1000, 100), receiver__ringing=ringing, receiver__speckle="rayleigh", track__speed=50.0)
    # A steady wave of energy a beside a Gaussian one of 1: mean 1 + a, variance 1 + 2a.
    a = 10.0 ** (-0.4343 * 50.0 * BIN_TIME)
    values = record.astype(float) / 1e-6
    assert values.mean() == pytest.approx(1.0 + a, abs=4.0 * math.sqrt((1.0 + 2.0 * a) / values.size))
    assert values.var() == pytest.approx(1.0 + 2.0 * a, rel=0.02)


def interference(**changes):
    return {"receiver__interference": {"kind": "sonar", "level": -50.0, "ping_rate": 7.0, "duration": 1e-3} | changes}


def test_another_sonar_pings_at_its_own_rate():
    pings = np.arange(400)
    record = of(np.zeros((400, 2, BINS), np.float32), pings, **interference(ping_rate=7.123))
    np.testing.assert_array_equal(record[:, 0], record[:, 1])
    heard = record[:, 0].astype(float) * 1e5
    assert heard.max() == pytest.approx(1.0, rel=1e-5)
    # All the energy of its pings that fall into the time of listening: 7.123 Hz · 1 ms of each second.
    listening = 400 * BINS * BIN_TIME
    assert heard.sum() * BIN_TIME == pytest.approx(7.123 * 1e-3 * listening, rel=0.05)
    # Each begins 1/7.123 s after the last.
    row, column = np.nonzero(np.diff(heard, axis=1) > 0.0)
    begins = row / RATE + (column + 1) * BIN_TIME
    begins = begins[np.r_[True, np.diff(begins) > 5e-4]]
    off = np.mod(begins - begins[0] + 0.5 / 7.123, 1.0 / 7.123) - 0.5 / 7.123
    assert np.abs(off).max() < 2.0 * BIN_TIME


def test_the_pings_of_another_sonar_have_phases_of_their_own():
    foreign = interference(level=-60.0, ping_rate=1e3, duration=1e-3)  # always on, as loud as the echo
    record = of(even(400, 200), receiver__speckle="rayleigh", track__speed=50.0, **foreign).astype(float) / 1e-6
    assert record.mean() == pytest.approx(2.0, abs=4.0 * math.sqrt(3.0 / record.size) * 3.0)
    assert record.var() == pytest.approx(3.0, rel=0.05)
    assert not np.array_equal(record, of(even(400, 200), seed=2, receiver__speckle="rayleigh", **foreign))


def test_without_speckle_energies_add():
    ringing = {"kind": "decay", "level": -60.0, "time": 1.0}
    foreign = interference(level=-60.0, ping_rate=1e3, duration=1e-3)
    record = of(even(), receiver__ringing=ringing, **foreign).astype(float) / 1e-6
    np.testing.assert_allclose(record, np.broadcast_to(2.0 + np.exp(-TIME), record.shape), rtol=1e-5)


@pytest.mark.parametrize(("bits", "stored"), [("8", "8"), ("16", "32")])  # an XTF sample of 16 bits holds 15
def test_a_record_in_bits_leaves_as_a_recording_of_as_many_unchanged(tmp_path, capsys, bits, stored):
    scene = ["render", "default", "--set", f"receiver.recorder.bits={bits}", "--set", "receiver.speckle=rayleigh"]
    scene += ["--set", "track.pings=20", "--set", "receiver.tvg=power", "--set", "receiver.noise=ambient"]
    assert main([*scene, "-o", str(tmp_path / "a.npz")]) == 0
    assert main([*scene, "-o", str(tmp_path / "a.xtf"), "--bits", stored]) == 0
    assert capsys.readouterr().out.count("20 pings of 2 x 1000 bins") == 2
    one, other = (read_record(tmp_path / name) for name in ("a.npz", "a.xtf"))
    np.testing.assert_allclose(np.sqrt(other.intensity), np.sqrt(one.intensity), rtol=1e-6)
    np.testing.assert_allclose(other.platform_altitude, one.platform_altitude, rtol=1e-6)
    assert other.attrs["frequency"] == one.attrs["frequency"] > 0.0
    assert np.unique(one.intensity).size <= 2 ** int(bits)
    assert not one.intensity.all()
