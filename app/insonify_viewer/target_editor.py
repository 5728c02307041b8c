"""Adds targets to the scene and takes them out again."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from insonify.scene import SceneError, plain
from insonify_viewer.session import Session
from insonify_viewer.target_placement import needs_file, new_target

if TYPE_CHECKING:
    from insonify.simulation import Simulation
    from insonify_viewer.simulator import Simulator
    from insonify_viewer.views.files import Files
    from insonify_viewer.views.main_window import MainWindow


class Targets:
    """Does what the window's menu of targets and the panel's crosses ask for, each as one step of undo.

    Parameters
    ----------
    session : Session
        Whose scene changes.
    window : MainWindow
        Who asks, and shows the record.
    simulator : Simulator
        Whose worker reads meshes.
    files : Files
        Asks for the files of meshes.

    Attributes
    ----------
    simulation : Simulation or None
        What is on screen, and therefore where there is a bed.
    """

    def __init__(self, session: Session, window: MainWindow, simulator: Simulator, files: Files) -> None:
        self._session, self._window, self._simulator, self._files = session, window, simulator, files
        self.simulation: Simulation | None = None
        window.target_wanted.connect(self.add)
        window.panel.removed.connect(self.remove)

    def add(self, kind: str) -> None:
        """Put a target where it will be seen; a file is asked for first where the kind is read from one."""
        path = self._files.ask_for_mesh() if needs_file(kind) else ""
        simulation, top = self.simulation, self._window.waterfall.top
        if simulation is not None and (path or not needs_file(kind)):
            if path:
                self._window.say(f"reading {Path(path).name} …")
            self._simulator.send(lambda: new_target(simulation, self._session.scene, kind, top, path), self._put)

    def remove(self, path: str) -> None:
        """Take the target at a dotted path out of the scene."""
        index = int(path.rpartition(".")[2])
        targets = plain(self._session.scene)["targets"]
        self._session.settle({"targets": targets[:index] + targets[index + 1 :]})

    def _put(self, target: dict[str, Any] | SceneError) -> None:
        if isinstance(target, SceneError):
            self._window.say(str(target))
            return
        targets = plain(self._session.scene)["targets"]
        if self._session.settle({"targets": [*targets, target]}):
            self._window.panel.turn_to(f"targets.{len(targets)}")
