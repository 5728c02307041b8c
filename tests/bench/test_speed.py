"""Speed and accuracy side by side, printed: run with `pytest -m bench -s tests/bench`."""

from dataclasses import replace
from functools import partial
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
SOME = np.arange(40, 480, 40)


SCENES = {  # with the greatest time of a ping that is aimed at, in µs of one thread
    "knife": (DEFAULT, {"sonar.beam": "knife", "targets": []}, 6),
    "knife at 37°": (DEFAULT, {"sonar.beam": "knife", "targets": [], "track.heading": 37.0}, 12),
    "default, bare": (DEFAULT, {"targets": []}, 39),
    "default": (DEFAULT, {}, 98),
    "array, two-way": (DEFAULT, {"sonar.beam": {"kind": "array", "length": 0.3, "two_way": True}}, None),
    "targets": (load_scene("targets"), {}, None),
    "ghosts": (load_scene("ghosts"), {}, None),
    "rough-ground": (load_scene("rough-ground"), {}, 1800),
    "thermocline": (load_scene("thermocline"), {}, 700),
    "wreck": (load_scene("wreck"), {}, 750),
}


def test_scenes_as_planned(say):
    calls, rows = {}, {}
    for name, (scene, changes, aim) in SCENES.items():
        simulation = prepare(edit(scene, changes), threads=1)
        pings = np.arange(0, simulation.scene.track.pings, 1 if simulation.plan.cost < 3e-4 else 8)
        poses, some = simulation.poses(pings), simulation.poses(pings[:: max(pings.size // 12, 1)])
        planes = max(simulation.plan.planes, 1)
        fine = replace(simulation.plan, model=simulation.plan.model._replace(planes=512 if planes > 1 else 1))
        right = replace(simulation, plan=fine).trace(some)
        errors = compare_records(simulation.reduced, some, simulation.trace(some), right)
        calls[name] = partial(simulation.trace, poses)
        rows[name] = planes, pings.size, errors, aim
    timings = time_calls(calls, rounds=7, clock=thread_time)
    for name, (planes, pings, errors, aim) in rows.items():
        say(
            f"{name:15s} {1e6 * timings[name].median / pings:7.1f} µs a ping ± {100 * timings[name].spread:2.0f} %"
            f" (aim {aim or '-'}), {planes:2d} planes, {100 * errors.beyond:.2f} % from 512",
        )


def test_a_knife_against_rays(say):
    simulation = prepare(edit(DEFAULT, {"sonar.beam": "knife", "targets": []}))
    arrays, few = simulation.reduced, simulation.poses(SOME)
    exact = rays.trace(arrays, few, rays=1 << 18)
    for words, limits in (("whole segments, as planned", arrays), ("segments divided", simulation.arrays)):
        errors = compare_records(arrays, few, sweep.trace(limits, few), exact)
        say(f"knife, {words}: {100 * errors.beyond:.2f} % beyond 1.4 altitudes, {100 * errors.all_bins:.2f} % in all")
    single = compare_records(arrays, few, sweep.trace(arrays, few), sweep.trace(arrays, few, double=True))
    say(f"knife: single precision errs by {single.beyond:.1e} of double")
