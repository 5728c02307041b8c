"""Plots with axes, zoom, marks to move by mouse and keys, and a menu that copies or saves them."""

import sys
import threading
from collections.abc import Sequence
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

from PySide6.QtCore import QEvent, QObject, QPoint, QPointF, QRect, QSize, Qt, QTimer, Signal
from PySide6.QtGui import QColor, QFocusEvent, QGuiApplication, QKeyEvent, QMouseEvent, QPainter, QPaintEvent
from PySide6.QtSvg import QSvgGenerator
from PySide6.QtWidgets import QLabel, QVBoxLayout, QWidget

from insonify.io.atomic import replacing
from insonify_viewer.errors import guard_override
from insonify_viewer.state.quantities import nearest_within
from insonify_viewer.widgets.arrow_keys import steps_of
from insonify_viewer.widgets.buttons import make, make_action
from insonify_viewer.widgets.layouts import fill
from insonify_viewer.widgets.save_dialogs import ask_where_to_save, save_pixmap
from insonify_viewer.widgets.theme import ACCENT, GROUND, MARK, RAISED

if TYPE_CHECKING:
    from insonify_viewer.widgets.plot_canvas import Canvas as Canvas
else:
    Canvas = Any

LOADER, CANVAS = "insonify plots", "insonify_viewer.widgets.plot_canvas"
GRASP = 12.0  # px, greatest distance at which a mark is grasped
STILL = 4  # px, that a click may move
MARK_SIZE = 10.0  # px
FORMATS = (("picture", ".png"), ("drawing", ".svg"), ("table of its curves", ".csv"))
FORTH, BACK = Qt.FocusReason.TabFocusReason, Qt.FocusReason.BacktabFocusReason
REDRAWN = QEvent.Type.PaletteChange, QEvent.Type.StyleChange, QEvent.Type.FontChange, QEvent.Type.EnabledChange
SOON = 10  # ms, before a plot in view is drawn again
Point = tuple[float, float]


def load_canvas() -> bool:
    """Whether pyqtgraph is loaded; it is loaded beside the window, which opens before and stays usable meanwhile."""
    if any(thread.name == LOADER for thread in threading.enumerate()):
        return False
    if CANVAS not in sys.modules:
        threading.Thread(target=import_module, args=(CANVAS,), name=LOADER, daemon=True).start()
    return CANVAS in sys.modules


def plots_are_drawn(window: QWidget) -> bool:
    """Whether no plot that is in view below a widget is still to be drawn."""
    return not any(plot.waits for plot in window.findChildren(Plot))


