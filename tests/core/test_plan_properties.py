"""What holds of the plan of any scene."""

from __future__ import annotations

import math
import time

import numpy as np
import pytest
from hypothesis import HealthCheck, Phase, assume, given, settings
from hypothesis import strategies as st
from pydantic import ValidationError

from drawn_scenes import scenes
from insonify.planning import plan
from insonify.scene import Scene, SceneError, edit, load_scene
from insonify.simulation import prepare
from planned_scenes import planned_scene

TOLERANCES = st.floats(math.log(1e-4), math.log(0.5)).map(math.exp)
KNIFE = {"sonar.beam": "knife", "targets": [], "water": {"kind": "uniform"}}


def drawn(values):
    try:
        return Scene.model_validate(values)
    except (ValidationError, SceneError):
        assume(False)


def planned(scene, tolerance):
    try:
        return plan(scene, tolerance)
    except SceneError:
        assume(False)


@settings(
    max_examples=40,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.filter_too_much],
    phases=[Phase.generate],  # scenes take minutes to shrink
    deadline=None,
)
@given(scenes(), TOLERANCES, TOLERANCES)
def test_more_tolerance_never_means_more_work(values, one, other):
    scene = drawn(values)
    fine, coarse = (planned(scene, tolerance) for tolerance in sorted((one, other)))
    assert coarse.cost <= fine.cost * (1.0 + 1e-12)


@pytest.mark.parametrize("seed", range(40))
def test_more_tolerance_never_means_more_work_over_rough_beds(seed, tmp_path):
    scene, _ = planned_scene(seed, tmp_path)
    costs = [plan(scene, tolerance).cost for tolerance in np.geomspace(1e-4, 0.5, 60)]
    assert costs == sorted(costs, reverse=True)


@pytest.mark.parametrize("seed", range(40))
def test_every_entry_tells_what_it_costs_and_what_it_leaves(seed, tmp_path):
    scene, _ = planned_scene(seed, tmp_path)
    chosen = plan(scene)
    assert chosen.error == pytest.approx(math.sqrt(sum(entry.error**2 for entry in chosen.entries)))
    assert chosen.cost > 0.0
    assert len({entry.subject for entry in chosen.entries}) == len(chosen.entries)
    for entry in chosen.entries:
        assert entry.choice
        assert entry.reason
        assert entry.error >= 0.0
        assert entry.cost >= 0.0
        if entry.modelled is False:
            assert entry.options


def test_what_was_forced_as_it_was_chosen_changes_nothing(tmp_path):
    for seed in range(20):
        scene, _ = planned_scene(seed, tmp_path)
        chosen = plan(scene)
        forced = {"planes": str(chosen.planes), "spacing": str(chosen.every), "method": chosen.method}
        again = plan(scene, forced=forced)
        assert (again.settings, again.every, again.bent) == (chosen.settings, chosen.every, chosen.bent)
        assert again.cost == pytest.approx(chosen.cost)


def test_a_plain_scene_is_traced_by_the_bare_sweep():
    simulation = prepare(edit(load_scene("default"), KNIFE))
    assert (simulation.plan.method, simulation.plan.settings) == ("sweep", {"planes": 1})
    bare = simulation.reduced
    assert (bare.water.bent, bare.multipath.enabled, bare.bounces, bare.solids.shape.size) == (False, False, 0, 0)
    assert bare.bed.heights is simulation.arrays.bed.heights


@pytest.mark.bench
def test_a_plan_is_made_in_a_millisecond(capsys, tmp_path):
    taken = []
    drawn_scenes = [planned_scene(seed, tmp_path)[0] for seed in range(100)]
    plan(drawn_scenes[0])  # imports what makes beds
    for scene in drawn_scenes:
        began = time.thread_time()
        plan(scene)
        taken.append(1e3 * (time.thread_time() - began))
    with capsys.disabled():
        print(f"\n100 plans, ms each: median {np.median(taken):.2f}, ninth of ten {np.percentile(taken, 90):.2f}")  # noqa: T201
