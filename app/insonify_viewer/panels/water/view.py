"""Sound-speed profile with points to drag, beside the rays that it bends."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from PySide6.QtCore import QPointF, Qt, Signal
from PySide6.QtGui import QKeyEvent
from PySide6.QtWidgets import QHBoxLayout, QWidget

from insonify.arrays import Floats
from insonify.display.ray_diagram.diagram import RayDiagram, compute_speed_limits, describe_eigenray, place_along_axis
from insonify_viewer.widgets.arrow_keys import ENTER, modifiers_of
from insonify_viewer.widgets.layouts import fill
from insonify_viewer.widgets.plot import Canvas, Plot
from insonify_viewer.widgets.theme import ACCENT_IN_WATER, HALO, MARK_IN_WATER, OVER_WATER, QUIET, TEXT

SPEED, DEPTH = 0.2, 0.1  # m/s and m, by which a key moves a point of the profile
KEY_STEP = 0.01  # of the range and of the depth, by which a key moves the cross in the water
HINT = (
    "Drag the points of the sound-speed profile. Click in the water to see which rays reach that place. Keys: Tab "
    "chooses a point or the cross in the water, arrow keys move it, Return finds the rays to the cross."
)
BED_SHARE = ABOVE = 0.12  # of the depth, drawn below the bed and above the surface
# Colours of sound speed, from slow to fast.
NIGHT = np.array([(28, 70, 108), (38, 62, 84), (62, 59, 56), (106, 80, 46)], dtype=np.float64)
RAY, BED, BED_EDGE, SHADE = "#6f92ad", "#4b3f2d", "#8a7450", (2, 4, 7, 190)
ON_BED = "#9cc3e2"
EIGENRAYS = (ACCENT_IN_WATER, "#7bd389", "#f26d6d", "#c792ea")
ROWS, COLUMNS = 128, 64  # size of the sound-speed picture
LABEL = 40  # px, beyond the range
NARROWEST, WIDEST = 110, 220  # px, of the profile

Points = tuple[tuple[float, float], ...]


class WaterView(QWidget):
    """Shows a ray diagram, and signals drags and clicks, which keys do as well."""

    # The Tab key goes from point to point of the profile, then to a cross in the water.

    point_dragged = Signal(int, float, float)  # number, depth and speed
    point_settled = Signal()
    targeted = Signal(float, float)  # range and depth

    def __init__(self) -> None:
        super().__init__()
        self.setMinimumHeight(150)
        self.profile, self.rays = ProfilePlot(), RayPlot()
        self.profile.dragged.connect(lambda number, speed, depth: self.point_dragged.emit(number, depth, speed))
        self.profile.released.connect(self.point_settled)
        self.rays.targeted.connect(self.targeted)
        row = fill(QHBoxLayout(self), margins=(0, 0, 0, 0), spacing=0)
        row.addWidget(self.profile, 2)
        row.addWidget(self.rays, 9)

    def show_points(self, points: Points) -> None:
        """Show the points of the present profile, depth and speed; its rays may still be under way."""
        self.profile.show_points(points)

    def show_diagram(self, diagram: RayDiagram) -> None:
        """Show a diagram."""
        for plot in (self.profile, self.rays):
            plot.show_diagram(diagram)


class _WaterPlot(Plot):
    """A plot over depth, down to below the bed."""

    def __init__(self, name: str, **properties: Any) -> None:
        super().__init__(name, HINT, focusPolicy=Qt.FocusPolicy.StrongFocus, still=True, **properties)
        self.diagram: RayDiagram | None = None

    def show_diagram(self, diagram: RayDiagram) -> None:
        """Show another diagram."""
        self.diagram = diagram
        self.redraw()

    def draw(self, canvas: Canvas) -> None:
        """Draw the bed and what a plot shows above it."""
        canvas.unit("left", "m")
        if self.diagram is None:
            self.say((OVER_WATER, "tracing rays …"))
            return
        self.draw_water(canvas, self.diagram)

    def draw_water(self, canvas: Canvas, diagram: RayDiagram) -> None:
        """Draw what the plot shows of a diagram."""
        raise NotImplementedError

    def draw_bed(self, canvas: Canvas, diagram: RayDiagram, ends: tuple[float, float]) -> None:
        """Draw the bed, and show all of the depth."""
        below = (1.0 + BED_SHARE) * diagram.bottom
        canvas.area(np.array(ends), np.full(2, below), diagram.bottom, BED)
        canvas.rule(diagram.bottom, BED_EDGE, upright=False, style=Qt.PenStyle.SolidLine)
        self.limit(ends, (below, -ABOVE * diagram.bottom))


class ProfilePlot(_WaterPlot):
    """Sound speed over depth, with points to drag."""

    steps = SPEED, DEPTH

    def __init__(self) -> None:
        super().__init__("Sound speed over depth", x="speed (m/s)")
        self.setMinimumWidth(NARROWEST)
        self.setMaximumWidth(WIDEST)
        self.points: Points = ()

    def show_points(self, points: Points) -> None:
        """Show other points."""
        self.points = points
        bottom = np.inf if self.diagram is None else self.diagram.bottom
        self.marks = [(speed, depth) for depth, speed in points if depth <= bottom]
        self.redraw()

    def show_diagram(self, diagram: RayDiagram) -> None:
        """Show the profile of another diagram, with its points in sight."""
        super().show_diagram(diagram)
        self.show_points(self.points)

    def draw_water(self, canvas: Canvas, diagram: RayDiagram) -> None:
        """Draw the profiles and the depth of the sonar."""
        self.say()
        self.draw_bed(canvas, diagram, compute_speed_limits(diagram))
        canvas.rule(diagram.source_depth, QUIET, upright=False, style=Qt.PenStyle.DashLine)
        layers = diagram.layers
        within = layers.depth[(layers.depth > 0.0) & (layers.depth < diagram.bottom)]
        depth = np.concatenate([[0.0], within, [diagram.bottom]])
        for number, profile in enumerate(layers.speed):
            share = number / max(len(layers.speed) - 1, 1)
            canvas.line(np.interp(depth, layers.depth, profile), depth, TEXT if share < 0.5 else QUIET, 2.0 - share)


class RayPlot(_WaterPlot):
    """Rays over range and depth, in water coloured by its sound speed."""

    targeted = Signal(float, float)
    note_below = 0.0  # the labels of the rays stand above the surface

    def __init__(self) -> None:
        super().__init__("Rays in the water", x="range (m)", grid=False)
        self.dragged.connect(lambda _, *place: self._move(*place))
        self.clicked.connect(self._aim)

    def show_diagram(self, diagram: RayDiagram) -> None:
        """Show another diagram; the cross stays where it is."""
        super().show_diagram(diagram)
        self.steps = KEY_STEP * diagram.reach, KEY_STEP * diagram.bottom
        self.marks = self.marks or [(0.5 * diagram.reach, 0.5 * diagram.bottom)]

    def shown_marks(self) -> Sequence[tuple[float, float]]:
        """Show the cross to the keyboard."""
        return self.marks if self.hasFocus() else ()

    def distance(self, mark: tuple[float, float], place: QPointF) -> float:
        """Distance of the mouse from the place to which rays are shown, which it can drag."""
        return super().distance(mark, place) if self.diagram is not None and self.diagram.target else np.inf

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Find the rays to the cross, or move it."""
        if self.marks and event.key() in ENTER and not modifiers_of(event):
            self.targeted.emit(*self.marks[0])
        else:
            super().keyPressEvent(event)

    def draw_water(self, canvas: Canvas, diagram: RayDiagram) -> None:
        """Draw water, rays, bed, labels and what is said of them."""
        ends = 0.0, diagram.reach
        canvas.hideAxis("left")
        canvas.picture(_water_picture(diagram), ends, (0.0, diagram.bottom))
        shade = np.zeros((*diagram.shadow.shape, 4), dtype=np.uint8)
        shade[diagram.shadow] = SHADE
        canvas.picture(shade, ends, (0.0, diagram.bottom))
        canvas.line(*_joined([(path.range, path.depth) for path in diagram.rays]), RAY, 1.0)
        canvas.dots(diagram.caustics, MARK_IN_WATER, 2.0)
        for number, path in enumerate(diagram.eigenrays):
            canvas.line(path.range, path.depth, EIGENRAYS[number % len(EIGENRAYS)], 2.4)
        self.draw_bed(canvas, diagram, (-0.02 * ends[1], ends[1] * (1.0 + LABEL / self.area.width())))
        for begin, end in diagram.dark:
            canvas.line(np.array([begin, end]), np.full(2, diagram.bottom), "#000000", 4.0)
        canvas.dots([(0.0, diagram.source_depth)], OVER_WATER, 10.0, HALO)
        if diagram.target is not None:
            canvas.dots([diagram.target], HALO, 9.0, OVER_WATER)
        _label_rays(canvas, diagram)
        self.say(*_sentences(diagram))

    def _move(self, distance: float, depth: float) -> None:
        """Move the cross within the water; the rays follow the mouse at once."""
        assert self.diagram is not None
        self.marks = [
            (min(max(distance, self.steps[0]), self.diagram.reach), min(max(depth, 0.0), self.diagram.bottom))
        ]
        self.redraw()
        if not self.keyed:
            self.targeted.emit(*self.marks[0])

    def _aim(self, distance: float, depth: float) -> None:
        """Find the rays to a place of the water."""
        if self.diagram is not None and distance > 0.0:
            self._move(distance, depth)


