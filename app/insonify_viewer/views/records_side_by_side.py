"""Places of the 3-D view, the simulated record and a recording in the middle of the window."""

from __future__ import annotations

from PySide6.QtWidgets import QSplitter, QWidget

ROOMY = 1000  # px of the middle of the window, from which the 3-D view keeps a part beside two records


class RecordsSideBySide:
    """Shows a recording beside the simulated record, or in its place with the simulated record wiped over it.

    Parameters
    ----------
    splitter : QSplitter
        Holds the 3-D view and the simulated record.
    simulated, recording : QWidget
        Views of the two records.
    """

    def __init__(self, splitter: QSplitter, simulated: QWidget, recording: QWidget) -> None:
        self._splitter, self._simulated, self._recording = splitter, simulated, recording
        self._before: list[int] = []
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
        solid = room // 4 if room >= ROOMY else 0
        each = (room - solid) // (1 if wiped else 2)
        self._splitter.setSizes([solid, 0 if wiped else each, each])

    def hide(self) -> None:
        """Show the 3-D view and the simulated record alone."""
        if self._recording.isHidden():
            return
        self._recording.hide()
        self._simulated.show()
        self._splitter.setCollapsible(0, False)
        self._splitter.setSizes(self._before)
