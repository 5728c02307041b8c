"""Adding, turning and removing targets in the window."""

from types import SimpleNamespace

import numpy as np
import pytest
from PySide6.QtCore import QTimer
from PySide6.QtWidgets import QApplication, QFileDialog, QToolButton
from stand_in import StandIn, ground_of

from insonify.scene import SceneError, edit, resources
from insonify_viewer.seabed.bed_shading import target_colours
from insonify_viewer.seabed.pv_meshes import CLOUD, frustum_mesh, targets_mesh, volumes_mesh
from insonify_viewer.state.sections import sections_of
from insonify_viewer.widgets.field_rows import FileRow
from insonify_viewer.widgets.gallery import Gallery
from insonify_viewer.window.target_placement import new_target, target_menu


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


def test_a_target_of_any_kind_is_added_taken_back_and_kept_apart_from_others(open_viewer, small, qtbot, monkeypatch):
    pick_file(monkeypatch, str(resources() / "meshes" / "tetrapod.obj"))
    viewer = open_viewer(edit(small, {"targets": []}))
    for kind in target_menu():
        target = add(viewer, kind, qtbot)
        assert target.kind == kind
        assert getattr(target, "path", "tetrapod") == "tetrapod"
        # Abeam of pings that are on screen, and within hearing.
        x, y = target.position[:2]
        assert 0.0 < x < 127 * 0.2
        assert 5.0 < abs(y) < 45.0
        qtbot.waitUntil(lambda: viewer.panels["parameters"].view.row("targets.0.material.name").label.isVisible())
        viewer.session.undo()
        assert viewer.session.scene.targets == ()
        viewer.session.redo()
        assert viewer.session.scene.targets == (target,)
        viewer.session.undo()
    # Targets keep apart from one another.
    places = np.array([add(viewer, "sphere", qtbot).position for _ in range(5)])
    distances = np.linalg.norm(places[:, None] - places, axis=2) + 1e9 * np.eye(5)
    assert distances.min() > 7.0


def test_a_mesh_is_chosen_by_its_picture_and_takes_another_file(viewer, small, qtbot, monkeypatch, tmp_path):
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
    qtbot.waitUntil(lambda: viewer.complete)


def test_no_file_and_a_wrong_mesh_add_nothing_and_a_cross_removes_one(open_viewer, small, qtbot, monkeypatch, tmp_path):
    pick_file(monkeypatch, "")
    viewer = open_viewer(small)
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


def test_shapes_come_before_attitude_and_materials_last(small):
    scene = edit(small, {"targets": [{"kind": "box", "position": [1.0, 2.0]}]})
    section = next(s for s in sections_of(scene) if s.key == "targets.0")
    labels = [parameter.label for parameter in section.parameters]
    shape = ["position x", "position y", "length", "width", "height", "heading", "pitch", "roll", "gap", "material"]
    assert labels[:10] == shape
    assert section.removable


def test_what_has_no_say_stands_aside(small):
    def labels(target):
        scene = edit(small, {"targets": [target]})
        return [p.label for s in sections_of(scene) if s.key == "targets.0" for p in s.parameters]

    assert "gap" not in labels({"kind": "sphere", "position": [1.0, 2.0, -20.0]})
    assert "pitch" not in labels({"kind": "pipe", "position": [1.0, 2.0], "gap": [[-1.0, 0.0], [1.0, 1.0]]})
    assert "pitch" in labels({"kind": "pipe", "position": [1.0, 2.0]})


def test_what_is_for_bounces_and_speckle_is_shown_with_them(small):
    def labels(**changes):
        scene = edit(small, {path.replace("__", "."): value for path, value in changes.items()})
        return {p.label for s in sections_of(scene) if s.key in ("seabed", "targets.0") for p in s.parameters}

    assert not {"reflection", "speed ratio", "speckle shape"} & labels()
    assert {"reflection", "speed ratio"} <= labels(sonar__bounces=1)


