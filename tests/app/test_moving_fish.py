"""The fish in motion, as the viewer shows it."""

import math
from dataclasses import replace

import numpy as np
import pytest
from controls import finish, turn_wheel
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from stand_in import StandIn

from insonify.kernels.common.types import PORT, STARBOARD
from insonify.scene import edit
from insonify_viewer.application import has_opengl
from insonify_viewer.record.marked_point import locate_mark
from insonify_viewer.seabed.pv_meshes import MESH_NODES, PATH_POINTS, bed_patch, path_pings, pose_matrix, scan_line
from insonify_viewer.seabed.seabed_canvas import CLOSER
from insonify_viewer.seabed.seabed_view import FARTHEST, NEAREST
from insonify_viewer.state.inspection import Mark

TURN = {"kind": "turn", "rate": 10.0, "begin": 2.0, "duration": 9.0}
TILTED = {"kind": "pitch", "amplitude": 10.0, "period": 1e5, "phase": 90.0}
YAWED = {"kind": "yaw", "amplitude": 20.0, "period": 1e5, "phase": 90.0}


def moved(scene, *motions) -> StandIn:
    return StandIn(edit(scene, {"track.motion": {"kind": "sum", "of": list(motions)}}), 0.03)


def one(simulation: StandIn, ping: int):
    return simulation.poses(np.array([ping], dtype=np.int64))


def test_a_fish_lies_as_its_pose_says(small):
    pose = one(moved(small, TILTED, YAWED, {"kind": "roll", "amplitude": 30.0, "period": 1e5, "phase": 90.0}), 0)
    matrix = pose_matrix(pose, 2.0)
    bow, port = matrix[:3, 0] / 2.0, matrix[:3, 1] / 2.0
    assert bow[2] == pytest.approx(math.sin(math.radians(10.0)))
    assert math.degrees(math.atan2(bow[1], bow[0])) == pytest.approx(20.0)
    assert port[2] == pytest.approx(math.sin(math.radians(30.0)) * math.cos(math.radians(10.0)))
    assert matrix[:3, 3].tolist() == [pose.x[0], pose.y[0], pose.z[0]]
    assert pose_matrix(pose, 2.0, level=True)[2, :3].tolist() == [0.0, 0.0, 2.0]


@pytest.mark.parametrize("side", [PORT, STARBOARD])
@pytest.mark.parametrize(
    "motions", [("straight",), (YAWED,), (TILTED,), (TILTED, YAWED), (YAWED, TILTED, TURN, "sway", "heave")]
)
@pytest.mark.parametrize("squint", [8.0, 0.0, -8.0])
def test_a_beam_is_a_cone_on_which_its_line_on_the_bed_and_points_of_the_record_lie(small, squint, motions, side):
    simulation = moved(edit(small, {"sonar.beam.squint": squint}), *motions)
    pose, forwards = one(simulation, 115), math.sin(math.radians(squint))
    bow, port, _, fish = pose_matrix(pose, 1.0)[:3].T
    line, slant = scan_line(simulation.ground, simulation.arrays, pose)
    np.testing.assert_allclose((line - fish) @ bow, slant * forwards, atol=0.05)
    np.testing.assert_allclose(np.linalg.norm(line - fish, axis=1), slant, rtol=1e-6)
    assert slant.max() == pytest.approx(50.0, abs=0.05)
    slant_range, across, place = locate_mark(simulation, Mark(115, side, 60))
    there = np.array(place) - fish
    # The bed of the stand-in is level but for a centimetre.
    assert float(there @ bow) == pytest.approx(slant_range * forwards, abs=0.05)
    assert np.linalg.norm(there) == pytest.approx(slant_range, abs=0.05)
    assert math.hypot(there[0], there[1]) == pytest.approx(across, abs=0.05)
    assert float(there @ port) * (1.0 if side == PORT else -1.0) > 0.0


def test_the_path_begins_where_the_tow_does():
    pings = path_pings(100, 0.2, 50.0)
    assert (len(pings), pings[0], pings[-1]) == (PATH_POINTS, 0, 225)
    assert path_pings(1000, 0.2, 50.0)[0] == 575


def test_fish_and_camera_follow_a_turn(open_viewer, small):
    viewer = open_viewer(edit(small, {"track.motion": {"kind": "sum", "of": [TURN, YAWED]}}))
    view = viewer.seabed.view
    matrix = np.array(view.fish_actor.user_matrix)
    # The line has turned by 90 degrees, the fish lies 20 degrees to port of it.
    assert math.degrees(math.atan2(matrix[1, 0], matrix[0, 0])) == pytest.approx(110.0)
    assert math.degrees(_looks(view)) == pytest.approx(90.0, abs=15.0)
    before = _looks(view)
    silence = np.zeros(2 * small.sonar.bins, dtype=np.float32)
    viewer.seabed.show_sonar(viewer.answer.simulation, 0, silence)
    assert math.degrees(before - _looks(view)) == pytest.approx(90.0)


def _looks(view) -> float:
    """Direction in which the camera looks, in radians."""
    camera = view.canvas.plotter.camera
    ahead = np.array(camera.focal_point) - camera.position
    return math.atan2(ahead[1], ahead[0])


