"""The real window on a virtual screen, over a simulation of known numbers."""

import numpy as np
import pytest
from controls import choose, finish, move_slider, picture_of
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QFileDialog
from stand_in import StandIn

from insonify.scene import edit
from insonify.scene.seabed.materials.catalogue import MATERIALS
from insonify.simulation import prepare
from insonify_viewer.widgets.field_rows import NumberRow


def number_row(viewer, path: str) -> NumberRow:
    row = viewer.panels["parameters"].view.row(path)
    assert isinstance(row, NumberRow)
    return row


def pick(viewer, path: str, option: str):
    combo = viewer.panels["parameters"].view.row(path).combo
    choose(combo, combo.findData(option))


def test_a_slider_palette_gain_and_other_bins_and_pings_change_the_waterfall(open_viewer, small, qtbot):
    viewer, fine = open_viewer(small), []  # a row of the record is a row of the screen at first
    viewer.simulator.answered.connect(lambda answer: fine.append(answer.fine))
    slider = move_slider(number_row(viewer, "track.altitude").slider, 300)
    qtbot.waitUntil(lambda: viewer.complete and fine and fine[-1])
    assert slider.isSliderDown()
    altitude = viewer.session.scene.track.altitude
    shown = {"track.altitude": f"{altitude:.4g} m", "track.depth": f"{30.0 - altitude:.4g} m"}
    qtbot.waitUntil(lambda: {path: number_row(viewer, path).field.text() for path in shown} == shown)
    assert not viewer.session.history.undoable, "the drag goes on"
    finish(viewer, qtbot, slider.setSliderDown, False)
    before = picture_of(viewer.window.waterfall).copy()
    slider = move_slider(number_row(viewer, "seabed.material.diffuse").slider, 600)
    finish(viewer, qtbot, slider.setSliderDown, False)
    assert viewer.session.scene.seabed.material.diffuse == pytest.approx(0.6, abs=0.01)
    assert (picture_of(viewer.window.waterfall) != before).any()
    # Palette and gain change the colours.
    viewer.find_levels()
    waterfall = viewer.window.waterfall
    copper = picture_of(waterfall).copy()
    choose(viewer.window.palettes, "pen")
    pen = picture_of(waterfall).copy()
    assert (copper != pen).any()
    viewer.window.gain.setValue(100)
    assert viewer.window._gain_text.text() == "10 dB"
    assert (picture_of(waterfall) != pen).any()
    viewer.find_levels()
    assert (picture_of(waterfall) == pen).all()
    # Port is left, and the newest ping on top.
    amplitude = np.zeros((1, 2, 100), np.float32)
    amplitude[0, 0, 99] = 50.0
    waterfall.show_rows(viewer.record.put(np.array([127]), amplitude, 99))
    picture = picture_of(waterfall)
    brightest = np.unravel_index(np.argmax(picture & 0xFF), picture.shape)
    assert brightest[0] == 0
    assert brightest[1] < picture.shape[1] // 50
    finish(viewer, qtbot, viewer.session.settle, {"sonar.bins": 50, "track.pings": 40})
    assert (viewer.record.pings, viewer.record.bins) == (40, 50)
    assert waterfall.record is viewer.record


def test_drag_is_coarse_and_release_is_fine(open_viewer, small, qtbot):
    made = []

    def prepare(scene, *, tolerance, forced, plan=None):
        made.append((scene, forced.get("planes", "as planned")))
        return StandIn(scene, tolerance=tolerance, forced=forced, plan=plan)

    def planes():
        """Last choice for the scene on screen; what effects change is measured on other scenes meanwhile."""
        return [choice for scene, choice in made if scene == viewer.session.scene][-1]

    viewer = open_viewer(small, prepare=prepare)
    before = viewer.session.scene
    viewer.simulator.cost = 1.0  # as if a coarse ping took a second, to be thinned as far as allowed
    viewer._rest.setInterval(10**6)  # as if the person went on within a moment
    between = []
    viewer.simulator.answered.connect(lambda answer: between.append(float(answer.between.mean())))
    slider = move_slider(number_row(viewer, "track.altitude").slider, 300)
    qtbot.waitUntil(lambda: viewer.complete)
    assert planes() == "1"
    assert between[0] > 0.5, "most pings are interpolated at first"
    assert between[-1] == 0.0, "then all are traced by one plane"
    finish(viewer, qtbot, slider.setSliderDown, False)
    assert planes() == "as planned"
    viewer.session.undo()
    assert viewer.session.scene == before, "a drag is one step of undo"


