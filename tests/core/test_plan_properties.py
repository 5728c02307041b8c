"""What holds of the plan of any scene."""

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
LONGEST = 100.0  # range of a drawn scene, in spacings of the grid
KNIFE = {"sonar.beam": "knife", "targets": [], "water": {"kind": "uniform"}}


def drawn(values):
    """A drawn scene of short range, in which a plan has the same choices as in a long one, for less work."""
    values["sonar"]["range"] = min(values["sonar"]["range"], LONGEST * values["seabed"]["spacing"])
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


@pytest.mark.parametrize("count", [2, pytest.param(40, marks=pytest.mark.slow)])
def test_more_tolerance_never_means_more_work(count):
    @settings(
        max_examples=count,
        suppress_health_check=[HealthCheck.too_slow, HealthCheck.filter_too_much],
        phases=[Phase.generate],  # scenes take minutes to shrink
        deadline=None,
    )
    @given(scenes(), TOLERANCES, TOLERANCES)
    def compare(values, one, other):
        scene = drawn(values)
        fine, coarse = (planned(scene, tolerance) for tolerance in sorted((one, other)))
        assert coarse.work <= fine.work

    compare()


@pytest.mark.parametrize("seed", [*range(10), *(pytest.param(seed, marks=pytest.mark.slow) for seed in range(10, 40))])
def test_a_plan_of_a_rough_bed(seed, tmp_path):
    """It works less the more it tolerates, whatever was measured before; it says and adds up all that it chooses."""
    scene, _ = planned_scene(seed, tmp_path)
    tolerances = np.geomspace(0.01, 0.5, 12)
    plans = [planned(scene, tolerance) for tolerance in tolerances]
    work = [made.work for made in plans]
    assert work == sorted(work, reverse=True)
    chosen = plan(scene)
    assert planned(scene, 0.03).model == chosen.model
    assert chosen.error == pytest.approx(math.sqrt(sum(entry.error**2 for entry in chosen.entries)))
    assert chosen.cost > 0.0
    assert sum(each.cost for each in chosen.entries if each.modelled) == pytest.approx(chosen.cost)
    assert len({entry.subject for entry in chosen.entries}) == len(chosen.entries)
    for entry in chosen.entries:
        assert entry.choice
        assert entry.reason
        assert entry.error >= 0.0
        assert entry.cost >= 0.0
        if entry.modelled is False:
            assert entry.options
    share = chosen.model.misplaced
    forced = {"planes": str(chosen.planes), "spacing": str(chosen.model.every), "method": chosen.method}
    forced["segments"] = "whole" if math.isinf(share) else str(share)
    forced["target_planes"] = str(chosen.model.across)
    again = plan(scene, forced=forced)
    assert again.settings == chosen.settings
    assert (again.model.every, again.model.bent) == (chosen.model.every, chosen.model.bent)
    assert again.work == chosen.work


def test_a_plain_scene_is_traced_by_the_bare_sweep():
    simulation = prepare(edit(load_scene("default"), KNIFE))
    assert (simulation.plan.method, simulation.plan.settings) == ("sweep", {"planes": 1})
    bare = simulation.reduced
    assert (bare.water.bent, bare.multipath.enabled, bare.bounces, bare.solids.shape.size) == (False, False, 0, 0)
    assert bare.bed.heights is simulation.arrays.bed.heights