def _water_picture(diagram: RayDiagram) -> Floats:
    """Picture of the water, coloured by sound speed, the surface first."""
    slowest, fastest = compute_speed_limits(diagram)
    x, depth = np.linspace(0.0, diagram.reach, COLUMNS), np.linspace(0.0, diagram.bottom, ROWS)
    speed = diagram.layers.speed_at(*place_along_axis(diagram.layers, x[None, :]), depth[:, None])
    share = (np.broadcast_to(speed, (ROWS, COLUMNS)) - slowest) / (fastest - slowest)
    places = np.linspace(0.0, 1.0, len(NIGHT))
    return np.stack([np.interp(share, places, tone) for tone in NIGHT.T], axis=-1).astype(np.uint8)


def _joined(paths: list[tuple[Floats, Floats]]) -> tuple[Floats, Floats]:
    """Points of all paths, with a gap behind each."""
    gap = np.full(1, np.nan)
    x, y = (np.concatenate([part for path in paths for part in (path[axis], gap)] or [gap]) for axis in (0, 1))
    return x, y


def _label_rays(canvas: Canvas, diagram: RayDiagram) -> None:
    """Label ray ends with launch angles, the roundest first, where there is room."""
    for path in sorted(diagram.rays, key=lambda path: (path.angle % 10.0 != 0.0, path.angle % 5.0 != 0.0)):
        x, y = float(path.range[-1]), float(path.depth[-1])
        leaves, on_bed = x >= diagram.reach * (1.0 - 1e-9), y > 0.5 * diagram.bottom
        anchor = (0.0, 0.5) if leaves else (0.5, 0.0) if on_bed else (0.5, 1.0)
        colour = QUIET if leaves or not on_bed else ON_BED
        canvas.words(f"{path.angle:.3g}°".replace("-", "−"), x, y, colour, anchor)


def _sentences(diagram: RayDiagram) -> list[tuple[str, str]]:
    """Describe the eigenrays, where no sound reaches the bed, and formulas beyond their range, with their colours."""
    lines = [(EIGENRAYS[k % len(EIGENRAYS)], describe_eigenray(path)) for k, path in enumerate(diagram.eigenrays)]
    if diagram.target is not None and not lines:
        lines = [(OVER_WATER, "no direct ray reaches this point: it lies in a shadow zone")]
    for begin, end in diagram.dark:
        place = f"beyond {begin:.1f} m" if end >= diagram.reach else f"from {begin:.1f} to {end:.1f} m"
        lines.append((OVER_WATER, f"no sound on the bed {place}"))
    return lines + [(OVER_WATER, sentence) for sentence in diagram.limits]
