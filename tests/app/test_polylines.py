"""A line through points holds their coordinates."""

import numpy as np
import pytest

from insonify_viewer.widgets.painting import make_polyline


@pytest.mark.parametrize("size", [0, 1, 2, 1000])
def test_coordinates_are_those_given(size):
    x, y = np.linspace(-3.5, 1e4, size), np.random.default_rng(1).normal(size=size)
    line = make_polyline(x, y)
    assert [(point.x(), point.y()) for point in line] == list(zip(x.tolist(), y.tolist(), strict=True))
