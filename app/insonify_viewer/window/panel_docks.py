"""Panels around scene and record, each in a dock without a title bar, and the room that they share."""

from collections.abc import Callable, Sequence
from itertools import pairwise

from PySide6.QtCore import QEvent, QObject, Qt
from PySide6.QtWidgets import QDockWidget, QMainWindow, QSplitter, QTabBar, QTabWidget, QToolBar, QWidget

from insonify_viewer.errors import guard_override
from insonify_viewer.panels.panel import Panel, Place
from insonify_viewer.widgets.buttons import make
from insonify_viewer.widgets.theme import scaled

HANDLES = 24  # px, of the lines between the parts
STACKED = 220  # px at the usual size of the text, least height of one of two panels that stand one below the other
UPPER_AND_LOWER = 100, 150  # shares of their height
LEAST = 0.45  # of the window, that the 3-D view and the record keep beside the panels
SIDE, NARROW = 332, 320  # px at the usual size of the text, usual and least width of the panels at the side
BELOW = 0.32  # of the height of the window, of the panels below when one is first opened

AREAS = {
    Place.SIDE: Qt.DockWidgetArea.RightDockWidgetArea,
    Place.BELOW: Qt.DockWidgetArea.BottomDockWidgetArea,
    Place.LEFT: Qt.DockWidgetArea.LeftDockWidgetArea,
}


class PanelRoom(QObject):
    """Keeps room for the 3-D view and the record beside the panels."""

    # Where the two views would have less than `LEAST` of the window, a panel of the left side stands below those at
    # the right one, and panels below and at the right are smaller. The 3-D view is left out where panels and record
    # need its room even so.

    def __init__(self, window: QMainWindow, splitter: QSplitter) -> None:
        super().__init__(window)
        self._window, self._splitter = window, splitter
        self.homes: dict[QDockWidget, Place] = {}  # where each panel is where there is room
        self._making = False
        self.resting = False  # whether the panels stay as they are
        window.installEventFilter(self)

    def watch(self, dock: QDockWidget, place: Place) -> None:
        """Make room whenever a dock opens or closes."""
        self.homes[dock] = place
        dock.installEventFilter(self)

    def make(self) -> None:
        """Place the panels anew, and show the 3-D view where there is room for it."""
        if not self._making and not self.resting:
            self._making = True
            self._stack()
            self._shrink()
            self._show_solid()
            self._making = False

    def _open(self, place: Place) -> list[QDockWidget]:
        return [dock for dock, home in self.homes.items() if home is place and not dock.isHidden()]

    def _height_beside(self, left: int) -> int:
        """Height that the views need beside panels at the right side and some width at the left one."""
        window = self._window
        wide = window.width() - left - scaled(window, SIDE) - HANDLES
        return round(LEAST * window.width() * window.height() / max(wide, 1))

    def _room_for_views(self) -> int:
        """Height of the window without its bars."""
        window = self._window
        # To look for them among all widgets would take 7 ms.
        tools = window.findChildren(QToolBar, options=Qt.FindChildOption.FindDirectChildrenOnly)
        bars = window.menuBar(), window.statusBar(), *(bar for bar in tools if not bar.isHidden())
        return window.height() - sum(bar.sizeHint().height() for bar in bars)

    def _stack(self) -> None:
        """Place the panels of the left side there, or below those at the right one."""
        lefts, belows = self._open(Place.LEFT), self._open(Place.BELOW)
        wide = max((dock.sizeHint().width() for dock in lefts), default=0)
        below = round(BELOW * self._window.height()) if belows else 0
        room, least = self._room_for_views(), 2 * scaled(self._window, STACKED)
        stacked = room >= least and self._height_beside(wide) > room - below
        area, upright = AREAS[Place.SIDE if stacked else Place.LEFT], Qt.Orientation.Vertical
        for dock in lefts:
            if self._window.dockWidgetArea(dock) is not area:
                self._window.addDockWidget(area, dock, upright)
                if stacked:
                    self._window.resizeDocks([*self._open(Place.SIDE)[:1], dock], [*UPPER_AND_LOWER], upright)

    def _shrink(self) -> None:
        """Make the panels below as low, and those at the right side as narrow, as the views need."""
        lefts, window = self._open(Place.LEFT), self._window
        beside = [dock for dock in lefts if window.dockWidgetArea(dock) is AREAS[Place.LEFT]]
        wide = max((dock.sizeHint().width() for dock in beside), default=0)
        room = self._room_for_views()
        most = max(room - self._height_beside(wide), 1)
        docks = [dock for dock in self._open(Place.BELOW) if dock.height() > max(most, dock.minimumSizeHint().height())]
        window.resizeDocks(docks, [most] * len(docks), Qt.Orientation.Vertical)
        needed = round(LEAST * window.width() * window.height() / max(room, 1))
        most = max(window.width() - wide - needed - HANDLES, scaled(window, NARROW))
        docks = [dock for dock in self._open(Place.SIDE) if dock.width() > most]
        window.resizeDocks(docks, [most] * len(docks), Qt.Orientation.Horizontal)

    def _show_solid(self) -> None:
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
        docks = [dock for dock in self.homes if not dock.isHidden() and self._window.dockWidgetArea(dock) is area]
        return max((dock.minimumSizeHint().width() for dock in docks), default=0)


