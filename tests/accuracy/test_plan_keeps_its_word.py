"""What plans predict against what comes out, over random scenes: run all of them with `pytest -m bench -s`.

An error under what the reference itself can tell, or under 0.3 % of the record, counts as predicted if it was predicted
to be that small. What a plan costs is measured beside the settings of the chart: planes by doublings over every node,
every second and every fourth, sound bent and straight. The echo of the sea surface itself is left out everywhere: it is
the same for all of them, and so loud that beside it nothing would be an error.
"""

from __future__ import annotations

import itertools
import math
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from insonify.accuracy.charts.reference import trace_exact_rays
from insonify.kernels.common.types import Poses, SceneArrays
from insonify.scene import Scene, edit
from insonify.simulation import Simulation, prepare
from insonify.statistics.record_errors import compare_records
from planned_scenes import planned_scene

JUDGED = range(300)
QUICK = (
    300_001,
    300_004,
    300_009,
    300_015,
    300_021,
    300_022,
    300_024,
    300_027,
    300_030,
    300_032,
    300_041,
    300_042,
    300_048,
)
TOLERANCES = (0.01, 0.15)
FLOOR = 0.003  # share of the record
SETTLED, FIRST_RAYS, MOST_RAYS = 0.3, 1 << 14, 1 << 19  # share of the tolerance; rays a side
PLANES, EVERY = (1, 2, 4, 8, 16, 32, 64), (1, 2, 4)
TIMED, ROUNDS = 12, 3  # pings, and times that each setting is timed


@dataclass(frozen=True)
class Word:
    """What a plan said of a scene and what came out."""

    scene: Scene
    said: Simulation
    tolerance: float
    measured: float
    moved: float  # by the last doubling of the reference's rays
    ratio: float  # of the plan's time to that of the cheapest charted setting that keeps to the tolerance

    @property
    def kept(self) -> bool:
        return self.measured <= self.tolerance

    @property
    def foretold(self) -> bool:
        floor = max(FLOOR, 3.0 * self.moved)
        one, other = max(self.said.plan.error, floor), max(self.measured, floor)
        return 1.0 / 3.0 <= one / other <= 3.0

    def line(self) -> str:
        plan, scene = self.said.plan, self.scene
        model = f"{plan.planes:3d} planes, every {plan.model.every:2d}, {'bent' if plan.model.bent else 'straight'}"
        verdict = f"{'' if self.kept else ' BROKEN'}{'' if self.foretold else ' unforetold'}"
        return (
            f"{scene.title} {scene.sonar.beam.kind:8} {scene.sonar.law:5} {scene.seabed.relief.kind:15} "
            f"{scene.seabed.material.kind:8} {len(scene.targets)} targets, {len(plan.model.ways)} ways: {model}; "
            f"tolerance {100 * self.tolerance:5.2f} %, predicted {100 * plan.error:5.2f} %, measured "
            f"{100 * self.measured:5.2f} % "
            f"(rays moved {100 * self.moved:4.2f} %), time × {self.ratio:4.2f}{verdict}"
        )


def tolerance_of(seed: int) -> float:
    low, high = map(math.log, TOLERANCES)
    return math.exp(np.random.default_rng([20261124, seed]).uniform(low, high))


def judge(seed: int, folder: Path, *, timed: bool = True) -> Word:
    """Plan a scene, simulate it so, and hold it against rays."""
    scene, pings = planned_scene(seed, folder)
    if scene.water.surface.kind != "none":
        scene = edit(scene, {"water.surface.surface_echo": False})
    tolerance = tolerance_of(seed)
    said = prepare(scene, tolerance=tolerance)
    whole = prepare(scene, method="rays", tolerance=tolerance, forced={"bending": "on"})
    poses = whole.poses(pings)
    right, moved = settled(whole.arrays, poses, SETTLED * tolerance)

    def error(simulation: Simulation) -> float:
        return compare_records(whole.arrays, poses, simulation.intensity(pings), right).beyond

    ratio = _cost_ratio(scene, said, tolerance, pings, error) if timed else math.nan
    return Word(scene, said, tolerance, error(said), moved, ratio)


def settled(arrays: SceneArrays, poses: Poses, wanted: float) -> tuple[np.ndarray, float]:
    """Record of exact rays, twice as many until that moves it by no more than is wanted; and how far it did."""
    count, moved = FIRST_RAYS, math.inf
    record = trace_exact_rays(arrays, poses, count)
    while moved > wanted and count < MOST_RAYS:
        count *= 4
        finer = trace_exact_rays(arrays, poses, count)
        moved, record = compare_records(arrays, poses, record, finer).beyond, finer
    return record, moved


def _cost_ratio(
    scene: Scene, said: Simulation, tolerance: float, pings: np.ndarray, error: Callable[[Simulation], float]
) -> float:
    """Time of a plan over that of the cheapest charted setting that keeps to the tolerance."""
    knife = scene.sonar.beam.kind == "knife"
    bent = ("on", "off") if said.arrays.water.bent or said.plan.entry("bending") else ("off",)
    nodes = EVERY if scene.seabed.relief.kind in ("flat", "dem") or _divides(scene) else (1,)
    settings = itertools.product((1,) if knife else PLANES, nodes, bent)
    charted = (
        prepare(scene, tolerance=tolerance, forced={"planes": str(k), "spacing": str(n), "bending": b})
        for k, n, b in settings
    )
    good = [simulation for simulation in charted if error(simulation) <= tolerance]
    if not good:
        return math.nan
    many = np.resize(pings, TIMED)
    taken = np.array([[_seconds(simulation, many) for simulation in (said, *good)] for _ in range(ROUNDS)])
    least = taken.min(axis=0)
    return float(least[0] / least[1:].min())


def _divides(scene: Scene) -> bool:
    return all(round(part.period / scene.seabed.spacing) % max(EVERY) == 0 for part in scene.seabed.random_reliefs)


def _seconds(simulation: Simulation, pings: np.ndarray) -> float:
    """Time of one thread, so that what else the machine does hardly counts."""
    poses = simulation.poses(pings)
    began = time.thread_time()
    simulation.tracer.trace(simulation.reduced, poses, threads=1, **simulation.plan.settings)
    return time.thread_time() - began


@pytest.mark.parametrize("seed", QUICK)
def test_a_plan_keeps_to_its_tolerance(seed, tmp_path):
    word = judge(seed, tmp_path, timed=False)
    assert word.kept, word.line()


@pytest.mark.bench
def test_three_hundred_plans_keep_their_word(capsys, tmp_path):
    words = []
    for seed in JUDGED:
        words.append(judge(seed, tmp_path))
        with capsys.disabled():
            sys.stdout.write(f"\n{words[-1].line()}")
    ratios = np.array([word.ratio for word in words])
    charted = np.isfinite(ratios)
    with capsys.disabled():
        sys.stdout.write(
            f"\n{len(words)} scenes: {100 * np.mean([word.kept for word in words]):.1f} % within tolerance, "
            f"{100 * np.mean([word.foretold for word in words]):.1f} % predicted within a factor of 3, "
            f"{100 * np.mean(ratios[charted] <= 1.5):.1f} % within 1.5 × of the cheapest charted setting "
            f"(median × {np.median(ratios[charted]):.2f}; for {np.sum(~charted)} no charted setting will do)"
        )
    assert np.mean([word.kept for word in words]) >= 0.95
