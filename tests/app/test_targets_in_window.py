"""Adding, turning and removing targets in the window, kinds of somebody else's, and scenes that are put together."""

import threading
from types import SimpleNamespace

import numpy as np
import pytest
import pyvista
from controls import finish
from PySide6.QtCore import QTimer
from PySide6.QtWidgets import QApplication, QFileDialog, QToolButton
from stand_in import StandIn, ground_of

from insonify import simulate
from insonify.files import bundled_meshes, bundled_sonars, resources
from insonify.scene import SceneError, edit
from insonify.scene_edits import add_dependent_edits
from insonify.simulation import prepare
from insonify_viewer.seabed.bed_shading import target_colours
from insonify_viewer.seabed.pv_meshes import CLOUD, frustum_triangles, target_triangles, volume_points
from insonify_viewer.state.fields import ChoiceField, NumberField
from insonify_viewer.state.sections import sections_of
from insonify_viewer.widgets.field_rows import FileRow
from insonify_viewer.widgets.gallery import Gallery
from insonify_viewer.window.new_scene import BEDS, NewScene, compose_scene
from insonify_viewer.window.target_placement import new_target, target_menu
from own_kinds import own_kinds, own_scene


def pick_file(monkeypatch, path: str):
    monkeypatch.setattr(Gallery, "exec", lambda gallery: gallery.wanted.emit(""))
    monkeypatch.setattr(QFileDialog, "getOpenFileName", lambda *_: (path, ""))


def add(viewer, kind: str, qtbot):
    before = len(viewer.session.scene.targets)
    action = next(a for a in viewer.window.targets.menu().actions() if a.data() == kind)
    action.trigger()
    # A mesh imports its reader first.
    qtbot.waitUntil(lambda: len(viewer.session.scene.targets) == before + 1)
    return viewer.session.scene.targets[-1]


def removers(viewer) -> list[QToolButton]:
    return [b for b in viewer.panels["parameters"].view.findChildren(QToolButton, "remove") if b.isVisible()]


@pytest.fixture
def own():
    """A scene with a shape, a map and a material of somebody else's."""
    with own_kinds():
        yield own_scene()


@pytest.mark.usefixtures("own")
def test_a_target_of_any_kind_is_added_taken_back_kept_apart_and_in_a_new_scene(open_viewer, small, qtbot, monkeypatch):
    pick_file(monkeypatch, str(resources() / "meshes" / "tetrapod.obj"))
    viewer = open_viewer(edit(small, {"targets": []}))
    assert list(target_menu())[-1] == "hoop", "of somebody else's"
    for kind in target_menu():
        target = add(viewer, kind, qtbot)
        assert target.kind == kind
        assert getattr(target, "path", "tetrapod") == "tetrapod"
        # Abeam of pings that are on screen, and within hearing.
        x, y = target.position[:2]
        assert 0.0 < x < 127 * 0.2
        assert 5.0 < abs(y) < 45.0
        qtbot.waitUntil(lambda: viewer.panels["parameters"].view.row("targets.0.material.name").label.isVisible())
        if kind == "hoop":
            assert viewer.panels["parameters"].view.row("targets.0.tube").label.isVisible()
            viewer.session.settle({"targets.0.tube": 0.75})
            assert viewer.session.scene.targets[0].tube == 0.75
            viewer.session.undo()
        viewer.session.undo()
        assert viewer.session.scene.targets == ()
        viewer.session.redo()
        assert viewer.session.scene.targets == (target,)
        viewer.session.undo()
    # Targets keep apart from one another.
    places = np.array([add(viewer, "sphere", qtbot).position for _ in range(5)])
    distances = np.linalg.norm(places[:, None] - places, axis=2) + 1e9 * np.eye(5)
    assert distances.min() > 7.0

    # The dialog of a new scene opens it without a file, with its targets.
    def answer(dialog: NewScene) -> bool:
        dialog.beds.setCurrentRow(3)
        dialog.sonar.setCurrentIndex(dialog.sonar.findData("kayak-800"))
        assert dialog.altitude.value() == pytest.approx(2.5)
        dialog.pings.setValue(100)
        for row in (0, 2):
            dialog.targets.item(row).setSelected(True)
        return True

    monkeypatch.setattr(NewScene, "exec", answer)
    viewer.window.new_scene.trigger()
    scene = viewer.session.scene
    assert (scene.title, viewer.session.file, scene.track.pings) == ("Untitled", "", 100)
    names = list(bundled_meshes())
    assert [target.path for target in scene.targets] == [names[0], names[2]]
    (x, y), (further, across) = (target.position for target in scene.targets)
    assert (x < further, y * across < 0.0) == (True, True)