class PanelDocks:
    """Mounts panels at the sides of a window and below; those at one place stand one behind the other."""

    def __init__(self, window: QMainWindow, room: PanelRoom) -> None:
        self._window, self._room = window, room
        self.by_panel: dict[str, QDockWidget] = {}  # the dock of each panel by its name
        self._opened_below = False
        window.setDocumentMode(True)
        window.setCorner(Qt.Corner.BottomRightCorner, AREAS[Place.SIDE])
        window.setCorner(Qt.Corner.BottomLeftCorner, AREAS[Place.LEFT])
        for area in (AREAS[Place.SIDE], AREAS[Place.BELOW]):
            window.setTabPosition(area, QTabWidget.TabPosition.North)

    def mount(self, panels: Sequence[Panel]) -> None:
        """Mount panels at their places, in this order; those at the right side are open, the first in front."""
        for place, area in AREAS.items():
            here = [panel for panel in panels if panel.place is place]
            docks = [self._dock(panel, area) for panel in here]
            if place is not Place.SIDE:
                for dock in docks:
                    dock.hide()
                continue
            for one, next_one in pairwise(docks):
                self._window.tabifyDockWidget(one, next_one)
            for dock, panel in zip(docks, here, strict=True):
                dock.visibilityChanged.connect(panel.opened)  # a click on its tab opens it too
            self._window.resizeDocks(docks, [scaled(self._window, SIDE)] * len(docks), Qt.Orientation.Horizontal)
            for dock in docks[:1]:
                dock.raise_()
        self._name_tabs()

    def bring_forward(self, panel: str) -> None:
        """Open a panel, before those that share its place."""
        dock = self.by_panel[panel]
        if dock.isHidden():
            area, homes = self._window.dockWidgetArea(dock), self._room.homes
            # Qt lays a dock out where it stands behind others only if these are in view by then. A panel of the left
            # side that stands at the right one was below the others there, and comes back there.
            for other in self.by_panel.values():
                if not other.isHidden() and self._window.dockWidgetArea(other) is area and homes[other] is homes[dock]:
                    self._window.tabifyDockWidget(other, dock)
            dock.show()
            self._name_tabs()
        dock.raise_()

    def show(self, panel: Panel, shown: bool) -> None:
        """Open or close a panel."""
        if shown and panel.place is Place.BELOW and not self._opened_below:
            self._opened_below = True
            height = round(BELOW * self._window.height())
            self._window.resizeDocks([self.by_panel[panel.name]], [height], Qt.Orientation.Vertical)
        if shown:
            self.bring_forward(panel.name)
        else:
            self.by_panel[panel.name].hide()
        panel.opened(shown)

    def stow(self, height: int) -> Callable[[], None]:
        """Hide all panels but those of the left side, which stand below, with a height; return what restores them."""
        window, shown = self._window, [dock for dock in self.by_panel.values() if not dock.isHidden()]
        front = [dock for dock in shown if not dock.visibleRegion().isEmpty()]
        widths = [dock.width() for dock in front]
        self._room.resting = True
        for dock in shown:
            if self._room.homes[dock] is Place.LEFT:
                window.addDockWidget(AREAS[Place.BELOW], dock)
                window.resizeDocks([dock], [height], Qt.Orientation.Vertical)
            else:
                dock.hide()

        def restore() -> None:
            for name, dock in self.by_panel.items():
                if dock in shown and dock.isHidden():
                    self.bring_forward(name)
                elif dock not in shown:
                    dock.hide()
            for dock in front:
                dock.raise_()
            self._room.resting = False
            self._room.make()
            window.resizeDocks(front, widths, Qt.Orientation.Horizontal)

        return restore

    def _dock(self, panel: Panel, area: Qt.DockWidgetArea) -> QDockWidget:
        """Put a panel at a side, without a title bar."""
        fixed = QDockWidget.DockWidgetFeature.NoDockWidgetFeatures
        dock = make(QDockWidget, panel.title, self._window, objectName=panel.name, features=fixed)
        dock.setTitleBarWidget(QWidget())
        dock.setWidget(panel.widget)
        self._window.addDockWidget(area, dock)
        self._room.watch(dock, panel.place)
        self.by_panel[panel.name] = dock
        return dock

    def _name_tabs(self) -> None:
        """Name the tabs of panels for screen readers; Qt makes some when panels come to stand behind one another."""
        for tabs in self._window.findChildren(QTabBar):
            tabs.setAccessibleName("Panels")
