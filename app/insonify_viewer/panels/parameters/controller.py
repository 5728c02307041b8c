"""Shows every field of the scene, and edits it."""

from functools import partial
from typing import Any

from insonify.scene import Scene, plain
from insonify.scene.edit import part_at
from insonify.scene.links import split_description
from insonify_viewer.panels.panel import Entry, Panel, Place, Workbench
from insonify_viewer.panels.parameters.effects import EffectMeter, EffectTicks, describe_tick
from insonify_viewer.panels.parameters.values import Resets, Trials, follow_values, glide_value, row_of
from insonify_viewer.panels.parameters.view.control_strip import ControlStrip
from insonify_viewer.panels.parameters.view.parameters_view import ParametersView
from insonify_viewer.record.record import RecordGrowth
from insonify_viewer.state.fields import NumberField, name_edit, name_field
from insonify_viewer.state.history import Modelling
from insonify_viewer.state.sections import (
    FieldSection,
    alone,
    found_section,
    needs_file,
    pinned_section,
    sections_of,
)

DROPPED = ("water", "track.motion", "targets")  # parts that take a file over when it is dropped on the window
ASIDE = 0.08  # slant ranges by which a copy of a target lies beside it


class ParametersPanel(Panel):
    """Shows the fields of the scene in sections; disabled until the first pings arrive."""

    name = "parameters"
    title = "Parameters"
    place = Place.SIDE
    rank = 10

    def __init__(self, workbench: Workbench) -> None:
        self._workbench, self._session = workbench, workbench.session
        self._opened: Scene | None = None
        self._trials, self._ticks, self._resets = Trials(), EffectTicks(), Resets()
        self._meter = EffectMeter(workbench.simulator, self._show_effects)
        self._followed: tuple[Scene, Modelling] | None = None  # the scene whose effects are measured
        self._due = True  # whether that is still to begin
        self._shown: tuple[FieldSection, ...] = ()
        self.view = view = ParametersView()
        self.strip = ControlStrip(view.dragged.emit, view.settled.emit)
        self._lit: tuple[str, ...] = ()
        view.setEnabled(False)
        view.dragged.connect(lambda path, value: self._session.drag({path: value}))
        view.settled.connect(self._settle)
        view.file_asked.connect(self._change_file)
        view.removed.connect(self._remove)
        view.followed.connect(self._follow)
        view.ticked.connect(self._tick)
        view.reset.connect(self._reset)
        view.duplicated.connect(self._duplicate)
        view.locked.connect(self._lock)
        view.searched.connect(lambda _: self._show())

    @property
    def at_rest(self) -> bool:
        """Whether it is known what each effect changes."""
        scene, modelling = self._session.scene, self._session.modelling
        return self._ticks.variants(scene).keys() <= self._meter.differences(scene, modelling).keys()

    def scene_changed(self, scene: Scene, settled: bool) -> None:
        """Show the values of the scene; while a slider moves, shortly after the record."""
        now = scene, self._session.modelling
        if now != self._followed:
            self._followed, self._due = now, True
            self._meter.stop()
        if settled:
            self._follow_history(scene)
            self.view.soon.stop()
            self._show()
        else:
            self.view.soon.call(self._show_moving)

    def record_grown(self, growth: RecordGrowth) -> None:
        """Enable the panel; measure the effects once the whole record is on screen."""
        self.view.setEnabled(True)
        if self._due and growth.current and growth.complete:
            self._due = False
            self.view.still.call(lambda: self._measure(growth))

    def entries(self) -> list[Entry]:
        """List the fields of the scene for the command palette, each of which comes into view and is lit."""
        fields = [field for section in sections_of(self._session.scene) for field in section.parameters]
        return [Entry("Parameter", each.name, each.tooltip, partial(self._point_to, each.path)) for each in fields]

    def _point_to(self, path: str) -> None:
        self._workbench.open_panel(self.name)
        self._workbench.light_fields((path,))

    def part_added(self, path: str) -> None:
        """Unfold the section of a new part."""
        self.view.turn_to(path)

    def fields_lit(self, paths: tuple[str, ...]) -> None:
        """Light rows; those that a scene has only later are lit then."""
        self._lit = paths
        self.view.light(paths)
        self._show_strip()

    def closing(self) -> None:
        """Drop the update that waits, and measure no more."""
        self.view.stop_waiting()
        self._meter.stop()

    def _follow_history(self, scene: Scene) -> None:
        """Forget what belongs to the scene that was open before."""
        if self._session.opened is not self._opened:
            self._opened = self._session.opened
            self._trials.forget()
            self.view.drop_glide()
        self._ticks.follow(scene, self._session.opened)
        self._resets.follow(self._session.opened)

    def _show(self) -> None:
        scene = self._session.scene
        self.view.about.say(split_description(scene.description), self._trials.tried(scene))
        self._shown = sections = self._sections()
        self.view.show_sections(sections)
        words = self.view.search.text().strip()
        self.view.show_found(found_section(scene, sections_of(scene), words) if words else None)
        self._show_strip()
        self.view.show_pictures(scene)
        rows = (row for section in sections for row in section.parameters)
        self.view.show_changed(self._resets.changed(scene, rows))
        self._show_effects()

    def _show_moving(self) -> None:
        """Show the numbers of a scene whose slider is held; the rest follows once it is let go."""
        sections = None if self.view.search.text() else follow_values(self._session.scene, self._shown)
        if sections is None:
            self._show()
        else:
            self._shown = sections
            self.view.show_values(sections)
            self._show_strip()
            self.view.show_pictures(self._session.scene)

    def _show_strip(self) -> None:
        """Show in the strip the fields that are lit, else those that the scene is about, else the first."""
        fields = {field.path: field for section in self._shown for field in section.parameters}
        about = [path for path in self._session.scene.controls if path in fields]
        lit = [path for path in self._lit if path in fields]
        self.strip.show_fields((alone(fields[path]) for path in lit or about or fields), lit)

    def _show_effects(self) -> None:
        scene = self._session.scene
        self.view.effects.show_rows(self._ticks.rows(scene, self._meter.differences(scene, self._session.modelling)))

    def _sections(self) -> tuple[FieldSection, ...]:
        """Sections of the scene, what it is about first."""
        scene = self._session.scene
        sections = sections_of(scene)
        pinned = pinned_section(scene, sections)
        return sections if pinned is None else (pinned, *sections)

    def _measure(self, growth: RecordGrowth) -> None:
        """Measure what each effect changes of the record on screen, unless the scene has changed since."""
        scene, modelling = self._session.scene, self._session.modelling
        if growth.answer.simulation.scene == scene:
            self._meter.begin(growth.answer.simulation, growth.record, modelling, self._ticks.variants(scene))
        self._show_effects()

    def _tick(self, name: str, on: bool) -> None:
        """Take an effect out, or bring it back as it was."""
        self._session.settle(self._ticks.tick(self._session.scene, name, on), describe_tick(name, on))

    def _follow(self, number: int) -> None:
        """Move the control that a link of the description speaks of, in sight, or move it back."""
        self.view.end_glide()
        link, changes = self._trials.follow(self._session.scene, number)
        rows = {row.path: row for section in sections_of(self._session.scene) for row in section.parameters}
        path = row_of(link.path, tuple(rows))
        self._workbench.light_fields((path,))
        row, value = rows.get(path), changes.get(path)
        if isinstance(row, NumberField) and isinstance(value, (int, float)):
            start, end = row, float(value)
            self.view.glide(
                lambda share: self._session.drag({path: _whole(start, glide_value(start, end, share))}),
                lambda: self._session.settle({path: _whole(start, end)}),
            )
        else:
            self._session.settle(changes)

    def _settle(self, path: str, value: Any) -> None:
        """Make an edit final; some choices need a file first."""
        if path == "seabed.relief.kind" and value == "dem":
            self._workbench.ask_for_dem(self._session.scene)
            self._session.settle()
        elif needs_file(self._session.scene, path, value):
            place = path.removesuffix("kind") + "path"
            file = self._workbench.ask_for_file(place)
            self._session.settle({path: value, place: file} if file else None)
            self._keep_recent(place, file)
        else:
            self._session.settle({path: value} if path else None)

    def _change_file(self, path: str) -> None:
        """Let the person pick another file for a field."""
        if path == "seabed.relief.path":
            self._workbench.ask_for_dem(self._session.scene)
        elif file := self._workbench.ask_for_file(path):
            self._session.settle({path: file})
            self._keep_recent(path, file)

    def _keep_recent(self, path: str, file: str) -> None:
        """Put a file among the recent ones, if a field took it over which a drop would give it to."""
        if path.startswith(DROPPED) and part_at(self._session.scene, path) == file:
            self._workbench.keep_recent(file)

    def _reset(self, paths: tuple[str, ...]) -> None:
        """Reset fields to the scene as it was opened."""
        changes = self._resets.edit(paths)
        self._session.settle(changes, f"{name_edit(self._session.scene, changes)} reset")

    def _duplicate(self, path: str) -> None:
        """Add a copy of a target beside it, not locked."""
        scene, index = self._session.scene, int(path.rpartition(".")[2])
        targets = plain(scene)["targets"]
        x, y, *height = targets[index]["position"]
        aside = round(ASIDE * scene.sonar.range, 1)
        copy = targets[index] | {"position": [x + aside, y, *height], "locked": False}
        if self._session.settle({"targets": [*targets, copy]}, f"{name_field(scene, path)} duplicated"):
            self.view.turn_to(f"targets.{len(targets)}")

    def _lock(self, path: str, locked: bool) -> None:
        """Lock a target, or unlock it."""
        name = f"{name_field(self._session.scene, path)} {'locked' if locked else 'unlocked'}"
        self._session.settle({f"{path}.locked": locked}, name)

    def _remove(self, path: str) -> None:
        """Remove the target or volume at a dotted path from the scene."""
        name, _, index = path.rpartition(".")
        parts = plain(self._session.scene)[name]
        del parts[int(index)]
        self._session.settle({name: parts}, f"{name_field(self._session.scene, path)} removed")


def _whole(number: NumberField, value: float) -> float | int:
    return round(value) if number.integer else value
