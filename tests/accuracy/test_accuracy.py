"""Errors and displacements of records, orders of convergence, the reference and the clock."""

import math

import numpy as np
import pytest

from beds import arrays_of, pipe_edges, poses_of, rough_arrays
from exact_rays import order
from insonify.accuracy.timing import time_calls
from insonify.acoustics.flat_bed import compute_flat_bed_curves
from insonify.statistics.record_errors import (
    compare_records,
    compute_errors,
    find_echo_shifts,
    find_edge_shifts,
    measure_displacement,
    measure_similarity,
)
from insonify.tracers import ray_sheets, rays

FINE = {"bins": 500, "bin_length": 0.06}


def test_errors_by_hand():
    curve = np.array([0.0, 0.0, 4.0, 2.0, 1.0])
    b = np.array([[9.0, 0.0, 4.0, 2.0, 0.0]])
    a = np.array([[0.0, 7.0, 8.0, 2.0, 1.0]])
    errors = compute_errors(a, b, curve, first_bin=2, beyond_bin=3)
    # Divided by the curve: b = 1, 1, 0 and a = 2, 1, 1.
    assert errors.all_bins == pytest.approx(1.0)
    assert errors.beyond == pytest.approx(1.0)
    assert errors.energy_bias == pytest.approx(1.0)
    assert errors.dark_leakage == pytest.approx(0.25)
    # Bins without a curve do not count.
    curve = np.array([0.0, 1.0, 1.0])
    errors = compute_errors(np.array([5.0, 1.0, 1.0]), np.ones(3), curve, first_bin=0, beyond_bin=1)
    assert errors == compute_errors(np.ones(3), np.ones(3), curve, first_bin=0, beyond_bin=1)
    assert errors.all_bins == errors.beyond == errors.energy_bias == errors.dark_leakage == 0.0
    # Of a silent reference any sound is infinitely wrong.
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


def test_calls_are_timed_in_turns():
    seen = []
    timings = time_calls({"a": lambda: seen.append("a"), "b": lambda: seen.append("b")}, rounds=3)
    assert seen == ["a", "b"] * 4
    assert set(timings) == {"a", "b"}
    assert all(timing.median > 0.0 and timing.spread >= 0.0 for timing in timings.values())


BINS = 400


def stepped(*edges):
    """Lit bed with one shadow between two edges, the bins that they fall in lit in part."""
    bins = np.arange(BINS, dtype=float)
    dark = np.clip(np.minimum(bins + 1, edges[1]) - np.maximum(bins, edges[0]), 0.0, 1.0)
    return 1.0 - dark


def test_edges_of_shadows_are_found_where_they_went():
    b = stepped(100.0, 200.0)
    for moved in (-7.0, 1.0, 0.0, 30.0):
        assert find_edge_shifts(stepped(100.0 + moved, 200.0 + moved), b) == pytest.approx([moved, moved])
    # Between two centres of bins a straight line stands for the step: 0.09 of a bin at most.
    for moved in np.linspace(-1.0, 1.0, 9):
        assert find_edge_shifts(stepped(100.0, 200.0 + moved), b) == pytest.approx([0.0, moved], abs=0.09)
    # A lost shadow is wrong by half its length.
    assert np.abs(find_edge_shifts(np.ones(BINS), b)) == pytest.approx([50.0, 50.0], abs=1.0)
    # The level does not matter, and no shadow has no edges.
    assert find_edge_shifts(3e-9 * b, 3e-9 * b) == [0.0, 0.0]
    assert find_edge_shifts(np.zeros(BINS), np.zeros(BINS)) == find_edge_shifts(b, np.ones(BINS)) == []
    assert find_edge_shifts(b, stepped(100.0, 105.0)) == []  # too short to be one
    # A shadow to the end of the range has its near edge alone.
    assert find_edge_shifts(stepped(303.0, 400.0), stepped(300.0, 400.0)) == pytest.approx([3.0])


def echoes(*places):
    """Echoes over a faint bed, each shared between the two bins about its place."""
    record = np.full(BINS, 1e-6)
    for place in places:
        k, part = int(place), place - int(place)
        record[k] += 10.0 * (1.0 - part)
        record[k + 1] += 10.0 * part
    return record