def test_a_mesh_is_chosen_by_its_picture_or_refused_and_removed_by_a_cross(viewer, small, qtbot, monkeypatch, tmp_path):
    seen = []

    def click_the_anchor():
        gallery = QApplication.activeModalWidget()
        if not isinstance(gallery, Gallery):
            QTimer.singleShot(20, click_the_anchor)
            return
        items = [gallery.list.item(k) for k in range(gallery.list.count())]
        seen.extend((item.text(), item.icon().availableSizes()) for item in items)
        gallery.list.itemClicked.emit(next(item for item in items if item.text().startswith("admiralty anchor")))

    QTimer.singleShot(0, click_the_anchor)
    assert add(viewer, "mesh", qtbot).path == "anchor"
    assert all(picture for _, picture in seen[:-1])
    assert seen[-1] == ("Other file…", [])
    # A mesh takes another file.
    path = tmp_path / "shape.obj"
    path.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n")
    viewer.open(edit(small, {"targets": [{"kind": "mesh", "path": "tetrapod", "position": [5.0, 20.0]}]}))
    row = viewer.panels["parameters"].view.row("targets.0.path")
    assert isinstance(row, FileRow)
    assert row.button.text() == "tetrapod …"
    pick_file(monkeypatch, str(path))
    row.button.click()
    assert viewer.session.scene.targets[0].path == str(path)
    assert row.button.text() == "shape.obj …"
    # No file and a wrong mesh add nothing.
    finish(viewer, qtbot, viewer.open, small)
    pick_file(monkeypatch, "")
    viewer.window.target_wanted.emit("mesh")
    qtbot.wait(50)
    assert viewer.session.scene == small
    (tmp_path / "empty.obj").write_text("")
    pick_file(monkeypatch, str(tmp_path / "empty.obj"))
    viewer.window.target_wanted.emit("mesh")
    qtbot.waitUntil(lambda: "holds no triangles" in viewer.window.status.sentence.text())
    assert viewer.session.scene == small
    # A cross removes its target alone.
    pipe, first, second = small.targets
    assert len(removers(viewer)) == 3
    removers(viewer)[1].click()
    assert viewer.session.scene.targets == (pipe, second)
    qtbot.waitUntil(lambda: len(removers(viewer)) == 2)
    viewer.session.undo()
    assert viewer.session.scene.targets == (pipe, first, second)


def test_shapes_come_before_attitude_and_materials_last_and_what_has_no_say_stands_aside(small):
    def labels(changes, *keys):
        found = [each for each in sections_of(edit(small, changes)) if each.key in ("targets.0", *keys)]
        assert found[-1].removable, "a target, which comes after the seabed"
        return [parameter.label for section in found for parameter in section.parameters]

    shape = ["position x", "position y", "length", "width", "height", "heading", "pitch", "roll", "gap", "material"]
    assert labels({"targets": [{"kind": "box", "position": [1.0, 2.0]}]})[:10] == shape
    assert "gap" not in labels({"targets": [{"kind": "sphere", "position": [1.0, 2.0, -20.0]}]})
    pipe = {"kind": "pipe", "position": [1.0, 2.0]}
    assert "pitch" not in labels({"targets": [pipe | {"gap": [[-1.0, 0.0], [1.0, 1.0]]}]})
    assert "pitch" in labels({"targets": [pipe]})
    assert not {"reflection", "speed ratio", "speckle shape"} & set(labels({}, "seabed"))
    assert {"reflection", "speed ratio"} <= set(labels({"sonar.bounces": 1}, "seabed")), "which bounces need"


def test_a_mesh_in_millimetres_is_brought_to_metres_and_beside_the_bed_there_is_no_place(small, tmp_path):
    (tmp_path / "large.obj").write_text("v 0 0 0\nv 4000 0 0\nv 0 3000 0\nf 1 2 3\n")
    simulation = StandIn(small, 0.03)
    assert new_target(simulation, small, "mesh", 100, str(tmp_path / "large.obj"))["scale"] == 0.01
    simulation.ground = SimpleNamespace(height_at_once=lambda x, y: np.full(x.shape, np.nan))
    with pytest.raises(SceneError, match="there is no bed beside this part of the tow"):
        new_target(simulation, small, "box", 100)


def test_the_drawn_targets_are_where_the_traced_ones_are(small):
    box = {"kind": "box", "position": [5.0, 20.0], "size": [3.0, 2.0, 1.0], "heading": 90.0}
    cone = {"kind": "cone", "position": [15.0, 20.0], "radius": 2.0, "height": 1.0}
    scene = edit(small, {"targets": [box, {**cone, "material": "rock"}]})
    arrays = StandIn(scene, 0.03).arrays
    drawn, colours = target_triangles(arrays.solids, arrays.mesh, target_colours(scene))
    low, high = drawn.min(axis=(0, 1)), drawn.max(axis=(0, 1))
    np.testing.assert_allclose(low[:2], [4.0, 18.0], atol=0.03)
    np.testing.assert_allclose(high[:2], [17.0, 22.0], atol=0.03)
    # Every face has the colour of its own target's material.
    steel, rock = target_colours(scene)
    expected = np.where((drawn.mean(axis=1)[:, 0] < 10.0)[:, None], steel, rock)
    np.testing.assert_array_equal(colours, expected)