def test_the_camera_is_reset_and_kept_within_its_limits_and_a_slider_moves_the_fish_once_a_drawing(viewer, qtbot):
    view = viewer.seabed.view
    view.eases = False
    camera = view.canvas.plotter.camera
    home, focus = np.array(camera.position), np.array(camera.focal_point)
    reach = view.reach
    for distance, kept in ((1e-4 * reach, NEAREST * reach), (1e3 * reach, FARTHEST * reach), (reach, reach)):
        camera.position = tuple(focus + (home - focus) / np.linalg.norm(home - focus) * distance)
        view._clip()
        assert np.linalg.norm(np.array(camera.position) - focus) == pytest.approx(kept)
    viewer.window.reset_view.trigger()
    assert np.array(camera.position) == pytest.approx(home)
    # It stays above the bed.
    camera.position = tuple(focus + reach * np.array([0.6, 0.0, -0.8]))
    view._clip()
    away = np.array(camera.position) - focus
    assert np.linalg.norm(away) == pytest.approx(reach)
    assert away[:2] == pytest.approx([reach, 0.0], abs=0.01 * reach)
    assert away[2] > 0.0
    # It may be moved between its reset and the next pose.
    viewer.window.reset_view.trigger()
    moves = {
        "turn": lambda: view.turn(5.0, 0.0),
        "magnify": lambda: view.magnify(CLOSER),
        "zoom about": lambda: view.zoom_about((5.0, 0.0, -10.0), CLOSER),
        "frame": lambda: view.frame((5.0, 0.0, -10.0), 2.0),
    }
    for name, move in moves.items():
        view.reset_camera()
        move()
        assert np.isfinite(camera.position).all(), name
        assert camera.distance > 0.1, name
    view.reset_camera()
    view._follow(view.pose, view._heading, view.reach)
    assert camera.position == pytest.approx(home)
    # Otherwise Mesa's software renderer may loop over the texels of one pixel for minutes, and the window hangs.
    textures = [actor.GetTexture() for actor in view.canvas.plotter.actors.values() if hasattr(actor, "GetTexture")]
    assert [one.GetMaximumAnisotropicFiltering() for one in textures if one is not None] == [1.0, 1.0]
    # A slider moves the fish once for each drawing.
    places = []
    show = view.show_sonar
    view.show_sonar = lambda arrays, pose, heading: (places.append(float(pose.z[0])), show(arrays, pose, heading))
    view.draw_now()
    for altitude in (8.0, 9.0, 11.0):
        viewer.session.drag({"track.altitude": altitude})
        qtbot.waitUntil(lambda: not viewer.missing().size)
    places.clear()
    # A slow machine may have traced finely meanwhile, which moves it at once.
    for _ in range(2):
        viewer._take(replace(viewer.answer, fine=False))
    assert not places
    view.draw_now()
    assert len(places) == 1
    assert places[0] == pytest.approx(11.0, abs=0.1)
    view.draw_now()
    assert len(places) == 1
    finish(viewer, qtbot, viewer.session.settle)
    assert len(places) > 1, "the record that is settled moves it at once"


def test_a_view_that_is_turned_draws_a_lighter_bed_and_the_wheel_zooms_about_the_mouse_within_the_limits(viewer, qtbot):
    """What lies under the mouse stays there while it zooms, and the camera stops before it."""
    view, seabed = viewer.seabed.view, viewer.seabed
    if not has_opengl():
        pytest.skip("no OpenGL for a widget")
    canvas, camera = view.canvas.widget, view.canvas.plotter.camera
    bed = seabed.patch
    whole = np.asarray(view.bed.points).reshape(MESH_NODES, MESH_NODES, 3)
    thinned = np.asarray(view.thinned_bed.points)
    assert thinned.reshape(129, 129, 3) == pytest.approx(whole[::2, ::2])
    assert np.ptp(thinned[:, :2], axis=0) == pytest.approx(np.ptp(whole[..., :2], axis=(0, 1)))  # as far as the whole
    middle = view.rect().center()
    assert _drawn_beds(view) == (True, False)
    QTest.mousePress(canvas, Qt.MouseButton.LeftButton, pos=middle)
    assert _drawn_beds(view) == (False, True)
    view.show_bed(bed_patch(viewer.answer.simulation.ground, (5.0, 0.0), view.reach))
    assert _drawn_beds(view) == (False, True), "another bed does not end the turn"
    QTest.mouseRelease(canvas, Qt.MouseButton.LeftButton, pos=middle)
    assert _drawn_beds(view) == (True, False)
    view.show_bed(bed)
    # The wheel zooms about the mouse.
    canvas.setMaximumSize(320, 240)  # a small picture is drawn in less time
    qtbot.waitUntil(lambda: canvas.width() == 320)
    mouse = QPoint(100, 150)
    place = np.array(seabed.meet(*view.look_from(mouse)))
    before = np.linalg.norm(np.array(camera.position) - place)
    turn_wheel(canvas, mouse, 2)
    assert np.linalg.norm(np.array(camera.position) - place) == pytest.approx(before / CLOSER**2)
    assert seabed.meet(*view.look_from(mouse)) == pytest.approx(place, abs=1e-3 * view.reach)
    turn_wheel(canvas, mouse, -2)
    assert np.linalg.norm(np.array(camera.position) - place) == pytest.approx(before)
    for notches in (1, -1):
        for _ in range(120):
            turn_wheel(canvas, mouse, notches)
        x, y, z = camera.position
        clearance = z - viewer.answer.simulation.ground.height_at(np.array([x]), np.array([y]))[0]
        assert clearance > 0.01 * view.reach
        assert 0.99 * NEAREST * view.reach < camera.distance < 1.01 * FARTHEST * view.reach
    assert camera.distance == pytest.approx(FARTHEST * view.reach, rel=0.01)
    turn_wheel(canvas, QPoint(100, 2), 1)  # over open water
    assert camera.distance == pytest.approx(FARTHEST * view.reach / CLOSER, rel=0.01)


def _drawn_beds(view) -> tuple[bool, bool]:
    return bool(view.bed_actor.visibility), bool(view.thinned_actor.visibility)
