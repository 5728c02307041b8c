"""The receiver: its order, and that each ping is a function of the scene and its number alone."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from beds import arrays_of
from insonify.explanation.pixel import explain_pixel
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


def test_an_echo_begins_at_its_range_and_lasts_the_pulse():
    traced = np.zeros((1, 2, BINS), np.float32)
    traced[0, 0, 400], traced[0, 1, 998] = 3.0, 1.0
    record = received(scene_with(), traced)
    # 0.1 ms is 7.5 cm, 1.5 bins of 5 cm.
    np.testing.assert_allclose(record[0, 0, 398:404], [0.0, 0.0, 1.5, 2.625, 0.375, 0.0], atol=1e-6)
    np.testing.assert_allclose(record[0, 1, 996:], [0.0, 0.0, 0.5, 0.875], atol=1e-6)
    assert np.count_nonzero(record) == 5


def test_an_even_echo_grows_with_the_pulse_and_light_does_not():
    traced = np.ones((1, 2, BINS), np.float32)
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
    declared = scene_with(
        receiver__speckle="rayleigh",
        receiver__fluctuation={"kind": "lognormal", "correlation_time": 0.1},
        receiver__noise={"kind": "ambient", "level": -80.0},
        receiver__source_level=10.0,
        receiver__tvg="power",
    )
    ready = reception(declared, 100)
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
