"""The three-dimensional view: what is drawn on the bed, its menu, and keys that turn and zoom it as the mouse does."""

import math
from collections.abc import Callable

import numpy as np
import pytest
import pyvista as pv
from controls import activate, drag, finish
from PySide6.QtCore import QPoint, Qt
from PySide6.QtGui import QAction, QGuiApplication
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QFileDialog, QMenu
from stand_in import ground_of

from insonify.display.display_options import DisplayOptions
from insonify.io.bathymetry import Grid
from insonify.io.georeference import Georeference, project
from insonify.scene import edit, load_scene
from insonify.simulation import prepare
from insonify.surveys.mosaic import Mosaic, colour_levels, write_mosaic
from insonify.tow.poses import make_poses
from insonify_viewer.application import has_opengl
from insonify_viewer.record.drape import MosaicSheet, RecordStrip, drape_mosaic, drape_record
from insonify_viewer.record.tone_map import make_tone_map
from insonify_viewer.seabed.bed_shading import LAMP, BedPatch, cast_shadows
from insonify_viewer.seabed.cameras import CAMERAS
from insonify_viewer.seabed.fan_sheet import STEP as RAYS_APART
from insonify_viewer.seabed.fan_sheet import fan_sheet
from insonify_viewer.seabed.pv_meshes import scan_line
from insonify_viewer.seabed.seabed_canvas import CLOSER, STEP
from insonify_viewer.seabed.seabed_view import FARTHEST, LOWEST, NEAREST, STEEPEST
from insonify_viewer.widgets.painting import make_polyline

pytestmark = pytest.mark.usefixtures("drawn_seabed")


@pytest.mark.parametrize("heading", [0.0, 30.0, 180.0])
@pytest.mark.parametrize("side", [0, 1])
def test_an_echo_lies_at_its_ground_range(small, heading, side):
    scene = edit(small, {"track.heading": heading, "track.start": [0.0, 0.0]})
    pings, bins, altitude = np.arange(100), 400, 10.0
    poses = make_poses(scene, ground_of(scene.seabed), pings)
    amplitude = np.zeros((100, 2, bins), np.float32)
    amplitude[40:60, side, 238:242] = 1.0
    rows = np.concatenate([amplitude[:, 0, ::-1], amplitude[:, 1]], axis=1)
    tone_map = make_tone_map(DisplayOptions(palette="grey", levels=(0.0, 1.0)), (0.0, 1.0))
    strip = RecordStrip(poses, rows, np.full(100, altitude), 50.0 / bins, tone_map)
    bed = np.full((360, 360, 3), 99, np.uint8)
    draped = drape_record(bed, (0.0, 0.0), 90.0, strip)
    row, column = np.nonzero(draped[..., 0] > 120)
    x, y = (column + 0.5) * 0.5 - 90.0, 90.0 - (row + 0.5) * 0.5
    ground = math.sqrt((240 * 50.0 / bins) ** 2 - altitude**2) * (1.0 if side == 0 else -1.0)
    angle = math.radians(heading)
    middle = 49.5 * 0.2
    assert x.mean() == pytest.approx(middle * math.cos(angle) - ground * math.sin(angle), abs=0.5)
    assert y.mean() == pytest.approx(middle * math.sin(angle) + ground * math.cos(angle), abs=0.5)
    assert (draped[0, 0] == 99).all(), "the bed stays where nothing is heard"
    assert (bed == 99).all()


def test_a_record_narrower_than_a_pixel_of_the_bed_leaves_it_as_it_is(small):
    pings = np.arange(3)
    poses = make_poses(small, ground_of(small.seabed), pings)
    tone_map = make_tone_map(DisplayOptions(palette="grey", levels=(0.0, 1.0)), (0.0, 1.0))
    strip = RecordStrip(poses, np.ones((3, 80), np.float32), np.full(3, 10.0), 0.2501, tone_map)  # 0.4 m of ground
    bed = np.full((8, 8, 3), 99, np.uint8)
    np.testing.assert_array_equal(drape_record(bed, (0.0, 0.0), 90.0, strip), bed)


