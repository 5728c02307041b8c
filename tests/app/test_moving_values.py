"""While a slider moves, the rows show the values of the scene as a whole description of it would."""

from typing import Any

import pytest

from insonify.scene import SceneError, bundled_scenes, edit, load_scene
from insonify_viewer.panels.parameters.sections import FieldSection, sections_of
from insonify_viewer.panels.parameters.values import follow_values
from insonify_viewer.state.fields import NumberField
from insonify_viewer.state.session import Session


def values(sections: tuple[FieldSection, ...]) -> dict[str, Any]:
    return {field.path: field.value for section in sections for field in section.parameters}


@pytest.mark.parametrize("name", sorted(bundled_scenes()))
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


def test_the_number_and_the_marks_follow_a_slider_that_is_held(viewer, small, qtbot):
    view = viewer.panels["parameters"].view
    row = view.row("track.altitude")
    row.slider.setSliderDown(True)
    row.slider.setValue(row.slider.value() + 150)
    moved = viewer.session.scene.track.altitude
    assert moved != small.track.altitude
    qtbot.waitUntil(lambda: row.field.text() == f"{moved:.4g} m")
    depth = next(box.rows["track.depth"] for box in view._boxes("track.depth")) if view._boxes("track.depth") else None
    assert depth is None or depth.field.text() == f"{small.seabed.depth - moved:.4g} m"
    row.slider.setSliderDown(False)
    row.slider.sliderReleased.emit()
    assert row.field.text() == f"{moved:.4g} m"
