"""The receiver: pulse and speckle."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from beds import problem_of
from insonify.kernels.types import LIGHT, SONAR
from insonify.receive import receive, tone_taps
from insonify.scene import edit, load_scene

FLAT = np.zeros((4, 4))
BINS = 1000


def scene(**changes):
    return edit(load_scene("default"), {path.replace("__", "."): value for path, value in changes.items()})


def received(declared, traced, pings=None, law=SONAR):
    pings = np.arange(traced.shape[0]) if pings is None else pings
    return receive(declared, problem_of(FLAT, bins=traced.shape[2], law=law), traced, pings)


@settings(max_examples=60, deadline=None, derandomize=True)
@given(length=st.floats(1e-3, 200.0))
def test_taps_hold_the_pulse(length):
    taps = tone_taps(length)
    assert taps.sum() == pytest.approx(length, rel=1e-9)
    assert (taps > -1e-12).all()
    assert taps.size <= length + 3
    # The echo of a bin is on average half a pulse late.
    assert (np.arange(taps.size) @ taps) / taps.sum() == pytest.approx(0.5 * length, abs=1e-9 * max(length, 1.0))


@pytest.mark.parametrize(("length", "taps"), [(1.0, [0.5, 0.5]), (2.0, [0.5, 1.0, 0.5]), (1.5, [0.5, 0.875, 0.125])])
def test_taps_by_hand(length, taps):
    given_taps = tone_taps(length)
    np.testing.assert_allclose(given_taps[: len(taps)], taps, atol=1e-12)
    np.testing.assert_allclose(given_taps[len(taps) :], 0.0, atol=1e-12)


def test_an_echo_begins_at_its_range_and_lasts_the_pulse():
    traced = np.zeros((1, 2, BINS), np.float32)
    traced[0, 0, 400], traced[0, 1, 998] = 3.0, 1.0
    record = received(scene(), traced)
    # 0.1 ms is 7.5 cm, 1.5 bins of 5 cm.
    np.testing.assert_allclose(record[0, 0, 398:404], [0.0, 0.0, 1.5, 2.625, 0.375, 0.0], atol=1e-6)
    np.testing.assert_allclose(record[0, 1, 996:], [0.0, 0.0, 0.5, 0.875], atol=1e-6)
    assert np.count_nonzero(record) == 5


def test_an_even_echo_grows_with_the_pulse_and_light_does_not():
    traced = np.ones((1, 2, BINS), np.float32)
    np.testing.assert_allclose(received(scene(), traced)[:, :, 10:], 1.5, rtol=1e-6)
    np.testing.assert_allclose(received(scene(), traced, law=LIGHT)[:, :, 10:], 1.0, rtol=1e-6)


def test_a_pulse_longer_than_the_record():
    traced = np.ones((1, 2, BINS), np.float32)
    record = received(scene(sonar__pulse__duration=0.1), traced)
    assert record.shape == traced.shape
    np.testing.assert_allclose(record[0, 0], np.arange(BINS) + 0.5, rtol=1e-5)


def test_nothing_declared_changes_nothing():
    traced = np.random.default_rng(0).random((3, 2, BINS), np.float32)
    assert received(scene(sonar__pulse="ideal"), traced) is traced


def speckled(traced, pings=None, **changes):
    return received(scene(sonar__pulse="ideal", receiver__speckle="rayleigh", **changes), traced, pings)


def test_speckle_is_exponential_in_intensity():
    even = np.ones((100, 2, BINS), np.float32)
    intensity = speckled(even).ravel().astype(float)
    n = intensity.size
    assert intensity.mean() == pytest.approx(1.0, abs=3.0 / np.sqrt(n))
    amplitude = np.sqrt(intensity)
    # Rayleigh: CV = √(4/π − 1) = 0.523; its estimate scatters by 0.47/√n.
    assert amplitude.std() / amplitude.mean() == pytest.approx(np.sqrt(4.0 / np.pi - 1.0), abs=3.0 * 0.47 / np.sqrt(n))
    # The whole distribution, not two of its moments (Kolmogorov-Smirnov at one in a thousand).
    ordered = np.sort(intensity)
    distance = np.abs(1.0 - np.exp(-ordered) - (np.arange(n) + 0.5) / n).max()
    assert distance < 1.95 / np.sqrt(n)


def test_speckle_of_neighbours_is_independent():
    cube = speckled(np.ones((60, 2, BINS), np.float32)).astype(float) - 1.0
    bound = 4.0 / np.sqrt(cube.size)
    assert abs((cube[:, :, 1:] * cube[:, :, :-1]).mean()) < bound
    assert abs((cube[1:] * cube[:-1]).mean()) < bound
    assert abs((cube[:, 0] * cube[:, 1]).mean()) < 1.5 * bound


def test_speckle_belongs_to_ping_side_and_bin():
    traced = np.random.default_rng(0).random((40, 2, 50), np.float32)
    whole = speckled(traced)
    order = np.random.default_rng(1).permutation(40)
    np.testing.assert_array_equal(speckled(traced[order], order), whole[order])
    np.testing.assert_array_equal(speckled(traced[7:9], np.array([7, 8])), whole[7:9])
    assert not np.array_equal(speckled(traced, seed=2), whole)


def test_speckle_leaves_shadows_silent_and_the_traced_record_alone():
    traced = np.zeros((4, 2, 50), np.float32)
    traced[:, :, 20:] = 1.0
    kept = traced.copy()
    record = speckled(traced)
    assert not record[:, :, :20].any()
    np.testing.assert_array_equal(traced, kept)
