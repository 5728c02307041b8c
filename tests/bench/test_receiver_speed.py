"""What each effect of the receiver costs, printed: run with `pytest -m bench -s tests/bench`."""

import numpy as np
import pytest

from insonify.accuracy.timing import time_calls
from insonify.parallel import in_parallel
from insonify.receiver import receive
from insonify.scene import edit, load_scene
from insonify.simulation import prepare
from insonify.tracers.scatterers import ScattererTracer

pytestmark = pytest.mark.bench
PINGS = np.arange(512)
K = {"kind": "k", "shape": 2.0}
EFFECTS = {
    "tone of 1.5 bins": {},
    "ideal pulse": {"sonar.pulse": "ideal"},
    "chirp of 1 ms (31 taps)": {"sonar.pulse": "chirp"},
    "Rayleigh": {"receiver.speckle": "rayleigh"},
    "Rayleigh, pings 5 mm apart": {"receiver.speckle": "rayleigh", "track.speed": 0.05},
    "Rayleigh, 4 looks": {"receiver.speckle": {"kind": "rayleigh", "looks": 4}},
    "K": {"receiver.speckle": K},
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

        def call(waves=waves, arrays=arrays, poses=poses, planes=simulation.plan.planes):
            waves.trace(arrays, poses, planes=planes, threads=1)

        timing = time_calls({"coherent": call}, rounds=5)["coherent"]
        say(
            f"coherent, {waves.scatterers.density:.0f} scatterers a m²: "
            f"{1e3 * timing.median / pings.size:.2f} ms a ping on one thread"
        )
