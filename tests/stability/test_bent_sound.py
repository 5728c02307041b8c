"""Rays between two points where a search for them is easily led astray."""

from __future__ import annotations

import numpy as np
import pytest

from insonify.accuracy.stability.themes.refraction import exact_time
from insonify.acoustics.paths import eigenrays
from insonify.scene.water.layered import ProfileWater

ONE_GRADIENT = ProfileWater(depth=(0.0, 8000.0), sound_speed=(1500.0, 1628.0))


@pytest.mark.parametrize(("depth", "to"), [(4000.0, 4100.0), (10.0, 110.0), (4100.0, 4000.0), (2000.0, 2000.0)])
def test_one_ray_comes_however_near_to_its_vertex(depth, to):
    # It turns at the depth asked for if that lies some 4.4 km away, and short of it farther on.
    for across in np.concatenate([np.arange(4000.0, 6000.0, 100.0), 4422.0 + np.logspace(-3.0, 2.0, 11)]):
        found = eigenrays(ONE_GRADIENT, depth, across, to)
        assert found.sizes["eigenray"] == 1, across
        assert float(found.time[0]) == pytest.approx(float(exact_time(across, (depth, to))), abs=1e-11)
