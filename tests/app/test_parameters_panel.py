"""The panel of parameters in a real window: what is pinned, rare fields, links to try, effects, names of edits."""

import numpy as np
import pytest
from controls import move_slider, watched_events
from PySide6.QtCore import QEvent, QPoint, Qt
from PySide6.QtGui import QShortcut
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QToolButton, QWidget

from insonify.display.normalisation import LevelBed
from insonify.scene import bundled_scenes, edit, load_scene
from insonify.simulation import prepare
from insonify.statistics.record_errors import compute_errors, find_first_bin
from insonify_viewer.panels.parameters.effects import EFFECTS
from insonify_viewer.panels.parameters.values import Trials, row_of
from insonify_viewer.panels.parameters.view import parameters_view
from insonify_viewer.panels.parameters.view.parameters_view import ParametersView
from insonify_viewer.panels.parameters.view.section_box import SectionBox
from insonify_viewer.record.comparison.record_difference import visible_share
from insonify_viewer.state.fields import name_edit, name_field
from insonify_viewer.state.sections import pinned_section, sections_of
from insonify_viewer.state.session import Session


def panel(viewer):
    return viewer.panels["parameters"]


def tick(viewer, name: str):
    """Click the tick box of an effect as the mouse does."""
    box = panel(viewer).view.effects.ticks[name]
    panel(viewer).view.ensureWidgetVisible(box)
    QTest.mouseClick(box, Qt.MouseButton.LeftButton, pos=QPoint(8, box.height() // 2))


def figure(viewer, name: str) -> str:
    return str(panel(viewer).view.effects.figures[name].text())


@pytest.mark.parametrize("name", sorted(bundled_scenes()))
def test_three_to_six_controls_are_pinned_and_every_link_leads_there_and_back(name):
    scene, trials = load_scene(name), Trials()
    section = pinned_section(scene, sections_of(scene))
    assert section is not None
    assert 3 <= len(section.parameters) <= 6
    paths = {row.path for section in sections_of(scene) for row in section.parameters}
    assert [row.path for row in section.parameters] == [path for path in scene.controls if path in paths]
    labels = [row.label for row in section.parameters]
    assert len(set(labels)) == len(labels)
    for number in range(len(trials.links(scene))):
        session = Session(scene)
        assert session.settle(trials.follow(session.scene, number)[1])
        assert trials.tried(session.scene)[number]
        there = tuple(row.path for section in sections_of(session.scene) for row in section.parameters)
        assert row_of(trials.links(scene)[number].path, there) in there, "its row is lit"
        assert session.settle(trials.follow(session.scene, number)[1])
        assert edit(session.scene, {"sonar.ping_rate": scene.sonar.ping_rate}) == scene


def test_rows_are_pinned_on_top_folded_duplicated_locked_and_found_by_words(viewer, qtbot):
    view = panel(viewer).view
    row = view.row("track.altitude")
    assert row is view.sections["controls"].rows["track.altitude"]
    other = view.sections["track"].rows["track.altitude"]
    assert row.label.mapTo(view.widget(), QPoint()).y() < other.label.mapTo(view.widget(), QPoint()).y()
    move_slider(row.slider, 100).setSliderDown(False)
    assert viewer.session.scene.track.altitude == pytest.approx(4.8, abs=0.05)  # a tenth of 2 to 30 m
    qtbot.waitUntil(lambda: viewer.complete)
    assert other.slider.value() == 100
    assert other.field.text() == row.field.text()
    # Rare fields are folded until they are asked for.
    box = view.sections["sonar"]
    squint = box.rows["sonar.beam.squint"]
    assert not squint.slider.isVisible()
    assert box.rows["sonar.beam.width"].slider.isVisible()
    view.ensureWidgetVisible(box.more)
    QTest.mouseClick(box.more, Qt.MouseButton.LeftButton)
    assert squint.slider.isVisible()
    viewer.session.settle({"sonar.beam.kind": "gaussian"})  # another set of rows
    qtbot.waitUntil(view.sections["sonar"].rows["sonar.beam.squint"].slider.isVisible)  # it stays open
    view.sections["track"].more.setChecked(False)
    view.light(("track.start.0",))
    assert view.sections["track"].rows["track.start.0"].slider.isVisible(), "what a lesson speaks of is shown"
    # A target is duplicated and locked.
    session = viewer.session

    def press(key, name):
        button = view.sections[key].findChild(QToolButton, name)
        view.ensureWidgetVisible(button)
        QTest.mouseClick(button, Qt.MouseButton.LeftButton)

    press("targets.1", "copy")
    copy = session.scene.targets[3]
    assert (copy.kind, copy.radius, copy.position) == ("sphere", 0.5, (66.0, -18.0))
    assert session.history.undoable[0] == "sphere 2 duplicated"
    press("targets.3", "lock")
    assert session.scene.targets[3].locked
    assert not view.row("targets.3.radius").slider.isEnabled()
    press("targets.3", "copy")
    assert not session.scene.targets[4].locked
    press("targets.3", "lock")
    assert view.row("targets.3.radius").slider.isEnabled()
    shortcut = view.findChild(QShortcut)
    assert shortcut.key().toString() == "Ctrl+F"
    shortcut.activated.emit()  # without a window manager no key comes here
    assert viewer.window.focusWidget() is view.search
    QTest.keyClicks(view.search, "beam wid")
    found = view.found
    assert [next(iter(found.rows)), found.rows["sonar.beam.width"].label.text()] == ["sonar.beam.width", "beam width"]
    assert not view.sections["sonar"].isVisible()
    assert not view.effects.isVisible()
    field = found.rows["sonar.beam.width"].field
    QTest.mouseDClick(field, Qt.MouseButton.LeftButton)
    QTest.keyClicks(field, "3")
    QTest.keyClick(field, Qt.Key.Key_Return)
    assert viewer.session.scene.sonar.beam.width == 3.0
    view.search.setFocus()
    QTest.keyClicks(view.search, " zzz")
    assert view.found.rows == {}
    QTest.keyClick(viewer.window.waterfall, Qt.Key.Key_Escape)
    assert view.search.text().endswith(" zzz"), "Escape elsewhere is not meant for the search"
    view.search.findChild(QShortcut).activated.emit()  # Escape
    assert view.found is None
    assert view.sections["sonar"].isVisible()


def test_a_link_moves_its_control_in_sight_and_an_effect_comes_back_as_it_was(open_viewer, small, qtbot, monkeypatch):
    links = "[Lower it](track.altitude=4.0), or [no beam](sonar.beam=knife)."
    viewer = open_viewer(edit(small, {"description": links}))
    view, session = panel(viewer).view, viewer.session
    seen = []
    session.changed.connect(lambda scene, settled: seen.append(scene.altitude))
    with monkeypatch.context() as patched:
        patched.setattr(parameters_view, "GLIDE", 10_000)  # ms: however seldom a busy machine moves it, it is seen
        view.about.label.linkActivated.emit("0")
        assert view.row("track.altitude").label.property("lit")
        qtbot.waitUntil(lambda: len({round(altitude, 2) for altitude in seen}) > 3)
        view.end_glide()
    qtbot.waitUntil(lambda: session.history.undoable[:1] == ("altitude",))
    assert seen[-1] == 4.0
    assert "↩" in view.about.label.text()
    view.about.label.linkActivated.emit("0")
    qtbot.waitUntil(lambda: session.scene.track.altitude == 10.0 and len(session.history.undoable) == 2)
    assert "↩" not in view.about.label.text()
    view.about.label.linkActivated.emit("1")
    assert session.scene.sonar.beam.kind == "knife"
    assert view.row("sonar.beam.kind").label.property("lit")
    view.about.label.linkActivated.emit("1")
    assert session.scene.sonar.beam == small.sonar.beam
    # A glide ends with its scene.
    monkeypatch.setattr(parameters_view, "GLIDE", 400)
    view.about.label.linkActivated.emit("0")
    qtbot.wait(50)
    viewer.open(edit(small, {"title": "Another", "track.altitude": 9.0}))
    qtbot.wait(500)
    assert session.scene.track.altitude == 9.0
    assert session.history.undoable[0] == "open Another"
    # An effect goes and comes back as it was.
    start = edit(small, {"sonar.beam": {"kind": "gaussian", "width": 2.5, "squint": 3.0}})
    viewer.open(start)
    tick(viewer, "beam")
    assert session.scene.sonar.beam.kind == "knife"
    assert session.history.undoable[0] == "beam switched off"
    tick(viewer, "beam")
    assert session.scene == start
    tick(viewer, "speckle")
    assert session.scene.receiver.speckle.kind == "rayleigh", "usual settings, for want of earlier ones"
    session.settle({"receiver.speckle.looks": 4})
    tick(viewer, "speckle")
    tick(viewer, "speckle")
    assert session.scene.receiver.speckle.looks == 4
    viewer.open(edit(small, {"title": "Another", "seed": 9}))
    tick(viewer, "speckle")
    assert session.scene.receiver.speckle.looks == 1, "another scene has no earlier settings"


def test_bent_water_goes_straight_and_bends_again():
    scene = edit(load_scene("thermocline"), {"water.absorption": 40.0})
    bending = next(effect for effect in EFFECTS if effect.name == "bending")
    assert bending.is_on(scene)
    straight = edit(scene, bending.take_out(scene))
    assert straight.water.kind == "uniform"
    assert straight.water.absorption == scene.water.absorption
    changed = edit(straight, {"water.surface": "flat"})
    again = edit(changed, bending.bring_back(changed, bending.settings(scene)))
    assert again.water == scene.water.model_copy(update={"surface": changed.water.surface})


@pytest.mark.parametrize("effect", EFFECTS, ids=lambda effect: effect.name)
def test_every_effect_can_be_added_and_taken_out(effect):
    scene = load_scene("default")
    with_it = scene if effect.is_on(scene) else edit(scene, effect.bring_back(scene, None))
    assert effect.is_on(with_it)
    assert not effect.is_on(edit(with_it, effect.take_out(with_it)))


def test_what_an_effect_changes_is_measured_as_seen_and_as_errors_are(open_viewer, small, qtbot):
    scene = edit(small, {"receiver.speckle": "rayleigh", "track.pings": 64})
    viewer, pings = open_viewer(scene, prepare=None), np.arange(64, dtype=np.int64)

    def measure(other):
        viewer.open(other)
        qtbot.waitUntil(lambda: viewer.complete and panel(viewer).at_rest, timeout=240000)
        return panel(viewer)._meter.differences(other, viewer.session.modelling)

    def normalised(simulation):
        return np.square(LevelBed(simulation).amplitudes(pings), dtype=np.float64)

    differences = measure(scene)
    smooth = edit(scene, {"receiver.speckle": "none"})
    for name, before, after in (("beam", smooth, edit(smooth, {"sonar.beam": "knife"})), ("speckle", scene, smooth)):
        simulation = prepare(before)
        a, b = normalised(prepare(after)), normalised(simulation)
        first = find_first_bin(1.4, simulation.arrays, simulation.poses(pings))
        share = compute_errors(a, b, np.ones(100), first_bin=0, beyond_bin=first).beyond
        told = differences[name]
        assert told.share == pytest.approx(share, rel=0.05), name
        lit = (a > 1e-4) | (b > 1e-4)
        seen = np.abs(10.0 * np.log10((a[lit] + 1e-4) / (b[lit] + 1e-4))) >= 1.0
        assert told.visible == pytest.approx(float(seen.mean()), rel=0.05), name
        assert figure(viewer, name) == f"changes {100 * told.visible:.2g} %"
    assert figure(viewer, "noise") == "", "what the scene never had is not measured"
    # Without the pulse the speckle of half of the bins is another; the bed and its shadows are where they were.
    scene = edit(load_scene("default"), {"receiver.speckle": "rayleigh", "track.pings": 64})
    told = measure(scene)["pulse"]
    one, other = (normalised(prepare(each)) for each in (scene, edit(scene, {"sonar.pulse": "ideal"})))
    assert visible_share(one, other) > 3.0 * told.visible
    tips = {name: panel(viewer).view.effects.figures[name].toolTip() for name in ("pulse", "speckle")}
    assert "compared without speckle" in tips["pulse"]
    assert "compared without speckle" not in tips["speckle"]
    # The pulse spreads the echo of the pipe over two bins: nearly all of the rms, and a line of the picture.
    told = measure(load_scene("default"))["pulse"]
    assert told.share > 0.8
    assert told.visible < 0.1
    assert figure(viewer, "pulse") == f"changes {100 * told.visible:.2g} %"
    explained = panel(viewer).view.effects.figures["pulse"].toolTip()
    assert "by 1 dB or more" in explained
    assert f"by {100 * told.share:.0f} %" in explained


def test_figures_are_measured_once(viewer, qtbot):
    qtbot.waitUntil(lambda: panel(viewer).at_rest)
    traced = []
    beside = viewer.simulator.trace_beside

    def count(scene, *others):
        traced.append(scene)
        return beside(scene, *others)

    viewer.simulator.trace_beside = count
    viewer.session.settle({"track.altitude": 8.0})
    assert figure(viewer, "beam") == "…"
    qtbot.waitUntil(lambda: panel(viewer).at_rest)
    assert figure(viewer, "beam").startswith("changes")
    once = len(traced)
    assert once == 2, "beam and pulse"
    viewer.session.settle({"track.altitude": 7.0})
    qtbot.waitUntil(lambda: len(traced) == 2 * once and panel(viewer).at_rest)
    viewer.session.undo()
    assert figure(viewer, "beam").startswith("changes"), "known at once"
    viewer.run(True)
    qtbot.wait(700)
    viewer.run(False)
    assert len(traced) == 2 * once


def test_undo_says_what_it_undoes_and_values_are_reset_by_their_names_and_sections(viewer, small, qtbot):
    undo, redo = viewer.window.undo, viewer.window.redo
    assert not undo.isEnabled()
    move_slider(panel(viewer).view.row("sonar.beam.width").slider, 600, 700, 800).setSliderDown(False)
    viewer.session.settle({"targets.1.position.0": 61.0})
    last, entries = "Undo: sphere 2 position x", viewer.window.history.lists[0].actions()
    assert (undo.text(), undo.toolTip()) == (last, f"{last} (Ctrl+Z)")
    assert [entry.text() for entry in entries] == [last, "Undo: beam width"]
    entries[1].trigger()
    assert viewer.session.scene == small
    assert (undo.isEnabled(), redo.text()) == (False, "Redo: beam width")
    redo.trigger()
    redo.trigger()
    assert viewer.session.scene.targets[1].position[0] == 61.0
    tools = viewer.window._bar.findChildren(QToolButton)
    assert next(tool for tool in tools if tool.defaultAction() is undo).text() == "Undo", "there is no room for more"
    assert undo in viewer.window.menus.edit.actions()
    assert not redo.isEnabled()
    # A value is reset by its name, and a section with its kinds.
    viewer.open(small)
    view, session = panel(viewer).view, viewer.session
    row = view.row("track.altitude")
    assert not row.label.property("changed")
    session.settle({"track.altitude": 6.0})
    session.settle({"sonar.beam.width": 2.0})
    assert row.label.property("changed")
    assert "was 10 m" in row.label.toolTip()
    assert not view.row("track.depth").label.property("changed"), "it follows the altitude"
    QTest.mouseDClick(row.label, Qt.MouseButton.LeftButton)
    assert (session.scene.track.altitude, session.scene.sonar.beam.width) == (10.0, 2.0)
    assert session.history.undoable[0] == "altitude reset"
    assert not row.label.property("changed")
    session.undo(3)
    assert not view.sections["sonar"].reset.isVisible()
    for changes in ({"sonar.beam": {"kind": "gaussian", "width": 4.0}}, {"sonar.range": 40.0}, {"track.altitude": 8.0}):
        session.settle(changes)
    qtbot.waitUntil(view.sections["sonar"].reset.isVisible)
    view.ensureWidgetVisible(view.sections["sonar"].reset)
    QTest.mouseClick(view.sections["sonar"].reset, Qt.MouseButton.LeftButton)
    assert (session.scene.sonar, session.scene.track.altitude) == (small.sonar, 8.0)
    session.undo()
    assert session.scene.sonar.beam.kind == "gaussian", "one step"


def test_fields_and_edits_have_names():
    scene = load_scene("default")
    names = {
        "sonar.beam.width": "beam width",
        "sonar.beam.kind": "beam",
        "track.altitude": "altitude",
        "seabed.depth": "bed depth",
        "seabed.relief.peaks.0.1": "relief peak 1 waves in y",
        "seabed.material.name": "material",
        "targets.0.gap.3.1": "pipe 1 gap 4 height",
        "targets.1.position.0": "sphere 2 position x",
        "water.kind": "water",
        "water.sound_speed": "sound speed",
        "receiver.tvg.kind": "TVG",
        "seed": "seed",
    }
    assert {path: name_field(scene, path) for path in names} == names
    assert name_edit(scene, {"sonar.beam.width": 2.0}) == "beam width"
    assert name_edit(scene, {"targets.0.position.0": 1.0, "targets.0.position.1": 1.0}) == "pipe 1 position"
    session = Session(scene)
    session.drag({"track.altitude": 5.0})
    session.settle()
    session.model(session.modelling.tolerating(0.1))
    session.open(load_scene("wreck"))
    assert session.history.undoable == ("open A wreck with a standing mast", "tolerance", "altitude")
    assert session.opened == load_scene("wreck")
    session.undo(2)
    assert session.opened == scene
    assert session.history.redoable == ("tolerance", "open A wreck with a standing mast")


def test_nothing_is_shown_as_a_window_of_its_own(open_viewer, small, qapp):
    def has_no_parent(watched):
        return isinstance(watched, QWidget) and watched.parent() is None

    with watched_events(qapp, QEvent.Type.Show, has_no_parent) as shown:
        viewer = open_viewer(small)
        viewer.session.settle({"sonar.beam.kind": "array"})
        panel(viewer).view.search.setText("beam")
        viewer.session.settle({"sonar.beam.kind": "knife"})
    assert set(shown) == {viewer.window}


def test_rows_are_built_section_by_section(qtbot, monkeypatch):
    built = []
    grid = SectionBox._grid
    monkeypatch.setattr(SectionBox, "_grid", lambda box, rows, to: (built.append(rows[0].path), grid(box, rows, to))[1])
    view = ParametersView()
    qtbot.addWidget(view)
    view.show_sections(sections_of(load_scene("wreck")))
    view.show()
    boxes = view.sections
    assert sum(box.built for box in boxes.values()) == 1, "the others wait for their turn"
    assert view.row("track.altitude").label.text() == "altitude", "unless a row is asked for"
    qtbot.waitUntil(lambda: not any(box.waits for box in boxes.values()))
    assert not any(path.startswith(("targets", "water", "receiver")) for path in built), "what is folded waits for that"
    boxes["targets.0"].unfold(True)
    qtbot.waitUntil(view.row("targets.0.position.0").field.isVisible)
    # Rows that are built later are marked and lit.
    view.show_changed({"water.sound_speed": "1450 m/s"})
    view._lit = ("water.sound_speed",)
    view._light_rows()
    box = next(box for box in boxes.values() if box.holds("water.sound_speed"))
    assert not box.built
    label = box.rows["water.sound_speed"].label
    assert label.property("changed")
    assert label.property("lit")
