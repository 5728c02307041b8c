"""Shows every field of the scene, and edits it."""

from __future__ import annotations

from typing import Any

from insonify.scene import Scene, plain
from insonify_viewer.panels.panel import Panel, Place, RecordGrowth, Workbench
from insonify_viewer.panels.parameters.sections import needs_file, sections_of
from insonify_viewer.panels.parameters.view import ParametersView


class ParametersPanel(Panel):
    """Shows the fields of the scene in sections; disabled until the first pings arrive."""

    name = "parameters"
    title = "Parameters"
    place = Place.SIDE
    rank = 10

    def __init__(self, workbench: Workbench) -> None:
        self._session, self._files = workbench.session, workbench.files
        self.view = view = ParametersView()
        view.setEnabled(False)
        view.dragged.connect(lambda path, value: self._session.drag({path: value}))
        view.settled.connect(self._settle)
        view.file_asked.connect(self._change_file)
        view.removed.connect(self._remove)

    @property
    def widget(self) -> ParametersView:
        """The sections."""
        return self.view

    def scene_changed(self, scene: Scene, settled: bool) -> None:
        """Show the values of the scene; while a slider moves, shortly after the record."""
        del scene
        if settled:
            self.view.show_at_once(self._show)
        else:
            self.view.show_soon(self._show)

    def record_grown(self, growth: RecordGrowth) -> None:
        """Enable the panel."""
        del growth
        self.view.setEnabled(True)

    def part_added(self, path: str) -> None:
        """Unfold the section of a new part."""
        self.view.turn_to(path)

    def fields_lit(self, paths: tuple[str, ...]) -> None:
        """Light rows; those that a scene has only later are lit then."""
        self.view.light(paths)

    def closing(self) -> None:
        """Drop the update that waits."""
        self.view.stop_waiting()

    def _show(self) -> None:
        scene = self._session.scene
        self.view.show_about(scene.description)
        self.view.show_sections(sections_of(scene))
        self.view.show_pictures(scene)

    def _settle(self, path: str, value: Any) -> None:
        """Make an edit final; some choices need a file first."""
        if path == "seabed.relief.kind" and value == "dem":
            self._files.ask_for_dem(self._session.scene)
            self._session.settle()
        elif needs_file(self._session.scene, path, value):
            place = path.removesuffix("kind") + "path"
            file = self._files.ask_for(place)
            self._session.settle({path: value, place: file} if file else None)
        else:
            self._session.settle({path: value} if path else None)

    def _change_file(self, path: str) -> None:
        """Let the person pick another file for a field."""
        if path == "seabed.relief.path":
            self._files.ask_for_dem(self._session.scene)
        elif file := self._files.ask_for(path):
            self._session.settle({path: file})

    def _remove(self, path: str) -> None:
        """Remove the target or volume at a dotted path from the scene."""
        name, _, index = path.rpartition(".")
        parts = plain(self._session.scene)[name]
        self._session.settle({name: parts[: int(index)] + parts[int(index) + 1 :]})
