"""The receiver: its order, each ping a function of the scene and its number alone, and what each stage does."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from beds import arrays_of
from insonify.acoustics.flat_bed import flat_bed_curve
from insonify.cli import main
from insonify.explanation.pixel import explain_pixel
from insonify.io.records import read_record
from insonify.kernels.common.types import LIGHT, SONAR
from insonify.receiver import receive
from insonify.receiver.reception import assemble
from insonify.receiver.stage import ReceiverSetup, Sound, Stage, stage_kinds
from insonify.scene import edit, load_scene
from insonify.scene.sonar.pulses import Tone
from insonify.simulation import prepare
from receptions import scene_with

FLAT = np.zeros((4, 4))
BINS = 1000
BIN_TIME = 2.0 * 0.05 / 1500.0
EVERYTHING = {
    "sonar__pulse": "chirp",
    "receiver__speckle": {"kind": "k", "shape": 1.5, "looks": 2, "cell": 0.05},
    "receiver__fluctuation": {"kind": "lognormal", "travel_time": 1e-4},
    "receiver__reverberation": "both",
    "receiver__noise": "ambient",
    "receiver__source_level": 10.0,
    "receiver__tvg": "power",
    "receiver__ringing": "decay",
    "receiver__interference": {"kind": "sonar", "level": -50.0, "ping_rate": 7.0, "duration": 1e-3},
    "receiver__recorder": {"bits": 8, "gain": [[0.0, 0.0], [1.0, 3.0]], "side_gain": 1.0, "dropped_pings": 0.2},
}
FOUR_LOOKS = {"kind": "rayleigh", "looks": 4}


def reception(declared, bins=BINS, law=SONAR, **options):
    arrays = arrays_of(FLAT, bins=bins, law=law, half_width=np.radians(0.5), spreading=law == SONAR, **options)
    return assemble(ReceiverSetup(declared, arrays, altitude=10.0, depth=20.0))


def received(declared, traced, pings=None, law=SONAR):
    pings = np.arange(traced.shape[0]) if pings is None else pings
    return receive(reception(declared, traced.shape[2], law), traced, pings)


@settings(max_examples=60, deadline=None, derandomize=True)
@given(length=st.floats(1e-3, 200.0))
def test_taps_hold_the_pulse(length):
    taps = Tone().taps(length)
    assert taps.sum() == pytest.approx(length, rel=1e-9)
    assert (taps > -1e-12).all()
    assert taps.size <= length + 3
    # The echo of a bin is on average half a pulse late.
    assert (np.arange(taps.size) @ taps) / taps.sum() == pytest.approx(0.5 * length, abs=1e-9 * max(length, 1.0))
    for length, by_hand in ((1.0, [0.5, 0.5]), (2.0, [0.5, 1.0, 0.5]), (1.5, [0.5, 0.875, 0.125])):
        taps = Tone().taps(length)
        np.testing.assert_allclose(taps, [*by_hand, *[0.0] * (taps.size - len(by_hand))], atol=1e-12)


def test_an_echo_begins_at_its_range_lasts_the_pulse_and_grows_with_it_which_light_does_not():
    traced = np.zeros((1, 2, BINS), np.float32)
    traced[0, 0, 400], traced[0, 1, 998] = 3.0, 1.0
    record = received(scene_with(), traced)
    # 0.1 ms is 7.5 cm, 1.5 bins of 5 cm.
    np.testing.assert_allclose(record[0, 0, 398:404], [0.0, 0.0, 1.5, 2.625, 0.375, 0.0], atol=1e-6)
    np.testing.assert_allclose(record[0, 1, 996:], [0.0, 0.0, 0.5, 0.875], atol=1e-6)
    assert np.count_nonzero(record) == 5
    traced[:] = 1.0
    np.testing.assert_allclose(received(scene_with(), traced)[:, :, 10:], 1.5, rtol=1e-6)
    np.testing.assert_allclose(received(scene_with(), traced, law=LIGHT)[:, :, 10:], 1.0, rtol=1e-6)
    longer = received(scene_with(sonar__pulse__duration=0.1), traced)  # than the record
    assert longer.shape == traced.shape
    np.testing.assert_allclose(longer[0, 0], np.arange(BINS) + 0.5, rtol=1e-5)
    assert received(scene_with(sonar__pulse="ideal"), traced) is traced


@pytest.mark.parametrize(
    "changes",
    [
        *({"track__speed": speed} for speed in (2.0, 0.02, 1e-3)),
        {"receiver__speckle": "none", "receiver__tvg": "table"},
        {"receiver__speckle": "rayleigh", "receiver__tvg": "table"},
        *({"receiver__speckle": kind, "receiver__crosstalk": -10.0} for kind in ("none", "k", FOUR_LOOKS)),
    ],
)
def test_whatever_it_does_belongs_to_ping_side_and_bin(changes):
    # At 2 mm a ping neighbours share most of their speckle, at 0.1 mm, the slowest tow, nearly all of it.
    declared = scene_with(**EVERYTHING | changes)
    traced = np.random.default_rng(0).random((40, 2, 200), np.float32)
    whole = received(declared, traced)
    order = np.random.default_rng(1).permutation(40)
    np.testing.assert_array_equal(received(declared, traced[order], order), whole[order])
    np.testing.assert_array_equal(received(declared, traced[7:9], np.array([7, 8])), whole[7:9])
    np.testing.assert_array_equal(received(declared, traced[[5, 5]], np.array([5, 5])), whole[[5, 5]])
    assert received(declared, traced[:0], np.empty(0, np.int64)).shape == (0, 2, 200)
    assert not np.array_equal(received(edit(declared, {"seed": 2}), traced), whole)
    assert np.isfinite(whole).all()
    assert (whole >= 0.0).all()


def test_speckle_leaves_shadows_silent_and_nothing_changes_the_traced_record():
    traced = np.zeros((4, 2, 50), np.float32)
    traced[:, :, 20:] = 1.0
    kept = traced.copy()
    for kind in ("rayleigh", "k"):
        record = received(scene_with(sonar__pulse="ideal", receiver__speckle=kind), traced)
        assert not record[:, :, :20].any()
        assert (record[:, :, 20:] > 0.0).all()
    received(scene_with(**EVERYTHING), traced)
    np.testing.assert_array_equal(traced, kept)


@pytest.mark.parametrize(
    ("path", "value"),
    [(path, value) for path, value in EVERYTHING.items() if path.startswith("receiver") and path[10:] != "recorder"]
    + [("receiver__reverberation", "volume"), ("receiver__reverberation", "surface")],
)
def test_each_effect_is_had_alone_and_undone_by_taking_it_back(path, value):
    plain = scene_with(sonar__pulse="ideal")
    traced = np.full((3, 2, BINS), 1e-6, np.float32)
    touched = edit(plain, {path.replace("__", "."): value})
    assert not np.array_equal(received(touched, traced), traced)
    none = 0.0 if path.endswith("level") else "none"
    assert received(edit(touched, {path.replace("__", "."): none}), traced) is traced


def test_the_mean_of_the_whole_way_is_the_mean_record():
    noise = {"receiver__noise": {"kind": "ambient", "level": -80.0}, "receiver__source_level": 10.0}
    fluctuation = {"receiver__fluctuation": {"kind": "lognormal", "correlation_time": 0.1}}
    ready = reception(scene_with(receiver__speckle="rayleigh", receiver__tvg="power", **noise, **fluctuation), 100)
    echo = np.full(100, 1e-6)
    traced = np.broadcast_to(echo.astype(np.float32), (6000, 2, 100)).copy()
    mean = receive(ready, traced, np.arange(6000)).astype(float).mean(axis=(0, 1))
    expected = ready.expected(echo)
    # Past the pulse's own length; the gain of some 4000 independent pings, and the speckle of 12,000 lines.
    np.testing.assert_allclose(mean[5:] / expected[5:], 1.0, atol=0.06)
    assert (mean[5:] / expected[5:]).mean() == pytest.approx(1.0, abs=3.0 * 0.35 / np.sqrt(4000.0))


@pytest.fixture
def attenuator(monkeypatch):
    """A stage that halves all that is received before detection, known until the test ends."""
    monkeypatch.setattr("insonify.receiver.stage.KINDS", [*stage_kinds()])

    @dataclass(frozen=True, eq=False)
    class Attenuator(Stage):
        """Cable that loses half of the energy."""

        name, detail, rank = "cable", "between sonar and receiver", 75.0

        @classmethod
        def prepare(cls, setup: ReceiverSetup) -> Attenuator:
            return cls()

        @property
        def gain(self) -> float:
            return 0.5

        def act_on_energies(self, sound: Sound) -> None:
            sound.scale(np.float32(0.5))

        act_on_waves = act_on_energies

    return Attenuator


WAVES = {"receiver.speckle": "rayleigh", "receiver.crosstalk": -20.0}
NOISE = {"receiver.noise": {"kind": "ambient", "level": 0.0}}


@pytest.mark.parametrize("changes", [{}, {"receiver.speckle": "rayleigh"}, WAVES, NOISE, WAVES | NOISE])
def test_a_stage_that_is_declared_acts_in_its_place(attenuator, changes):
    scene = edit(load_scene("default"), {"track.pings": 8, "receiver.tvg": "power", **changes})
    whole = reception(scene, 300, SONAR)
    assert [stage.name for stage in whole.stages][-2:] == ["cable", "time-varied gain"]
    without = replace(whole, stages=tuple(stage for stage in whole.stages if not isinstance(stage, attenuator)))
    traced = np.random.default_rng(1).random((8, 2, 300), np.float32)
    one, other = (receive(each, traced, np.arange(8)) for each in (whole, without))
    np.testing.assert_allclose(one, 0.5 * other, rtol=1e-5)
    np.testing.assert_allclose(whole.expected(np.ones(300)), 0.5 * without.expected(np.ones(300)))


def test_a_stage_that_is_declared_is_listed_for_a_pixel_and_named_where_it_cannot_act_on_waves(attenuator):
    simulation = prepare(edit(load_scene("default"), {"track.pings": 4, **WAVES}))
    explained = explain_pixel(simulation, 2, 0, 500)
    (term,) = (term for term in explained.terms if term.name == "cable")
    assert term.decibels == pytest.approx(10.0 * math.log10(0.5), abs=1e-4)
    assert term.detail == "between sonar and receiver"
    attenuator.act_on_waves = Stage.act_on_waves
    ready = reception(edit(load_scene("default"), WAVES), 300, SONAR)
    with pytest.raises(NotImplementedError, match="Attenuator acts between speckle and detection"):
        receive(ready, np.ones((2, 2, 300), np.float32), np.arange(2))


# Recorder, gain table, ringing and interference


def even(pings=4, bins=BINS, energy=1e-6):
    return np.full((pings, 2, bins), energy, np.float32)


def of(traced, **changes):
    """Record of traced echoes by the default receiver, without a pulse, but for some changes."""
    return received(scene_with(**{"sonar__pulse": "ideal"} | changes), traced)


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
    options = {"bins": BINS, "bin_length": 0.05, "half_width": math.radians(0.5), "spreading": True}
    loudest = flat_bed_curve(arrays_of(FLAT, **options), 10.0).max()
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
    loud = reception(scene_with(receiver__noise={"kind": "ambient", "level": 0.0}, **changes))
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
    record = of(np.zeros((400, 2, BINS), np.float32), **interference(ping_rate=7.123))
    np.testing.assert_array_equal(record[:, 0], record[:, 1])
    heard = record[:, 0].astype(float) * 1e5
    assert heard.max() == pytest.approx(1.0, rel=1e-5)
    # All the energy of its pings that fall into the time of listening: 7.123 Hz · 1 ms of each second.
    listening = 400 * BINS * BIN_TIME
    assert heard.sum() * BIN_TIME == pytest.approx(7.123 * 1e-3 * listening, rel=0.05)
    # Each begins 1/7.123 s after the last.
    row, column = np.nonzero(np.diff(heard, axis=1) > 0.0)
    begins = row / 10.0 + (column + 1) * BIN_TIME
    begins = begins[np.r_[True, np.diff(begins) > 5e-4]]
    off = np.mod(begins - begins[0] + 0.5 / 7.123, 1.0 / 7.123) - 0.5 / 7.123
    assert np.abs(off).max() < 2.0 * BIN_TIME


def test_pings_of_another_sonar_have_phases_of_their_own_and_without_speckle_energies_add():
    foreign = interference(level=-60.0, ping_rate=1e3, duration=1e-3)  # always on, as loud as the echo
    record = of(even(400, 200), receiver__speckle="rayleigh", track__speed=50.0, **foreign).astype(float) / 1e-6
    assert record.mean() == pytest.approx(2.0, abs=4.0 * math.sqrt(3.0 / record.size) * 3.0)
    assert record.var() == pytest.approx(3.0, rel=0.05)
    assert not np.array_equal(record, of(even(400, 200), seed=2, receiver__speckle="rayleigh", **foreign))
    ringing = {"kind": "decay", "level": -60.0, "time": 1.0}
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
