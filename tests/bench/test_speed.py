"""Speed and accuracy side by side, and kernels beside a floor and Embree's casts: `pytest -m bench -s tests/bench`.

The floor only reads a ping's heights and writes its bins. Embree casts 2000 rays a ping on a scene of triangles; it is
the optional extra `embree`. Times are those of the thread itself, so that what else the machine does hardly counts.
"""

import math
from dataclasses import replace
from functools import partial
from importlib.util import find_spec
from time import thread_time

import numpy as np
import pytest

from floor import floor_call
from insonify.accuracy.charts.embree import TriangulatedScene
from insonify.accuracy.timing import time_calls
from insonify.kernels.rays.cell_walk import empty_bundle
from insonify.kernels.rays.launch import aim_rays, empty_launch, orient_beam, rotate_to_world
from insonify.scene import edit, load_scene
from insonify.simulation import prepare
from insonify.statistics.record_errors import compare_records
from insonify.tracers import rays, sweep
from insonify.tracers.azimuth_fan import lay_planes_of_images

pytestmark = pytest.mark.bench
DEFAULT = load_scene("default")
PINGS, SOME = np.arange(512), np.arange(40, 480, 40)
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
        calls[name], calls[f"{name} labelled"] = partial(simulation.trace, poses), partial(simulation.labels, poses)
        rows[name] = planes, pings.size, errors, aim
    timings = time_calls(calls, rounds=7, clock=thread_time)
    for name, (planes, pings, errors, aim) in rows.items():
        say(
            f"{name:15s} {1e6 * timings[name].median / pings:7.1f} µs a ping ± {100 * timings[name].spread:2.0f} %"
            f" (aim {aim or '-'}), {planes:2d} planes, {100 * errors.beyond:.2f} % from 512,"
            f" with labels × {timings[f'{name} labelled'].median / timings[name].median:.2f}",
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


KNIFE, BARE = {"sonar.beam": "knife"}, {"targets": []}
ARRAY = {"kind": "array", "length": 0.3, "two_way": True}
HEADINGS = (10.0, 37.0, 45.0)
PLANES = 8
ROUNDS = 15
FLOORS = 8  # runs of the floor in a call: a single one takes 0.2 ms, and its time varies by a third
THREADS = 2


def embree_call(simulation, pings):
    """Call that casts 1000 rays a side at the pings, aimed as the exact rays of a knife."""
    arrays, poses = simulation.reduced, simulation.poses(pings)
    triangles = TriangulatedScene(arrays, poses)
    bundles = []
    for ping in range(pings.size):
        for side in range(2):
            launch, bundle = empty_launch(1000), empty_bundle(1000)
            beam = orient_beam(arrays, poses, ping, side)
            aim_rays(launch, beam.z, 0.0, beam.reach, 0.0, arrays.law, False)
            rotate_to_world(launch, beam, bundle)
            bundles.append(bundle)
    rays = [
        (
            (np.column_stack([bundle.x, bundle.y, bundle.z]) - triangles._origin).astype(np.float32),
            np.column_stack([bundle.dx, bundle.dy, bundle.dz]).astype(np.float32),
        )
        for bundle in bundles
    ]
    return lambda: [triangles._scene.run(origins, directions, output=1) for origins, directions in rays]


def trace_call(simulation, pings=PINGS, **settings):
    poses = simulation.poses(pings)
    settings = {"threads": 1, **simulation.plan.settings} | settings
    return partial(sweep.trace, simulation.reduced, poses, **settings)


def planes_of(simulation, planes):
    return lay_planes_of_images(simulation.reduced, simulation.poses(PINGS[:1]), planes)[0][1].azimuth.size


def cases():
    """Calls with their numbers of pings, and pairs to compare: name, what, beside what, the goal."""
    calls, pairs = {}, []
    knife = prepare(edit(DEFAULT, KNIFE | BARE))
    calls["floor"] = floor_call(knife, PINGS.size, FLOORS), FLOORS * PINGS.size
    if find_spec("embreex") is not None:
        calls["Embree, 2000 casts"] = embree_call(knife, SOME), SOME.size
    calls["knife"] = trace_call(knife), PINGS.size
    calls["knife with targets"] = trace_call(prepare(edit(DEFAULT, KNIFE))), PINGS.size
    for heading in HEADINGS:
        tow = prepare(edit(DEFAULT, KNIFE | BARE | {"track.heading": heading}))
        calls[f"knife towed at {heading:g}°"] = trace_call(tow), PINGS.size
        pairs.append((f"knife towed at {heading:g}°", "knife", 1.0, "2"))
    fan = prepare(edit(DEFAULT, BARE))
    array = prepare(edit(DEFAULT, BARE | {"sonar.beam": ARRAY}))
    calls["array, two-way"] = trace_call(array, planes=PLANES), PINGS.size
    laid = planes_of(array, PLANES)
    alike = min(range(2, 64), key=lambda n: abs(planes_of(fan, n) - laid))
    calls["fan of as many planes"] = trace_call(fan, planes=alike), PINGS.size
    pairs.append(("array, two-way", "fan of as many planes", laid / planes_of(fan, alike), "1.5"))
    return calls, pairs


def test_kernels(say):
    calls, pairs = cases()
    timings = time_calls({name: call for name, (call, _) in calls.items()}, rounds=ROUNDS, clock=thread_time)
    each = {name: 1e6 * timings[name].median / pings for name, (_, pings) in calls.items()}
    embree = each.get("Embree, 2000 casts", np.nan)
    for name, microseconds in each.items():
        say(
            f"{name:28s} {microseconds:10.2f} µs a ping ± {100 * timings[name].spread:3.0f} %, "
            f"{microseconds / each['floor']:8.2f} × the floor, Embree's casts {embree / microseconds:8.2f} ×",
        )
    say(f"knife: {each['knife'] / each['floor']:.1f} × the floor (at most 3)")
    if math.isfinite(embree):
        say(f"knife: {embree / each['knife']:.0f} × fewer µs than Embree's casts (at least 100)")
    say(f"targets + {each['knife with targets'] - each['knife']:.1f} µs a ping (at most 8)")
    for what, beside, more, goal in pairs:
        say(f"{what}: {each[what] / each[beside] / more:.2f} × {beside} (at most {goal})")


def test_the_default_fan_as_planned(say):
    simulation = prepare(DEFAULT)
    calls = {threads: trace_call(simulation, threads=threads) for threads in (1, THREADS)}
    timings = time_calls(calls, rounds=ROUNDS)
    timing = timings[THREADS]
    planes = simulation.plan.planes
    say(
        f"default fan, {planes} planes, {PINGS.size} pings on {THREADS} threads: {1e3 * timing.median:.1f} ms "
        f"± {100 * timing.spread:.0f} % (at most 25), {timings[1].median / timing.median:.2f} × as fast as one "
        "(at least 1.8)",
    )
