"""Keeps the panel of the water up to date, and does what is asked for there."""

from __future__ import annotations

from typing import TYPE_CHECKING

from insonify.scene import Scene, SceneError
from insonify.scene.waters.profile import ProfileWater
from insonify.scene.waters.uniform import UniformWater
from insonify_viewer.session import Session

if TYPE_CHECKING:
    from insonify.display.ray_diagram.diagram import RayDiagram
    from insonify_viewer.simulator import Simulator
    from insonify_viewer.views.main_window import MainWindow

APART = 0.1  # m that points of a profile keep from each other
COARSE = 121  # columns of the shadow while something is dragged
Target = tuple[float, float] | None


class WaterPanel:
    """Traces the rays of the current scene on the worker whenever the panel is there to be seen.

    Parameters
    ----------
    session : Session
        Whose scene is shown, and changed by points that are dragged.
    window : MainWindow
        Who holds the panel.
    simulator : Simulator
        Whose worker traces.
    """

    def __init__(self, session: Session, window: MainWindow, simulator: Simulator) -> None:
        self._session, self._window, self._simulator = session, window, simulator
        self._target: Target = None
        self._shown: tuple[Scene, Target, bool] | None = None
        self._busy = self._settled = False
        self._bent = self._ready = False
        session.changed.connect(self._follow)
        window.water_shown.connect(self._trace)
        simulator.answered.connect(self._begin)
        window.water.targeted.connect(self._aim)
        window.water.point_dragged.connect(self._drag)
        window.water.point_settled.connect(session.settle)
        self._follow(session.scene, True)

    @property
    def complete(self) -> bool:
        """Whether the panel, if there is one to be seen, shows the current scene."""
        return not self._window.water_is_shown or (not self._busy and self._shown == self._wanted)

    @property
    def _wanted(self) -> tuple[Scene, Target, bool]:
        return self._session.scene, self._target, self._settled

    def _begin(self) -> None:
        """Trace from the first picture of the record on, which is not to wait for rays."""
        if not self._ready:
            self._ready = True
            self._trace()

    def _follow(self, scene: Scene, settled: bool) -> None:
        """Trace the new scene; the first water that may bend sound opens the panel."""
        bent = not isinstance(scene.water, UniformWater)
        if bent and not self._bent:
            self._window.show_water(True)
        self._bent, self._settled = bent, settled
        self._trace()

    def _aim(self, distance: float, depth: float) -> None:
        self._target = (distance, depth)
        self._trace()

    def _drag(self, number: int, depth: float, speed: float) -> None:
        """Move a point of the profile, between its neighbours."""
        water = self._session.scene.water
        if not isinstance(water, ProfileWater):
            return
        low = water.depth[number - 1] + APART if number else 0.0
        high = water.depth[number + 1] - APART if number + 1 < len(water.depth) else depth
        place = round(min(max(depth, low), max(high, low)), 2)
        self._session.drag(
            {f"water.depth.{number}": place, f"water.sound_speed.{number}": round(min(max(speed, 1300.0), 1700.0), 1)}
        )

    def _trace(self) -> None:
        """Trace what is wanted, unless it is shown, or something else is being traced."""
        wanted = self._wanted
        if not self._ready or self._busy or wanted == self._shown or not self._window.water_is_shown:
            return
        self._busy, self._shown = True, wanted
        self._simulator.send(lambda: _diagram(*wanted), self._show)

    def _show(self, diagram: RayDiagram | SceneError) -> None:
        self._busy = False
        if isinstance(diagram, SceneError):
            self._window.say(str(diagram))
        else:
            assert self._shown is not None
            self._window.water.show_diagram(diagram, _points(self._shown[0]))
        self._trace()


def _diagram(scene: Scene, target: Target, fine: bool) -> RayDiagram:
    # lazy: on the worker; the window is there before Numba is
    from insonify.display.ray_diagram.tracing import ACROSS, trace_ray_diagram
    from insonify.terrain import build_ground

    datum = build_ground(scene).datum
    inside = target is not None and target[0] <= scene.sonar.range and target[1] <= -datum
    return trace_ray_diagram(scene, datum=datum, target=target if inside else None, columns=ACROSS if fine else COARSE)


def _points(scene: Scene) -> tuple[tuple[float, float], ...]:
    """Depths and speeds of a profile that can be dragged."""
    water = scene.water
    return tuple(zip(water.depth, water.sound_speed)) if isinstance(water, ProfileWater) else ()
