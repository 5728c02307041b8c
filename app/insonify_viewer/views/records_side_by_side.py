"""Places of the 3-D view, the simulated record and a recording in the middle of the window."""

from __future__ import annotations

from PySide6.QtCore import QEvent, QObject
from PySide6.QtWidgets import QSplitter, QWidget

ROOMY = 1000  # px of the middle of the window, from which the 3-D view keeps a part beside two records


class RecordsSideBySide(QObject):
    """Shows a recording beside the simulated record, or in its place with the simulated record wiped over it.

    Parameters
    ----------
    splitter : QSplitter
        Holds the 3-D view and the simulated record.
    simulated, recording : QWidget
        Views of the two records.
    """

    def __init__(self, splitter: QSplitter, simulated: QWidget, recording: QWidget) -> None:
        super().__init__(splitter)
        self._splitter, self._simulated, self._recording = splitter, simulated, recording
        self._before: list[int] = []
        self._wiped = self._roomy = False
        splitter.installEventFilter(self)
        splitter.addWidget(recording)
        recording.hide()

    def show(self, *, wiped: bool) -> None:
        """Show the recording, side by side with the simulated record or in its place.

        The 3-D view keeps a quarter of the room where that is wide, and can be drawn out from the edge where it is not.
        """
        if self._recording.isHidden():
            self._before = self._splitter.sizes()
        self._splitter.setCollapsible(0, True)
        self._recording.show()
        self._simulated.setVisible(not wiped)
        room = self._splitter.width()
        self._wiped, self._roomy = wiped, room >= ROOMY
        solid = room // 4 if self._roomy else 0
        each = (room - solid) // (1 if wiped else 2)
        self._splitter.setSizes([solid, 0 if wiped else each, each])

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Divide the room anew when it becomes wide or narrow."""
        if event.type() is QEvent.Type.Resize and not self._recording.isHidden():
            roomy = self._splitter.width() >= ROOMY
            if roomy is not self._roomy:
                self.show(wiped=self._wiped)
        return False

    def hide(self) -> None:
        """Show the 3-D view and the simulated record alone."""
        if self._recording.isHidden():
            return
        self._recording.hide()
        self._simulated.show()
        self._splitter.setCollapsible(0, False)
        self._splitter.setSizes(self._before)
