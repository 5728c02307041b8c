"""Constants of a plan's counts of work beside measured ones: `pytest -m bench -s tests/bench/test_plan_work.py`.

Each is measured as the ratio of the times of two models of one scene, traced in turns on one thread. Times are those of
the thread itself, so that what else the machine does hardly counts.
"""

import math
from time import thread_time

import numpy as np
import pytest

from insonify.accuracy.timing import time_calls
from insonify.packing.packed_scene import Model, pack
from insonify.planning import Plan
from insonify.scene import edit, load_scene
from insonify.tracers import march, rays, sweep
from insonify.tracers.base import prepare_tracer

pytestmark = pytest.mark.bench
STRIDES = 1, 2, 4, 8, 16, 32
PINGS, MANY, ROUNDS = np.arange(40, 480, 40), np.arange(480), 9
DEFAULT = load_scene("default")
REACH, SPACING = DEFAULT.sonar.range, DEFAULT.seabed.spacing
KNOTS = REACH / SPACING
BARE, KNIFE, FLAT = {"targets": []}, {"sonar.beam": "knife"}, {"water.surface": "flat"}
ARRAY = {"sonar.beam": {"kind": "array", "length": 0.3, "two_way": True}}
BENT = {"water": {"kind": "profile", "depth": [0.0, 30.0], "sound_speed": [1500.0, 1495.0]}}
ROUGH = {"water.surface": {"kind": "rough", "wind_speed": 6.0}}
PATHS = frozenset({"surface_bottom", "surface_bottom_surface", "second_bottom"})
SURFACE_SCENES = {  # with the targets and planes of each
    "knife, bare bed": (DEFAULT, BARE | KNIFE, 1),
    "fan, bare bed": (DEFAULT, BARE, 8),
    "fan, bare bed, rough sea": (DEFAULT, BARE | ROUGH, 8),
    "array, bare bed": (DEFAULT, BARE | ARRAY, 8),
    "default": (DEFAULT, {}, 8),
    "ghosts": (load_scene("ghosts"), {}, 8),
    "wreck": (load_scene("rough-ground"), {"sonar.vertical": {"kind": "uniform"}}, 8),
    "wreck, array": (load_scene("rough-ground"), ARRAY | {"sonar.vertical": {"kind": "uniform"}}, 8),
}


def call_of(scene, model, pings=PINGS):
    """Call that traces a scene's pings by a model with all targets."""
    packed = pack(scene)
    model = model._replace(targets=tuple(range(len(scene.targets))))
    poses = packed.poses(pings[pings < scene.track.pings])
    tracer, arrays, settings = prepare_tracer(packed, model), packed.modelled_arrays(model), Plan(model).settings
    return lambda: tracer.trace(arrays, poses, threads=1, **settings), poses.x.size


def medians(calls):
    """Seconds of a ping of each call."""
    timings = time_calls({name: call for name, (call, _) in calls.items()}, rounds=ROUNDS, clock=thread_time)
    return {name: timings[name].median / pings for name, (_, pings) in calls.items()}


def time_a_knot(times):
    """Seconds of a knot on both sides, from those of a knife with all nodes and with every second."""
    return (times[1] - times[2]) / (0.5 * KNOTS)


def tell(say, name, constant, measured):
    say(f"{name:40s} {constant:8.2f} in plans, {measured:8.2f} measured")


def test_knots_planes_and_targets(say):
    bare = edit(DEFAULT, BARE | KNIFE)
    calls = {every: call_of(bare, Model(every=every), MANY) for every in STRIDES}
    calls |= {share: call_of(bare, Model(misplaced=share), MANY) for share in sweep.KNOTS if share < math.inf}
    calls["targets"] = call_of(edit(DEFAULT, KNIFE), Model(), MANY)
    calls["bent"] = call_of(edit(DEFAULT, BARE | KNIFE | BENT), Model(bent=True), MANY)
    times = medians(calls)
    knot = time_a_knot(times)
    plane = times[1] / knot - KNOTS
    tell(say, "PLANE, knots of a knife", sweep.PLANE, plane)
    segments, parts, beyond = zip(
        *(sweep._divide_profile(REACH, every * SPACING, DEFAULT.altitude) for every in STRIDES)
    )
    left = np.array([times[every] for every in STRIDES]) / knot - plane - np.array(beyond)
    cut, part = np.linalg.lstsq(np.column_stack([segments, parts])[2:], left[2:])[0]
    tell(say, "CUT_SEGMENT, knots", sweep.CUT_SEGMENT, cut)
    tell(say, "PART, knots", sweep.PART, part)
    tell(say, "TARGET, knots", sweep.TARGET, (times["targets"] - times[1]) / knot / len(DEFAULT.targets))
    tell(say, "REFRACTED, knots of a knot", sweep.REFRACTED, (times["bent"] / knot - plane) / KNOTS)
    for share, constant in sweep.KNOTS.items():
        if share < math.inf:
            tell(say, f"KNOTS[{share}]", constant, (times[share] / knot - plane) / KNOTS)


def test_planes_of_the_near_field(say):
    for name, changes, constant in (
        ("NEAR_PLANES", BARE, sweep.NEAR_PLANES),
        ("NEAR_PLANES_OF_PATTERN", BARE | ARRAY, sweep.NEAR_PLANES_OF_PATTERN),
    ):
        scene = edit(DEFAULT, changes)
        times = medians({planes: call_of(scene, Model(planes=planes), MANY) for planes in (1, 8)})
        tell(say, f"{name}, beside 8 planes", constant, times[8] / times[1] - 8.0)


def test_surface_paths(say):
    for name, (scene, changes, planes) in SURFACE_SCENES.items():
        below = edit(scene, FLAT | changes)
        calls = {ways: call_of(below, Model(planes=planes, ways=ways)) for ways in (frozenset(), PATHS)}
        times = medians(calls)
        ratio = (times[PATHS] / times[frozenset()] - 1.0) / len(PATHS)
        facets = pack(below).arrays.multipath.facets.shape[1]
        constant = sweep.SURFACE_PATH + (sweep.FACET * facets if facets > 1 else 0.0)
        tell(say, f"a path by the surface, {name}", constant, ratio)
        say(f"{'':40s} × {1.0 + len(PATHS) * ratio:.2f} with all three (at most 3 over a calm sea)")


def test_single_rays(say):
    bare, few, count = edit(DEFAULT, BARE | KNIFE), PINGS[:2], 2000
    calls = {every: call_of(bare, Model(every=every), MANY) for every in STRIDES}
    calls["rays"] = call_of(bare, Model("rays", rays=count), few)
    calls["bent"] = call_of(edit(bare, BENT), Model("rays", rays=count, bent=True), few)
    calls["march"] = call_of(bare, Model("march", rays=count, step=0.1), few)
    times, steps = medians(calls), REACH / 0.1
    knot = time_a_knot(times)
    tell(say, "RAY, knots", rays.RAY, times["rays"] / knot / count)
    tell(say, "REFRACTED_RAY, knots", rays.REFRACTED_RAY, times["bent"] / knot / count)
    tell(say, "STEP, knots", march.STEP, (times["march"] / knot / count - rays.RAY) / steps)
