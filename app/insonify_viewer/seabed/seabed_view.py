"""Three-dimensional view of bed, targets, towfish, scan line and the sound of a pixel."""

import math
import time
from collections.abc import Callable, Sequence
from functools import cache
from typing import Any

import numpy as np
from PySide6.QtCore import QPoint, QPointF, QTimer, Signal
from PySide6.QtGui import QImage
from PySide6.QtWidgets import QVBoxLayout, QWidget

from insonify.arrays import Bytes, Floats, Singles
from insonify.kernels.common.types import Poses, SceneArrays
from insonify_viewer.seabed import pv_meshes
from insonify_viewer.seabed.bed_shading import BedPatch
from insonify_viewer.seabed.cameras import CAMERAS, USUAL
from insonify_viewer.seabed.lean_pyvista import pv
from insonify_viewer.seabed.pv_meshes import ScanFan, ScanLine
from insonify_viewer.seabed.seabed_canvas import InteractiveCanvas, OffScreenCanvas, SeabedInput
from insonify_viewer.seabed.seabed_guides import SeabedGuides
from insonify_viewer.seabed.seabed_handles import SeabedHandles
from insonify_viewer.seabed.swath_guides import SwathGuides
from insonify_viewer.state.inspection import SoundDrawing
from insonify_viewer.widgets.layouts import fill
from insonify_viewer.widgets.painting import LIT, image_of
from insonify_viewer.widgets.theme import MARK_IN_WATER, text_scale

WATER = ("#2f6b84", "#629db2")  # below and above; the far bed fades into the latter
EASE = 0.5, 25  # how long the camera takes to a new place, s, and the time between its steps, ms
CLOSE = 0.4  # distance of the camera from the subject of a lesson, as a share of that behind the fish
VIEW_ANGLE = 54.0
FISH = 0.11  # length over the height of the view at its distance: it shows at any zoom
MOST_BACK = 1.6  # of the usual distance, in a narrow view
LOWEST = 0.03  # least slope of the line of sight, by which the camera stays above the bed
STEEPEST = math.radians(88.0)  # depression of the line of sight, at which the view still has an upper edge
NEAREST, FARTHEST = 0.05, 6.0  # distance of the camera from its focus, in slant ranges
FADED, CLOUDED = 0.25, 0.35  # opacities of a bed of an earlier scene, and of a volume of the water column
FRAMED = 0.5, 1.3  # least slope at which a framed body is seen, and the half height of the view over its size
SLICES = 400  # of acoustic shadows, one a ping
REST = 4.0  # pause between two drawings, in drawing times, which leaves time for the window

BLOCKED, HIDDEN = "#ff7a5c", "#2a0f0a"
LIFT = 0.002  # share of the slant range by which stretches of the bed are drawn above it


