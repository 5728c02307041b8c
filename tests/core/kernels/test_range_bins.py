"""Range bins: what is spread over them, segment by segment and by whole profiles, and that none is ever negative."""

import numpy as np
import pytest

from insonify.kernels.common.range_bins import (
    FIXED_POINT,
    RangeBins,
    accumulate_bins,
    mean_over_centre,
    range_weight,
    spread_energy,
    step_density,
    tilt_density,
)
from insonify.kernels.common.types import NO_DECAY, RangeDecay
from insonify.kernels.sweep.segment_densities import deposit_linear_densities
from insonify.kernels.sweep.visibility import empty_segment_echoes

DECAYS = [NO_DECAY, RangeDecay(4.0, 0.0), RangeDecay(4.0, 0.3), RangeDecay(0.0, 9.0)]


def empty_bins(count, decay=NO_DECAY):
    return RangeBins(np.zeros(count + 2, dtype=np.int64), decay)


def spread_over(pieces, count=20, decay=NO_DECAY):
    bins, out = empty_bins(count, decay), np.zeros(count, dtype=np.float32)
    for near, far, energy in pieces:
        spread_energy(bins, near, far, energy * FIXED_POINT)
    accumulate_bins(bins, np.ones(count), out)
    return out


def test_energy_goes_where_the_piece_lies():
    np.testing.assert_allclose(spread_over([(3.25, 5.75, 2.0)])[2:7], [0.0, 0.6, 0.8, 0.6, 0.0], atol=1e-10)
    np.testing.assert_allclose(spread_over([(5.75, 3.25, 2.0)]), spread_over([(3.25, 5.75, 2.0)]))
    assert spread_over([(4.5, 4.5, 1.5)])[4] == pytest.approx(1.5)  # of no length
    assert not spread_over([(3.2, 3.6, -2.0 / FIXED_POINT)]).any()  # rounding below zero is silence


@pytest.mark.parametrize(("near", "far"), [(6.02, 6.03), (6.9, 6.9), (6.7, 7.4), (10.0, 13.0), (18.1, 19.9)])
@pytest.mark.parametrize("loss", [0.0, 0.05])
def test_an_energy_is_weighed_by_its_own_range_and_not_by_that_of_its_bin(near, far, loss):
    decay = RangeDecay(4.0, loss)
    centres = np.arange(20) + 0.5
    mean = centres**-4.0 * np.exp(-loss * centres) * mean_over_centre(20, decay)
    out = spread_over([(near, far, 1.0)], decay=decay) * mean
    r = near + (far - near) * (np.arange(10000) + 0.5) / 10000
    exact = np.bincount(r.astype(int), r**-4.0 * np.exp(-loss * r) / r.size, 20)
    np.testing.assert_allclose(out, exact, rtol=0.03, atol=0.01 * exact.max())  # half as much as the second order
    single = [range_weight(decay, k, place, 0.0) for k, place in zip(r.astype(int), r)]
    np.testing.assert_allclose(np.bincount(r.astype(int), single, 20) / r.size * mean, exact, rtol=2e-3)


@pytest.mark.parametrize("length", [1e-5, 2e-6, 1.1e-6])
@pytest.mark.parametrize("decay", DECAYS)
def test_no_bin_is_negative_however_short_and_loud_its_piece(length, decay):
    """A density beyond 2⁵³ is no longer a whole number of its own in float64."""
    rng = np.random.default_rng(1)
    for energy in rng.uniform(0.1, 4.0, 2000):
        near = np.nextafter(8.0, 0.0) if rng.random() < 0.5 else 8.0 - length * rng.random()
        out = spread_over([(near, near + length, energy)], decay=decay)
        assert out.min() >= 0.0
        if decay is NO_DECAY:
            assert out.sum() == pytest.approx(energy, rel=1e-5)


@pytest.mark.parametrize("decay", DECAYS)
def test_faint_densities_that_change_within_a_bin_leave_none_below_zero(decay):
    rng = np.random.default_rng(2)
    for _ in range(300):
        bins = empty_bins(20, decay)
        density = np.concatenate([[0], rng.integers(0, 4, 40), [0]])
        for position, change in zip(np.sort(rng.uniform(0.0, 20.0, 41)), np.diff(density)):
            step_density(bins, position, change)
        total = np.cumsum(bins.steps)
        assert total[:20].min() >= 0
        assert total[20:].tolist() == [0, 0]


