"""Speed against accuracy of every method on one scene, measured from start to end on this machine."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from time import thread_time

import numpy as np

from insonify.accuracy.charts.accuracy_chart import AccuracyChart, AccuracyRow, TracedScene
from insonify.accuracy.charts.embree import TriangulatedScene, explain_omission
from insonify.accuracy.charts.method_settings import (
    EMBREE,
    EMBREE_OWN,
    MethodSetting,
    Record,
    SettingKey,
    list_settings,
    pack_for_chart,
)
from insonify.accuracy.charts.reference import Reference, refine_reference
from insonify.accuracy.timing import describe_machine, time_calls
from insonify.kernels.common.types import Poses, SceneArrays
from insonify.scene import Scene, SceneError, edit
from insonify.statistics.displacement import measure_displacement
from insonify.statistics.record_errors import compare_records
from insonify.tow.poses import take_poses

PINGS = 8
PROVING = 300.0  # s of processor time for a reference, over all cores; without surface paths rays seldom take as much
TIMING = 8.0  # s
SHORTEST_CALL = 0.01  # s that a timed call takes at least; a quick method traces the pings again and again
MOST_PINGS = 512  # pings of a timed call
RAYS_OF_TRIANGLES = 1 << 20


def measure_chart(
    scene: Scene, *, pings: int = PINGS, progress: Callable[[float], None] | None = None
) -> AccuracyChart:
    """Measure time per ping and error of every method on a scene, on this machine.

    Parameters
    ----------
    scene : Scene
        Scene to trace; one with targets is also traced without them.
    pings : int
        Number of pings to compare, spread evenly over the track.
    progress : callable, optional
        Called now and then with the completed share, from 0 to 1; may raise to stop.

    Returns
    -------
    AccuracyChart

    Raises
    ------
    SceneError
        If there are no pings to trace, or the scene cannot be simulated.
    """
    if pings < 1:
        raise SceneError(f"pings: {pings} is too few; give at least 1")
    scenes = {False: edit(scene, {"targets": []})} if scene.targets else {}
    scenes |= {bool(scene.targets): scene}
    rows: list[AccuracyRow] = []
    traced: dict[bool, TracedScene] = {}
    records: dict[SettingKey, Record] = {}
    for number, (targets, one) in enumerate(scenes.items()):

        def share(done: float, before: int = number) -> None:
            if progress is not None:
                progress((before + done) / len(scenes))

        arrays, poses = pack_for_chart(one, pings)
        measured, traced[targets], found = _measure(targets, arrays, poses, share)
        rows += measured
        records |= found
    notes = tuple(dict.fromkeys(_describe_triangles(targets, scene) for targets, scene in traced.items()))
    count = traced[False].poses.x.size
    return AccuracyChart(scene.title, tuple(rows), count, describe_machine(), traced, records, notes)


chart = measure_chart  # the public name of the package


def _describe_triangles(targets: bool, scene: TracedScene) -> str:
    """State the distance of a scene of triangles itself from the curved surfaces, or why Embree is left out."""
    if scene.triangles is None:
        return explain_omission(scene.arrays, scene.poses)
    apart = compare_records(scene.arrays, scene.poses, scene.triangles.record, scene.reference.record).beyond
    return (
        f"embree: with {scene.triangles.rays:,} rays per side {'bed and targets of' if targets else 'the bed of'} "
        f"triangles differ{'' if targets else 's'} from the exact surfaces by {100.0 * apart:.2g} %; the rest of its "
        "error is due to the number of rays"
    )


def _measure(
    targets: bool, arrays: SceneArrays, poses: Poses, progress: Callable[[float], None]
) -> tuple[list[AccuracyRow], TracedScene, dict[SettingKey, Record]]:
    """Trace all methods, refine the reference until it resolves their errors, time them and compare."""
    named = {SettingKey(one.method, one.setting, targets): one for one in list_settings(arrays, poses)}
    records: dict[SettingKey, Record] = {}
    for number, (key, one) in enumerate(named.items()):
        progress(0.2 * number / len(named))
        records[key] = one.trace(poses)
    reference = refine_reference(
        arrays, poses, list(records.values()), seconds=PROVING, progress=lambda share: progress(0.2 + 0.5 * share)
    )
    scene = TracedScene(arrays, poses, reference, _trace_triangles(arrays, poses, lambda: progress(0.7)))
    timed = {}
    for key, one in named.items():
        progress(0.7)
        timed[key] = _lengthen_call(one, poses)
    timings = time_calls(
        {key: call for key, (call, _) in timed.items()},
        seconds=TIMING,
        clock=thread_time,
        progress=lambda share: progress(0.7 + 0.3 * share),
    )
    rows = []
    for key, one in named.items():
        per_ping = 1e6 * timings[key].median / timed[key][1]
        for method in (one.method, EMBREE_OWN) if one.method == EMBREE else (one.method,):
            records[key._replace(method=method)] = records[key]
            pair = records[key], scene.reference_of(method).record
            errors, moved = compare_records(arrays, poses, *pair), measure_displacement(arrays, poses, *pair)
            spread = timings[key].spread
            rows.append(AccuracyRow(method, one.setting, one.size, targets, per_ping, spread, errors, moved))
    return sorted(rows, key=lambda row: row.method == EMBREE_OWN), scene, records


def _trace_triangles(arrays: SceneArrays, poses: Poses, report: Callable[[], None]) -> Reference | None:
    """Trace a scene of triangles and how far doubling the rays moves its record; None without Embree."""
    if explain_omission(arrays, poses):
        return None
    scene = TriangulatedScene(arrays, poses)

    def trace(rays: int) -> Record:
        records = []
        for ping in range(poses.x.size):
            records.append(scene.trace(take_poses(poses, slice(ping, ping + 1)), rays=rays))
            report()
        return np.concatenate(records)

    half, whole = trace(RAYS_OF_TRIANGLES // 2), trace(RAYS_OF_TRIANGLES)
    moved = compare_records(arrays, poses, half, whole)
    return Reference(whole, moved.beyond, RAYS_OF_TRIANGLES, moved.all_bins)


def _lengthen_call(one: MethodSetting, poses: Poses) -> tuple[Callable[[], Record], int]:
    """Call that traces the poses often enough to be timed, and the number of pings that it traces."""
    began = thread_time()
    one.trace(poses)
    times = math.ceil(SHORTEST_CALL / max(thread_time() - began, 1e-6))
    many = take_poses(poses, np.tile(np.arange(poses.x.size), max(min(times, MOST_PINGS // poses.x.size), 1)))
    return partial(one.trace, many), many.x.size