def test_the_record_and_a_mosaic_are_laid_over_the_bed_until_they_are_taken_off(viewer, qtbot, tmp_path, monkeypatch):
    seabed, action, show = viewer.seabed, viewer.seabed_menu.mosaic, viewer.seabed.view.show_texture
    qtbot.waitUntil(lambda: seabed.complete)
    shown, bare, place = [], [], seabed.patch.centre
    seabed.view.show_texture = lambda image: (shown.append(image.copy()), show(image))
    viewer.session.show(draped=True)
    qtbot.waitUntil(lambda: len(shown) == 1)
    assert (shown[0] != seabed.patch.image).mean() > 0.05
    viewer.session.show(draped=False)
    qtbot.waitUntil(lambda: len(shown) == 2)
    assert (shown[1] == seabed.patch.image).all()
    # So is a mosaic of the scene.
    path = tmp_path / "mosaic.tif"
    level = np.tile(np.linspace(-9.0, 9.0, 20, dtype=np.float32), (20, 1))
    write_mosaic(path, Mosaic(level, (place[0] - 10.0, place[1] + 10.0), 1.0, np.ones((20, 20), np.uint16)), "")
    monkeypatch.setattr(QFileDialog, "getOpenFileName", lambda *_, **__: (str(path), ""))
    action.trigger()
    qtbot.waitUntil(lambda: len(shown) == 3)
    side = np.sqrt((shown[2] != seabed.patch.image).any(axis=2).mean()) * 2.0 * seabed.patch.half
    assert side == pytest.approx(20.0, abs=0.5)
    viewer.seabed_menu.open(None, QPoint(0, 0)).close()
    assert action.isChecked()
    action.trigger()
    qtbot.waitUntil(lambda: len(shown) == 4)
    np.testing.assert_array_equal(shown[3], seabed.patch.image)
    # A map elsewhere is refused in one sentence, and a mosaic is no bed.
    write_mosaic(path, Mosaic(level, (5e5, 5e6), 1.0, np.ones((20, 20), np.uint16)), "EPSG:32631")
    action.trigger()
    qtbot.waitUntil(lambda: "no place on Earth; set world.crs and world.origin" in viewer.window.status.sentence.text())
    assert not action.isChecked()
    viewer.files.open(str(path))
    qtbot.waitUntil(lambda: "holds levels in dB, not heights" in viewer.window.status.sentence.text())
    # The record stays over the bed when the window of the bed moves.
    viewer.session.show(draped=True)
    qtbot.waitUntil(lambda: seabed.complete)
    patch = seabed.patch
    seabed.view.show_texture = lambda image: (bare.append((image == seabed.patch.image).all()), show(image))
    viewer.go_to(viewer.tow.newest + 60)
    qtbot.waitUntil(lambda: viewer.complete and seabed.patch is not patch)
    assert bare, "the bed was drawn at its new place"
    assert not any(bare), "never without the record"
    # Beds share one texture.
    texture, before = seabed.view.bed_actor.texture, seabed.view.grab().toImage()
    finish(viewer, qtbot, viewer.session.settle, {"track.start": [500.0, 0.0], "seabed.material.name": "rock"})
    seabed.view.draw_now()
    assert seabed.view.bed_actor.texture is texture
    qtbot.waitUntil(lambda: seabed.view.grab().toImage() != before)


@pytest.mark.parametrize("elsewhere", [False, True])
def test_a_mosaic_lies_on_the_bed_by_its_map(elsewhere):
    """A mark of the mosaic is found at its place, whose zone of the map is the scene's or the next one."""
    scene_map, mosaic_map = "EPSG:32631", "EPSG:32632" if elsewhere else "EPSG:32631"
    origin, centre, half = (735_000.0, 5_700_000.0), (40.0, -25.0), 90.0
    mark = project(scene_map, mosaic_map, np.array([origin[0] + 70.0]), np.array([origin[1] + 10.0]))
    corner = mark[0][0] - 200.25, mark[1][0] - 100.25
    levels = np.full((800, 800), np.nan)
    levels[190:212, 390:412] = -20.0
    levels[201, 401] = 0.0  # its centre is the mark
    grid = Grid(levels, spacing=(0.5, 0.5), corner=(corner[0] - 0.25, corner[1] - 0.25), crs=mosaic_map)
    sheet = MosaicSheet("m.tif", grid, colour_levels(levels), Georeference(scene_map, origin))
    bed = np.full((720, 720, 3), 99, np.uint8)
    draped = drape_mosaic(bed, centre, half, sheet)
    row, column = np.nonzero((draped == draped.max(axis=(0, 1))).all(axis=2))
    x, y = centre[0] - half + (column + 0.5) * 0.25, centre[1] + half - (row + 0.5) * 0.25
    assert (x.mean(), y.mean()) == pytest.approx((70.0, 10.0), abs=0.2)
    covered = (draped != bed).any(axis=2)
    assert covered.sum() * 0.25**2 == pytest.approx(22 * 22 * 0.5**2, rel=0.03)


