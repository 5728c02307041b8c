"""Traces the rays of the current scene, and edits its sound-speed profile."""

from insonify.scene import Scene, SceneError
from insonify.scene.water import UniformWater
from insonify.scene.water.layered import ProfileWater
from insonify_viewer.core_types import RayDiagram
from insonify_viewer.panels.panel import Button, Panel, Place, Workbench
from insonify_viewer.panels.water.view import WaterView
from insonify_viewer.record.record import RecordGrowth
from insonify_viewer.work.newest_wins import NewestWins

APART = 0.1  # m, least distance of neighbouring points of a profile
SLOWEST, FASTEST = 1300.0, 1700.0  # m/s
COARSE = 121  # columns of the shadow picture while a value is dragged
Target = tuple[float, float] | None


class WaterPanel(Panel):
    """Shows the rays of the current scene, traced on the worker while the panel is open."""

    name = "water"
    title = "Water"
    place = Place.BELOW
    button = Button("Rays", "Show how the water bends sound", "Ctrl+R", icon="rays")

    def __init__(self, workbench: Workbench) -> None:
        self._workbench = workbench
        self.target: Target = None
        self._open = self._settled = False
        self._bent = self._ready = False
        send = workbench.simulator.send
        self._question = NewestWins(lambda: self._wanted, send, _diagram, self._show, in_turn=True)
        self.view = WaterView()
        self.view.targeted.connect(self._aim)
        self.view.point_dragged.connect(self._drag)
        self.view.point_settled.connect(workbench.session.settle)

    @property
    def complete(self) -> bool:
        """Whether the panel is closed or shows the current scene."""
        return not self._open or (self._ready and self._question.complete)

    @property
    def _wanted(self) -> tuple[Scene, Target, bool] | None:
        wanted = self._workbench.session.scene, self.target, self._settled
        return wanted if self._open and self._ready else None

    def opened(self, shown: bool) -> None:
        """Trace the rays when the panel opens."""
        self._open = shown
        self._question.ask()

    def record_grown(self, growth: RecordGrowth) -> None:
        """Start tracing after the first pings of the record, which the rays must not delay."""
        if not self._ready:
            self._ready = True
            self._question.ask()

    def scene_changed(self, scene: Scene, settled: bool) -> None:
        """Trace the new scene; open the panel for the first water that may bend sound."""
        bent = not isinstance(scene.water, UniformWater)
        if bent and not self._bent:
            self._workbench.open_panel(self.name)
        self._bent, self._settled = bent, settled
        self.view.show_points(_points(scene))
        self._question.ask()

    def _aim(self, distance: float, depth: float) -> None:
        self.target = (distance, depth)
        self._question.ask()

    def _drag(self, number: int, depth: float, speed: float) -> None:
        """Move a point of the profile, between its neighbours."""
        session = self._workbench.session
        water = session.scene.water
        if not isinstance(water, ProfileWater):
            return
        low = water.depth[number - 1] + APART if number else 0.0
        high = water.depth[number + 1] - APART if number + 1 < len(water.depth) else depth
        place = round(min(max(depth, low), max(high, low)), 2)
        within = round(min(max(speed, SLOWEST), FASTEST), 1)
        session.drag({f"water.depth.{number}": place, f"water.sound_speed.{number}": within})

    def _show(self, diagram: RayDiagram | SceneError) -> None:
        if isinstance(diagram, SceneError):
            self._workbench.complain(diagram)
        else:
            self.view.show_diagram(diagram)


def _diagram(scene: Scene, target: Target, fine: bool) -> RayDiagram:
    # lazy: loaded on the worker; the window opens before Numba is loaded
    from insonify.display.ray_diagram.tracing import ACROSS, trace_ray_diagram
    from insonify.terrain import build_ground

    datum = build_ground(scene).datum
    inside = target is not None and target[0] <= scene.sonar.range and target[1] <= -datum
    return trace_ray_diagram(scene, datum=datum, target=target if inside else None, columns=ACROSS if fine else COARSE)


def _points(scene: Scene) -> tuple[tuple[float, float], ...]:
    """Depths and speeds of a profile, which can be dragged."""
    water = scene.water
    return tuple(zip(water.depth, water.sound_speed)) if isinstance(water, ProfileWater) else ()
