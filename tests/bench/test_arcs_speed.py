"""What a bent ray costs, printed: run with `pytest -m bench -s tests/bench`."""

import math

import numpy as np
import pytest

from insonify.accuracy.timing import time_calls
from insonify.acoustics.rays import join_points
from insonify.compiler.jit import kernel
from insonify.kernels.refraction.eigenrays import find_direct_ray
from water import NO_CEILING, NO_FLOOR, followed, layers, water_of

pytestmark = pytest.mark.bench
PAIRS = 5000


@kernel
def join_all(height, speed, x, z):
    """Sum of the times, so that nothing is left out."""
    total = 0.0
    for k in range(x.size):
        total += find_direct_ray(height, speed, -5.0, z[k], x[k], NO_FLOOR, NO_CEILING)[1].time
    return total


@pytest.mark.parametrize("nodes", [2, 4, 11, 101])
def test_a_ray(nodes, say):
    depth = np.linspace(0.0, 60.0, nodes)
    water = layers(depth, 1500.0 - 10.0 * np.tanh((depth - 25.0) / 4.0))
    rng = np.random.default_rng(0)
    x, z = rng.uniform(1.0, 100.0, PAIRS), rng.uniform(-60.0, -20.0, PAIRS)
    angles, ranges = np.linspace(2.0, 80.0, 500), np.linspace(0.0, 200.0, 201)
    timings = time_calls(
        {
            "direct": lambda: join_all(*water, x, z),
            "all": lambda: join_points(water_of(*water), -5.0, -30.0, 80.0, -60.0, 0.0, 0),
            "paths": lambda: followed(water_of(*water), 5.0, angles, ranges, bottom=60.0),
        },
        rounds=9,
    )
    direct, every, paths = (timings[name].median * 1e6 for name in ("direct", "all", "paths"))
    say(
        f"{nodes} nodes: the direct ray between two points {direct / PAIRS:.2f} µs, all rays {every:.0f} µs, "
        f"a path of up to 200 points to the bed {paths / angles.size:.1f} µs"
    )
    assert math.isfinite(direct)