def far_ends(triangles: np.ndarray) -> np.ndarray:
    """Corners of the triangles but for the sonar, (2n, 3)."""
    return triangles[:, 1:].reshape(-1, 3)


def test_the_fan_ends_at_the_pipe_and_leaves_its_shadow_out():
    simulation = prepare(edit(load_scene("pipe-on-bed"), {"track.pings": 64}))
    triangles = fan_sheet(simulation, 40).lit
    sonar = simulation.poses(np.array([40]))
    np.testing.assert_allclose(triangles[:, 0], [[sonar.x[0], sonar.y[0], sonar.z[0]]] * len(triangles))
    ends = far_ends(triangles)
    np.testing.assert_allclose(ends[:, 0], sonar.x[0], atol=1e-9)  # a knife
    on_pipe = ends[ends[:, 2] > 0.05]
    np.testing.assert_allclose(np.hypot(on_pipe[:, 1] + 30.0, on_pipe[:, 2] - 0.5), 0.5, atol=1e-6)
    # The ray that grazes the pipe comes down at 33.4 m: none of the bed between has a triangle.
    assert not ((ends[:, 1] < -30.6) & (ends[:, 1] > -33.3)).any()
    assert (ends[:, 1] < -33.3).any()
    assert ends[:, 1].max() > 48.0
    # No triangle spans the shadow.
    one, other = triangles[:, 1, 1], triangles[:, 2, 1]
    assert not ((np.minimum(one, other) < -33.3) & (np.maximum(one, other) > -30.6)).any()


@pytest.mark.parametrize(("name", "clear"), [("pipe-on-bed", 0.0), ("pipe-span", 1.0)])
def test_a_shadow_is_the_triangle_between_tangents_and_bed(name, clear):
    simulation = prepare(edit(load_scene(name), {"track.pings": 64, "targets.0.gap": clear}))
    shaded = fan_sheet(simulation, 40).shaded
    sonar = simulation.poses(np.array([40]))
    height, (y, z, radius) = float(sonar.z[0]), (-30.0, 0.5 + clear, 0.5)
    # Two tangents from the sonar to the pipe, and where they meet the level bed, at most where the pipe touches it.
    towards, half = np.arctan2(z - height, -y), np.arcsin(radius / np.hypot(y, z - height))
    near, far = (height / np.tan(-(towards + turn)) for turn in (-half, half))
    on_bed = shaded[np.abs(shaded[..., 2]) < 1e-6][:, 1]
    assert on_bed.min() == pytest.approx(-far, rel=1e-3)
    if clear:
        assert on_bed.max() == pytest.approx(-near, rel=1e-3)
    one, other = shaded[:, 1] - shaded[:, 0], shaded[:, 2] - shaded[:, 0]
    area = 0.5 * np.linalg.norm(np.cross(one, other), axis=1).sum()
    tangent = np.sqrt(y**2 + (z - height) ** 2 - radius**2)
    whole = 0.5 * (far - near) * height  # of the sonar and the bed between the tangents
    before = radius * tangent - (np.pi / 2.0 - half) * radius**2  # between the sonar and the face of the pipe
    if clear:
        assert area == pytest.approx(whole - before, rel=0.01)


def test_the_fan_is_shown_and_shadows_gather_as_the_fish_passes_until_they_are_switched_off(open_viewer, qtbot):
    viewer = open_viewer(edit(load_scene("pipe-on-bed"), {"track.pings": 64, "sonar.bins": 500}), prepare=None)
    view = viewer.seabed.view
    viewer.seabed.show_shadows(True)
    for count, ping in enumerate((40, 41, 42), start=1):
        viewer.go_to(ping)
        qtbot.waitUntil(lambda count=count: len(view.shadows) >= count)
    assert view.shadow_actor.visibility
    viewer.seabed.show_shadows(False)
    qtbot.waitUntil(lambda: not view.shadows)
    assert not view.shadow_actor.visibility
    # The fan that is cut is shown.
    viewer.go_to(40)
    expected = fan_sheet(viewer.answer.simulation, 40).lit

    def shown():
        points = np.asarray(pv.wrap(view.sheet_actor.mapper.GetInput()).points)
        return points.shape == (3 * len(expected), 3) and bool(np.allclose(points, expected.reshape(-1, 3), atol=1e-3))

    qtbot.waitUntil(shown)


