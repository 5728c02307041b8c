"""Adds targets to the scene."""

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

from insonify.scene import SceneError, plain
from insonify_viewer.core_types import Simulation
from insonify_viewer.seabed.target_handles import TargetHandles
from insonify_viewer.state.session import Session
from insonify_viewer.window.file_opening import FileOpening
from insonify_viewer.window.main_window import MainWindow
from insonify_viewer.window.target_placement import needs_file, new_target
from insonify_viewer.work.simulator import Simulator


class TargetEditor:
    """Adds targets from the window's menu, each as one step of undo."""

    def __init__(
        self,
        session: Session,
        window: MainWindow,
        simulator: Simulator,
        files: FileOpening,
        added: Callable[[str], None],
    ) -> None:
        self._session, self._window, self._simulator, self._files = session, window, simulator, files
        self._added = added
        self.handles = TargetHandles(session, window.waterfall)
        self._simulation: Simulation | None = None
        self._new: int | None = None  # target that was added and is not simulated yet
        window.target_wanted.connect(self.add)
        files.mesh_opened.connect(partial(self.add, "mesh"))

    def follow(self, simulation: Simulation) -> None:
        """Take the simulation on screen, which holds the bed."""
        self._simulation = simulation
        self.handles.follow(simulation)
        if self._new is not None and self._new < len(simulation.scene.targets):
            self.handles.frame(self._new)
            self._new = None

    def add(self, kind: str, path: str = "") -> None:
        """Place a target of a kind where the record shows it; one that is read from a file asks for it unless given."""
        path = path or (self._files.ask_for_mesh() if needs_file(kind) else "")
        simulation, top = self._simulation, self._window.waterfall.top
        if simulation is not None and (path or not needs_file(kind)):
            if path:
                self._window.say(f"reading {Path(path).name} …")
            self._simulator.send(
                lambda: new_target(simulation, self._session.scene, kind, top, path), partial(self._put, path)
            )

    def _put(self, path: str, target: dict[str, Any] | SceneError) -> None:
        """Add a declared target, or show why the file of a path cannot be one."""
        if isinstance(target, SceneError):
            self._window.complain(target)
            return
        targets = plain(self._session.scene)["targets"]
        name = f"{target['kind'].replace('_', ' ')} added"
        x, y, *_ = target["position"]
        said = f"mesh {Path(path).name} added as target {len(targets) + 1}, at x {x:g} m, y {y:g} m" if path else ""
        if self._session.settle({"targets": [*targets, target]}, name, said):
            self._files.keep_recent(path)
            self._new = len(targets)
            self.handles.choose(len(targets))
            self._added(f"targets.{len(targets)}")