def test_rows_stand_where_the_simulation_says_and_a_tow_that_runs_pauses_before_the_targets_leave(
    viewer, small, qtbot, monkeypatch
):
    record = viewer.record
    for ping in (0, 5, 127):
        expected = MATERIALS["medium_sand"].diffuse * (1.0 + (ping % 7) / 10.0)
        assert record.amplitude_at(ping, 0, 50) == pytest.approx(expected, rel=1e-3)
        assert record.amplitude_at(ping, 1, 3) == 0.0
    held = picture_of(viewer.window.waterfall).copy()
    qtbot.wait(150)
    assert viewer.tow.newest == 127
    assert (picture_of(viewer.window.waterfall) == held).all()
    assert viewer.window.pause.shortcut().toString() == "Space"
    viewer.window.pause.trigger()
    qtbot.waitUntil(lambda: viewer.window.waterfall.top > 129)
    viewer.window.pause.trigger()
    assert not viewer.tow.running
    # The tow pauses once before the targets leave.
    viewer.tow.speed = 16.0
    viewer.run(True)
    qtbot.waitUntil(lambda: not viewer.tow.running)
    # The pipe begins 12 m along the track, at ping 60; 124 of the 128 on screen lie above it.
    assert viewer.tow.newest == 60 + 123
    assert "press Space to go on" in viewer.window.status.sentence.text()
    assert viewer.window.pause.isChecked()
    viewer.open(edit(small, {"seed": 7}))
    assert viewer.tow.running
    assert not viewer.window.pause.isChecked()
    qtbot.waitUntil(lambda: not viewer.tow.running)
    viewer.run(True)
    qtbot.waitUntil(lambda: viewer.tow.newest > 400)
    # It waits for pings that take long.
    viewer.run(False)
    finish(viewer, qtbot, viewer.open, edit(small, {"targets": []}))
    monkeypatch.setattr(viewer.simulator, "ask", lambda request: None)  # as if nothing were ever traced
    viewer.run(True)
    qtbot.waitUntil(lambda: viewer.tow.newest > 127 + 48)
    qtbot.wait(500)
    assert viewer.tow.running
    # It stops when more than 48 are blank, and goes on by no more than a fifth of a second at once.
    assert 127 + 48 < viewer.tow.newest <= 127 + 48 + round(0.2 * 16.0 * 10.0) + 1


def test_names_turn_into_numbers_and_values_are_typed_or_read(open_viewer, small, tmp_path, qtbot, monkeypatch):
    viewer = open_viewer(edit(small, {"seabed.material.diffuse": 0.33}))
    assert number_row(viewer, "seabed.material.diffuse").field.text() == "0.33"
    pick(viewer, "seabed.material.name", "rock")
    shown = [number_row(viewer, f"seabed.material.{n}").field.text() for n in ("diffuse", "specular", "shininess")]
    assert shown == [f"{value:.4g}" for value in MATERIALS["rock"].reflectivity[:3]]
    viewer.open(edit(small, {"sonar.beam": "array"}))
    field = number_row(viewer, "sonar.frequency").field
    for text, expected in (("600 kHz", 6e5), ("0.3MHz", 3e5), ("abc", 3e5), ("-5", 3e5)):
        field.clear()
        QTest.keyClicks(field, text)
        QTest.keyClick(field, Qt.Key.Key_Return)
        assert viewer.session.scene.sonar.frequency == pytest.approx(expected)
    assert "frequency" in viewer.window.status.sentence.text()
    assert field.text() == "300 kHz"
    # A kind that is read from a file asks for it.
    path = tmp_path / "correlation.csv"
    path.write_text("lag,value\n0,1\n1,0.5\n2,0.1\n4,0\n")
    viewer.open(edit(small, {"seabed.relief": {"kind": "autocorrelation"}}))
    picked = ""
    monkeypatch.setattr(QFileDialog, "getOpenFileName", lambda *_: (picked, ""))
    pick(viewer, "seabed.relief.function.kind", "file")
    assert viewer.session.scene.seabed.relief.function.kind == "exponential"
    picked = str(path)
    pick(viewer, "seabed.relief.function.kind", "file")
    assert viewer.session.scene.seabed.relief.function.path == picked
    # One ping and one bin are a record.
    finish(viewer, qtbot, viewer.open, edit(small, {"sonar.bins": 1, "track.pings": 1}))
    viewer.window.resize(880, 520)
    viewer.run(True)
    qtbot.wait(100)
    assert picture_of(viewer.window.waterfall).shape[0] == 1


