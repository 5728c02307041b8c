"""Moves, turns and resizes targets by their handles, each drag one step of undo."""

from insonify.scene import Scene
from insonify_viewer.core_types import Simulation
from insonify_viewer.record.marked_point import locate_mark
from insonify_viewer.record.waterfall_view import WaterfallView
from insonify_viewer.seabed.controller import SeabedController
from insonify_viewer.seabed.handle_geometry import (
    Handle,
    Place,
    drag_edit,
    echo_mark,
    echo_marks,
    half_length,
    half_width,
    handles_of,
    target_at,
)
from insonify_viewer.state.fields import name_field
from insonify_viewer.state.inspection import Mark
from insonify_viewer.state.session import Session

ABOVE = 4  # a target that is brought into the record is shown this part of the screen below its edge
DONE = {"move": "moved", "turn": "turned", "resize": "resized", "thicken": "thickened", "raise": "height"}


class TargetHandles:
    """Shows handles in the record and in three dimensions, and edits the scene while one is dragged."""

    def __init__(self, session: Session, waterfall: WaterfallView) -> None:
        self._session, self._waterfall = session, waterfall
        self._seabed: SeabedController | None = None
        self._simulation: Simulation | None = None
        self.all: tuple[Handle, ...] = ()
        self._held: Handle | None = None
        self._scene: Scene | None = None  # in which the drag began
        self._begun: Place | None = None  # place under the mouse then
        self._origin: Simulation | None = None  # in which places of the record are found during a drag
        self._awaited: Mark | None = None  # point of the record whose target is chosen as soon as it is known
        self._opened = session.opened  # scene of which a target may be chosen
        self.chosen: int | None = None
        waterfall.clicked.connect(self.choose_at)
        waterfall.handles.taken.connect(self._take)
        waterfall.handles.pulled.connect(self._pull_mark)
        waterfall.handles.released.connect(self._release)

    def connect_seabed(self, seabed: SeabedController) -> None:
        """Show handles in the three-dimensional view too."""
        self._seabed = seabed
        seabed.picked.connect(self._choose_place)
        seabed.taken.connect(self._take)
        seabed.pulled.connect(self._pull)
        seabed.released.connect(self._release)

    def follow(self, simulation: Simulation) -> None:
        """Show the handles of a scene that was traced."""
        if simulation is not self._simulation:
            self._simulation = simulation
            if self._session.opened is not self._opened:
                self._opened, self.chosen = self._session.opened, None
            if self._awaited is not None:
                self.choose_at(self._awaited)
            self._show()

    def choose(self, target: int | None) -> None:
        """Choose a target, which then has all its handles."""
        if target != self.chosen:
            self.chosen = target
            self._show()

    def frame(self, target: int | None = None) -> None:
        """Frame a target, else the chosen one, in three dimensions, and bring it into the record."""
        target = self.chosen if target is None else target
        place = next((each.place for each in self.all if (each.target, each.action) == (target, "move")), None)
        if place is None or self._simulation is None or self._seabed is None or target is None:
            return
        body = self._simulation.scene.targets[target]
        self._seabed.frame(place, 2.0 * max(half_length(body), half_width(body)))
        self.show_in_record(place)

    def show_in_record(self, place: Place) -> None:
        """Point at the echo of a place in the record, which is scrolled there if the echo is not on screen."""
        mark = None if self._simulation is None else echo_mark(self._simulation, place)
        record, top = self._waterfall.record, self._waterfall.top
        if mark is not None:
            if not top - record.pings < mark.ping <= top:
                self._waterfall.scrubbed.emit(mark.ping + record.pings // ABOVE)
            self._waterfall.hovered.emit(mark)

    def _show(self) -> None:
        simulation = self._simulation
        if simulation is None:
            return
        self.all = handles_of(simulation, self.chosen)
        marks = echo_marks(simulation, [handle.place for handle in self.all])
        self._waterfall.handles.show(
            [
                (number, mark, handle.action, handle.target == self.chosen)
                for number, (handle, mark) in enumerate(zip(self.all, marks, strict=True))
                if mark is not None
            ]
        )
        if self._seabed is not None:
            self._seabed.show_handles(
                [(handle.place, handle.action, handle.target == self.chosen) for handle in self.all]
            )

    def choose_at(self, mark: Mark) -> None:
        """Choose the target whose echo is at a point of the record, once its scene is traced."""
        self._awaited = mark if self._simulation is None else None
        if self._simulation is not None:
            place = locate_mark(self._simulation, mark)[2]
            self.choose(None if place is None else target_at(self._simulation.scene, *place[:2]))

    def _choose_place(self, place: Place) -> None:
        if self._simulation is not None:
            self.choose(target_at(self._simulation.scene, *place[:2]))

    def _take(self, number: int) -> None:
        """Begin a drag of a handle, unless it is one of a scene that has given way to another meanwhile."""
        if number < len(self.all) and self._is_current(self.all[number]):
            self._held, self._scene = self.all[number], self._session.scene
            self._origin, self._begun = self._simulation, None
            self.chosen = self._held.target

    def _is_current(self, handle: Handle) -> bool:
        """Whether the scene has the target of a handle still."""
        if self._simulation is None:
            return False
        simulated, targets = self._simulation.scene.targets, self._session.scene.targets
        return handle.target < len(targets) and simulated[handle.target].kind == targets[handle.target].kind

    def _pull_mark(self, mark: Mark) -> None:
        """Move the dragged handle to a place of the record, where there is bed."""
        place = None if self._origin is None else locate_mark(self._origin, mark)[2]
        if place is not None:
            self._pull(place)

    def _pull(self, place: Place) -> None:
        """Move the dragged handle to a place of the bed."""
        if self._held is None or self._scene is None:
            return
        if self._begun is None:
            self._begun = place
        elif self._held.target < len(self._scene.targets):
            self._session.drag(drag_edit(self._scene, self._held, self._begun, place))

    def _release(self) -> None:
        """End the drag, as one step of undo."""
        held, self._held = self._held, None
        if held is not None and self._scene is not None and self._session.scene != self._scene:
            target = name_field(self._scene, f"targets.{held.target}")
            self._session.settle(None, f"{target} {DONE[held.action]}")
        self._show()
