"""Controller of the three-dimensional view; meshes and textures are made on the worker."""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, cast

import numpy as np
from psygnal import Signal

from insonify.arrays import Bytes, Floats, Singles
from insonify.kernels.common.types import Mesh, Poses, Solids
from insonify.scene import SceneError
from insonify.scene.volumes import Volume
from insonify_viewer.core_types import AnyGround, PackedScene, Simulation
from insonify_viewer.errors import Failure
from insonify_viewer.record.drape import MosaicSheet, RecordStrip, drape_mosaic, drape_record
from insonify_viewer.seabed.cameras import USUAL
from insonify_viewer.seabed.fan_sheet import FanSheet, fan_sheet
from insonify_viewer.seabed.handle_geometry import meet_bed
from insonify_viewer.state.inspection import Inspection
from insonify_viewer.work.gc_policy import leave_out_libraries
from insonify_viewer.work.ping_request import is_same_ground
from insonify_viewer.work.simulator import Simulator

if TYPE_CHECKING:
    from insonify_viewer.seabed.bed_shading import BedPatch
    from insonify_viewer.seabed.pv_meshes import ScanLine

    Vector = Floats
    Grip = tuple[tuple[float, float, float], str, bool]
    _Bed = tuple[AnyGround, tuple[float, float], float, bool]
    _Bodies = tuple[Solids, Mesh, Bytes, tuple[Volume, ...]]
    _Made = tuple[BedPatch, Bytes, Floats, Bytes, Singles]  # bed, its colours, targets, their colours, and volumes
    from insonify_viewer.seabed.seabed_view import SeabedView

VIEW = "insonify_viewer.seabed.seabed_view"
# pyvistaqt imports these, and they every class of PySide6. On another thread that races with the main thread, which
# looks up the classes of the events that it handles, and ends the program.
QT_MODULES = ("qtpy.QtCore", "qtpy.QtGui", "qtpy.QtWidgets", "qtpy.QtOpenGLWidgets")


