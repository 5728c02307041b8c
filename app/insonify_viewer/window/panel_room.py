"""Room for panels at the sides of a narrow window, and for large text."""

from __future__ import annotations

from PySide6.QtCore import QEvent, QObject, Qt
from PySide6.QtWidgets import QDockWidget, QMainWindow, QSplitter

from insonify_viewer.errors.guarded_overrides import guard_override
from insonify_viewer.widgets.text_scale import scaled

HANDLES = 24  # px, of the lines between the parts


class PanelRoom(QObject):
    """Leaves out the 3-D view while the panels at the sides and the record need its room."""

    def __init__(self, window: QMainWindow, splitter: QSplitter) -> None:
        super().__init__(window)
        self._window, self._splitter = window, splitter
        window.installEventFilter(self)

    def watch(self, dock: QDockWidget) -> None:
        """Make room whenever a dock opens or closes."""
        dock.installEventFilter(self)

    def make(self) -> None:
        """Show the 3-D view, unless the window is too narrow for it beside the panels and the record."""
        views = [self._splitter.widget(place) for place in range(self._splitter.count())]
        solid, *others, live = [view for view in views if view is not None]
        left = self._narrowest(Qt.DockWidgetArea.LeftDockWidgetArea)
        right = self._narrowest(Qt.DockWidgetArea.RightDockWidgetArea)
        # Beside record A alone, the 3-D view can be drawn out from the edge.
        beside = [view for view in others if left and not view.isHidden()]
        narrowest = right + sum(view.minimumWidth() for view in (solid, live, *beside))
        solid.setVisible(left + scaled(self._window, narrowest) + HANDLES <= self._window.width())

    @guard_override(False)
    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Make room when the window changes its width, or a dock opens or closes."""
        kind = QEvent.Type
        on_window = watched is self._window and event.type() is kind.Resize
        on_dock = watched is not self._window and event.type() in (kind.ShowToParent, kind.HideToParent)
        if on_window or on_dock:
            self.make()
        return False

    def _narrowest(self, area: Qt.DockWidgetArea) -> int:
        """Least width of the panels that are open at a side, 0 without any."""
        docks = [
            dock
            for dock in self._window.findChildren(QDockWidget)
            if not dock.isHidden() and self._window.dockWidgetArea(dock) is area
        ]
        return max((dock.minimumSizeHint().width() for dock in docks), default=0)