def test_edits_are_refused_take_rows_along_and_a_slider_without_effect_stands_aside(viewer, small, qtbot):
    row = number_row(viewer, "seabed.depth")
    home = row.slider.value()
    move_slider(row.slider, 0).setSliderDown(False)
    assert "above the surface" in viewer.window.status.sentence.text()
    assert viewer.session.scene == small
    assert row.slider.value() == home
    assert row.field.text() == "30 m"
    viewer.session.settle({"seed": 666})
    qtbot.waitUntil(lambda: viewer.session.scene == small)
    assert "666" in viewer.window.status.sentence.text()
    # A kind edits the scene and its rows.
    pick(viewer, "sonar.beam.kind", "knife")
    assert viewer.session.scene.sonar.beam.kind == "knife"
    with pytest.raises(StopIteration):
        viewer.panels["parameters"].view.row("sonar.beam.width")
    viewer.window.undo.trigger()
    assert viewer.session.scene.sonar.beam.kind == "fan"
    assert number_row(viewer, "sonar.beam.width").field.text() == "1°"
    # A slider that changes nothing stands aside.
    viewer.open(edit(small, {"seabed.material": {"name": "silt", "diffuse": 0.2, "specular": 0.0}}))
    row = number_row(viewer, "sonar.frequency")
    assert not row.slider.isEnabled()
    assert "changes nothing here" in row.slider.toolTip()
    assert number_row(viewer, "sonar.range").slider.isEnabled()
    acting = {"sonar.beam": "array", "water.absorption": "francois_garrison", "receiver.speckle": "rayleigh"}
    for path, kind in (acting | {"seabed.material": "silt"}).items():
        viewer.session.settle({path: kind})
        row = number_row(viewer, "sonar.frequency")
        assert row.slider.isEnabled(), path
        assert "has no effect" not in row.field.toolTip()
        viewer.session.undo()
        assert not number_row(viewer, "sonar.frequency").field.isEnabled()
    assert "the specular share is 0" in number_row(viewer, "seabed.material.shininess").slider.toolTip()
    assert "it acts beside noise" in number_row(viewer, "receiver.source_level").slider.toolTip()
    viewer.session.settle({"receiver.noise": "ambient"})
    assert number_row(viewer, "receiver.source_level").slider.isEnabled()


def test_dem_is_opened_and_the_tow_ends_with_it(open_viewer, small, tmp_path, qtbot):
    y, x = np.mgrid[0:60, 0:90]
    np.save(tmp_path / "hill.npy", np.hypot(x - 45.0, y - 30.0) / -20.0)
    viewer = open_viewer(small, prepare=prepare)
    viewer.files.open_dem(edit(small, {"seabed.spacing": 1.0}), str(tmp_path / "hill.npy"))
    qtbot.waitUntil(lambda: viewer.complete and viewer.session.scene.seabed.relief.kind == "dem")
    scene = viewer.session.scene
    assert (scene.title, scene.sonar.range, scene.targets) == ("hill.npy", 18.0, ())
    assert viewer.record.amplitude.max() > 0.0
    viewer.tow.speed = 16.0
    viewer.run(True)
    qtbot.waitUntil(lambda: not viewer.tow.running)
    assert "left the measured bed" in viewer.window.status.sentence.text()
    viewer.files.open_dem(scene, str(tmp_path / "none.npy"))
    said = viewer.window.status.sentence
    qtbot.waitUntil(lambda: "none.npy" in said.text() and "…" not in said.text())
    assert viewer.session.scene == scene
