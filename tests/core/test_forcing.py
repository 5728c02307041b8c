"""Choices that are forced upon a plan: taken, carried out, recorded."""

import numpy as np
import pytest

from insonify.planning import plan
from insonify.scene import SceneError, edit, load_scene
from insonify.simulation import prepare, simulate
from insonify.tracers import sweep

DEFAULT = load_scene("default")
SMALL = edit(
    DEFAULT,
    {"seabed.spacing": 0.4, "seabed.relief.period": 51.2, "seabed.relief.peaks": [[12.0, 6.0]], "sonar.bins": 200},
)
PINGS = np.arange(0, 512, 64)


def test_what_is_forced_is_taken_and_marked():
    forced = {"planes": "16", "spacing": "2", "targets": "off"}
    chosen = plan(DEFAULT, forced=forced)
    assert (chosen.planes, chosen.model.every, chosen.model.targets) == (16, 2, ())
    marked = {entry.subject for entry in chosen.entries if entry.forced}
    assert marked == set(forced)
    assert not chosen.entry("targets").modelled
    assert not any(entry.forced for entry in plan(DEFAULT).entries)


def test_a_method_may_be_forced_like_any_other_choice():
    assert plan(DEFAULT, forced={"method": "rays", "rays": "5000"}).settings == {"rays": 5000}
    assert plan(DEFAULT, forced={"method": "march", "step": "0.25"}).settings["step"] == 0.25


def test_what_the_scene_leaves_no_choice_about_is_without_effect():
    assert plan(DEFAULT, forced={"bending": "on", "surface_echo": "on", "bounces": "off"}) == plan(DEFAULT)


@pytest.mark.parametrize(
    ("forced", "sentence"),
    [
        ({"colour": "red"}, r"^model: 'colour' is not a choice of a plan; choose one of method, planes, "),
        ({"planes": "many"}, r"^model planes: 'many' is not valid; give a whole number from 1 to 512$"),
        ({"planes": "2.5"}, r"^model planes: '2.5' is not valid; give a whole number from 1 to 512$"),
        ({"step": "nan"}, r"^model step: 'nan' is not valid; give a number from 1e-06 to 10000$"),
        ({"targets": "some"}, r"^model targets: 'some' is not known; choose one of on, off$"),
        ({"method": "magic"}, r"^method: 'magic' is not known; choose one of auto, sweep, march, rays$"),
    ],
)
def test_what_is_no_choice_is_refused(forced, sentence):
    with pytest.raises(SceneError, match=sentence):
        plan(DEFAULT, forced=forced)


def test_what_is_forced_off_is_not_heard():
    without = prepare(SMALL, forced={"targets": "off"})
    bare = prepare(edit(SMALL, {"targets": []}), forced={"planes": str(without.plan.planes)})
    np.testing.assert_array_equal(without.intensity(PINGS), bare.intensity(PINGS))
    sea = edit(SMALL, {"water.surface": {"kind": "flat"}})
    some = prepare(sea, forced={"surface_bottom": "off", "surface_echo": "off"})
    declared = prepare(edit(sea, {"water.surface": {"kind": "flat", "surface_bottom": False, "surface_echo": False}}))
    np.testing.assert_array_equal(some.intensity(PINGS), declared.intensity(PINGS))


def test_a_thinned_bed_has_the_same_nodes():
    whole, thinned = prepare(SMALL), prepare(SMALL, forced={"spacing": "4"})
    np.testing.assert_array_equal(thinned.reduced.bed.heights, whole.arrays.bed.heights[::4, ::4])
    assert thinned.reduced.bed.spacing == 4.0 * whole.arrays.bed.spacing
    # The bed of the scene, on which the platform and the targets stand, stays what it is.
    poses, same = whole.poses(PINGS), thinned.poses(PINGS)
    np.testing.assert_array_equal(whole.altitude(PINGS), thinned.altitude(PINGS))
    np.testing.assert_array_equal(poses.z, same.z)
    assert thinned.arrays.bed.spacing == whole.arrays.bed.spacing
    assert sweep.trace(thinned.reduced, poses).any()


def test_a_record_tells_how_it_was_forced():
    scene = edit(SMALL, {"track.pings": 2})
    record = simulate(scene, tolerance=0.1, forced={"planes": "4", "targets": "off"})
    assert (record.method, record.tolerance, record.model) == ("auto", 0.1, "planes=4 targets=off")
    assert "model" not in simulate(scene).attrs
