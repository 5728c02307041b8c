"""Rows of parameters: their numbers and sliders, values while one moves, pictures below them, and kinds of relief."""

import threading
from typing import Any

import numpy as np
import pytest
from controls import drag, finish, scenes_by_rows
from PySide6.QtCore import Qt

from field_changes import RELIEFS, with_relief
from insonify.display.scene_curves import beam_curve
from insonify.scene import SceneError, edit, load_scene
from insonify.scene.edit import parse_quantity
from insonify_viewer.panels.parameters.values import follow_values
from insonify_viewer.panels.parameters.view import setting_pictures as registry
from insonify_viewer.panels.parameters.view.setting_pictures import CurvesPicture, SpectrumPicture
from insonify_viewer.state import sections as field_sections
from insonify_viewer.state.fields import NumberField
from insonify_viewer.state.quantities import format_duration, format_quantity, slider_position, slider_value
from insonify_viewer.state.sections import FieldSection, sections_of
from insonify_viewer.state.session import Session


def test_numbers_are_printed_and_read_back():
    printed = {
        "Hz": {4e5: "400 kHz", 1.2e6: "1.2 MHz", 10.0: "10 Hz"},
        "s": {1e-4: "0.1 ms", 0.0: "0 s"},
        "°": {1.0: "1°"},
        "cycles/period": {48.0: "48"},
        "": {100000.0: "100000"},
        "m": {-0.125: "-0.125 m"},
    }
    for unit, texts in printed.items():
        assert {value: format_quantity(value, unit) for value in texts} == texts
        assert [parse_quantity(text, unit) for text in texts.values()] == pytest.approx(list(texts))


def test_units_that_people_write_are_read():
    read = {  # by the unit of the field and the text that it shows
        ("s", "0.1 ms"): {"0.2": 2e-4, "200 µs": 2e-4, "2e-4": 2e-4},
        ("Hz", "400 kHz"): {"500 kHz": 5e5, "500khz": 5e5, "500": 5e5, "4e5": 4e5, "1.2M": 1.2e6},
        ("m", "0.1 m"): {"20 cm": 0.2, "20": 20.0},
        ("m", ""): {"1,5 m": 1.5},
        ("m", "2 m"): {"−3": -3.0},
        ("°", "1°"): {"17.45 mrad": 0.99981},
        ("°", "0°"): {"225T": -135.0},
        ("m/s", "2 m/s"): {"4 kn": 2.05778},
        ("", "0.2"): {"0.3": 0.3},
    }
    for (unit, like), numbers in read.items():
        assert {text: parse_quantity(text, unit, like) for text in numbers} == pytest.approx(numbers, rel=1e-5)


def test_times_are_printed_in_three_digits_and_nonsense_is_not_a_number():
    times = {1.23e-5: "12.3 µs", 9.99e-4: "999 µs", 9.996e-4: "1 ms", 1.288e-3: "1.29 ms"}
    assert {seconds: format_duration(seconds) for seconds in times} == times
    assert [parse_quantity(text, "m") for text in ("", "abc", "nan", "inf", "1 2", "3 kHz", "1e999")] == [None] * 7


@pytest.mark.parametrize("log", [False, True])
def test_slider_places_and_values_agree(log):
    ends = (0.01, 10.0)
    for part in np.linspace(0.0, 1.0, 17):
        value = slider_value(float(part), ends, log=log, integer=False)
        assert slider_position(value, ends, log=log) == pytest.approx(part, abs=2e-3)
    assert tuple(slider_value(part, ends, log=log, integer=False) for part in (0.0, 1.0)) == ends
    assert slider_position(1e9, ends, log=log) == 1.0


def values(sections: tuple[FieldSection, ...]) -> dict[str, Any]:
    return {field.path: field.value for section in sections for field in section.parameters}