class SeabedView(QWidget):
    """Shows bed, targets and sonar; drawings are delayed and merged, because they may be slow."""

    sighted = Signal(object, object, object)  # ends of the line of sight through a click, and a target's place or None
    menu_wanted = Signal(object, object, object, QPoint)  # the same of a right click, and the place of the screen
    zoom_wanted = Signal(object, object, object, float)  # the same of the mouse, and the magnification

    def __init__(self, *, accelerated: bool, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.canvas = InteractiveCanvas(self) if accelerated else OffScreenCanvas(self)
        fill(QVBoxLayout(self), self.canvas.widget, margins=(0, 0, 0, 0))
        self.reach = 0.0  # slant range of the sonar that is shown, m
        self.reset_camera()
        self.pose: Poses | None = None  # of the fish that is shown
        self._heading = 0.0
        self._bed_shown = self._held = False
        self._window = 0.0, 0.0, 0.0  # middle of the bed on screen, and half of its side
        self._depths: tuple[float, float] | None = None  # ends of the colours of depths
        self._fan = ScanFan()
        self.shadows: list[Floats] = []  # slices of the acoustic shadows that are shown
        self._path = pv.MultipleLines(np.zeros((pv_meshes.PATH_POINTS, 3)))
        self.bed, self.thinned_bed = pv_meshes.bed_mesh(), pv_meshes.bed_mesh(thinned=True)
        self._furnish()
        self.canvas.on_turn(self._clip)
        self.canvas.on_hold(self._thin)
        self.canvas.on_click(self.look_at)
        self._drawn, self.draw_time = 0.0, 0.05  # when the last drawing ended, and how long it took, in seconds
        self._awaited: Callable[[], None] | None = None
        self.eases = accelerated  # whether the camera glides to another place about the fish; a picture is drawn there
        # When the camera left, and where it and its focus were and will be, as seen from the fish.
        self._glide = 0.0, np.zeros((2, 3)), np.zeros((2, 3))
        self.gliding = QTimer(self, interval=EASE[1])
        self.gliding.timeout.connect(self._step_camera)
        self._due = QTimer(self, singleShot=True)
        self._due.timeout.connect(self.draw_now)
        self.handles = SeabedHandles(self.canvas.plotter, self.canvas.widget, self._sight, self._later)
        self.guides = SeabedGuides(self.canvas.plotter, self.canvas.widget)
        SeabedInput(
            self.canvas.widget,
            clicked=self._want_menu,
            wheeled=lambda place, factor: self.zoom_wanted.emit(*self.look_from(place), factor),
            turned=self.turn,
            zoomed=self.magnify,
        )
        self.canvas.widget.setAccessibleName("Seabed in 3-D")

    def show_bed(self, patch: BedPatch, picture: Bytes | None = None) -> None:
        """Show another bed in its own colours or, from its first drawing on, under a picture."""
        self.bed.points = patch.points
        nodes = patch.points.reshape(pv_meshes.MESH_NODES, pv_meshes.MESH_NODES, 3)  # its edges stay when it is thinned
        self.thinned_bed.points = nodes[:: pv_meshes.THINNED, :: pv_meshes.THINNED].reshape(-1, 3)
        self.show_texture(patch.image if picture is None else picture)
        self._bed_shown, self._depths = True, patch.depths
        self._window = (*patch.centre, patch.half)
        self.swath.cover(self._window)
        self._thin(self._held)

    def fade_bed(self, faded: bool) -> None:
        """Fade bed, targets and volumes while they belong to an earlier scene than the record."""
        opacity = FADED if faded else 1.0
        if self.bed_actor.prop.opacity != opacity:
            for actor in (self.bed_actor, self.thinned_actor, self.targets_actor):
                actor.prop.opacity = opacity
            self.volumes_actor.prop.opacity = CLOUDED * opacity
            self._later()

    def show_texture(self, picture: Bytes) -> None:
        """Show other colours of the bed."""
        image = pv.Texture(picture).to_image()
        for actor in (self.bed_actor, self.thinned_actor):  # OpenGL would keep the pixels of other textures for good
            actor.texture.SetInputData(image)
            actor.texture.Modified()
        self._later()

    def show_targets(self, triangles: Floats, colours: Bytes, volumes: Singles) -> None:
        """Show other targets, as coloured triangles, and other volumes of the water column, as points."""
        self.targets_actor.visibility, self.volumes_actor.visibility = len(triangles) > 0, len(volumes) > 0
        if len(triangles):
            mesh = pv_meshes.triangles_mesh(triangles)
            mesh.cell_data["colour"] = colours
            self.targets_actor.mapper.SetInputData(mesh)
        if len(volumes):
            self.volumes_actor.mapper.SetInputData(pv.PolyData(volumes))
        self._later()

    def show_sonar(self, arrays: SceneArrays, pose: Poses, heading: float) -> None:
        """Move the fish; the camera follows and turns with the heading of the track."""
        reach = arrays.bins * arrays.bin_length
        self.fish_actor.visibility = self._cable_actor.visibility = True
        self._follow(pose, heading, reach)
        self._later()

    def show_scan(self, arrays: SceneArrays, pose: Poses, scanned: ScanLine, tones: Singles) -> None:
        """Move fan and footprint to the line of the bed that is scanned."""
        self._fan.move(arrays, pose, scanned, tones)
        self.sheet_actor.mapper.SetInputData(self._fan.sheet)  # until what shades it is known
        self.sheet_actor.visibility = self._footprint_actor.visibility = True
        self.swath.show(pose, scanned, arrays.bins * arrays.bin_length, text_scale(self), self._window)
        self._later()

    def show_sheet(self, triangles: Floats) -> None:
        """Show the fan as triangles, (n, 3, 3), until the sonar moves on."""
        if len(triangles):
            self.sheet_actor.mapper.SetInputData(pv_meshes.triangles_mesh(triangles))
            self._later()

    def show_shadows(self, slices: Sequence[Floats]) -> None:
        """Show the last slices of acoustic shadows, each of triangles (n, 3, 3)."""
        self.shadows = [each for each in slices if len(each)][-SLICES:]
        self.shadow_actor.visibility = bool(self.shadows)
        if self.shadows:
            self.shadow_actor.mapper.SetInputData(pv_meshes.triangles_mesh(np.concatenate(self.shadows)))
        self._later()

    def show_path(self, path: Poses) -> None:
        """Draw the track through `PATH_POINTS` poses."""
        self._path.points = np.column_stack([path.x, path.y, path.z]).astype(np.float32)
        self._path_actor.visibility = True
        self.swath.show_path(path, self.reach)
        self._later()

    def show_mark(self, place: tuple[float, float, float] | None) -> None:
        """Mark a point of the bed; None removes the mark."""
        self._put_pin(self._mark_actor, place)

    def show_pick(self, place: tuple[float, float, float] | None) -> None:
        """Mark a picked place; None removes the mark."""
        self._put_pin(self._pick_actor, place)

    def _put_pin(self, actor: Any, place: tuple[float, float, float] | None) -> None:
        actor.visibility = place is not None
        if place is not None:
            actor.position, actor.scale = place, self.reach
        self._later()

    def show_sound(self, drawing: SoundDrawing | None) -> None:
        """Draw the sound of a pixel; None removes it."""
        self.sound.show(drawing, self.reach)
        self._later()

    def look_at(self, x: float, y: float) -> None:
        """Signal the line of sight through a point of the view, in pixels from its lower left corner."""
        self.sighted.emit(*self._look(x, y))

    def _want_menu(self, place: QPoint) -> None:
        """Signal that a menu is wanted at a place of the view."""
        self.menu_wanted.emit(*self.look_from(place), self.canvas.widget.mapToGlobal(place))

    def look_from(self, place: QPoint | QPointF) -> tuple[Floats, Floats, Floats | None]:
        """Line of sight through a place of the widget, and the place of a target that it meets."""
        widget, ratio = self.canvas.widget, self.canvas.widget.devicePixelRatioF()
        return self._look(place.x() * ratio, (widget.height() - 1.0 - place.y()) * ratio)

    def _look(self, x: float, y: float) -> tuple[Floats, Floats, Floats | None]:
        """Return the ends of the line of sight through a point of the view, and the place of a target that it meets."""
        renderer, ends = self.canvas.plotter.renderer, self._sight(x, y)
        picker = pv._vtk.vtkCellPicker()
        picker.PickFromListOn()
        picker.AddPickList(self.targets_actor)
        picker.SetTolerance(0.0)
        met = self.targets_actor.visibility and picker.Pick(x, y, 0.0, renderer)
        return ends[0], ends[1], np.array(picker.GetPickPosition()) if met else None

    def _sight(self, x: float, y: float) -> list[Floats]:
        """Return the ends of the line of sight through a point of the view."""
        renderer, ends = self.canvas.plotter.renderer, []
        for depth in (0.0, 1.0):
            renderer.SetDisplayPoint(x, y, depth)
            renderer.DisplayToWorld()
            *place, scale = renderer.GetWorldPoint()
            ends.append(np.array(place) / scale)
        return ends

    def reset_camera(self, subject: tuple[float, float] | None = None, camera: str = USUAL) -> None:
        """Put the camera to one of its places, or to one that shows a place of the bed, at the next pose."""
        self._is_placed, self._subject, self._camera, self.follows = False, subject, camera, True

    def frame(self, place: tuple[float, float, float], size: float) -> None:
        """Look at a place so that a body of some metres about it fills the view; the camera stays there."""
        self.gliding.stop()
        camera, self.follows, self._is_placed = self.canvas.plotter.camera, False, True
        away = np.array(camera.position) - np.array(camera.focal_point)
        away[2] = max(away[2], FRAMED[0] * float(np.hypot(away[0], away[1])))
        distance = FRAMED[1] * size / math.tan(math.radians(VIEW_ANGLE) / 2.0)
        camera.focal_point = place
        camera.position = tuple(np.array(place) + away * distance / np.linalg.norm(away))
        self._clip()
        self._later()

    def picture(self) -> QImage:
        """Draw the view with three times as many pixels along each side."""
        return image_of(self.canvas.plotter.screenshot(return_img=True, scale=3))

    def turn(self, across: float, up: float) -> None:
        """Turn the scene about the focus of the camera by degrees to the right and upwards, as a drag does."""
        self.gliding.stop()
        camera = self.canvas.plotter.camera
        x, y, z = away = np.array(camera.position) - np.array(camera.focal_point)
        bearing = math.atan2(y, x) - math.radians(across)
        slope = min(math.atan2(z, math.hypot(x, y)) - math.radians(up), STEEPEST)
        level = math.cos(slope)
        direction = np.array([level * math.cos(bearing), level * math.sin(bearing), math.sin(slope)])
        camera.position = tuple(np.array(camera.focal_point) + np.linalg.norm(away) * direction)
        self._clip()
        self._later()

    def magnify(self, factor: float) -> None:
        """Move the camera closer to its focus by a factor, within the limits of the wheel."""
        self.gliding.stop()
        camera = self.canvas.plotter.camera
        focus = np.array(camera.focal_point)
        camera.position = tuple(focus + (np.array(camera.position) - focus) / factor)
        self._clip()
        self._later()

    def zoom_about(self, place: tuple[float, float, float], factor: float) -> None:
        """Magnify the view about a place, which stays under the mouse; the camera stops before it."""
        if self.pose is None:  # the camera has yet to be placed
            return
        self.gliding.stop()
        camera = self.canvas.plotter.camera
        position, focus, fixed = (np.array(each) for each in (camera.position, camera.focal_point, place))
        to_focus, to_place = (float(np.linalg.norm(position - each)) for each in (focus, fixed))
        closest = max(min(to_focus, to_place) / (NEAREST * self.reach), 1.0)
        farthest = min(to_focus / (FARTHEST * self.reach), 1.0)
        kept = 1.0 / min(max(factor, farthest), closest)
        camera.position, camera.focal_point = (tuple(fixed + kept * (each - fixed)) for each in (position, focus))
        self._clip()
        self._later()

    def close_view(self) -> None:
        """Release the drawing resources."""
        self._due.stop()
        self.gliding.stop()
        self.canvas.close()

    def _furnish(self) -> None:
        plotter = self.canvas.plotter
        plotter.set_background(WATER[0], top=WATER[1])
        plotter.renderer.camera.is_set = True  # else PyVista draws the view when the camera is first asked for
        add: dict[str, Any] = {"render": False, "reset_camera": False, "show_scalar_bar": False}
        self.bed_actor = plotter.add_mesh(self.bed, texture=_blank_texture(), lighting=False, **add)
        self.thinned_actor = plotter.add_mesh(self.thinned_bed, texture=_blank_texture(), lighting=False, **add)
        shiny: dict[str, Any] = {"ambient": 0.35, "diffuse": 0.7, "specular": 0.25}
        ball = pv.Sphere()
        ball.cell_data["colour"] = np.zeros((ball.n_cells, 3), np.uint8)
        self.targets_actor = plotter.add_mesh(ball, scalars="colour", rgb=True, **shiny, **add)
        cloud: dict[str, Any] = {"style": "points", "point_size": 3.0, "opacity": CLOUDED}
        self.volumes_actor = plotter.add_mesh(pv.Sphere(), color="#eaf6ff", lighting=False, **cloud, **add)
        self.fish_actor = plotter.add_mesh(pv_meshes.fish_mesh(1.0), color="#ff8a1f", **shiny, **add)
        self._cable_actor = plotter.add_mesh(pv_meshes.cable_mesh(1.0), color="#23333f", line_width=1.5, **add)
        self._path_actor = plotter.add_mesh(
            self._path, color="#ffc83d", opacity=0.8, line_width=2.0, lighting=False, **add
        )
        self.sheet_actor = plotter.add_mesh(self._fan.sheet, color="#bfeaff", opacity=0.17, lighting=False, **add)
        self.shadow_actor = plotter.add_mesh(self._fan.sheet, color=HIDDEN, opacity=0.3, lighting=False, **add)
        self._footprint_actor = plotter.add_mesh(self._fan.footprint, scalars="colour", rgb=True, lighting=False, **add)
        self._mark_actor = plotter.add_mesh(_pin(), color=MARK_IN_WATER, lighting=False, **add)
        self._pick_actor = plotter.add_mesh(_pin(), color=LIT, lighting=False, **add)
        self.sound = SoundActors(plotter)
        self.swath = SwathGuides(plotter)
        for actor in plotter.actors.values():
            actor.visibility = False

    def _follow(self, pose: Poses, heading: float, reach: float) -> None:
        """Move the camera with the fish, however the person turned it; reset it for another range."""
        camera, place = self.canvas.plotter.camera, _place_of(pose)
        # A fish that jumps would take the camera along, away from the place of the bed that it shows.
        leapt = self.pose is not None and float(np.linalg.norm(place - _place_of(self.pose))) > reach
        if self.pose is None or reach != self.reach or not self._is_placed or (leapt and self._subject is not None):
            shown = np.array([camera.position, camera.focal_point])
            before = None if self.pose is None else shown - _place_of(self.pose)
            turn = _about_z(heading)
            camera.up = (0.0, 0.0, 1.0)
            camera.view_angle = VIEW_ANGLE
            position, focus = (np.array(part) for part in CAMERAS[self._camera])
            # A narrow view moves back, so that both ends of the fan are visible.
            back = min(max(self.height() / max(self.width(), 1), 0.8), MOST_BACK)
            away, focus = turn @ (position - focus) * back * reach, place + turn @ focus * reach
            if self._subject is not None:  # from nearer, in the middle of the view
                away, focus = CLOSE * away, np.array([*self._subject, 0.0])
            position = focus + away
            self.reach, self._is_placed = reach, True
            if self.eases and before is not None:
                self._glide = time.perf_counter(), before, np.array([position, focus]) - place
                self.gliding.start()
                position, focus = place + before
        elif not self.follows:
            position, focus = camera.position, camera.focal_point
        else:
            turn, before = _about_z(heading - self._heading), _place_of(self.pose)
            position = place + turn @ (np.array(camera.position) - before)
            focus = place + turn @ (np.array(camera.focal_point) - before)
        camera.position, camera.focal_point = tuple(position), tuple(focus)
        self.pose, self._heading = pose, heading
        self._clip()

    def _step_camera(self) -> None:
        """Move the camera on its way to another place about the fish."""
        begun, first, last = self._glide
        share = min((time.perf_counter() - begun) / EASE[0], 1.0)
        if share == 1.0 or self._held:
            self.gliding.stop()
        if self._held or self.pose is None:
            return
        camera = self.canvas.plotter.camera
        ends = _place_of(self.pose) + first + share**2 * (3.0 - 2.0 * share) * (last - first)
        camera.position, camera.focal_point = map(tuple, ends)
        self._clip()
        self._later()

    def _clip(self) -> None:
        """Keep the camera above its focus and its distance within limits, and fit its clipping range to it."""
        if self.pose is None:  # it has yet to be placed
            return
        camera = self.canvas.plotter.camera
        away = np.array(camera.position) - np.array(camera.focal_point)
        distance = float(np.linalg.norm(away))
        kept = min(max(distance, NEAREST * self.reach), FARTHEST * self.reach)
        level = float(np.hypot(away[0], away[1]))
        if away[2] < LOWEST * level:  # it would see the bed from below
            away[2] = LOWEST * level
        if distance > 0.0 and (kept != distance or away[2] == LOWEST * level):
            away *= kept / np.linalg.norm(away)
            camera.position = tuple(np.array(camera.focal_point) + away)
        camera.clipping_range = (0.02 * kept, kept + 6.0 * self.reach)
        self._size_fish()
        self._show_guides()

    def _show_guides(self) -> None:
        """Show the scale at the focus, where north is, and the colours of depths."""
        camera = self.canvas.plotter.camera
        x, y, z = np.array(camera.focal_point) - np.array(camera.position)
        high = 2.0 * math.sqrt(x**2 + y**2 + z**2) * math.tan(math.radians(VIEW_ANGLE) / 2.0)
        metres = high / max(self.height(), 1) * text_scale(self)  # of a pixel at the usual size of the text
        self.guides.show(metres, math.atan2(y, x), self._depths)

    def _size_fish(self) -> None:
        """Draw the fish as large on the screen at any distance."""
        if self.pose is None:
            return
        distance = np.linalg.norm(np.array(self.canvas.plotter.camera.position) - _place_of(self.pose))
        length = FISH * 2.0 * float(distance) * math.tan(math.radians(VIEW_ANGLE) / 2.0)
        self.fish_actor.user_matrix = pv_meshes.pose_matrix(self.pose, length)
        self._cable_actor.user_matrix = pv_meshes.pose_matrix(self.pose, length, level=True)

    def _thin(self, held: bool) -> None:
        """Draw a bed of fewer nodes while the person holds the view, so that it turns smoothly."""
        self._held = held
        self.bed_actor.visibility = self._bed_shown and not held
        self.thinned_actor.visibility = self._bed_shown and held

    def _later(self) -> None:
        """Schedule a drawing, with a pause after the last one."""
        if not self._due.isActive():
            rest = self._drawn + REST * self.draw_time - time.perf_counter()
            self._due.start(max(int(1000 * rest), 15))

    def draw_after(self, update: Callable[[], None]) -> None:
        """Draw soon, and call a function just before, in place of one that still waits for the drawing."""
        self._awaited = update
        self._later()

    def draw_now(self) -> None:
        """Draw immediately."""
        update, self._awaited = self._awaited, None
        if update is not None:
            update()
        self._due.stop()
        self._show_guides()
        self.canvas.draw()
        self.draw_time = max(self.canvas.draw_time(), 0.01)
        self._drawn = time.perf_counter()


def _place_of(pose: Poses) -> Floats:
    """Place of the first of some poses."""
    return np.array([pose.x[0], pose.y[0], pose.z[0]], dtype=np.float64)


def _about_z(angle: float) -> Floats:
    """Rotation matrix about z by an angle in radians."""
    cos, sin = math.cos(angle), math.sin(angle)
    return np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])


