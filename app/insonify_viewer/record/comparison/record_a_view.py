"""View of record A: beside the live record, or laid over it, pixel for pixel."""

from dataclasses import replace

from PySide6.QtCore import QEvent, QObject, QRect
from PySide6.QtGui import QPainter
from PySide6.QtWidgets import QSplitter, QWidget

from insonify_viewer.errors import guard_override
from insonify_viewer.record.projection import Zoom, project_record
from insonify_viewer.record.waterfall_view import WaterfallView

ROOMY = 1000  # px of the middle of the window, from which the 3-D view keeps a part beside two records


class RecordAView(WaterfallView):
    """Draws a record that is not the live one; while it lies over the live one, others draw it there."""

    def __init__(self, *, native: bool = False, parent: QWidget | None = None) -> None:
        self._live: WaterfallView | None = None
        self._by_ping = True
        self._laid: tuple[object, ...] = ()
        super().__init__(native=native, parent=parent)
        self.show_title("")

    def lie_over(self, live: WaterfallView | None, *, by_ping: bool) -> None:
        """Compute the picture for the place of another record, or with None for a view of its own."""
        known = self._live is live and self._by_ping is by_ping
        self._live, self._by_ping = live, by_ping
        if not known:
            self._fit()
        self.follow()

    def follow(self) -> None:
        """Compute the picture anew if the place of the live record has changed."""
        if self._live is not None and self._laid != self._place(self._live):
            self._fit()

    def draw_over(self, painter: QPainter) -> None:
        """Draw the picture in the place of the live record, as far as it goes."""
        plot, zoom = self.plot_area, self.projection.zoom
        upper, lower = max(zoom.upper, 0.0), min(zoom.lower, 1.0)
        if upper >= lower:
            return
        high = plot.height() / (zoom.lower - zoom.upper)
        room = QRect(plot.left(), plot.top() + round((upper - zoom.upper) * high), plot.width(), 1)
        room.setHeight(max(round((lower - upper) * high), 1))
        inside = replace(self.projection, zoom=zoom._replace(upper=upper, lower=lower))
        self.image.draw(painter, room, inside)

    @property
    def rows_a_ping(self) -> float:
        """Rows of this record for each of the live one."""
        return 1.0 if self._by_ping or self._live is None else self._live.step / self.step

    def _lay(self) -> None:
        """Take the place of the live record, and its metres across."""
        super()._lay()
        if self._live is None:
            return
        self._laid, self.plot_area = self._place(self._live), QRect(self._live.plot_area)
        zoom = self._zoom_over(self._live)
        self.projection = project_record(self.look, self.record, self.projection.axis, zoom, self.top)

    def _place(self, live: WaterfallView) -> tuple[object, ...]:
        projection = live.projection
        return QRect(live.plot_area), projection.shown, projection.ages, live.step

    def _zoom_over(self, live: WaterfallView) -> Zoom:
        """Part of this record that has the metres and the pings of the live one; it may reach beyond its edges."""
        first, last = self.projection.extent
        left, right = ((metres - first) / (last - first) for metres in live.projection.shown)
        upper, lower = (age * self.rows_a_ping / self.record.pings for age in live.projection.ages)
        return Zoom(left, right, upper, lower) if self.look.newest_on_top else Zoom(left, right, 1 - upper, 1 - lower)


class RecordsSideBySide(QObject):
    """Shows record A left of the live record."""

    def __init__(self, splitter: QSplitter, live: QWidget, beside: QWidget) -> None:
        super().__init__(splitter)
        self._splitter, self._live, self._beside = splitter, live, beside
        self._before: list[int] = []
        self._roomy = False
        splitter.installEventFilter(self)
        splitter.insertWidget(splitter.indexOf(live), beside)  # A stands left of B, as where A is wiped over it
        beside.hide()

    def show(self) -> None:
        """Show record A, as wide as the live record."""
        # The 3-D view keeps a quarter of the room where that is wide, and can be drawn out from the edge where it is
        # not.
        if self._beside.isHidden():
            self._before = self._splitter.sizes()
        self._splitter.setCollapsible(0, True)
        self._beside.show()
        room = self._splitter.width()
        self._roomy = room >= ROOMY
        solid = room // 4 if self._roomy else 0
        each = (room - solid) // 2
        self._splitter.setSizes([solid, each, each])

    @guard_override(False)
    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Divide the room anew when it becomes wide or narrow."""
        if event.type() is QEvent.Type.Resize and not self._beside.isHidden():
            roomy = self._splitter.width() >= ROOMY
            if roomy is not self._roomy:
                self.show()
        return False

    def hide(self) -> None:
        """Show the 3-D view and the live record alone."""
        if self._beside.isHidden():
            return
        self._beside.hide()
        self._splitter.setCollapsible(0, False)
        self._splitter.setSizes(self._before)