class Plot(QWidget):
    """A plot that is drawn when it is in view and what it shows has changed.

    A subclass overrides `draw`. All places are coordinates of the plot.
    """

    # Marks are moved with the mouse; where the keyboard reaches the plot, the Tab key goes from one to the next and
    # arrow keys move the chosen one.

    hovered = Signal(float, float)
    clicked = Signal(float, float)
    dragged = Signal(int, float, float)  # a mark, and where it is moved to
    released = Signal()  # the mark that was moved

    marks: Sequence[Point] = ()
    ground: QColor | str = RAISED
    note_below: float | None = None  # the y below which words over the plot stand, where that is not its upper edge
    steps: Point = (1.0, 1.0)  # of an arrow key, to the right and down

    def __init__(
        self,
        name: str,
        tip: str = "",
        *,
        x: str = "",
        y: str = "",
        grid: bool = True,
        still: bool = False,
        **properties: Any,
    ) -> None:
        super().__init__(**properties)
        self.setAccessibleName(name)
        self.setToolTip(tip)
        self.words = x, y  # of the axes
        self._grid, self._still = grid, still
        self._canvas: Canvas | None = None
        self._due = True
        self._limits: tuple[Point, Point] | None = None
        self.chosen = 0  # mark that keys move
        self._held: int | None = None  # mark that the mouse moves
        self.keyed = False  # whether a key that is down has moved a mark
        self._pressed = QPoint()
        self._soon = QTimer(self, singleShot=True, interval=SOON)
        self._soon.timeout.connect(self._draw_in_view)
        self.note = make(QLabel, parent=self, wordWrap=True, objectName="note", textFormat=Qt.TextFormat.RichText)
        self.note.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        self.note.hide()
        self._column = fill(QVBoxLayout(self), margins=(0, 0, 0, 0))
        self.setContextMenuPolicy(Qt.ContextMenuPolicy.ActionsContextMenu)
        self.addAction(make_action(self, "Copy picture", "Copy the plot as a picture", do=self.copy))
        self.addAction(make_action(self, "Save plot…", "Save the plot as a picture or a table", do=self._ask_and_save))
        if not still:
            self.addAction(make_action(self, "Whole plot", "Show the whole plot again", do=self.show_all))

    def draw(self, canvas: Canvas) -> None:
        """Draw on a blank canvas what is shown now."""
        raise NotImplementedError

    def shown_marks(self) -> Sequence[Point]:
        """Return the marks that are drawn."""
        return self.marks

    @property
    def canvas(self) -> Canvas:
        """The canvas, made for the first plot in view."""
        if self._canvas is None:
            # lazy: the window opens before pyqtgraph is loaded
            from insonify_viewer.widgets import plot_canvas

            self._canvas = plot_canvas.Canvas(still=self._still)
            self._canvas.viewport().installEventFilter(self)
            self._column.addWidget(self._canvas)
            self._canvas.show()
            self._column.activate()
            self.note.raise_()
        return self._canvas

    @property
    def surface(self) -> QWidget:
        """The widget to which the mouse points."""
        return self.canvas.viewport()

    @property
    def area(self) -> QRect:
        """The part within the axes, px."""
        return self.canvas.mapFromScene(self.canvas.plotItem.vb.sceneBoundingRect()).boundingRect()

    def place_of(self, x: float, y: float) -> QPoint:
        """Place of a point in px."""
        return self.canvas.place_of(x, y).toPoint()

    def redraw(self) -> None:
        """Draw again soon, or when the plot comes into view."""
        self._due = True
        self._soon.start()

    def limit(self, x: Point, y: Point) -> None:
        """Show a range of both axes; the person may zoom into it. Nothing changes while a mark is moved."""
        if (x, y) != self._limits and not self.moving:
            self._limits = x, y
            canvas = self.canvas
            canvas.setLimits(xMin=x[0], xMax=x[1], yMin=min(y), yMax=max(y))
            canvas.plotItem.vb.invertY(y[0] > y[1])
            self.show_all()

    def show_all(self) -> None:
        """Show the whole range."""
        if self._limits is not None:
            (left, right), (low, high) = self._limits
            self.canvas.setRange(xRange=(left, right), yRange=(min(low, high), max(low, high)), padding=0.0)

    def say(self, *lines: tuple[object, str]) -> None:
        """Write lines, each with its colour, over the upper right part of the plot."""
        self.note.setText("<br>".join(f'<span style="color:{colour}">{words}</span>' for colour, words in lines))
        self.note.setVisible(bool(lines))

    @property
    def moving(self) -> bool:
        """Whether a mark is being moved."""
        return self._held is not None or self.keyed

    def copy(self) -> None:
        """Copy the plot as a picture."""
        QGuiApplication.clipboard().setPixmap(self.grab())

    def save(self, path: Path) -> None:
        """Write the plot as a picture, a drawing or a table, by the name of the file."""
        if path.suffix == ".png":
            save_pixmap(self.grab(), path)
            return
        with replacing(path) as beside:
            if path.suffix == ".csv":
                self.canvas.save_table(str(beside))
                return
            drawing = QSvgGenerator()
            drawing.setFileName(str(beside))
            drawing.setSize(self.size())
            drawing.setViewBox(QRect(QPoint(0, 0), self.size()))
            with QPainter(drawing) as painter:
                self.canvas.render(painter)

    def _ask_and_save(self) -> None:
        path = ask_where_to_save(self, "Save the plot", "plot.png", FORMATS)
        if path is not None:
            self.save(path)

    def _draw_in_view(self) -> None:
        if self.waits:
            self.draw_now() if load_canvas() else self._soon.start()

    @property
    def waits(self) -> bool:
        """Whether it is in view and still to be drawn."""
        shown = self if self._canvas is None else self._canvas.viewport()
        return self._due and self.isEnabled() and not shown.visibleRegion().isEmpty()

    def draw_now(self) -> None:
        """Draw what has changed."""
        self._due = False
        canvas = self.canvas
        canvas.begin(*self.words, self.ground, grid=self._grid)
        self.draw(canvas)
        lit = self._held if self._held is not None else self.chosen if self.hasFocus() else -1
        for number, mark in enumerate(self.shown_marks()):
            canvas.dots([mark], ACCENT if number == lit else MARK, MARK_SIZE, GROUND)
        canvas.plotItem.layout.activate()  # else places would be those of the axes before
        self._lay_note()

    def _lay_note(self) -> None:
        if not self.note.isHidden() and self._canvas is not None:
            area, note = self.area, self.note
            note.ensurePolished()
            note.setWordWrap(False)
            width = min(note.sizeHint().width(), max(area.width() - 16, 1))
            note.setWordWrap(True)
            top = area.top() + 6 if self.note_below is None else self.place_of(0.0, self.note_below).y() + 2
            left = max(area.right() - 8 - width, area.left() + 8)
            note.setGeometry(left, top, width, note.heightForWidth(width))

    def _mark_near(self, place: QPointF) -> int | None:
        """Nearest mark within grasp."""
        return nearest_within([self.distance(mark, place) for mark in self.marks], GRASP)

    def distance(self, mark: Point, place: QPointF) -> float:
        """Distance of a mark from a place of the mouse, px."""
        return (self.canvas.place_of(*mark) - place).manhattanLength()

    @guard_override(QSize())
    def sizeHint(self) -> QSize:
        """Preferred size."""
        return QSize(300, 160)

    @guard_override(None)
    def paintEvent(self, _: QPaintEvent) -> None:
        """Draw soon what has come into view."""
        if self._due:
            self._soon.start()

    @guard_override(None)
    def changeEvent(self, event: QEvent) -> None:
        """Draw again in another theme or size of text."""
        super().changeEvent(event)
        if event.type() in REDRAWN:
            self.redraw()

    @guard_override(False)
    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Move marks with the mouse, and signal clicks and moves elsewhere; all else is left to the canvas."""
        kind = event.type()
        if kind is QEvent.Type.Paint and self._due:
            self._soon.start()
        elif kind is QEvent.Type.Resize:
            self.redraw()
        if not isinstance(event, QMouseEvent):
            return False
        place = event.position()
        if kind is QEvent.Type.MouseMove:
            return self._follow_mouse(place)
        if event.button() is not Qt.MouseButton.LeftButton:
            return False
        if kind is QEvent.Type.MouseButtonPress:
            self._pressed, self._held = place.toPoint(), self._mark_near(place)
            if self._held is not None:
                self.chosen = self._held
                self.redraw()
                return True
        elif kind is QEvent.Type.MouseButtonRelease and self._held is not None:
            self._held = None
            self.released.emit()
            self.redraw()
            return True
        elif kind is QEvent.Type.MouseButtonRelease:
            moved = (place.toPoint() - self._pressed).manhattanLength()
            if moved <= STILL and self.area.contains(place.toPoint()):
                self.clicked.emit(*self.canvas.at(place))
        return False

    def _follow_mouse(self, place: QPointF) -> bool:
        """Move the mark that is held, else signal where the mouse is."""
        if self._held is not None:
            self.dragged.emit(self._held, *self.canvas.at(place))
            return True
        shape = Qt.CursorShape.ArrowCursor if self._mark_near(place) is None else Qt.CursorShape.OpenHandCursor
        self.surface.setCursor(shape)
        self.hovered.emit(*self.canvas.at(place))
        return False

    @guard_override(False)
    def focusNextPrevChild(self, forth: bool) -> bool:
        """Choose the next mark before the keyboard goes elsewhere."""
        chosen = self.chosen + (1 if forth else -1)
        if not 0 <= chosen < len(self.marks):
            return super().focusNextPrevChild(forth)
        self._choose(chosen)
        return True

    @guard_override(None)
    def focusInEvent(self, event: QFocusEvent) -> None:
        """Begin at the end of the marks from which the Tab key comes."""
        super().focusInEvent(event)
        last = max(len(self.marks) - 1, 0)
        self._choose(min({FORTH: 0, BACK: last}.get(event.reason(), self.chosen), last))

    @guard_override(None)
    def focusOutEvent(self, event: QFocusEvent) -> None:
        """Release the mark that a pressed key still moves."""
        self._choose(self.chosen)
        super().focusOutEvent(event)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Move the chosen mark."""
        steps = steps_of(event)
        if steps is None or self.chosen >= len(self.marks):
            super().keyPressEvent(event)
            return
        x, y = self.marks[self.chosen]
        self.keyed = True
        self.dragged.emit(self.chosen, x + steps[0] * self.steps[0], y + steps[1] * self.steps[1])

    def keyReleaseEvent(self, event: QKeyEvent) -> None:
        """Release a mark that a key has moved, once, however long the key was held."""
        if not event.isAutoRepeat():
            self._settle()
        super().keyReleaseEvent(event)

    def _choose(self, chosen: int) -> None:
        self._settle()
        self.chosen = chosen
        self.redraw()

    def _settle(self) -> None:
        if self.keyed:
            self.keyed = False
            self.released.emit()
            self.redraw()
