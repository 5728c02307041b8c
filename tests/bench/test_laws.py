"""The laws of cost measured anew, printed as `planning.fitted_laws` has them: run with `pytest -m bench -s`."""

from __future__ import annotations

import sys
import time

import numpy as np
import pytest
from scipy.optimize import nnls

from insonify.planning import fitted_laws
from insonify.planning.candidates import Candidate, count_operations
from insonify.planning.scene_summary import summarise_scene
from insonify.scene import SceneError
from insonify.simulation import Simulation, prepare
from planned_scenes import planned_scene

pytestmark = pytest.mark.bench
SEEDS = range(500_000, 500_060)
PLANES, RAYS, EVERY = ("1", "2", "6", "16", "40"), ("1000", "4000"), ("1", "2")
PINGS, ROUNDS = 16, 3
SLOW = 2e-3  # s a ping; what takes longer is timed by few pings


def seconds(simulation: Simulation, pings: np.ndarray) -> float:
    """Least time of one thread for a ping."""
    poses = simulation.poses(pings)
    taken = []
    for _ in range(ROUNDS):
        began = time.thread_time()
        simulation.tracer.trace(simulation.reduced, poses, threads=1, **simulation.plan.settings)
        taken.append(time.thread_time() - began)
    return min(taken) / pings.size


def draft_of(simulation: Simulation) -> Candidate:
    plan = simulation.plan
    return Candidate(
        plan.method,
        planes=plan.planes,
        rays=plan.settings.get("rays", 0),
        every=plan.every,
        bent=plan.bent,
        bounces=plan.bounces,
        targets=plan.targets,
        ways=plan.ways,
    )


def test_what_a_ping_costs(capsys, tmp_path):
    rows, costs = [], []
    for seed in SEEDS:
        scene, pings = planned_scene(seed, tmp_path)
        view = summarise_scene(scene)
        settings = [{"planes": planes, "spacing": every} for planes in PLANES for every in EVERY]
        settings += [{"method": "rays", "rays": rays} for rays in RAYS]
        for forced in settings:
            try:
                simulation = prepare(scene, forced=forced | ({"bending": "off"} if "rays" in forced else {}))
            except SceneError:
                continue
            prepare_time = seconds(simulation, pings[:1])
            rows.append(count_operations(view, draft_of(simulation)))
            costs.append(seconds(simulation, np.resize(pings, PINGS if prepare_time < SLOW else 2)))
    names = list(fitted_laws.SECONDS)
    table, cost = np.array([[row.get(name, 0.0) for name in names] for row in rows]), np.array(costs)
    # Relative errors count: a cheap ping is to be foretold as well as a dear one.
    found, _ = nnls(table / cost[:, None], np.ones(cost.size))
    off = np.exp(np.abs(np.log(table @ found / cost)))
    with capsys.disabled():
        lines = "\n".join(f'    "{name}": {value:.3g},' for name, value in zip(names, found))
        sys.stdout.write(
            f"\n{lines}\n{cost.size} settings: within a factor of {np.median(off):.2f} in the middle, "
            f"{np.percentile(off, 90):.2f} in nine of ten"
        )
