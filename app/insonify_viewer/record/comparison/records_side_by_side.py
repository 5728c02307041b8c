"""Places of the 3-D view, the live record and record A in the middle of the window."""

from __future__ import annotations

from PySide6.QtCore import QEvent, QObject
from PySide6.QtWidgets import QSplitter, QWidget

from insonify_viewer.errors.guarded_overrides import guard_override

ROOMY = 1000  # px of the middle of the window, from which the 3-D view keeps a part beside two records


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
        """Show record A, as wide as the live record.

        The 3-D view keeps a quarter of the room where that is wide, and can be drawn out from the edge where it is not.
        """
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
