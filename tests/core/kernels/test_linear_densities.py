"""Linear densities of whole profiles beside those of one segment at a time."""

import numpy as np
import pytest

from insonify.kernels.common.range_bins import FIXED_POINT, step_density, tilt_density
from insonify.kernels.sweep.segment_densities import deposit_linear_densities
from insonify.kernels.sweep.visibility import empty_segment_echoes

BINS, BIN_LENGTH = 60, 0.05


def one_by_one(echoes, count):
    """Difference array of the segments of a profile, one after the other."""
    bins, last = np.zeros(BINS + 2, np.int64), float(BINS)
    for i in range(count - 1):
        energy, a, b = echoes.energy[i], *sorted(echoes.r[i : i + 2] / BIN_LENGTH)
        if energy != 0.0 and b > a:
            step_density(bins, a, np.int64(abs(energy)), last)
            step_density(bins, b, -np.int64(abs(energy)), last)
            tilt_density(bins, a, b, energy, echoes.change[i], last)
    return bins


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
    rng = np.random.default_rng(count)
    for _ in range(20):
        echoes = random_profile(rng, count, steps, dtype)
        bins, exact = np.zeros(BINS + 2, np.int64), one_by_one(echoes, count)
        deposit_linear_densities(count, echoes, BIN_LENGTH, bins)
        energy, right = np.cumsum(bins), np.cumsum(exact)
        np.testing.assert_allclose(energy[:BINS], right[:BINS], rtol=0.0, atol=error * FIXED_POINT)
        assert not energy[:BINS][right[:BINS] == 0].any()
        assert not echoes.even.any()
        assert not echoes.odd.any()
