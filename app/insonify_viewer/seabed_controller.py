"""Controller of the three-dimensional view; meshes and textures are made on the worker."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from insonify.scene import SceneError
from insonify_viewer.simulator import Simulator

if TYPE_CHECKING:
    from insonify.kernels.common.types import Mesh, Solids
    from insonify.simulation import Simulation
    from insonify.terrain import AnyGround
    from insonify_viewer.views.pv_meshes import BedPatch

    _Bed = tuple[AnyGround, tuple[float, float], float]
    _Bodies = tuple[Solids, Mesh, NDArray[np.uint8]]
    from insonify_viewer.views.seabed_view import SeabedView


class SeabedController:
    """Loads the view and its libraries, and passes on only what has changed.

    Parameters
    ----------
    simulator : Simulator
        The worker that makes meshes and textures.
    accelerated : bool
        Whether OpenGL widgets work here.
    """

    def __init__(self, simulator: Simulator, *, accelerated: bool) -> None:
        self._simulator, self._accelerated = simulator, accelerated
        self._view: SeabedView | None = None
        self._latest: tuple[Simulation, int, NDArray[np.float32]] | None = None
        self._bed: _Bed | None = None
        self._bodies: _Bodies | None = None
        self._baking = 0
        self._laid = False

    @property
    def view(self) -> SeabedView | None:
        """The view; None until it is loaded."""
        return self._view

    @property
    def complete(self) -> bool:
        """Whether the view shows the present bed and targets."""
        return self._view is not None and self._bed is not None and self._baking == 0

    def load(self, put: Callable[[SeabedView], None]) -> None:
        """Import the libraries on the worker, then make the view on the main thread and hand it to ``put``."""
        self._simulator.send(self._import, lambda _: self._build(put))

    def show_sonar(self, simulation: Simulation, ping: int, tones: NDArray[np.float32]) -> None:
        """Move the sonar to a ping; update bed and targets if they have changed."""
        self._latest = (simulation, ping, tones)
        if self._view is None:
            return
        # lazy: the window opens before PyVista is loaded
        from insonify_viewer.bed_shading import target_colours
        from insonify_viewer.views.pv_meshes import path_pings, window_centre

        sent = np.array([ping], dtype=np.int64)
        pose, line = simulation.poses(sent), simulation.line(sent)
        reach = simulation.arrays.bins * simulation.arrays.bin_length
        ground, bed = simulation.ground, (simulation.ground, window_centre(line, reach), reach)
        bodies = (simulation.arrays.solids, simulation.arrays.mesh, target_colours(simulation.scene))
        if self._bed != bed or not _same(self._bodies, bodies):
            self._bed, self._bodies = bed, bodies
            self._bake(bed, bodies)
        self._view.show_sonar(ground, simulation.arrays, pose, float(line.heading[0]), tones)
        scene = simulation.scene
        step = scene.track.speed / scene.sonar.ping_rate
        self._view.show_path(simulation.poses(path_pings(ping, step, reach)))

    def show_mark(self, place: tuple[float, float, float] | None) -> None:
        """Mark a point of the bed; None removes the mark."""
        if self._view is not None:
            self._view.show_mark(place)

    def reset_camera(self) -> None:
        """Reset the camera to its place behind and above the fish."""
        if self._view is not None:
            self._view.reset_camera()

    def draw_now(self) -> None:
        """Draw immediately, for a picture of the window."""
        if self._view is not None:
            self._view.draw_now()

    def close(self) -> None:
        """Release the drawing resources."""
        if self._view is not None:
            self._view.close_view()
            self._view = None

    def _import(self) -> None:
        # These imports take a second or two.
        # lazy: the window opens before PyVista is loaded
        from insonify_viewer.views.seabed_view import load_libraries

        load_libraries(accelerated=self._accelerated)

    def _build(self, put: Callable[[SeabedView], None]) -> None:
        # lazy: the window opens before PyVista is loaded
        from insonify_viewer.views.seabed_view import SeabedView

        self._view = SeabedView(accelerated=self._accelerated)
        put(self._view)
        if self._latest is not None:
            self.show_sonar(*self._latest)

    def _bake(self, bed: _Bed, bodies: _Bodies) -> None:
        """Make the meshes of bed and targets on the worker."""
        # lazy: the window opens before PyVista is loaded
        from insonify_viewer.views.pv_meshes import bed_patch, targets_mesh

        self._baking += 1
        number = self._baking
        # The first bed appears before the kernels are compiled; later ones wait for the record.
        send = self._simulator.send_patiently if self._laid else self._simulator.send
        send(lambda: (bed_patch(*bed), targets_mesh(*bodies)), lambda baked: self._lay(number, baked))

    def _lay(self, number: int, baked: tuple[BedPatch, Any] | SceneError) -> None:
        if number == self._baking:
            self._baking = 0
        self._laid = True
        if self._view is not None and not isinstance(baked, SceneError):
            self._view.show_bed(baked[0])
            self._view.show_targets(baked[1])


def _same(first: _Bodies | None, second: _Bodies) -> bool:
    """Whether two sets of targets have the same shapes and colours."""
    if first is None or first[0] is second[0]:
        return first is not None
    bodies = [*zip(first[0], second[0]), *zip(first[1], second[1])]
    return np.array_equal(first[2], second[2]) and all(np.array_equal(a, b) for a, b in bodies)
