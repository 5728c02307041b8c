"""Explains the pinned pixel on another thread, and finds the pixels with echoes of a picked place."""

from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from insonify.scene import Scene, SceneError
from insonify_viewer.core_types import CrossSection, Listener, PixelExplanation, Simulation
from insonify_viewer.panels.panel import Button, Panel, Place, Workbench
from insonify_viewer.panels.pixel.view import PixelView
from insonify_viewer.record.comparison.recording import explain_point
from insonify_viewer.record.record import Record, RecordGrowth
from insonify_viewer.state.inspection import Mark, SoundDrawing
from insonify_viewer.state.inspection import Place as ScenePlace
from insonify_viewer.work.newest_wins import NewestWins

AROUND = 600  # pings to either side of the ping on top that may receive echoes of a place


@dataclass(frozen=True, eq=False)
class ExplainedPixel:
    """Explanation of a pixel, and the section through the scene that it lies in."""

    explanation: PixelExplanation
    section: CrossSection


class PixelPanel(Panel):
    """Shows the budget of the pinned pixel beside the plane of the beam."""

    name = "pixel"
    title = "Pixel"
    place = Place.BELOW
    button = Button("Explain a pixel", "See why a pixel that you click is bright or dark", "Ctrl+E", icon="explain")

    def __init__(self, workbench: Workbench) -> None:
        self._workbench = workbench
        self._executor = workbench.simulator.executor
        self._compiled: set[tuple[object, ...]] = set()  # modelled effects whose kernels are compiled
        self._simulation: Simulation | None = None
        send = partial(self._executor.submit, "pixel")
        self._question = NewestWins(lambda: self._wanted, send, _explained, self._take)
        self._record: Record | None = None
        self._newest = 0
        self._recorded: Mark | None = None  # the pixel of a recording that is shown
        self.view = PixelView()
        self.view.same_place.clicked.connect(self._pin_same_place)
        workbench.inspection.pinned.connect(self._pin)
        workbench.inspection.picked.connect(self._pick)
        workbench.recordings.clicked.connect(self._show_recorded)
        workbench.recordings.opened.connect(self._leave_recorded)

    @property
    def complete(self) -> bool:
        """Whether the pinned pixel is explained in the present scene, or there is none."""
        return self._question.complete

    @property
    def _wanted(self) -> tuple[Simulation, Mark] | None:
        mark = self._workbench.inspection.mark
        return None if mark is None or self._simulation is None else (self._simulation, mark)

    def record_grown(self, growth: RecordGrowth) -> None:
        """Explain the pinned pixel anew once another scene is traced at full accuracy."""
        self._record, self._newest = growth.record, int(growth.record.ping.max())
        if growth.current and growth.answer.simulation is not self._simulation:
            self._simulation = growth.answer.simulation
            self._explain()
        if growth.current and growth.complete:
            self._compile(growth.answer.simulation)

    def scene_changed(self, scene: Scene, settled: bool) -> None:
        """Let go of a pixel that the record no longer has."""
        mark = self._workbench.inspection.mark
        if settled and mark is not None and mark.bin >= scene.sonar.bins:
            self._workbench.inspection.pin(None)

    def _compile(self, simulation: Simulation) -> None:
        """Compile the kernels that the first click needs while nobody waits; each set of effects has its own."""
        model = simulation.plan.model
        effects = model.method, model.bent, model.bounces, model.targets, model.ways
        if effects not in self._compiled:
            self._compiled.add(effects)
            self._executor.submit("pixel kernels", lambda: _compile(simulation), lambda _: None)

    def _pin(self, mark: Mark | None) -> None:
        """Open the panel for a pinned pixel, and explain it."""
        if mark is None:
            self._question.forget()
            self.view.show_nothing()
            return
        self._workbench.open_panel(self.name)
        self._explain()

    def _show_recorded(self, mark: Mark) -> None:
        """Show what is known of a pixel of the recording, in the place of a pinned one."""
        recording = self._workbench.recordings.recording
        if recording is not None:
            self._workbench.inspection.pin(None)
            self._workbench.open_panel(self.name)
            self._recorded = mark
            self.view.show_recorded(*explain_point(recording, mark))

    def _pin_same_place(self) -> None:
        """Pin the pixel of the simulated record that lies where the one of the recording does."""
        live, beside = self._workbench.record_views
        found = self._recorded and self._workbench.comparison.links.find_place(beside, live, self._recorded)
        if found:
            self._workbench.inspection.pin(found)
        else:
            self._workbench.say("the simulated record does not reach there; scroll or zoom it, or set its range")

    def _leave_recorded(self, _: object) -> None:
        """Leave a pixel of a recording that is no longer shown."""
        if self._workbench.inspection.mark is None:
            self.view.show_nothing()

    def _explain(self) -> None:
        if self._question.ask() and self._wanted is not None:
            self.view.show_waiting(self._wanted[1])

    def _take(self, found: ExplainedPixel | SceneError | None) -> None:
        """Show an explanation, or why there is none."""
        if isinstance(found, ExplainedPixel):
            pixel = found.explanation.ping, found.explanation.side, found.explanation.bin
            amplitude = None if self._record is None else self._record.amplitude_at(*pixel)
            sentence = found.explanation.describe_brightness(amplitude)
            self.view.show_pixel(found.explanation, found.section, sentence)
            self._workbench.inspection.drawn.emit(_drawing(found.explanation))
        else:
            self.view.show_nothing()
            self._workbench.complain(found or SceneError("this pixel cannot be explained; click another one"))

    def _pick(self, place: ScenePlace | None) -> None:
        """Light up the pixels that receive an echo from a picked place."""
        simulation = self._simulation
        if place is None or simulation is None:
            return
        last = self._newest
        pings = np.arange(max(last - 2 * AROUND, 0), last + 1, dtype=np.int64)
        self._workbench.say("looking for the pixels that receive an echo from this place …")
        self._executor.submit("pixel", lambda: _listeners(simulation, place, pings), self._light)

    def _light(self, found: tuple[Listener, ...] | None) -> None:
        """Light the pixels up and say how many there are."""
        marks = tuple(Mark(each.ping, each.side, each.bin) for each in found or ())
        self._workbench.inspection.lit.emit(marks)
        ghosts = sum(each.path != "direct" for each in found or ())
        self._workbench.say(_words(len(marks) - ghosts, ghosts))