def test_triangles_are_few_and_narrow():
    simulation = prepare(edit(load_scene("default"), {"track.pings": 64}))
    triangles = fan_sheet(simulation, 40).lit
    ends = far_ends(triangles).reshape(-1, 2, 3) - triangles[:, :1]
    unit = ends / np.linalg.norm(ends, axis=2, keepdims=True)
    angle = np.arccos(np.clip((unit[:, 0] * unit[:, 1]).sum(axis=1), -1.0, 1.0))
    assert angle.max() < 3.0 * RAYS_APART
    assert len(triangles) < 2000
    ground = simulation.ground.height_at(far_ends(triangles)[:, 0], far_ends(triangles)[:, 1])
    assert (far_ends(triangles)[:, 2] >= ground - 0.02).all()


@pytest.mark.parametrize("name", ["double-image", "endless"])
def test_a_fan_without_a_section_is_drawn_whole(name):
    scene = edit(load_scene(name), {"track.pings": 32, "sonar.bins": 100, "seabed.spacing": 0.4})
    simulation = prepare(scene, forced={"method": "rays", "rays": "1000"})
    triangles, shaded = fan_sheet(simulation, 10)
    assert not len(shaded)
    assert triangles.shape[1:] == (3, 3)
    assert np.isfinite(triangles).all()


@pytest.mark.parametrize("size", [0, 1, 2, 1000])
def test_coordinates_are_those_given(size):
    x, y = np.linspace(-3.5, 1e4, size), np.random.default_rng(1).normal(size=size)
    line = make_polyline(x, y)
    assert [(point.x(), point.y()) for point in line] == list(zip(x.tolist(), y.tolist(), strict=True))


@pytest.mark.parametrize("below", [0.0, -3.0])
def test_a_target_keeps_the_lamp_off_the_bed_where_its_light_would_fall(below):
    """A plate of 4 m by 4 m, 5 m over a level bed: its shadow has its size and lies where lines from the lamp end."""
    x = np.linspace(-20.0, 20.0, 41)
    points = np.stack([*np.meshgrid(x, x), np.full((41, 41), below)], axis=-1).reshape(-1, 3)
    patch = BedPatch((0.0, 0.0), points.astype(np.float32), np.full((400, 400, 3), 200, np.uint8), 20.0)
    a, b, c, d = ([2.0 * u, 2.0 * v, below + 5.0] for u, v in ((-1, -1), (1, -1), (1, 1), (-1, 1)))
    shaded = cast_shadows(patch, np.array([[a, b, c], [a, c, d]])).image
    row, column = np.nonzero(shaded[..., 0] < 0.7 * 200)
    x, y = (column + 0.5) * 0.1 - 20.0, 20.0 - (row + 0.5) * 0.1
    np.testing.assert_allclose([x.mean(), y.mean()], -5.0 * LAMP[:2] / LAMP[2], atol=0.1)
    assert len(row) * 0.01 == pytest.approx(16.0, rel=0.06)
    assert (shaded[:10] == 200).all()


@pytest.fixture
def viewer(open_viewer, small):
    return open_viewer(edit(small, {"targets": []}))


def trigger(viewer, text):
    next(each for each in viewer.window.findChildren(QAction) if each.text() == text).trigger()


def sight(viewer) -> np.ndarray:
    """Places of the camera and of its focus."""
    camera = viewer.seabed.view.canvas.plotter.camera
    return np.array([camera.position, camera.focal_point])


def away(viewer) -> np.ndarray:
    """From the focus of the camera to the camera."""
    return np.subtract(*sight(viewer))


