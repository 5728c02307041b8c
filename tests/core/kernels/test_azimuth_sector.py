"""Sectors of a beam's planes: together they stand for every azimuth once, a top-hat's in pairs about athwart."""

import math

import numpy as np
import pytest

from beds import arrays_of, gaussian_pattern
from insonify.kernels.beam.azimuth_sector import arcsine
from insonify.tracers.azimuth_fan import beam_planes, pattern_planes


@pytest.mark.parametrize("width", [0.2, 1.0, 2.5, 20.0, 90.0])
@pytest.mark.parametrize("planes", [2, 3, 4, 5, 10, 11, 64])
def test_sectors_in_pairs_leave_no_azimuth_out_and_none_twice(width, planes):
    half = math.radians(0.5 * width)
    laid = beam_planes(half, planes)
    assert laid.angle.sum() == pytest.approx(math.pi)
    assert laid.far_angle.sum() == pytest.approx(2.0 * half)
    assert np.count_nonzero(laid.far_angle) == planes
    for hand in (1.0, -1.0):
        of_hand = hand * laid.azimuth >= 0.0
        order = np.argsort(laid.s_low[of_hand])
        low, high = laid.s_low[of_hand][order], laid.s_high[of_hand][order]
        np.testing.assert_array_equal(np.append(low, 1.0), np.append(0.0, high))
    assert np.count_nonzero(laid.azimuth == 0.0) == planes % 2, "an odd plane lies athwart, the others in pairs"
    np.testing.assert_array_equal(np.sort(laid.azimuth), np.sort(-laid.azimuth))


def test_the_arcsine_of_sectors_is_fine_enough_for_single_precision():
    sines = np.append(1.0 - np.geomspace(1e-9, 1.0, 500), 1.0)
    np.testing.assert_allclose([arcsine(s) for s in sines], np.arcsin(sines), rtol=0.0, atol=2.5e-8)


@pytest.mark.parametrize("targets", [False, True])
@pytest.mark.parametrize("planes", [4, 64, 900])
@pytest.mark.parametrize("width", [0.05, 0.3, 1.0, 20.0])
def test_sectors_of_a_pattern_leave_out_what_it_does_not_take_in_and_nothing_else(width, planes, targets):
    half = math.radians(width)
    bodies = [((0.0, 12.0, 0.6), 0.6)] if targets else []
    pattern = gaussian_pattern(math.radians(width))
    arrays = arrays_of(np.zeros((8, 8)), 4.0, periodic=True, half_width=half, pattern=pattern, solids=bodies)
    laid = pattern_planes(arrays, planes, 10.0, np.zeros(1))
    np.testing.assert_array_equal(laid.s_low[1:], laid.s_high[:-1])
    # Nearer than a hundredth of the height no ground range is looked at.
    farthest = min(pattern.extent[0] * math.hypot(1.0, 0.01) / 0.01, 1.0)
    assert laid.s_high[-1] >= farthest
    assert laid.s_low[0] <= -farthest
    assert laid.azimuth.size < 30 * planes + 60