def _words(direct: int, ghosts: int) -> str:
    """Sentence with the number of pixels that receive echoes of a place."""
    if not direct + ghosts:
        return "no pixel of the record receives an echo from this place: it is hidden or outside the beam"
    words = f"{direct} {'pixel receives' if direct == 1 else 'pixels receive'} a direct echo from this place"
    return words + (f", and {ghosts} an echo by way of the sea surface" if ghosts else "")


def _compile(simulation: Simulation) -> None:
    # lazy: loads Numba on the thread of the panel; the window opens before
    from insonify.explanation.compilation import compile_explanations

    compile_explanations(simulation)


def _explained(simulation: Simulation, mark: Mark) -> Any:
    # lazy: loads Numba on the thread of the panel; the window opens before
    from insonify.explanation.cross_section import cut_cross_section
    from insonify.explanation.pixel import explain_pixel

    try:
        explanation = explain_pixel(simulation, mark.ping, mark.side, mark.bin)
        return ExplainedPixel(explanation, cut_cross_section(simulation, mark.ping, mark.side))
    except SceneError as error:
        return error


def _listeners(simulation: Simulation, place: ScenePlace, pings: Any) -> tuple[Listener, ...]:
    # lazy: loads Numba on the thread of the panel; the window opens before
    from insonify.explanation.listeners import find_listeners

    return find_listeners(simulation, np.array(place), pings)


def _drawing(explanation: PixelExplanation) -> SoundDrawing:
    """Lines of an explanation in three dimensions."""
    nothing = np.empty((0, 2, 3))
    return SoundDrawing(
        rays=tuple(ray for each in explanation.contributions for ray in each.rays),
        blocked=tuple(ray for each in explanation.obstructions for ray in each.rays),
        echoing=np.concatenate([nothing, *(each.places for each in explanation.contributions)]),
        hidden=np.concatenate([nothing, *(each.places for each in explanation.obstructions)]),
    )
