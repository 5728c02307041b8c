"""Search in ascending numbers, against NumPy's."""

import numpy as np
import pytest

from insonify.kernels.common.search import last_not_above


@pytest.mark.parametrize("count", [0, 1, 2, 5, 64, 513])
def test_the_last_that_is_not_above(count):
    rng = np.random.default_rng(count)
    edges = np.sort(rng.integers(-20, 20, count) / 4.0)
    for x in (*edges, *rng.uniform(-6.0, 6.0, 50), -np.inf, np.inf):
        assert last_not_above(edges, x) == np.searchsorted(edges, x, side="right") - 1
