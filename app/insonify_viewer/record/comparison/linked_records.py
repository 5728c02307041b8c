"""Record A and the live record side by side, with one zoom, one scroll and one cursor while they are linked."""

from collections.abc import Callable
from functools import partial

import numpy as np
from PySide6.QtCore import QObject, Qt
from PySide6.QtWidgets import QToolButton

from insonify_viewer.record.projection import Zoom
from insonify_viewer.record.waterfall_view import WaterfallView
from insonify_viewer.state.inspection import Mark
from insonify_viewer.widgets.buttons import make, set_icon


class LinkedRecords(QObject):
    """Passes zoom, scroll and cursor on from one record to the other while the padlock over record A is closed."""

    # A place of one record is shown in the other where as many metres across lie, as many pings below the newest;
    # beside a recording, as many metres along.

    def __init__(self, live: WaterfallView, beside: WaterfallView) -> None:
        super().__init__(beside)
        self._live, self._beside = live, beside
        self.by_ping = True  # whether rows of both are paired by ping, else by metres along the track
        self._passing = False  # whether a change is being passed on, which must not come back
        self.padlock = make(QToolButton, beside, objectName="link", checkable=True, checked=True)
        self.padlock.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        self.padlock.setAccessibleName("Link A and B")
        self.padlock.toggled.connect(self._show_padlock)
        self._show_padlock(True)
        for one, other in ((live, beside), (beside, live)):
            one.zoomed.connect(partial(self._pass, partial(self._zoom, other)))
            one.scrolled.connect(partial(self._pass, partial(self._scroll, one, other)))
            one.hovered.connect(partial(self._pass, partial(self._point, one, other)))
        beside.clicked.connect(partial(self._pass, self._click))

    def find_place(self, one: WaterfallView, other: WaterfallView, mark: Mark) -> Mark | None:
        """Find the bin of the other record at the place of a bin of one; None beyond the other."""
        here, there = one.projection, other.projection
        u, v = here.place_of(mark)
        (first, last), (newest, oldest) = here.shown, here.ages
        age = (newest + v * (oldest - newest)) * self._rows_of(one, other)
        newest, oldest = there.ages
        across = float(there.across(np.array(first + u * (last - first))))
        return there.mark_at(across, (age - newest) / (oldest - newest))

    def _rows_of(self, one: WaterfallView, other: WaterfallView) -> float:
        """Rows of the other record for each row of one."""
        return 1.0 if self.by_ping else one.step / other.step

    def _pass(self, change: Callable[..., None], *values: object) -> None:
        """Pass a change on to the other record, if both are linked."""
        if self.padlock.isChecked() and not self._passing:
            self._passing = True
            try:
                change(*values)
            finally:
                self._passing = False

    def _zoom(self, other: WaterfallView, zoom: Zoom) -> None:
        other.show_zoom(zoom)

    def _scroll(self, one: WaterfallView, other: WaterfallView, pings: int) -> None:
        if self._beside.isVisible():
            other.scrolled.emit(round(pings * self._rows_of(one, other)))

    def _point(self, one: WaterfallView, other: WaterfallView, mark: Mark | None) -> None:
        if self._beside.isVisible():
            other.show_marks(cross=None if mark is None else self.find_place(one, other, mark))

    def _click(self, mark: Mark) -> None:
        """Explain the pixel of the live record at the place that is clicked in a simulated A."""
        if self.by_ping and (found := self.find_place(self._beside, self._live, mark)) is not None:
            self._live.clicked.emit(found)

    def _show_padlock(self, closed: bool) -> None:
        set_icon(self.padlock, "lock" if closed else "unlock")
        tip = "Zoom, scroll and point at A and B together" if closed else "A and B are apart"
        self.padlock.setToolTip(f"{tip}; click to {'part' if closed else 'link'} them")
        self.padlock.adjustSize()