@pytest.mark.parametrize("name", scenes_by_rows())
def test_values_are_those_of_a_whole_description(name):
    scene = load_scene(name)
    sections, session, moved = sections_of(scene), Session(scene), 0
    for field in (field for section in sections for field in section.parameters):
        if not isinstance(field, NumberField) or field.slider is None:
            continue
        value = field.slider[0] + 0.37 * (field.slider[1] - field.slider[0])
        session.drag({field.path: round(value) if field.integer else value})
        followed = follow_values(session.scene, sections)
        whole = values(sections_of(session.scene))
        if followed is None:  # a choice follows from the number
            continue
        moved += session.scene != scene
        assert {path: value for path, value in values(followed).items() if path in whole} == {
            path: value for path, value in whole.items() if path in values(sections)
        }, field.path
        session.settle(None)
        session.undo()
    assert moved > 5


def test_what_stays_is_the_same_object_and_a_choice_or_missing_part_is_told():
    scene = load_scene("default")
    sections = sections_of(scene)
    again = follow_values(edit(scene, {"track.altitude": 7.5}), sections)
    assert again is not None
    changed = {
        field.path
        for before, section in zip(sections, again, strict=True)
        for old, field in zip(before.parameters, section.parameters, strict=True)
        if field is not old
    }
    assert changed == {"track.altitude", "track.depth"} & values(sections).keys() != set()
    assert sum(section is not before for before, section in zip(sections, again, strict=True)) == 1
    assert follow_values(edit(scene, {"sonar.beam.kind": "gaussian"}), sections) is None
    with pytest.raises(SceneError):
        edit(scene, {"targets.9.radius": 1.0})
    assert follow_values(edit(scene, {"targets": []}), sections) is None


@pytest.mark.parametrize(("changes", "kept"), [
    ({"targets.2.radius": 0.7}, 3), ({"seabed.relief": "flat"}, 4), ({"track.pings": 5}, 4), ({"sonar.bounces": 1}, 0),
    ({"targets.0": {"kind": "box", "position": [0.0, 5.0], "size": [1.0, 1.0, 1.0]}}, 0), ({"sonar.frequency": 1e5}, 0),
    ({"receiver.speckle": "none"}, None),
])  # fmt: skip
def test_sections_of_targets_that_an_edit_leaves_as_they_are_stay_the_same_objects(changes, kept, monkeypatch):
    def described(scene, known):
        monkeypatch.setattr(field_sections, "_KNOWN", known)
        return [section for section in sections_of(scene) if section.key.startswith("targets.")]

    spheres = [{"kind": "sphere", "position": [float(k), 5.0], "radius": 0.5} for k in range(4)]
    scene, known = edit(load_scene("default"), {"targets": spheres}), {}
    before, after = described(scene, known), described(edit(scene, changes), known)
    assert after == described(edit(scene, changes), {}), "whatever was described before"
    assert kept is None or sum(one is other for one, other in zip(before, after, strict=True)) == kept