class SeabedController:
    """Loads the view and its libraries, and passes on only what has changed."""

    picked = Signal(tuple)  # place of the bed or of a target that was clicked
    taken = Signal(int)  # number of the handle at which a drag begins
    pulled = Signal(tuple)  # place of the bed to which it is dragged
    released = Signal()
    failed = Signal(object)  # a `Failure` or an exception
    menu_wanted = Signal(object, object)  # the place under the mouse, or None, and the place of the screen

    def __init__(self, simulator: Simulator, inspection: Inspection, *, accelerated: bool) -> None:
        self._simulator, self._inspection, self.accelerated = simulator, inspection, accelerated
        self.view: SeabedView | None = None  # None until it is loaded
        self.by_depth = False  # whether the bed is coloured by its depth
        self.shadows = False  # whether acoustic shadows of targets are shown
        self._shaded: PackedScene | None = None  # shadows on screen belong to this scene
        self._latest: tuple[PackedScene, int, Singles, bool] | None = None
        self._bed: _Bed | None = None
        self._bodies: _Bodies | None = None
        self._asked = self._shown = 0  # numbers of the newest bed that is made, and of the one on screen
        self._owed = 0  # number of the bed of a settled scene that is not yet on screen, else 0
        self._loading = False  # whether this window is the first of the process, which loads the libraries
        self._executor = simulator.executor
        self._subject: tuple[float, float] | None = None  # place of the bed that the camera shows
        self._strip: RecordStrip | None = None  # what is laid over the bed
        self.mosaic: MosaicSheet | None = None  # what is laid over the bed beneath the record
        self.patch: BedPatch | None = None  # the bed on screen
        self._drape_asked = self._drape_shown = 0
        self._grips: Sequence[Grip] = ()

    @property
    def complete(self) -> bool:
        """Whether the view shows the present bed and targets."""
        laid = self.view is not None and self._bed is not None and self._shown == self._asked
        return laid and self._drape_shown == self._drape_asked

    def load(self, put: Callable[[SeabedView], None]) -> None:
        """Import the libraries on the worker, then make the view on the main thread and hand it to ``put``."""
        self._loading = VIEW not in sys.modules
        if self.accelerated:
            load_qt_modules()
        self._executor.submit("libraries", self._import, lambda _: self._build(put))

    def show_sonar(self, simulation: PackedScene, ping: int, tones: Singles, *, at_once: bool = False) -> None:
        """Move the sonar to a ping; update bed and targets if they have changed."""
        self._latest = (simulation, ping, tones, at_once)
        if self.mosaic is not None and self.mosaic.place != simulation.scene.georeference:  # of a scene elsewhere
            self.lay_mosaic(None)
        if self.view is None:
            return
        # lazy: the window opens before PyVista is loaded
        from insonify_viewer.seabed.bed_shading import target_colours
        from insonify_viewer.seabed.pv_meshes import path_pings, window_centre

        sent = np.array([ping], dtype=np.int64)
        pose, line = simulation.poses(sent), simulation.line(sent)
        scene, arrays = simulation.scene, simulation.arrays
        reach = arrays.bins * arrays.bin_length
        bed = simulation.ground, window_centre(line, reach), reach, self.by_depth
        bodies = arrays.solids, arrays.mesh, target_colours(scene), scene.volumes
        known = self._bed
        same = known is not None and known[1:] == bed[1:] and is_same_ground(known[0], bed[0])
        if not same or not _same(self._bodies, bodies):
            self._bed, self._bodies = bed, bodies
            self._bake(bed, bodies, at_once=at_once)
        if not at_once:  # pings of the scene are on screen
            self.view.fade_bed(bool(self._owed))
        self.view.show_sonar(arrays, pose, float(line.heading[0]))
        self._scan(pose)
        step = scene.track.speed / scene.sonar.ping_rate
        self.view.show_path(simulation.poses(path_pings(ping, step, reach)))

    def show_later(self, show: Callable[[], None]) -> None:
        """Call a function that shows the sonar before the next drawing; drawings are rarer than moves of a slider."""
        if self.view is not None:
            self.view.draw_after(show)

    def drape(self, strip: RecordStrip | None) -> None:
        """Lay a record over the bed; None shows the bed as it is."""
        self._strip = strip
        self._drape()

    def lay_mosaic(self, mosaic: MosaicSheet | None) -> None:
        """Lay a mosaic over the bed of its scene, or none."""
        self.mosaic = mosaic
        self._drape()

    def open_mosaic(self, path: Path) -> None:
        """Read a mosaic on the worker, and lay it over the bed of the present scene."""
        # lazy: the window opens before Numba is loaded
        from insonify.surveys.mosaic import colour_levels, read_levels

        place = None if self._latest is None else self._latest[0].scene.georeference

        def read() -> MosaicSheet:
            grid = read_levels(path)
            return MosaicSheet(path.name, grid, colour_levels(grid.heights), place)

        def show(read: MosaicSheet | SceneError | Failure) -> None:
            self.lay_mosaic(read) if isinstance(read, MosaicSheet) else self.failed.emit(read)

        self._simulator.send(read, show)

    def _drape(self) -> None:
        """Lay mosaic and record over the bed, on a thread of its own."""
        patch, strip, mosaic = self.patch, self._strip, self.mosaic
        if patch is None or self.view is None:
            return
        self._drape_asked += 1
        number = self._drape_asked

        def show(image: Bytes | None) -> None:
            self._drape_shown = number
            if self.view is not None and image is not None and patch is self.patch:
                self.view.show_texture(image)

        self._executor.submit("drape", lambda: _picture_of(patch, strip, mosaic), show)

    def show_mark(self, place: tuple[float, float, float] | None) -> None:
        """Mark a point of the bed; None removes the mark."""
        if self.view is not None:
            self.view.show_mark(place)

    def show_handles(self, grips: Sequence[Grip]) -> None:
        """Show handles of targets: place, what a drag does, and whether it belongs to the chosen target."""
        self._grips = grips
        if self.view is not None:
            self.view.handles.show(grips)

    def reset_camera(self, subject: tuple[float, float] | None = None) -> None:
        """Reset the camera to its place behind and above the fish, or to one that shows a place of the bed."""
        self._subject = subject
        if self.view is not None:
            self.view.reset_camera(subject)

    def look_from(self, camera: str = USUAL) -> None:
        """Put the camera to one of its places about the fish now, where it follows the fish."""
        if self.view is not None:
            self.view.reset_camera(camera=camera)
        self._show_latest()

    def colour_by_depth(self, by_depth: bool) -> None:
        """Colour the bed by its depth, or by its materials."""
        self.by_depth = by_depth
        self._show_latest()

    def show_shadows(self, shown: bool) -> None:
        """Show acoustic shadows of targets, of each ping that the fish passes from now on, or none."""
        self.shadows, self._shaded = shown, None
        self._show_latest()

    def frame(self, place: tuple[float, float, float], size: float) -> None:
        """Look at a place from as near as a body of some metres about it fills the view."""
        if self.view is not None:
            self.view.frame(place, size)

    def draw_now(self) -> None:
        """Draw immediately, for a picture of the window."""
        if self.view is not None:
            self.view.draw_now()

    def close(self) -> None:
        """Release the drawing resources."""
        if self.view is not None:
            self.view.close_view()
            self.view = None

    def _import(self) -> None:
        import_module(VIEW)  # takes a second or two
        if self.accelerated:
            import_module("pyvistaqt")

    def _build(self, put: Callable[[SeabedView], None]) -> None:
        # lazy: the window opens before PyVista is loaded
        from insonify_viewer.seabed.seabed_view import SeabedView

        if self._loading:
            leave_out_libraries()
        self.view = SeabedView(accelerated=self.accelerated)
        self.view.reset_camera(self._subject)
        self.view.sighted.connect(self._pick)
        self.view.zoom_wanted.connect(self._zoom)
        self.view.menu_wanted.connect(lambda *sight: self.menu_wanted.emit(self.meet(*sight[:3]), sight[3]))
        self._inspection.drawn.connect(self.view.show_sound)
        self._inspection.picked.connect(self.view.show_pick)
        handles = self.view.handles
        handles.taken.connect(lambda number: self.taken.emit(number))
        handles.pulled.connect(self._pull)
        handles.released.connect(lambda: self.released.emit())
        handles.show(self._grips)
        put(self.view)
        self._show_latest()

    def _show_latest(self) -> None:
        if self._latest is not None:
            simulation, ping, tones, at_once = self._latest
            self.show_sonar(simulation, ping, tones, at_once=at_once)

    def _scan(self, pose: Poses) -> None:
        """Lay the fan on the bed; heights of endless ground may take a second, on a thread of their own."""
        # lazy: the window opens before PyVista and Numba are loaded
        from insonify.terrain import EndlessGround
        from insonify_viewer.seabed.pv_meshes import scan_line

        assert self._latest is not None
        latest = simulation, ping, tones, at_once = self._latest
        arrays, ground = simulation.arrays, simulation.ground

        def show(scanned: ScanLine | None) -> None:
            if self.view is None or scanned is None:
                return
            self.view.show_scan(arrays, pose, scanned, tones)
            if not at_once and self._latest is latest:  # the kernels of the first pings must not wait for its own
                self._cut_fan(simulation, ping)

        if isinstance(ground, EndlessGround):
            self._executor.submit("scan", lambda: scan_line(ground, arrays, pose), show)
        else:
            show(scan_line(ground, arrays, pose))

    def _cut_fan(self, simulation: PackedScene, ping: int) -> None:
        """Cut the fan by what shades it, on a thread of its own."""
        if not hasattr(simulation, "plan"):  # shown before it is planned
            return
        latest = self._latest

        def show(sheet: FanSheet | None) -> None:
            if self.view is None or sheet is None:
                return
            if self._shaded is not simulation:
                self.view.show_shadows([])
                self._shaded = simulation
            if self.shadows:
                self.view.show_shadows([*self.view.shadows, sheet.shaded])
            if self._latest is latest:  # else the fish is farther on by now; the next sheet follows
                self.view.show_sheet(sheet.lit)

        self._executor.submit("fan", lambda: fan_sheet(cast("Simulation", simulation), ping), show)

    def _pull(self, begin: Vector, end: Vector) -> None:
        """Signal the place of the bed under the mouse while it drags a handle."""
        if self._latest is not None:
            bed = self._latest[0].arrays.bed
            place = meet_bed(self._latest[0].ground, begin, end, (bed.low, bed.high))
            if place is not None:
                self.pulled.emit(place)

    def _pick(self, begin: Vector, end: Vector, target: Vector | None) -> None:
        """Signal the nearest place of a target or of the bed along a line of sight."""
        if (place := self.meet(begin, end, target)) is not None:
            self.picked.emit(place)

    def _zoom(self, begin: Vector, end: Vector, target: Vector | None, factor: float) -> None:
        """Zoom about what lies on a line of sight, or about the focus of the camera where nothing does."""
        if self.view is not None:
            place = self.meet(begin, end, target)
            self.view.magnify(factor) if place is None else self.view.zoom_about(place, factor)

    def meet(self, begin: Vector, end: Vector, target: Vector | None) -> tuple[float, float, float] | None:
        """Find the nearest place of a target or of the bed along a line of sight."""
        if self._latest is None:
            return None
        bed = self._latest[0].arrays.bed
        place = meet_bed(self._latest[0].ground, begin, end, (bed.low, bed.high))
        if target is not None and (place is None or np.linalg.norm(target - begin) < np.linalg.norm(place - begin)):
            place = float(target[0]), float(target[1]), float(target[2])
        return place

    def _bake(self, bed: _Bed, bodies: _Bodies, *, at_once: bool) -> None:
        """Make the meshes of bed and targets, on a thread of their own or on the worker."""
        # lazy: the window opens before PyVista is loaded
        from insonify_viewer.seabed.bed_shading import cast_shadows
        from insonify_viewer.seabed.pv_meshes import bed_patch, target_triangles, volume_points

        self._asked += 1
        number = self._asked

        def make() -> _Made:
            triangles, colours = target_triangles(*bodies[:3])
            patch = cast_shadows(bed_patch(*bed), triangles)
            # With the record from the first drawing on: without it, the bed would be bare until the record is laid.
            picture = _picture_of(patch, self._strip, self.mosaic)
            return patch, picture, triangles, colours, volume_points(bodies[3], bed[0])

        def show(made: _Made | SceneError | Failure) -> None:
            self._lay(number, made)

        if at_once:
            self._owed = number
            self._executor.start("picture of the bed", make, done=show, failed=show)
        elif self._shown:
            self._simulator.send_patiently("bed", make, show)
        else:
            self._simulator.send(make, show)

    def _lay(self, number: int, made: _Made | SceneError | Failure) -> None:
        """Show meshes, unless newer ones are on screen."""
        if self.view is None or number < self._shown:
            return
        self._shown = number
        if isinstance(made, (SceneError, Failure)):
            self.failed.emit(made)
            return
        self.patch = made[0]
        self.view.show_bed(*made[:2])
        if number >= self._owed:
            self._owed = 0
            self.view.fade_bed(False)
        if self._strip is not None or self.mosaic is not None:
            self._drape()
        self.view.show_targets(*made[2:])


def _picture_of(patch: BedPatch, strip: RecordStrip | None, mosaic: MosaicSheet | None) -> Bytes:
    """Colours of a bed, with a mosaic and then a record laid over them unless they are None."""
    image = patch.image if mosaic is None else drape_mosaic(patch.image, patch.centre, patch.half, mosaic)
    return image if strip is None else drape_record(image, patch.centre, patch.half, strip)


def _same(first: _Bodies | None, second: _Bodies) -> bool:
    """Whether two sets of targets and volumes have the same shapes and colours."""
    if first is None or first[3] != second[3]:
        return False
    if first[0] is second[0]:
        return True
    bodies = [*zip(first[0], second[0]), *zip(first[1], second[1])]
    return np.array_equal(first[2], second[2]) and all(np.array_equal(a, b) for a, b in bodies)


def silence(simulation: PackedScene) -> Singles:
    """Tones of a scan line without echoes."""
    return np.zeros(2 * simulation.arrays.bins, dtype=np.float32)


def load_qt_modules() -> None:
    """Import the modules; to be called on the main thread, before pyvistaqt is imported on another."""
    for name in QT_MODULES:
        import_module(name)