def test_a_place_has_a_menu_depths_colours_a_new_target_its_frame_and_the_camera_its_places(viewer, qtbot):
    widget = viewer.seabed.view.canvas.widget
    x, y = viewer.seabed.view.handles._in_view(np.array([15.0, 12.0, 0.0]))
    QTest.mouseClick(widget, Qt.MouseButton.RightButton, pos=QPoint(round(x), round(widget.height() - 1.0 - y)))
    (menu,) = (each for each in viewer.window.findChildren(QMenu) if each.isVisible())
    texts = [action.text() for action in menu.actions() if action.text()]
    assert texts[:2] == ["Light up the pixels that receive its echo", "Show this place in the record"]
    menu.actions()[1].trigger()
    assert viewer.session.mark is not None
    assert (viewer.session.mark.side, viewer.session.mark.ping) == (0, pytest.approx(75, abs=3))
    menu.close()
    # Depths have colours with a bar.
    view = viewer.seabed.view
    assert view.guides.shown[0] > 0.0
    plain = viewer.seabed.patch.image.copy()
    finish(viewer, qtbot, trigger, viewer, "Depth colours")
    shallow, deep = viewer.seabed.patch.depths
    assert 0.0 < shallow < viewer.session.scene.seabed.depth < deep
    qtbot.waitUntil(lambda: view.guides.shown[2] == (shallow, deep))
    assert (viewer.seabed.patch.image != plain).mean() > 0.5
    trigger(viewer, "Copy picture of the 3-D view")
    assert QGuiApplication.clipboard().image().width() == 3 * view.canvas.plotter.window_size[0]
    # A new target is chosen, framed and in the record.
    viewer.window.target_wanted.emit("box")
    qtbot.waitUntil(lambda: viewer.complete and bool(viewer.session.scene.targets) and not view.follows)
    handles = viewer.targets.handles
    assert handles.chosen == 0
    target = viewer.session.scene.targets[0]
    assert sight(viewer)[1][:2] == pytest.approx(target.position[:2])
    assert np.linalg.norm(away(viewer)) < 0.5 * viewer.session.scene.sonar.range
    assert any(action == "move" for _, _, action, _ in viewer.window.waterfall.handles.shown)
    # The camera glides to its places, and follows the towfish.
    before = sight(viewer)
    view.eases = True
    viewer.window.reset_view.trigger()
    assert np.allclose(sight(viewer), before)
    qtbot.waitUntil(lambda: not view.gliding.isActive())
    assert view.follows
    view.eases = False
    home = sight(viewer)
    viewer.window.reset_view.trigger()
    assert np.allclose(sight(viewer), home)
    seen = {}
    for camera in CAMERAS:
        trigger(viewer, camera)
        seen[camera] = away(viewer) / np.linalg.norm(away(viewer))
    assert seen["From above"][2] > 0.99
    assert abs(seen["From abeam"][1]) > 0.9, "the track runs along x"
    before = sight(viewer)
    finish(viewer, qtbot, viewer.go_to, 20)
    assert not np.allclose(sight(viewer), before)
    trigger(viewer, "Follow the towfish")
    before = sight(viewer)
    finish(viewer, qtbot, viewer.go_to, 40)
    assert np.allclose(sight(viewer), before)
    viewer.window.reset_view.trigger()
    assert viewer.seabed.view.follows


def test_the_altitude_and_range_of_the_sonar_stand_in_the_view_and_a_bed_far_from_the_fish_is_not_missed(viewer):
    view, scene, pose = viewer.seabed.view, viewer.session.scene, viewer.seabed.view.pose
    assert view.swath.range.GetInput() == f"{scene.sonar.range:g} m"
    assert float(view.swath.altitude.GetInput().split()[0]) == pytest.approx(scene.track.altitude, abs=0.2)
    assert not view.swath.level.visibility
    simulation, far = viewer.answer.simulation, pose._replace(x=pose.x + 500.0)
    scanned = scan_line(simulation.ground, simulation.arrays, far)
    view.show_scan(simulation.arrays, far, scanned, np.zeros(2 * scene.sonar.bins, np.float32))
    assert view.swath.level.visibility
    assert view.swath.level.position[0] == pytest.approx(float(far.x[0]))
    # Nor is a place of the bed that the camera shows, when the fish comes from far away.
    view.eases = False
    view.show_sonar(simulation.arrays, far, 0.0)
    viewer.seabed.reset_camera((12.0, 5.0))
    for each in (far, pose):
        view.show_sonar(simulation.arrays, each, 0.0)
    assert sight(viewer)[1] == pytest.approx([12.0, 5.0, 0.0])