def test_curves_follow_the_scene_and_a_peak_is_dragged_in_one_step(open_viewer, small, qtbot, monkeypatch):
    threads = set()

    def watched(scene):
        threads.add(threading.current_thread())
        1.0 / (scene.sonar.beam.width - 3.0)
        return beam_curve(scene)

    monkeypatch.setattr(registry, "beam_curve", watched)
    peaked = edit(small, {"seabed.relief": {"kind": "fractal", "peaks": [[8.0, 20.0], [0.0, 0.0]], "rms": 0.05}})
    viewer = open_viewer(peaked)
    panel = viewer.panels["parameters"].widget
    picture = next(one for one in panel.findChildren(CurvesPicture) if watched in one.draws)
    panel.ensureWidgetVisible(picture, 0, 0)
    qtbot.waitUntil(lambda: bool(picture.curves))
    assert picture.curves[0].note.startswith("−3 dB: 1°")
    assert viewer.session.settle({"sonar.beam.width": 4.0})
    qtbot.waitUntil(lambda: picture.curves[0].note.startswith("−3 dB: 4°"))
    assert threading.main_thread() not in threads, "painting computes nothing"
    # A fault on the thread is reported, and the next scene has its curves.
    with qtbot.captureExceptions() as printed:
        assert viewer.session.settle({"sonar.beam.width": 3.0})
        qtbot.waitUntil(lambda: not picture.curves)
    assert [kind for kind, *_ in printed] == [ZeroDivisionError]
    assert viewer.session.settle({"sonar.beam.width": 4.0})
    qtbot.waitUntil(lambda: bool(picture.curves))
    assert picture.curves[0].note.startswith("−3 dB: 4°")
    # What has no curve takes no room.
    changes = {"sonar.beam": {"kind": "knife"}, "sonar.pulse": {"kind": "ideal"}, "seabed.material.diffuse": 0.2}
    assert viewer.session.settle(changes)
    assert not [one for one in panel.findChildren(CurvesPicture) if one.isVisible()]
    # A peak is dragged in one step.
    finish(viewer, qtbot, viewer.open, peaked)
    undoable = viewer.session.history.undoable
    picture = panel.findChildren(SpectrumPicture)[0]
    panel.ensureWidgetVisible(picture, 0, 0)
    plot = picture.plot
    qtbot.waitUntil(lambda: len(plot.marks) == 2)
    qtbot.wait(20)
    qtbot.mouseClick(plot.surface, Qt.MouseButton.LeftButton, pos=plot.place_of(-20.0, -20.0))
    assert viewer.session.scene == peaked, "a press beside the peaks moves none"
    drag(plot.surface, plot.place_of(8.0, 20.0), plot.place_of(-8.0, 20.0))
    moved, still = viewer.session.scene.seabed.relief.peaks
    assert moved == pytest.approx((-8.0, 20.0), abs=1.0)
    assert moved == tuple(float(round(wave)) for wave in moved)
    assert still == (0.0, 0.0)
    viewer.session.undo()
    assert viewer.session.scene.seabed.relief.peaks[0] == (8.0, 20.0)
    assert viewer.session.history.undoable == undoable


def shown(scene) -> dict:
    """Parameters of the relief by their path beneath it."""
    seabed = next(section for section in sections_of(scene) if section.key == "seabed")
    prefix = "seabed.relief."
    return {p.path.removeprefix(prefix): p for p in seabed.parameters if p.path.startswith(prefix)}


@pytest.mark.parametrize("kind", [kind for kind in RELIEFS if kind not in ("flat", "mimic")])
def test_every_slider_of_a_kind_may_be_pushed_to_either_end(kind):
    chosen = with_relief(load_scene("default"), kind=kind)
    sliders = {path: p for path, p in shown(chosen).items() if isinstance(p, NumberField) and p.slider is not None}
    assert sliders
    for path, number in sliders.items():
        for end in number.slider:
            if "peaks" not in path:
                with_relief(chosen, **{path.replace(".", "__"): end})


def test_what_all_relief_has_comes_last_a_mask_brings_its_sliders_and_parts_of_a_sum_keep_one_period():
    scene = load_scene("default")
    ripples = with_relief(scene, kind="ripples")
    names = list(shown(ripples))
    assert (names[:2], names[-3:]) == (["kind", "wavelength"], ["period", "extent", "mask.kind"])
    assert "period" not in shown(with_relief(ripples, extent="endless"))
    assert "period" in shown(with_relief(with_relief(scene, kind="power_law"), extent="endless"))
    assert {"mask.share", "mask.size", "mask.softness"} <= set(shown(with_relief(ripples, mask__kind="patches")))
    both = with_relief(scene, kind="sum")
    assert [part.kind for part in both.seabed.relief.of] == ["fractal", "ripples"]
    assert both.seabed.relief.of[0] == scene.seabed.relief
    longer = with_relief(both, of__1__period=204.8)
    assert [part.period for part in longer.seabed.relief.of] == [204.8, 204.8]
    assert "of.1.heading" in shown(both)
