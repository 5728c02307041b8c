"""Errors that the planes of a ping estimate: their factor as printed, and cases with a known variance."""

import math

import numpy as np
import pytest
from scipy.special import zeta

from insonify.compiler.jit import kernel
from insonify.kernels.common.range_bins import FIXED_POINT, RangeBins
from insonify.kernels.common.types import NO_DECAY
from insonify.kernels.sweep.plane_errors import (
    ALPHA,
    BEYOND,
    NODES,
    POWER_STEP,
    REGIONS,
    add_plane,
    begin_side,
    empty_plane_sums,
    finish_side,
    share_planes,
)

BINS = 4000


@pytest.mark.parametrize("place", range(ALPHA.size))
def test_the_factor_is_that_of_the_formula(place):
    p = POWER_STEP * place + 1e-7  # beside its removable poles
    found = math.gamma(p + 1.0) * zeta(p + 1.0) * math.cos(0.5 * math.pi * (p - 1.0))
    found /= (2.0 * math.pi) ** (p + 1.0) * (1.0 - 2.0 ** (p - 2.0))
    assert pytest.approx(found, rel=1e-4) == ALPHA[place]


@kernel
def add_planes(sums, bins, rows, shares, apart, factor, out, errors):
    """Take planes with the energies of rows, (planes, bins), of equal shares."""
    begin_side(sums)
    for k in range(rows.shape[0]):
        before = 0
        for i in range(rows.shape[1]):
            value = np.int64(rows[k, i] * FIXED_POINT)
            bins.steps[i] += value - before
            before = value
        add_plane(sums, bins, shares, rows.shape[1], float(k), apart[k])
    finish_side(sums, factor, out, errors, np.zeros(0, np.float32))


def estimate(densities, apart=()):
    """Square of the estimated error of the mean of planes with densities, (planes, bins), summed over the bins."""
    planes, sums = len(densities), empty_plane_sums(BINS)
    sums.scale[:] = 1.0 / FIXED_POINT
    sums.edges[BEYOND] = 0, BINS
    sums.nodes[:] = np.linspace(0.0, BINS, NODES)
    errors, out = np.zeros((REGIONS, 2)), np.zeros(BINS, np.float32)
    steps = RangeBins(np.zeros(BINS + 2, np.int64), NO_DECAY)
    begins = np.isin(np.arange(planes), apart)
    rows = np.asarray(densities, float) / planes
    add_planes(sums, steps, rows, np.full(NODES + 1, 1.0 / planes), begins, np.ones(BINS), out, errors)
    np.testing.assert_allclose(out, rows.sum(axis=0), rtol=1e-5)
    return errors[BEYOND, 0]


@pytest.mark.parametrize("planes", [3, 4, 8, 16])
def test_planes_at_random_err_as_a_mean_and_an_edge_between_two_as_its_uniform_place(planes):
    random = np.random.default_rng(planes)
    noise = random.normal(size=(planes, BINS))
    assert estimate(5.0 + noise) == pytest.approx(BINS / planes, rel=0.15)
    edges = random.uniform(0.0, planes, BINS)
    lit = np.arange(planes)[:, None] + 0.5 < edges
    # The square of a mean of planes against the integral: 1/12 of a plane's own.
    assert estimate(lit) == pytest.approx(BINS / 12.0 / planes**2, rel=0.35 if planes < 5 else 0.15)


def test_what_is_even_errs_by_nothing_and_a_slope_by_next_to_nothing():
    places = np.arange(8.0)[:, None]
    assert estimate(np.ones((8, BINS))) == 0.0
    assert estimate(1.0 + places + np.zeros(BINS)) < 1e-9 * BINS


def test_an_edge_at_a_border_of_a_target_is_known_and_errs_by_nothing():
    lit = np.repeat([0.0, 1.0], 4)[:, None] + np.zeros(BINS)
    assert estimate(lit) > 0.0
    assert estimate(lit, apart=(4,)) == 0.0


@pytest.mark.parametrize("bins", [1, 2, 10, NODES])
def test_records_of_few_bins_are_weighed_within_their_room(bins):
    sums, guarded = empty_plane_sums(bins), np.full(3 * bins + 2 * NODES, np.float32(7.0))
    sums = sums._replace(density=guarded[: 3 * bins].reshape(3, bins))
    sums.nodes[:] = np.linspace(1.0, bins + 1.0, NODES)
    weights = np.arange(2.0 * (NODES + 1)).reshape(2, NODES + 1)
    whole = weights.sum(axis=0)
    share_planes(sums, weights)
    assert (guarded == 7.0).all()
    np.testing.assert_allclose(sums.weights, whole)
    np.testing.assert_allclose(weights.sum(axis=0), 1.0)