@pytest.mark.parametrize(("near", "far"), [(3.2, 3.7), (3.2, 4.1), (3.0, 5.0), (2.6, 9.3), (17.5, 19.9)])
@pytest.mark.parametrize("change", [-1.9, -0.3, 0.0, 0.7, 2.0])
def test_a_tilted_density_is_the_integral_of_a_linear_one(near, far, change):
    density, bins, out = 0.8, empty_bins(20), np.zeros(20)
    spread_energy(bins, near, far, density * (far - near) * FIXED_POINT)
    tilt_density(bins, near, far, density * FIXED_POINT, change)
    accumulate_bins(bins, np.ones(20), out)
    edges = np.clip(np.linspace(0.0, 20.0, 20 * 1000 + 1), near, far)
    middle = 0.5 * (edges[1:] + edges[:-1])
    linear = density * (1.0 + change * ((middle - near) / (far - near) - 0.5)) * np.diff(edges)
    np.testing.assert_allclose(out, linear.reshape(20, 1000).sum(axis=1), atol=1e-9)
    assert out.sum() == pytest.approx(density * (far - near))


BINS, BIN_LENGTH = 60, 0.05


def one_by_one(echoes, count, decay):
    """Difference array of the segments of a profile, one after the other."""
    bins = empty_bins(BINS, decay)
    for i in range(count - 1):
        energy, a, b = echoes.energy[i], *sorted(echoes.r[i : i + 2] / BIN_LENGTH)
        if energy != 0.0 and b > a:
            step_density(bins, a, np.int64(abs(energy)))
            step_density(bins, b, -np.int64(abs(energy)))
            tilt_density(bins, a, b, energy, echoes.change[i])
    return bins.steps


def random_profile(rng, count, steps, dtype):
    """Knots at random steps of range, in bins, with segments that are hidden or lie beside a hole."""
    echoes = empty_segment_echoes(count + 64, BINS, dtype)
    echoes.r[:count] = np.abs(BIN_LENGTH * (rng.uniform(0.0, 5.0) + np.cumsum(rng.uniform(*steps, count))))
    echoes.energy[: count - 1] = FIXED_POINT * rng.uniform(0.1, 2.0, count - 1) * np.sign(np.diff(echoes.r[:count]))
    echoes.energy[: count - 1][rng.random(count - 1) < 0.2] = 0.0
    echoes.change[: count - 1] = rng.uniform(-1.9, 1.9, count - 1)
    if count > 8:
        echoes.r[count // 2] = np.nan
        echoes.energy[count // 2 - 1 : count // 2 + 1] = 0.0
        echoes.change[count // 2 - 1 : count // 2 + 1] = np.nan
    return echoes


@pytest.mark.parametrize(("dtype", "error"), [(np.float32, 2e-6), (np.float64, 1e-10)])
@pytest.mark.parametrize("steps", [(0.0, 0.9), (0.0, 2.5), (2.0, 6.0), (-1.5, 2.5), (-0.2, 9.0)])
@pytest.mark.parametrize("count", [2, 3, 7, 33, 64])
def test_a_profile_adds_what_its_segments_add_one_by_one(count, steps, dtype, error):
    decay = DECAYS[count % 3]
    rng = np.random.default_rng(count)
    for _ in range(20):
        echoes = random_profile(rng, count, steps, dtype)
        bins, exact = empty_bins(BINS, decay), one_by_one(echoes, count, decay)
        deposit_linear_densities(count, echoes, BIN_LENGTH, bins)
        energy, right = np.cumsum(bins.steps), np.cumsum(exact)
        np.testing.assert_allclose(energy[:BINS], right[:BINS], rtol=0.0, atol=error * FIXED_POINT)
        assert not energy[:BINS][right[:BINS] == 0].any()
        assert not echoes.even.any()
        assert not echoes.odd.any()
