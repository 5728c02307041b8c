"""The marked point of the record: ranges, bed, intensity and label, and their look-up."""

from __future__ import annotations

import math
from collections import OrderedDict
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from insonify.arrays import Singles
from insonify.explanation.words import PATH_NAMES, name_materials, name_part
from insonify_viewer.core_types import LevelBed, RecordLabels, Simulation
from insonify_viewer.record.record import Record
from insonify_viewer.state.inspection import Mark
from insonify_viewer.work.executor import Executor
from insonify_viewer.work.ping_request import TracedPings

Position = tuple[float, float, float]
BED = -1
HIDDEN = 0.5  # share of the bed's echo that is hidden where a bin counts as shadow
LEAST = 0.05  # share hidden that is worth telling
KEPT = 32  # pings whose labels are kept


@dataclass(frozen=True)
class MarkedPoint:
    """What the record and the scene hold at a point of the record."""

    mark: Mark  # ping, side and bin of the point
    slant_range: float  # as recorded, in metres
    ground_range: float | None  # in metres; None in the water column
    # (float, float, float) local coordinates of the bed there; None in the water column or where there is no bed.
    position: Position | None
    intensity: float  # linear, before display gain
    label: PixelLabel | None = None  # what the bin shows; None while it is not known
    error: float = math.nan  # estimated, as a share of the mean echo of the bin; NaN where it is not known


def marked_point(simulation: Simulation, record: Record, level: LevelBed, mark: Mark) -> MarkedPoint | None:
    """Look a point of the record up."""
    amplitude = record.amplitude_at(mark.ping, mark.side, mark.bin)
    if amplitude is None or mark.bin >= simulation.scene.sonar.bins:
        return None
    intensity = amplitude**2 * float(level.curves(np.array([mark.ping]))[0, 0, mark.bin])
    return MarkedPoint(mark, *locate_mark(simulation, mark), intensity)


def locate_mark(simulation: Simulation, mark: Mark) -> tuple[float, float | None, Position | None]:
    """Find where a point of the record lies, on a bed that is level across the track."""
    sonar, ground = simulation.scene.sonar, simulation.ground
    slant = (mark.bin + 0.5) * sonar.range / sonar.bins
    pose = simulation.poses(np.array([mark.ping], dtype=np.int64))
    below = float(ground.height_at_once(pose.x, pose.y)[0])
    height = float(pose.z[0]) - (0.0 if math.isnan(below) else below)
    true_slant = (mark.bin + 0.5) * simulation.arrays.bin_length
    # The beam is a cone about the fish's axis, squinted from the plane athwart; with the bow up it leans forward.
    pitch, squint = float(pose.pitch[0]), simulation.arrays.pattern.centre
    ahead = (squint * true_slant + height * math.sin(pitch)) / math.cos(pitch)
    if true_slant < math.hypot(height, ahead):
        return slant, None, None
    across = math.sqrt(true_slant**2 - height**2 - ahead**2)
    left = across if mark.side == 0 else -across
    cos, sin = math.cos(float(pose.heading[0])), math.sin(float(pose.heading[0]))
    x, y = float(pose.x[0]) + ahead * cos - left * sin, float(pose.y[0]) + ahead * sin + left * cos
    z = float(ground.height_at_once(np.array([x]), np.array([y]))[0])
    return slant, math.hypot(across, ahead), None if math.isnan(z) else (x, y, z)


@dataclass(frozen=True)
class PixelLabel:
    """The label of one bin."""

    source: str = ""  # what the greatest echo comes from: ``pipe 1``, ``bed``; empty without an echo
    material: str = ""  # of the source; empty where it has none
    ghost: str = ""  # the path of that echo in words; empty for the direct one
    shadow: str = ""  # what hides the bed there: ``shadow of pipe 1``; empty where no target hides it
    ground_range: float | None = None  # of the echo, in metres
    incidence: float | None = None  # on the source, in degrees

    @property
    def words(self) -> list[str]:
        """The label as it is read, part by part."""
        echo = ", ".join(filter(None, (self.source, self.material)))
        parts = [f"{self.ghost} ({echo})" if self.ghost and echo else self.ghost or echo, self.shadow]
        if self.incidence is not None:
            parts.append(f"incidence {self.incidence:.0f}°")
        return [part for part in parts if part]


