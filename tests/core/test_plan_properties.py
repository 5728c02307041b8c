"""What holds of the plan of any scene."""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np
import pytest
from hypothesis import HealthCheck, Phase, assume, given, settings
from hypothesis import strategies as st
from pydantic import ValidationError

from drawn_scenes import scenes
from insonify.packing.packed_scene import pack
from insonify.planning import plan
from insonify.planning.choices.base import Case
from insonify.planning.selection import check_request, choose_for_case
from insonify.scene import Scene, SceneError, edit, load_scene
from insonify.simulation import prepare
from random_scenes import planned_scene

TOLERANCES = st.floats(math.log(1e-4), math.log(0.5)).map(math.exp)
KNIFE = {"sonar.beam": "knife", "targets": [], "water": {"kind": "uniform"}}


def drawn(values):
    try:
        return Scene.model_validate(values)
    except (ValidationError, SceneError):
        assume(False)


@lru_cache(maxsize=8)  # scenes are drawn more than once
def case_of(scene):
    """What is measured of a scene, which does not depend on the tolerance."""
    check_request(scene, 0.03, "auto", {})
    return Case(pack(scene), "auto", {})


def planned(scene, tolerance):
    try:
        return choose_for_case(case_of(scene), tolerance)
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
    assert coarse.work <= fine.work


@pytest.mark.parametrize("seed", range(40))
def test_more_tolerance_never_means_more_work_over_rough_beds(seed, tmp_path):
    scene, _ = planned_scene(seed, tmp_path)
    work = [planned(scene, tolerance).work for tolerance in np.geomspace(0.01, 0.5, 12)]
    assert work == sorted(work, reverse=True)


def test_what_was_measured_for_other_tolerances_changes_no_plan(tmp_path):
    scene, _ = planned_scene(3, tmp_path)
    for tolerance in (0.5, 0.05, 0.01):
        assert planned(scene, tolerance).model == plan(scene, tolerance).model


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
        share = chosen.model.misplaced
        forced = {"planes": str(chosen.planes), "spacing": str(chosen.model.every), "method": chosen.method}
        forced["segments"] = "whole" if math.isinf(share) else str(share)
        again = plan(scene, forced=forced)
        assert (again.settings, again.model.every, again.model.bent) == (
            chosen.settings,
            chosen.model.every,
            chosen.model.bent,
        )
        assert again.work == chosen.work


def test_a_plain_scene_is_traced_by_the_bare_sweep():
    simulation = prepare(edit(load_scene("default"), KNIFE))
    assert (simulation.plan.method, simulation.plan.settings) == ("sweep", {"planes": 1})
    bare = simulation.reduced
    assert (bare.water.bent, bare.multipath.enabled, bare.bounces, bare.solids.shape.size) == (False, False, 0, 0)
    assert bare.bed.heights is simulation.arrays.bed.heights