def test_a_mesh_in_millimetres_is_brought_to_metres(small, tmp_path):
    (tmp_path / "large.obj").write_text("v 0 0 0\nv 4000 0 0\nv 0 3000 0\nf 1 2 3\n")
    target = new_target(StandIn(small, 0.03), small, "mesh", 100, str(tmp_path / "large.obj"))
    assert target["scale"] == 0.01


def test_beside_the_bed_there_is_no_place(small):
    simulation = StandIn(small, 0.03)
    simulation.ground = SimpleNamespace(height_at_once=lambda x, y: np.full(x.shape, np.nan))
    with pytest.raises(SceneError, match="there is no bed beside this part of the tow"):
        new_target(simulation, small, "box", 100)


def test_the_drawn_targets_are_where_the_traced_ones_are(small):
    box = {"kind": "box", "position": [5.0, 20.0], "size": [3.0, 2.0, 1.0], "heading": 90.0}
    cone = {"kind": "cone", "position": [15.0, 20.0], "radius": 2.0, "height": 1.0}
    scene = edit(small, {"targets": [box, {**cone, "material": "rock"}]})
    arrays = StandIn(scene, 0.03).arrays
    drawn = targets_mesh(arrays.solids, arrays.mesh, target_colours(scene))
    low, high = np.array(drawn.bounds).reshape(3, 2).T
    np.testing.assert_allclose(low[:2], [4.0, 18.0], atol=0.03)
    np.testing.assert_allclose(high[:2], [17.0, 22.0], atol=0.03)
    # Every face has the colour of its own target's material.
    steel, rock = target_colours(scene)
    expected = np.where((np.asarray(drawn.cell_centers().points)[:, 0] < 10.0)[:, None], steel, rock)
    np.testing.assert_array_equal(drawn.cell_data["colour"], expected)


def test_volumes_are_drawn_where_they_echo_and_follow_an_edit(open_viewer, small, qtbot):
    depth, school = small.seabed.depth, {"kind": "school", "position": [10.0, 20.0, -5.0], "length": 8.0}
    plume = {"kind": "plume", "position": [10.0, -20.0, -depth - 2.0], "height": 6.0}  # its vent lies under the bed
    scene = edit(small, {"volumes": [{**school, "width": 4.0, "height": 2.0}, plume]})
    points = np.asarray(volumes_mesh(scene.volumes, ground_of(scene.seabed)).points)
    fish, bubbles = points[:CLOUD], points[CLOUD:]
    assert (np.abs(fish - [10.0, 20.0, depth - 5.0]) <= [4.001, 2.001, 1.001]).all()
    assert (np.ptp(fish, axis=0) > [7.0, 3.5, 1.7]).all()
    assert len(bubbles) > 0
    assert -0.02 < bubbles[:, 2].min() < 0.3
    assert volumes_mesh((), ground_of(scene.seabed)).n_points == 0
    viewer = open_viewer(scene)
    drawn = viewer.seabed.view._volumes_actor
    qtbot.waitUntil(lambda: bool(drawn.visibility))
    usual = drawn.prop.opacity
    viewer.seabed.view.fade_bed(True)
    assert drawn.prop.opacity < 0.5 * usual
    viewer.seabed.view.fade_bed(False)
    assert drawn.prop.opacity == usual
    viewer.session.settle({"volumes.0.position.2": -8.0})
    qtbot.waitUntil(lambda: abs(np.asarray(drawn.mapper.dataset.points)[:CLOUD, 2].mean() - depth + 8.0) < 0.1)
    viewer.session.settle({"volumes": []})
    qtbot.waitUntil(lambda: not drawn.visibility)


def test_a_cone_is_drawn_outside_out():
    for end in (0.0, 0.5):
        mesh = frustum_mesh(np.array([1.0, 2.0, 3.0]), np.array([1.0, 4.0, 3.0]), 1.0, end)
        mesh = mesh.compute_normals(auto_orient_normals=False, consistent_normals=False, point_normals=False)
        outward = np.asarray(mesh.cell_centers().points) - [1.0, 3.0, 3.0]
        assert ((np.asarray(mesh.cell_data["Normals"]) * outward).sum(axis=1) > -1e-6).all()