def test_volumes_are_drawn_where_they_echo_by_the_main_thread_alone(open_viewer, small, qtbot, monkeypatch):
    # Where another thread destroys an object of VTK while VTK draws, each waits for the other for ever.
    threads, made = set(), pyvista.DataObject.__init__

    def note(self, *args, **options):
        threads.add(threading.current_thread().name)
        made(self, *args, **options)

    monkeypatch.setattr(pyvista.DataObject, "__init__", note)
    depth, school = small.seabed.depth, {"kind": "school", "position": [10.0, 20.0, -5.0], "length": 8.0}
    plume = {"kind": "plume", "position": [10.0, -20.0, -depth - 2.0], "height": 6.0}  # its vent lies under the bed
    scene = edit(small, {"volumes": [{**school, "width": 4.0, "height": 2.0}, plume]})
    points = volume_points(scene.volumes, ground_of(scene.seabed))
    fish, bubbles = points[:CLOUD], points[CLOUD:]
    assert (np.abs(fish - [10.0, 20.0, depth - 5.0]) <= [4.001, 2.001, 1.001]).all()
    assert (np.ptp(fish, axis=0) > [7.0, 3.5, 1.7]).all()
    assert len(bubbles) > 0
    assert -0.02 < bubbles[:, 2].min() < 0.3
    assert volume_points((), ground_of(scene.seabed)).shape == (0, 3)
    viewer = open_viewer(scene)
    drawn, targets = viewer.seabed.view.volumes_actor, viewer.seabed.view.targets_actor
    qtbot.waitUntil(lambda: bool(drawn.visibility and targets.visibility))
    usual = drawn.prop.opacity
    viewer.seabed.view.fade_bed(True)
    assert drawn.prop.opacity < 0.5 * usual
    viewer.seabed.view.fade_bed(False)
    assert drawn.prop.opacity == usual
    viewer.session.settle({"volumes.0.position.2": -8.0})
    qtbot.waitUntil(lambda: abs(np.asarray(drawn.mapper.dataset.points)[:CLOUD, 2].mean() - depth + 8.0) < 0.1)
    viewer.session.settle({"targets": [], "volumes": []})
    qtbot.waitUntil(lambda: not drawn.visibility and not targets.visibility)
    assert threads == {threading.main_thread().name}


def test_a_cone_is_drawn_outside_out():
    for end in (0.0, 0.5):
        triangles = frustum_triangles(np.array([1.0, 2.0, 3.0]), np.array([1.0, 4.0, 3.0]), 1.0, end)
        normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
        assert ((normals * (triangles.mean(axis=1) - [1.0, 3.0, 3.0])).sum(axis=1) > -1e-6).all()


def test_a_hoop_has_its_own_colour_its_sliders_its_material_in_a_list_and_a_map_to_switch_to(own):
    arrays, colours = prepare(own).arrays, target_colours(own)
    shown, coloured = target_triangles(arrays.solids, arrays.mesh, colours)
    bounds = np.stack([shown.min(axis=(0, 1)), shown.max(axis=(0, 1))], axis=1)
    np.testing.assert_allclose(bounds, [[2.5, 7.5], [15.5, 20.5], [0.0, 1.0]], atol=1e-6)
    np.testing.assert_array_equal(np.unique(coloured, axis=0), colours)
    assert colours[0, 0] > colours[0, 2]
    ring = next(section for section in sections_of(own) if section.key == "targets.0")
    assert ring.title == "Hoop 1"
    rows = {row.path.removeprefix("targets.0."): row for row in ring.parameters}
    assert isinstance(rows["tube"], NumberField)
    assert (rows["tube"].slider, rows["tube"].unit, rows["tube"].log) == ((0.05, 2.0), "m", True)
    assert {"radius", "heading", "pitch", "roll", "gap"} <= rows.keys()
    assert isinstance(rows["material.name"], ChoiceField)
    assert "coral" in rows["material.name"].options
    scene = edit(own, add_dependent_edits(own, {"seabed.material.kind": "halves"})[0])
    assert [one.name for one in scene.seabed.material.materials] == ["medium_sand", "rock"]
    paths = [row.path for section in sections_of(scene) for row in section.parameters]
    assert "seabed.material.border" in paths


@pytest.mark.parametrize(("bed", "sonar"), list(zip(BEDS.values(), [*bundled_sonars()][::2], strict=True)))
def test_every_bed_and_sonar_make_a_record_with_its_targets(bed, sonar):
    meshes = list(bundled_meshes())[:3]
    scene = compose_scene(bed, sonar, 60.0, 8.0, 24, meshes)
    assert [target.path for target in scene.targets] == meshes
    assert scene.track.altitude == 8.0
    assert scene.sonar.preset == sonar
    record = simulate(edit(scene, {"sonar.bins": 128, "track.pings": 4}), forced={"planes": "1"})
    assert (record.intensity.values > 0.0).any()