def _blank_texture() -> Any:
    """Return a black texture that is filtered alike in all directions."""
    texture = pv.Texture(np.zeros((2, 2, 3), np.uint8))
    texture.interpolate = texture.mipmap = True
    # VTK asks for four samples along the line of sight. Mesa's software renderer then loops for minutes, or for ever,
    # over the texels of one pixel where a triangle is seen from its edge, and the window hangs.
    texture.SetMaximumAnisotropicFiltering(1.0)
    return texture


@cache
def _pin() -> Any:
    """Return a marker, a ball on a needle, for a slant range of 1; one mesh that all marks share."""
    ball = pv.Sphere(center=(0, 0, 0.07), radius=0.011)
    needle = pv.Cylinder(center=(0, 0, 0.035), direction=(0, 0, 1), radius=0.002, height=0.07)
    return pv.merge([ball, needle]).extract_surface(algorithm=None)


class SoundActors:
    """Actors of one plotter that draw a `SoundDrawing`."""

    def __init__(self, plotter: Any) -> None:
        add: dict[str, Any] = {"render": False, "reset_camera": False, "lighting": False}
        styles = {
            "rays": {"color": MARK_IN_WATER, "line_width": 1.5, "opacity": 0.85},
            "blocked": {"color": BLOCKED, "line_width": 1.5, "opacity": 0.85},
            "echoing": {"color": MARK_IN_WATER, "line_width": 6.0},
            "hidden": {"color": HIDDEN, "line_width": 6.0},
        }
        self.actors = {name: plotter.add_mesh(_line(), **add, **style) for name, style in styles.items()}

    def show(self, drawing: SoundDrawing | None, reach: float) -> None:
        """Draw the sound of a pixel, at a view's slant range in metres; None hides it."""
        lines: dict[str, Sequence[Floats]] = dict.fromkeys(self.actors, ())
        if drawing is not None:
            lift = np.array([0.0, 0.0, LIFT * reach])
            lines = {
                "rays": drawing.rays,
                "blocked": drawing.blocked,
                "echoing": list(drawing.echoing + lift),
                "hidden": list(drawing.hidden + lift),
            }
        for name, actor in self.actors.items():
            actor.visibility = len(lines[name]) > 0
            if len(lines[name]):
                actor.mapper.SetInputData(pv_meshes.polylines(lines[name]))


def _line() -> Any:
    return pv_meshes.polylines([np.zeros((2, 3))])
