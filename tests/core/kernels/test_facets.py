"""Facets of targets: where their parts lie."""

import numpy as np
import pytest

from insonify.kernels.sweep.facets import Facet, along_curve, facet_curve, is_facet_met


def facet(near: float, centre: float, far: float) -> Facet:
    return Facet(0.1, 0.2, np.cos(0.15), np.sin(0.15), near, centre, far, 0.5, centre)


@pytest.mark.parametrize("share", [0.0, 0.25, 0.5, 0.75, 1.0])
def test_parts_lie_ahead_of_the_sonar_however_long_the_facet_is(share):
    for near, centre, far in ((10.0, 20.0, 1e4), (1e9, 30.0, 5.0), (0.0, 1.0, 1e6)):
        long = facet(near, centre, far)
        assert along_curve(long, facet_curve(long), share) >= 0.0
    short = facet(10.0, 10.1, 10.3)
    assert along_curve(short, facet_curve(short), 0.0) == pytest.approx(10.0)
    assert along_curve(short, facet_curve(short), 1.0) == pytest.approx(10.3)


@pytest.mark.parametrize("wrong", [-1.0, np.inf, np.nan])
def test_a_facet_behind_the_sonar_or_nowhere_is_not_met(wrong):
    assert is_facet_met(facet(10.0, 10.1, 10.3))
    for place in range(3):
        distances = [10.0, 10.1, 10.3]
        distances[place] = wrong
        assert not is_facet_met(facet(*distances))
