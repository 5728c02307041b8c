"""Occlusion of the bed by targets: the test without angles against the stretches that are visible."""

import numpy as np

from insonify.kernels.multipath.paired_segments import SegmentLine
from insonify.kernels.sweep.partial_segments import launch_angle
from insonify.kernels.targets.occlusion import Occlusion, is_hidden, next_visible

EDGES = np.array([-0.9, -0.7, -0.6, -0.45, -0.4])
NEARNESS = np.array([0.12, 0.1, 0.0, 0.09])  # of targets along the middle of each cell, per metre; one cell is empty


def occlusion():
    """Cells that each hold a target square to the middle of the cell, but one."""
    middle = 0.5 * (EDGES[:-1] + EDGES[1:])
    return Occlusion(EDGES, np.cos(EDGES), np.sin(EDGES), NEARNESS * np.cos(middle), NEARNESS * np.sin(middle))


def test_what_is_hidden_has_no_visible_stretch():
    cells, rng, hidden, behind = occlusion(), np.random.default_rng(3), 0, 0
    for _ in range(4000):
        segment = SegmentLine(rng.uniform(-14.0, -2.0), rng.uniform(-0.2, 0.2))
        start = rng.uniform(1.0, 30.0)
        stop = start + rng.uniform(0.01, 3.0)
        low, high = launch_angle(segment, start), launch_angle(segment, stop)
        dark = low < high and next_visible(cells, segment, low, high)[0] >= high
        found = is_hidden(cells, segment, start, stop)
        assert dark or not found
        hidden, behind = hidden + found, behind + dark
    assert 0.9 * behind < hidden < 4000
