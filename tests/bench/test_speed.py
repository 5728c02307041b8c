"""Speed and accuracy side by side, printed: run with `pytest -m bench -s tests/bench`."""

from time import thread_time

import numpy as np
import pytest

from insonify.accuracy.timing import time_calls
from insonify.scene import edit, load_scene
from insonify.simulation import prepare
from insonify.statistics.record_errors import compare_records
from insonify.tracers import rays, sweep

pytestmark = pytest.mark.bench
DEFAULT = load_scene("default")
PINGS = np.arange(512)
SOME = np.arange(40, 480, 40)


def test_a_knife_on_one_thread(say):
    simulation = prepare(edit(DEFAULT, {"sonar.beam": "knife", "targets": []}))
    arrays, poses = simulation.arrays, simulation.poses(PINGS)
    timing = time_calls({"knife": lambda: sweep.trace(arrays, poses, threads=1)}, rounds=9, clock=thread_time)["knife"]
    few = simulation.poses(SOME)
    errors = compare_records(arrays, few, sweep.trace(arrays, few), rays.trace(arrays, few, rays=1 << 18))
    say(
        f"knife, 2 × 1000 bins over 1024²: {PINGS.size / timing.median:,.0f} pings/s a thread "
        f"({1e6 * timing.median / PINGS.size:.1f} µs a ping, ± {100 * timing.spread:.0f} %), "
        f"error {100 * errors.beyond:.2f} % beyond 1.4 altitudes, {100 * errors.all_bins:.2f} % in all",
    )
    single = compare_records(arrays, few, sweep.trace(arrays, few), sweep.trace(arrays, few, double=True))
    say(f"knife: single precision errs by {single.beyond:.1e} of double")


def test_a_fan_as_planned(say):
    fans = {
        f"{width:g}°{', no targets' if not targets else ''}": prepare(
            edit(DEFAULT, {"sonar.beam.width": width} | ({} if targets else {"targets": []}))
        )
        for width in (1.0, 2.5)
        for targets in (True, False)
    }

    def tracing(simulation):
        poses = simulation.poses(PINGS)
        return lambda: sweep.trace(simulation.arrays, poses, planes=simulation.plan.planes, threads=2)

    timings = time_calls({name: tracing(simulation) for name, simulation in fans.items()}, rounds=5)
    for name, simulation in fans.items():
        poses = simulation.poses(SOME)
        record, fine = (sweep.trace(simulation.arrays, poses, planes=n) for n in (simulation.plan.planes, 64))
        errors = compare_records(simulation.arrays, poses, record, fine)
        say(
            f"fan of {name}: {simulation.plan.planes} planes, {1e3 * timings[name].median:.0f} ms for "
            f"{PINGS.size} pings on two threads, {100 * errors.beyond:.2f} % from 64 planes",
        )