def label_bin(simulation: Simulation, labels: RecordLabels, side: int, range_bin: int) -> PixelLabel:
    """Read the label of one bin."""
    # lazy: loads Numba; the window opens before
    from insonify.tracers.labels import PATHS

    place = (0, side, range_bin)
    scene = simulation.scene
    shadow = _shadow(scene.targets, float(labels.shadow[place]), int(labels.shadow_id[place]))
    volume = int(labels.volume_id[place])
    if volume >= 0:
        return PixelLabel(source=name_part(scene.volumes[volume], volume), shadow=shadow)
    target, row, path = int(labels.target_id[place]), int(labels.material[place]), int(labels.path[place])
    return PixelLabel(
        source=name_part(scene.targets[target], target) if target >= 0 else "bed" if target == BED else "",
        material=name_materials(scene, simulation.ground)[row] if row >= 0 else "",
        ghost=PATH_NAMES[PATHS[path]] if path > 0 else "",  # the first is the direct one
        shadow=shadow,
        ground_range=_number(labels.ground_range[place]),
        incidence=_number(labels.incidence[place]),
    )


def _shadow(targets: tuple[object, ...], share: float, index: int) -> str:
    if index < 0 or share < LEAST:
        return ""
    of = f"shadow of {name_part(targets[index], index)}"
    return of if share >= HIDDEN else f"{100 * share:.0f} % in the {of}"


def _number(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None


class MarkController:
    """Looks marked points up; their labels come from another thread, a moment later."""

    # On endless ground, whose heights may take a second, the points come from another thread too.

    def __init__(
        self,
        show: Callable[[MarkedPoint | None], None],
        executor: Executor,
    ) -> None:
        self._show = show
        self._executor = executor
        self._wanted: Mark | None = None
        self._simulation: Simulation | None = None
        self._labels: OrderedDict[int, RecordLabels | None] = OrderedDict()
        self._errors: tuple[int, Singles | None] = (-1, None)  # of the bins of one ping
        self._point: MarkedPoint | None = None
        self._labelled = False  # whether kernels are there: those of labels would be compiled before all others

    def show(self, mark: Mark | None, answer: TracedPings | None, record: Record) -> None:
        """Show a point of the record; nothing where the record is empty."""
        # lazy: the window opens before Numba is loaded
        from insonify.terrain import EndlessGround

        self._wanted = mark
        if mark is None or answer is None:
            self._show_point(None)
            return
        simulation = answer.simulation
        if simulation is not self._simulation:
            self._simulation = simulation
            self._labels.clear()
            self._errors = -1, None

        def find() -> MarkedPoint | None:
            return marked_point(simulation, record, answer.level, mark)

        def take(point: MarkedPoint | None) -> None:
            if mark == self._wanted and simulation is self._simulation:
                self._take(simulation, point)

        self._labelled = not answer.example
        if isinstance(simulation.ground, EndlessGround) or answer.example:
            self._executor.submit("points", find, take)
        else:
            take(find())

    def _take(self, simulation: Simulation, point: MarkedPoint | None) -> None:
        """Show a point, and request its label."""
        self._show_point(point)
        if point is not None and self._labelled and point.mark.ping not in self._labels:
            self._ask(simulation, point.mark.ping)
        if point is not None and self._labelled and point.mark.ping != self._errors[0]:
            self._ask_for_errors(simulation, point.mark.ping)

    def _ask_for_errors(self, simulation: Simulation, ping: int) -> None:
        """Estimate the errors of the bins of a ping on another thread; a request replaces one that waits."""
        # lazy: loads Numba on the thread; the window opens before
        from insonify.explanation.pixel import find_bin_errors

        def take(errors: Singles | None) -> None:
            if simulation is self._simulation:
                self._errors = ping, errors
                if self._point is not None and self._point.mark.ping == ping:
                    self._show_point(self._point)

        pings = np.array([ping], dtype=np.int64)
        self._executor.submit("errors", lambda: find_bin_errors(simulation, pings), take)

    def _ask(self, simulation: Simulation, ping: int) -> None:
        def take(labels: RecordLabels | None) -> None:
            if simulation is self._simulation:
                self._keep(ping, labels)

        self._executor.submit("labels", lambda: simulation.truth(np.array([ping], dtype=np.int64)), take)

    def _keep(self, ping: int, labels: RecordLabels | None) -> None:
        """Keep the labels of a ping, and show the point anew if it lies there."""
        self._labels[ping] = labels
        while len(self._labels) > KEPT:
            self._labels.popitem(last=False)
        if self._point is not None and self._point.mark.ping == ping:
            self._show_point(self._point)

    def _show_point(self, point: MarkedPoint | None) -> None:
        if point is not None and self._simulation is not None:
            labels = self._labels.get(point.mark.ping)
            if labels is not None:
                label = label_bin(self._simulation, labels, point.mark.side, point.mark.bin)
                point = replace(point, label=label)
            ping, errors = self._errors
            if errors is not None and ping == point.mark.ping:
                point = replace(point, error=float(errors[0, point.mark.side, point.mark.bin]))
        self._point = point
        self._show(point)
