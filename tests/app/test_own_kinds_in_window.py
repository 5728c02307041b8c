"""A shape and a material of somebody else's in the window: menu, three dimensions, sliders."""

import numpy as np
import pytest

from insonify.scene import edit
from insonify.scene_edits import add_dependent_edits
from insonify.simulation import prepare
from insonify_viewer.seabed.bed_shading import target_colours
from insonify_viewer.seabed.pv_meshes import targets_mesh
from insonify_viewer.state.fields import ChoiceField, NumberField
from insonify_viewer.state.sections import sections_of
from insonify_viewer.window.target_placement import target_menu
from own_kinds import own_kinds, own_scene


@pytest.fixture(autouse=True)
def _known():
    with own_kinds():
        yield


def test_the_menu_puts_a_hoop_on_the_bed(open_viewer, small, qtbot):
    assert list(target_menu())[-1] == "hoop"
    viewer = open_viewer(edit(small, {"targets": []}))
    action = next(action for action in viewer.window.targets.menu().actions() if action.text() == "Hoop")
    action.trigger()
    qtbot.waitUntil(lambda: len(viewer.session.scene.targets) == 1)
    assert viewer.session.scene.targets[0].kind == "hoop"
    row = viewer.panels["parameters"].view.row("targets.0.tube")
    qtbot.waitUntil(row.label.isVisible)
    viewer.session.settle({"targets.0.tube": 0.75})
    assert viewer.session.scene.targets[0].tube == 0.75


def test_it_is_shown_in_its_own_colour():
    arrays, colours = prepare(own_scene()).arrays, target_colours(own_scene())
    shown = targets_mesh(arrays.solids, arrays.mesh, colours)
    np.testing.assert_allclose(np.reshape(shown.bounds, (3, 2)), [[2.5, 7.5], [15.5, 20.5], [0.0, 1.0]], atol=1e-6)
    np.testing.assert_array_equal(np.unique(shown.cell_data["colour"], axis=0), colours)
    assert colours[0, 0] > colours[0, 2]


def test_the_panel_has_its_sliders_and_the_material_in_its_list():
    ring = next(section for section in sections_of(own_scene()) if section.key == "targets.0")
    assert ring.title == "Hoop 1"
    rows = {row.path.removeprefix("targets.0."): row for row in ring.parameters}
    tube = rows["tube"]
    assert isinstance(tube, NumberField)
    assert (tube.slider, tube.unit, tube.log) == ((0.05, 2.0), "m", True)
    assert {"radius", "heading", "pitch", "roll", "gap"} <= rows.keys()
    material = rows["material.name"]
    assert isinstance(material, ChoiceField)
    assert "coral" in material.options


def test_a_map_of_somebody_elses_is_switched_to():
    changes, _ = add_dependent_edits(own_scene(), {"seabed.material.kind": "halves"})
    scene = edit(own_scene(), changes)
    assert [one.name for one in scene.seabed.material.materials] == ["medium_sand", "rock"]
    paths = [row.path for section in sections_of(scene) for row in section.parameters]
    assert "seabed.material.border" in paths
