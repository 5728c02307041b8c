"""Handles of targets in the three-dimensional view: the mouse drags them before it turns the view."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from PySide6.QtCore import QEvent, QObject, QPointF, Qt, Signal
from PySide6.QtGui import QMouseEvent
from PySide6.QtWidgets import QWidget

from insonify.arrays import Floats
from insonify_viewer.errors import guard_override
from insonify_viewer.seabed.lean_pyvista import pv
from insonify_viewer.widgets.theme import ACCENT_IN_WATER, MARK_IN_WATER

Grip = tuple[tuple[float, float, float], str, bool]
REACH = 11.0  # px from a handle at which the mouse takes hold of it
POINTS = 13.0  # px, size of a handle
COLOURS = {
    "move": MARK_IN_WATER,
    "turn": ACCENT_IN_WATER,
    "resize": "#ffffff",
    "thicken": "#b6f09c",
    "raise": "#f3a6dd",
}


class SeabedHandles(QObject):
    """Points by which targets are dragged in three dimensions."""

    taken = Signal(int)  # number of a handle
    pulled = Signal(object, object)  # ends of the line of sight under the mouse
    released = Signal()

    def __init__(
        self, plotter: Any, widget: QWidget, sight: Callable[[float, float], list[Any]], drawn: Callable[[], None]
    ) -> None:
        super().__init__(widget)
        self._plotter, self._widget, self._sight, self._drawn = plotter, widget, sight, drawn
        self._grips: Sequence[Grip] = ()
        self._held = False
        self._actors = {action: self._make(action) for action in COLOURS}
        widget.installEventFilter(self)

    def show(self, grips: Sequence[Grip]) -> None:
        """Show handles: place, what a drag does, and whether it belongs to the chosen target, which alone is drawn."""
        self._grips = grips
        for action, (mesh, actor) in self._actors.items():
            places = [place for place, does, chosen in grips if chosen and does == action]
            actor.visibility = bool(places)
            if places:
                mesh.points = np.array(places, dtype=np.float64)
                mesh.verts = np.column_stack([np.ones(len(places), int), np.arange(len(places))]).ravel()
        self._drawn()

    def place(self, number: int) -> QPointF:
        """Position of a handle in the widget."""
        x, y = self._in_view(np.array(self._grips[number][0]))
        ratio = self._widget.devicePixelRatioF()
        return QPointF(x / ratio, self._widget.height() - 1.0 - y / ratio)

    @guard_override(False)
    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Take hold of a handle, drag it and let it go; all else is left to the view."""
        if not isinstance(event, QMouseEvent):
            return False
        kind = event.type()
        if kind is QEvent.Type.MouseButtonPress and event.button() is Qt.MouseButton.LeftButton:
            number = self._at(event.position())
            if number is not None:
                self._held = True
                self.taken.emit(number)
                self._pull(event.position())
            return self._held
        if not self._held:
            return False
        if kind is QEvent.Type.MouseMove:
            self._pull(event.position())
        elif kind is QEvent.Type.MouseButtonRelease:
            self._held = False
            self.released.emit()
        return True

    def _make(self, action: str) -> tuple[Any, Any]:
        mesh = pv.PolyData(np.zeros((1, 3)))
        actor = self._plotter.add_mesh(
            mesh,
            color=COLOURS[action],
            point_size=POINTS,
            render_points_as_spheres=True,
            lighting=False,
            render=False,
            reset_camera=False,
            show_scalar_bar=False,
        )
        actor.visibility = False
        # In front of the target that they belong to.
        actor.mapper.SetResolveCoincidentTopologyToPolygonOffset()
        actor.mapper.SetRelativeCoincidentTopologyPointOffsetParameter(-1e5)
        return mesh, actor

    def _pull(self, place: QPointF) -> None:
        ratio = self._widget.devicePixelRatioF()
        self.pulled.emit(*self._sight(place.x() * ratio, (self._widget.height() - 1.0 - place.y()) * ratio))

    def _at(self, place: QPointF) -> int | None:
        """Return the nearest handle within reach; ends before middles, which move the whole."""
        within = []
        for number, (_, action, chosen) in enumerate(self._grips):
            way = self.place(number) - place
            distance = abs(way.x()) + abs(way.y())
            if chosen and distance <= REACH:
                within.append((action == "move", distance, number))
        return min(within)[2] if within else None

    def _in_view(self, place: Floats) -> tuple[float, float]:
        """Point of the view at which a place is seen, in device pixels from its lower left corner."""
        renderer = self._plotter.renderer
        renderer.SetWorldPoint(*place, 1.0)
        renderer.WorldToDisplay()
        x, y, _ = renderer.GetDisplayPoint()
        return float(x), float(y)
