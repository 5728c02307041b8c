"""Speed and accuracy of scenes as planned, beside a floor and Embree's casts: `pytest -m bench -s tests/bench`.

The floor only reads a ping's heights and writes its bins. Embree casts 2000 rays a ping on a scene of triangles; it is
the optional extra `embree`. Times are those of the thread itself, so that what else the machine does hardly counts.
"""

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
KNIFE, BARE = {"sonar.beam": "knife"}, {"targets": []}
ARRAY = {"sonar.beam": {"kind": "array", "length": 0.3, "two_way": True}}
SCENES = {  # with the greatest time of a ping that is aimed at, in µs of one thread
    "knife": (DEFAULT, KNIFE | BARE, 6),
    "knife at 10°": (DEFAULT, KNIFE | BARE | {"track.heading": 10.0}, 12),
    "knife at 37°": (DEFAULT, KNIFE | BARE | {"track.heading": 37.0}, 12),
    "knife at 45°": (DEFAULT, KNIFE | BARE | {"track.heading": 45.0}, 12),
    "knife with targets": (DEFAULT, KNIFE, 14),
    "default, bare": (DEFAULT, BARE, 39),
    "default": (DEFAULT, {}, 98),
    "array, two-way": (DEFAULT, ARRAY, None),
    "targets": (load_scene("targets"), {}, None),
    "ghosts": (load_scene("ghosts"), {}, None),
    "rough-ground": (load_scene("rough-ground"), {}, 1800),
    "thermocline": (load_scene("thermocline"), {}, 700),
    "wreck": (load_scene("wreck"), {}, 750),
}
FLOORS = 8  # runs of the floor in a call: a single one takes 0.2 ms, and its time varies by a third
PLANES = 8
ROUNDS = 15
THREADS = 2


def embree_call(simulation, pings):
    """Call that casts 1000 rays a side at the pings, aimed as the exact rays of a knife."""
    arrays, poses = simulation.reduced, simulation.poses(pings)
    triangles = TriangulatedScene(arrays, poses)
    casts = []
    for ping in range(pings.size):
        for side in range(2):
            launch, bundle = empty_launch(1000), empty_bundle(1000)
            beam = orient_beam(arrays, poses, ping, side)
            aim_rays(launch, beam.z, 0.0, beam.reach, 0.0, arrays.law, False)
            rotate_to_world(launch, beam, bundle)
            origins = np.column_stack([bundle.x, bundle.y, bundle.z]) - triangles._origin
            directions = np.column_stack([bundle.dx, bundle.dy, bundle.dz])
            casts.append((origins.astype(np.float32), directions.astype(np.float32)))
    return lambda: [triangles._scene.run(*cast, output=1) for cast in casts]


def test_scenes_as_planned(say):
    bare = prepare(edit(DEFAULT, KNIFE | BARE), threads=1)
    calls, sizes, rows = {"floor": floor_call(bare, PINGS.size, FLOORS)}, {"floor": FLOORS * PINGS.size}, {}
    if find_spec("embreex") is not None:
        calls["Embree"], sizes["Embree"] = embree_call(bare, SOME), SOME.size
    for name, (scene, changes, aim) in SCENES.items():
        simulation = prepare(edit(scene, changes), threads=1)
        pings = np.arange(0, simulation.scene.track.pings, 1 if simulation.plan.cost < 3e-4 else 8)
        poses, some = simulation.poses(pings), simulation.poses(pings[:: max(pings.size // 12, 1)])
        planes = max(simulation.plan.planes, 1)
        fine = replace(simulation.plan, model=simulation.plan.model._replace(planes=512 if planes > 1 else 1))
        right = replace(simulation, plan=fine).trace(some)
        errors = compare_records(simulation.reduced, some, simulation.trace(some), right)
        labelled = f"{name} labelled"
        calls[name], calls[labelled] = partial(simulation.trace, poses), partial(simulation.labels, poses)
        sizes[name] = sizes[labelled] = pings.size
        rows[name] = planes, errors, aim
    timings = time_calls(calls, rounds=7, clock=thread_time)
    each = {name: 1e6 * timings[name].median / size for name, size in sizes.items()}
    say(f"floor {each['floor']:.2f} µs a ping, 2000 casts by Embree {each.get('Embree', np.nan):.0f} µs")
    for name, (planes, errors, aim) in rows.items():
        say(
            f"{name:18s} {each[name]:7.1f} µs a ping ± {100 * timings[name].spread:2.0f} %"
            f" (aim {aim or '-'}), {planes:2d} planes, {100 * errors.beyond:.2f} % from 512,"
            f" with labels × {each[f'{name} labelled'] / each[name]:.2f}, {each[name] / each['floor']:.1f} × the floor,"
            f" Embree's casts {each.get('Embree', np.nan) / each[name]:.1f} ×",
        )
    say("aims of the knife: at most 3 × the floor, Embree's casts at least 100 ×, towed obliquely at most 2 ×")


def test_a_knife_against_rays(say):
    simulation = prepare(edit(DEFAULT, KNIFE | BARE))
    arrays, few = simulation.reduced, simulation.poses(SOME)
    exact = rays.trace(arrays, few, rays=1 << 18)
    for words, limits in (("whole segments, as planned", arrays), ("segments divided", simulation.arrays)):
        errors = compare_records(arrays, few, sweep.trace(limits, few), exact)
        say(f"knife, {words}: {100 * errors.beyond:.2f} % beyond 1.4 altitudes, {100 * errors.all_bins:.2f} % in all")


def trace_call(simulation, **settings):
    poses = simulation.poses(PINGS)
    return partial(sweep.trace, simulation.reduced, poses, **{"threads": 1, **simulation.plan.settings} | settings)


def count_planes(simulation, planes):
    return lay_planes_of_images(simulation.reduced, simulation.poses(PINGS[:1]), planes)[0].of(0).azimuth.size


def test_an_array_beside_a_fan_of_as_many_planes(say):
    fan, array = (prepare(edit(DEFAULT, BARE | beam)) for beam in ({}, ARRAY))
    laid = count_planes(array, PLANES)
    alike = min(range(2, 64), key=lambda n: abs(count_planes(fan, n) - laid))
    calls = {"array": trace_call(array, planes=PLANES), "fan": trace_call(fan, planes=alike)}
    timings = time_calls(calls, rounds=ROUNDS, clock=thread_time)
    more = timings["array"].median / timings["fan"].median / (laid / count_planes(fan, alike))
    say(f"array, two-way: {more:.2f} × a fan of as many planes (at most 1.5)")


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
