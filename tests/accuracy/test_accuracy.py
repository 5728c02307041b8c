"""Errors, orders of convergence, the reference and the clock."""

import math

import numpy as np
import pytest

from beds import arrays_of, poses_of, rough_arrays
from exact_rays import order, reference
from insonify.accuracy.timing import time_calls
from insonify.acoustics.flat_bed import compute_flat_bed_curves
from insonify.statistics.record_errors import compare_records, compute_errors
from insonify.tracers import rays

FINE = {"bins": 500, "bin_length": 0.06}


def test_error_by_hand():
    curve = np.array([0.0, 0.0, 4.0, 2.0, 1.0])
    b = np.array([[9.0, 0.0, 4.0, 2.0, 0.0]])
    a = np.array([[0.0, 7.0, 8.0, 2.0, 1.0]])
    errors = compute_errors(a, b, curve, first_bin=2, beyond_bin=3)
    # Divided by the curve: b = 1, 1, 0 and a = 2, 1, 1.
    assert errors.all_bins == pytest.approx(1.0)
    assert errors.beyond == pytest.approx(1.0)
    assert errors.energy_bias == pytest.approx(1.0)
    assert errors.dark_leakage == pytest.approx(0.25)


def test_bins_without_a_curve_do_not_count():
    curve = np.array([0.0, 1.0, 1.0])
    errors = compute_errors(np.array([5.0, 1.0, 1.0]), np.ones(3), curve, first_bin=0, beyond_bin=1)
    assert errors == compute_errors(np.ones(3), np.ones(3), curve, first_bin=0, beyond_bin=1)
    assert errors.all_bins == errors.beyond == errors.energy_bias == errors.dark_leakage == 0.0


def test_silent_reference():
    quiet, loud, curve = np.zeros(4), np.ones(4), np.ones(4)
    assert compute_errors(quiet, quiet, curve, first_bin=0, beyond_bin=0).beyond == 0.0
    assert compute_errors(loud, quiet, curve, first_bin=0, beyond_bin=0).beyond == math.inf
    assert compute_errors(quiet, loud, curve, first_bin=0, beyond_bin=0).energy_bias == -1.0


def test_near_bins_do_not_rule():
    # The same share too much is the same error, with spreading r⁻⁴ or without.
    poses = poses_of(0.0, 0.0, 8.0)
    errors = []
    for spreading in (False, True):
        arrays = arrays_of(np.zeros((8, 8)), 4.0, periodic=True, spreading=spreading)
        record = rays.trace(arrays, poses, rays=8400).astype(float)
        errors.append(compare_records(arrays, poses, record * np.where(np.arange(1000) > 700, 1.1, 1.0), record))
    assert errors[0].all_bins == pytest.approx(errors[1].all_bins, rel=1e-3)


def test_each_ping_has_the_curve_of_its_altitude():
    arrays = rough_arrays(**FINE)
    curves = compute_flat_bed_curves(arrays, poses_of(0.0, 0.0, [8.0, 5.0, 8.0]))
    assert curves.shape == (3, 1, 500)
    np.testing.assert_array_equal(curves[0], curves[2])
    assert np.flatnonzero(curves[1, 0])[0] == int(5.0 / 0.06)


@pytest.mark.parametrize(
    ("half_width", "expected"),
    # A knife's bins hold one ray more or less of many: first order. A fan's points fill bins whose borders wind
    # through the beam: the 3/4 of an even set of points in a region of the plane.
    [(0.0, 1.0), (math.radians(1.0), 0.75)],
)
def test_rays_converge_in_their_order(half_width, expected):
    arrays, poses = rough_arrays(half_width, **FINE), poses_of(np.arange(4) * 0.9, 1.3, 8.0)
    finest = rays.trace(arrays, poses, rays=1 << 18)
    counts = np.array([1 << k for k in range(10, 15)])
    errors = [compare_records(arrays, poses, rays.trace(arrays, poses, rays=int(n)), finest).beyond for n in counts]
    assert order(counts, errors) == pytest.approx(expected, rel=0.1)


def test_reference_moves_less_than_asked():
    arrays, poses = rough_arrays(**FINE), poses_of([0.0, 3.0], 1.3, 8.0)
    record, moved = reference(arrays, poses, tolerance=0.003)
    assert moved < 0.003
    finest = rays.trace(arrays, poses, rays=1 << 18)
    assert compare_records(arrays, poses, record, finest).beyond < 0.003
    np.testing.assert_array_equal(record, reference(arrays, poses, tolerance=0.003)[0])


def test_calls_are_timed_in_turns():
    seen = []
    timings = time_calls({"a": lambda: seen.append("a"), "b": lambda: seen.append("b")}, rounds=3)
    assert seen == ["a", "b"] * 4
    assert set(timings) == {"a", "b"}
    assert all(timing.median > 0.0 and timing.spread >= 0.0 for timing in timings.values())