def angles(viewer) -> np.ndarray:
    """Bearing and slope from the focus to the camera, in degrees."""
    x, y, z = away(viewer)
    return np.degrees([math.atan2(y, x), math.atan2(z, math.hypot(x, y))])


def turned_by(viewer, act: Callable[[], None]) -> np.ndarray:
    """Degrees by which an act turns the camera about its focus: bearing and slope."""
    before = angles(viewer)
    act()
    turn: np.ndarray = (angles(viewer) - before + 180.0) % 360.0 - 180.0
    return turn


def test_keys_turn_and_zoom_the_scene_within_its_limits_and_all_others_are_those_of_the_window(viewer, qtbot):
    viewer.seabed.view.eases = False
    if not has_opengl():
        pytest.skip("no OpenGL for a widget")
    activate(viewer.window, qtbot)
    canvas, waterfall = viewer.seabed.view.canvas.widget, viewer.window.waterfall
    canvas.setMaximumSize(320, 240)  # a small picture is drawn in less time
    canvas.setFocus()
    home, middle = away(viewer), canvas.rect().center()
    # An arrow turns the scene as a drag does.
    for key, way in (
        (Qt.Key.Key_Left, QPoint(-30, 0)),
        (Qt.Key.Key_Right, QPoint(30, 0)),
        (Qt.Key.Key_Up, QPoint(0, -30)),
        (Qt.Key.Key_Down, QPoint(0, 30)),
    ):
        distance = np.linalg.norm(away(viewer))
        turn = turned_by(viewer, lambda key=key: QTest.keyClick(canvas, key))
        assert sorted(np.abs(turn)) == pytest.approx([0.0, STEP], abs=1e-9)
        assert np.linalg.norm(away(viewer)) == pytest.approx(distance)
        dragged = turned_by(viewer, lambda way=way: drag(canvas, middle, middle + way))
        axis = np.argmax(np.abs(turn))
        assert (np.argmax(np.abs(dragged)), np.sign(dragged[axis])) == (axis, np.sign(turn[axis]))
    # The view neither turns over nor below the bed.
    for key, slope, within in ((Qt.Key.Key_Down, STEEPEST, 1e-6), (Qt.Key.Key_Up, math.atan(LOWEST), 0.01)):
        for _ in range(40):
            QTest.keyClick(canvas, key)
        assert angles(viewer)[1] == pytest.approx(math.degrees(slope), abs=within)
    QTest.keyClick(canvas, Qt.Key.Key_Home)
    assert away(viewer) == pytest.approx(home)
    # Other keys are those of the window.
    QTest.keyClick(canvas, "b")
    assert viewer.session.display.bottom_line
    QTest.keyClick(canvas, Qt.Key.Key_Right, Qt.KeyboardModifier.AltModifier)
    assert away(viewer) == pytest.approx(home), "keys with Alt or Ctrl are not those of the view"
    for letter, factor, limit in (("+", 1.0 / CLOSER, NEAREST), ("-", CLOSER, FARTHEST)):
        canvas.setFocus()
        before, zoom = np.linalg.norm(away(viewer)), waterfall.projection.zoom
        QTest.keyClick(canvas, letter)
        assert np.linalg.norm(away(viewer)) == pytest.approx(factor * before)
        for _ in range(60):
            QTest.keyClick(canvas, letter)
        assert np.linalg.norm(away(viewer)) == pytest.approx(limit * viewer.seabed.view.reach)
        assert waterfall.projection.zoom == zoom, "they zoom what has the keyboard"
        waterfall.setFocus()
        QTest.keyClick(waterfall, letter)
        assert np.linalg.norm(away(viewer)) == pytest.approx(limit * viewer.seabed.view.reach)
    viewer.window.tour.begin()
    canvas.setFocus()
    QTest.keyClick(canvas, Qt.Key.Key_Escape)
    assert viewer.window.tour.card is None
    QTest.keyClick(canvas, Qt.Key.Key_Tab)
    assert QApplication.focusWidget() is not canvas
    QTest.keyClick(QApplication.focusWidget(), Qt.Key.Key_Backtab)
    assert QApplication.focusWidget() is canvas
