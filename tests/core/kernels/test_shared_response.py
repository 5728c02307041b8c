"""The azimuths that two directions of a path by way of the surface share, against sums over many slices."""

from __future__ import annotations

import math

import numpy as np
import pytest

from insonify.kernels.beam.pattern import is_top_hat, shared_response
from insonify.packing.packed_scene import pack
from insonify.scene import edit, load_scene


@pytest.mark.parametrize(
    ("level", "tip", "level_other", "tip_other"),
    [(0.9, 0.0, 0.7, 0.0), (0.3, 0.002, 0.2, -0.003), (0.004, 0.0, 0.003, 0.001), (0.9, 0.02, 0.9, -0.02)],
)
def test_azimuths_shared_by_two_directions_of_a_fan(level, tip, level_other, tip_other) -> None:
    pattern = pack(edit(load_scene("ghosts"), {"track.pings": 1})).arrays.pattern
    assert is_top_hat(pattern)
    sines = np.sin((np.arange(1_000_000) + 0.5) / 1_000_000 * math.pi - math.pi / 2.0)
    covered = (abs(level * sines + tip) <= pattern.extent[0]) & (
        abs(level_other * sines + tip_other) <= pattern.extent[0]
    )
    response = pattern.integral[0, 1] / (2.0 * pattern.extent[0])
    expected = response * covered.mean() * math.pi
    found = shared_response(pattern, level, tip, 20.0, level_other, tip_other, 25.0)
    assert found == pytest.approx(expected, abs=2e-5)