def test_echoes_are_found_where_they_went_or_lost():
    for moved in (-20.0, -1.0, -0.3, 0.0, 0.25, 0.5, 3.75, 60.0):
        found = find_echo_shifts(echoes(150.0 + moved, 300.0 + moved), echoes(150.0, 300.0))
        assert found == pytest.approx([moved, moved], abs=1e-4)
    assert np.isnan(find_echo_shifts(np.zeros(BINS), echoes(150.0))).all()
    bed = np.random.default_rng(1).exponential(0.3, BINS)
    # Specks of the bed stand out too, and are where they were.
    found = np.array(find_echo_shifts(bed, bed + echoes(150.0)))
    assert np.count_nonzero(np.isnan(found)) == 1
    np.testing.assert_allclose(found[~np.isnan(found)], 0.0, atol=1e-4)
    one_lost = find_echo_shifts(echoes(150.0), echoes(150.0, 350.0))
    np.testing.assert_allclose(one_lost, [0.0, np.nan], atol=1e-9)
    assert find_echo_shifts(echoes(150.0), np.full(BINS, 1.0)) == []


def test_displacements_are_in_metres_and_none_between_exact_records():
    arrays = arrays_of(np.zeros((8, 8)), 4.0, periodic=True, bins=BINS, bin_length=0.25)
    poses = poses_of(0.0, 0.0, 10.0)
    curve = compute_flat_bed_curves(arrays, poses)
    right = curve * np.stack([stepped(120.0, 200.0), np.ones(BINS)])
    found = measure_displacement(arrays, poses, curve * np.stack([stepped(118.0, 203.0), np.ones(BINS)]), right)
    assert found.shadow_edge == pytest.approx(0.25 * 2.5, rel=1e-6)
    assert math.isnan(found.echo)
    assert found.lost == 0
    both = curve * np.stack([echoes(150.0, 300.0), np.ones(BINS)])
    some = measure_displacement(arrays, poses, curve * np.stack([echoes(152.0), np.ones(BINS)]), both)
    assert some.echo == pytest.approx(0.5, abs=1e-3)
    assert some.lost == 1
    arrays = arrays_of(np.zeros((8, 8)), 32.0, periodic=True, solids=[((0.0, 20.0, 1.0), 1.0)])
    poses = poses_of(0.0, 0.0, 8.0)
    few, many = (rays.trace(arrays, poses, rays=count) for count in (60_000, 90_000))
    exact = measure_displacement(arrays, poses, few, many)
    assert exact.shadow_edge < 0.01
    assert exact.echo < 0.01


def test_the_shadow_of_a_span_from_a_sonar_at_another_height():
    pipe = [((-50.0, 30.0, 1.5), (50.0, 30.0, 1.5), 0.5)]
    arrays = arrays_of(np.zeros((8, 8)), 32.0, x0=-128.0, y0=-128.0, solids=pipe, bins=2000, bin_length=0.025)
    low, high = (ray_sheets.trace(arrays, poses_of(0.0, 0.0, z), rays=1 << 15)[:, :1] for z in (10.0, 10.4))
    curve = compute_flat_bed_curves(arrays, poses_of(0.0, 0.0, 10.0))
    a, b = (np.divide(each, curve, out=np.zeros_like(curve), where=curve > 0.0)[0, 0, 500:] for each in (high, low))
    higher, lower = (pipe_edges(1.0, altitude=z)[2:] for z in (10.4, 10.0))
    expected = np.subtract(higher, lower) / arrays.bin_length
    assert find_edge_shifts(a, b) == pytest.approx(expected, abs=0.35)  # of 25 mm


def test_pictures_alike():
    rng = np.random.default_rng(1)
    picture = rng.rayleigh(1.0, (4, 300))
    assert measure_similarity(picture, picture) == pytest.approx(1.0)
    noisy = (picture + size * rng.standard_normal(picture.shape) for size in (0.05, 0.8))
    near, far = (measure_similarity(each, picture) for each in noisy)
    assert far < near < 1.0
    assert measure_similarity(picture[:, :3], picture[:, :3]) == 1.0
