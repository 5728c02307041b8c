"""What effects of the receiver, bent rays and explanations cost, printed: run with `pytest -m bench -s tests/bench`."""

import math
from functools import partial
from statistics import median

import numpy as np
import pytest

from insonify.accuracy.timing import time_calls
from insonify.acoustics.rays import join_points
from insonify.compiler.jit import kernel
from insonify.explanation.cross_section import cut_cross_section
from insonify.explanation.listeners import find_listeners
from insonify.explanation.pixel import explain_pixel
from insonify.kernels.refraction.eigenrays import find_direct_ray
from insonify.parallel import in_parallel
from insonify.receiver import receive
from insonify.scene import edit, load_scene
from insonify.simulation import prepare
from insonify.tracers.scatterers import ScattererTracer
from water import NO_CEILING, NO_FLOOR, followed, layers, water_of

pytestmark = pytest.mark.bench
PINGS = np.arange(512)
EFFECTS = {
    "tone of 1.5 bins": {},
    "ideal pulse": {"sonar.pulse": "ideal"},
    "chirp of 1 ms (31 taps)": {"sonar.pulse": "chirp"},
    "Rayleigh": {"receiver.speckle": "rayleigh"},
    "Rayleigh, pings 5 mm apart": {"receiver.speckle": "rayleigh", "track.speed": 0.05},
    "Rayleigh, 4 looks": {"receiver.speckle": {"kind": "rayleigh", "looks": 4}},
    "K": {"receiver.speckle": {"kind": "k", "shape": 2.0}},
    "fluctuation": {"receiver.fluctuation": {"kind": "lognormal", "travel_time": 1e-4}},
    "reverberation": {"receiver.reverberation": "both"},
    "noise": {"receiver.noise": "ambient"},
    "TVG": {"receiver.tvg": "power"},
}


def test_what_each_effect_costs(say):
    calls = {}
    for name, changes in EFFECTS.items():
        simulation = prepare(edit(load_scene("default"), changes))
        traced = simulation.intensity(PINGS)

        def call(ready=simulation.reception, traced=traced):
            in_parallel(lambda first, last: receive(ready, traced[first:last], PINGS[first:last]), PINGS.size, 2)

        calls[name] = call
    timings = time_calls(calls, rounds=7)
    base = timings["tone of 1.5 bins"].median
    for name, timing in timings.items():
        added = 1e6 * (timing.median - base) / PINGS.size
        say(
            f"{name}: {1e3 * timing.median:.1f} ms for {PINGS.size} pings × 2 × 1000 bins on two threads"
            f" ({added:+.1f} µs a ping)"
        )


def test_what_coherent_speckle_costs(say):
    pings = PINGS[:64]
    for density in (None, 100.0, 10.0):
        speckle = {"kind": "coherent", "density": density}
        simulation = prepare(edit(load_scene("default"), {"receiver.speckle": speckle}))
        waves, arrays, poses = simulation.tracer, simulation.arrays, simulation.poses(pings)
        assert isinstance(waves, ScattererTracer)

        call = partial(waves.trace, arrays, poses, planes=simulation.plan.planes, threads=1)
        timing = time_calls({"coherent": call}, rounds=5)["coherent"]
        say(
            f"coherent, {waves.scatterers.density:.0f} scatterers a m²: "
            f"{1e3 * timing.median / pings.size:.2f} ms a ping on one thread"
        )


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


SCENES = ("default", "targets", "wreck", "thermocline", "ghosts", "raw-record", "rough-tow", "double-image")


@pytest.mark.parametrize("name", SCENES)
def test_time_of_an_explanation(name, say):
    simulation = prepare(load_scene(name))
    bins = np.linspace(0.25, 0.95, 12) * simulation.reduced.bins
    place = np.array([float(simulation.poses(np.array([60])).x[0]), 20.0, 0.0])
    calls = {k: partial(explain_pixel, simulation, 60, 0, int(k)) for k in bins}
    calls["cut"] = partial(cut_cross_section, simulation, 60, 0)
    calls["place"] = partial(find_listeners, simulation, place, np.arange(120))
    *times, cut, found = (1e3 * timing.median for timing in time_calls(calls, rounds=3).values())
    say(
        f"{name}: pixel {median(times):.1f} ms (most {max(times):.1f}), cross-section {cut:.1f} ms, "
        f"pixels of a place {found:.1f} ms\n"
    )
