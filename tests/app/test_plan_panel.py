"""The plan's panel: what is modelled, what is left out, and what forcing a choice changes."""

import numpy as np
from controls import choose

from insonify.cli import main
from insonify.scene import edit, load_scene
from insonify.simulation import prepare
from insonify.statistics.record_errors import compare_records
from insonify.tracers import sweep
from insonify_viewer.panels.plan.controller import changed_subject, difference_in_words
from insonify_viewer.record.comparison.record_difference import RecordDifference
from insonify_viewer.state.history import Modelling
from insonify_viewer.state.session import Session

BENT = {"kind": "profile", "depth": [0.0, 10.0, 20.0, 30.0], "sound_speed": [1520.0, 1518.0, 1500.0, 1502.0]}


def line_of(view, subject: str):
    return next(group.lines[subject] for group in view.groups.values() if subject in group.lines)


def pick(viewer, subject: str, choice: str | None):
    combo = line_of(viewer.panels["plan"].view, subject).combo
    index = combo.findData(choice)
    assert index >= 0
    choose(combo, index)


def wait(viewer, qtbot):
    qtbot.waitUntil(lambda: viewer.complete, timeout=120000)


def test_forced_choices_are_undone_with_the_scenes():
    default = load_scene("default")
    session = Session(default)
    session.model(session.modelling.forcing("planes", "16"))
    session.settle({"track.altitude": 8.0})
    session.model(session.modelling.forcing("planes", None).forcing("targets", "off"))
    assert session.modelling.forced == (("targets", "off"),)
    session.undo()
    assert session.modelling.forced == (("planes", "16"),)
    session.undo()
    session.undo()
    assert session.modelling == Modelling()
    session.redo()
    assert dict(session.modelling.forced) == {"planes": "16"}
    session.open(edit(default, {"seed": 9}))
    assert session.modelling == Modelling(), "another scene leaves every choice to its own plan"


def test_a_drag_keeps_what_is_left_out_and_forgets_how_finely():
    modelling = Modelling(0.01, (("planes", "64"), ("targets", "off"), ("method", "rays")))
    assert dict(modelling.coarse.forced) == {"targets": "off", "planes": "1", "rays": "1000"}
    assert modelling.coarse.tolerance == 0.01


def test_every_entry_has_a_line_in_its_group_and_the_tolerance_is_final_when_it_is_let_go(open_viewer, small, qtbot):
    viewer = open_viewer(edit(small, {"water": BENT}))
    wait(viewer, qtbot)
    view, plan = viewer.panels["plan"].view, viewer._answer.simulation.plan
    assert {entry.subject for entry in plan.entries if entry.modelled} == set(view.groups[True].lines)
    assert "bending" in view.groups[True].lines
    pick(viewer, "bending", "off")
    wait(viewer, qtbot)
    assert "bending" in view.groups[False].lines
    assert line_of(view, "bending").combo.currentText() == "off"
    assert view.automatic.isEnabled()
    view.automatic.click()
    wait(viewer, qtbot)
    assert "bending" in view.groups[True].lines
    assert not view.automatic.isEnabled()
    assert viewer.session.modelling == Modelling()
    # The tolerance is final when it is let go.
    viewer.open(small)
    wait(viewer, qtbot)
    slider = viewer.panels["plan"].view._tolerance.slider
    slider.setSliderDown(True)
    slider.setValue(1000)
    assert viewer.session.modelling.tolerance == 0.03
    slider.setSliderDown(False)
    wait(viewer, qtbot)
    assert viewer.session.modelling.tolerance == 0.5
    assert viewer._answer.simulation.tolerance == 0.5
    # What cannot be done is said and taken back.
    viewer.open(edit(small, {"receiver.speckle": "coherent"}))
    wait(viewer, qtbot)
    before = viewer.session.modelling
    viewer.session.model(before.forcing("method", "rays"))
    qtbot.waitUntil(lambda: viewer.session.modelling == before)
    assert "coherent" in viewer.window.status.sentence.text()


def test_a_forced_choice_tells_what_it_changed_and_is_what_the_command_writes(open_viewer, small, qtbot, tmp_path):
    scene = edit(small, {"track.pings": 32})
    viewer = open_viewer(scene, prepare=prepare)
    pings = np.arange(32, dtype=np.int64)
    before = viewer._answer.simulation.intensity(pings)
    pick(viewer, "planes", "2")
    wait(viewer, qtbot)
    after = viewer._answer.simulation.intensity(pings)
    assert (after != before).any()
    said = viewer.window.status.sentence.text()
    assert said.startswith("planes 2: changes the record by")
    assert said.endswith("× the time")
    assert line_of(viewer.panels["plan"].view, "planes")._change.text() == said.partition(": ")[2]
    path = tmp_path / "two.npz"
    assert main(["render", "default", "-o", str(path), "--set", "sonar.bins=100", "--set", "track.pings=32",
                 "--model", "planes=2"]) == 0  # fmt: skip
    with np.load(path) as written:
        np.testing.assert_array_equal(np.moveaxis(written["intensity"], 0, 1), after)


def test_changes_in_words():
    assert (
        difference_in_words(RecordDifference(0.0041, 0.0, 0.0), 1.83)
        == "changes the record by 0.41 %, not visibly, takes 1.8 × the time"
    )
    assert (
        difference_in_words(RecordDifference(0.0, 0.0, 0.0), 0.9) == "does not change the record, takes 0.9 × the time"
    )
    assert difference_in_words(None, 2.0) == "takes 2 × the time"
    auto = Modelling()
    assert changed_subject(auto, auto.forcing("planes", "8")) == "planes"
    assert changed_subject(auto.forcing("planes", "8"), auto.forcing("planes", "16")) == "planes"
    assert changed_subject(auto, auto.forcing("planes", "8").forcing("targets", "off")) == ""
    assert changed_subject(auto, Modelling(0.1)) == ""


def test_what_a_drag_leaves_out_of_the_default_scene_is_a_fifth_at_most():
    scene, pings = load_scene("default"), np.arange(100, 340, 24, dtype=np.int64)
    coarse, fine = (
        prepare(scene, forced={**dict(Modelling().coarse.forced), **finer}) for finer in ({}, {"planes": "32"})
    )
    poses = fine.poses(pings)
    records = (sweep.trace(fine.arrays, poses, planes=one.plan.planes) for one in (coarse, fine))
    assert 0.02 < compare_records(fine.arrays, poses, *records).beyond < 0.2
