"""Shows the marked point of the record in views and panels, with what it is."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from insonify_viewer.record.marked_point import MarkedPoint, marked_point
from insonify_viewer.record.pixel_label import label_bin
from insonify_viewer.work.newest_wins import NewestWins

if TYPE_CHECKING:
    from insonify.simulation import Simulation
    from insonify.tracers.labels import RecordLabels
    from insonify_viewer.record.record import Record
    from insonify_viewer.state.session import Mark
    from insonify_viewer.work.ping_request import TracedPings

KEPT = 32  # pings whose labels are kept


class MarkController:
    """Looks marked points up; their labels come from a thread of their own, a moment later.

    On endless ground, whose heights may take a second, the points come from another thread too.
    """

    def __init__(
        self,
        show: Callable[[MarkedPoint | None], None],
        call_later: Callable[[Callable[[Any], None], Any], None],
    ) -> None:
        self._show = show
        self._thread = NewestWins("labels", call_later)
        self._lookups = NewestWins("points", call_later)
        self._wanted: Mark | None = None
        self._simulation: Simulation | None = None
        self._labels: OrderedDict[int, RecordLabels | None] = OrderedDict()
        self._point: MarkedPoint | None = None

    def show(self, mark: Mark | None, answer: TracedPings | None, record: Record) -> None:
        """Show a point of the record; nothing where the record holds nothing."""
        # lazy: the window opens before Numba is loaded
        from insonify.terrain import EndlessGround

        self._wanted = mark
        if mark is None or answer is None:
            self._show_point(None)
            return
        simulation = answer.simulation
        if simulation is not self._simulation:
            self._simulation = simulation
            self._labels.clear()

        def find() -> MarkedPoint | None:
            return marked_point(simulation, record, answer.level, mark)

        def take(point: MarkedPoint | None) -> None:
            if mark == self._wanted and simulation is self._simulation:
                self._take(simulation, point)

        if isinstance(simulation.ground, EndlessGround):
            self._lookups.send(find, take)
        else:
            take(find())

    def close(self, patience: float | None = None) -> None:
        """End the threads."""
        self._thread.close(patience)
        self._lookups.close(patience)

    def _take(self, simulation: Simulation, point: MarkedPoint | None) -> None:
        """Show a point, and ask for its label."""
        self._show_point(point)
        if point is not None and point.mark.ping not in self._labels:
            self._ask(simulation, point.mark.ping)

    def _ask(self, simulation: Simulation, ping: int) -> None:
        def take(labels: RecordLabels | None) -> None:
            if simulation is self._simulation:
                self._keep(ping, labels)

        self._thread.send(lambda: simulation.truth(np.array([ping], dtype=np.int64)), take)

    def _keep(self, ping: int, labels: RecordLabels | None) -> None:
        """Keep the labels of a ping, and show the point anew if it lies there."""
        self._labels[ping] = labels
        while len(self._labels) > KEPT:
            self._labels.popitem(last=False)
        if self._point is not None and self._point.mark.ping == ping:
            self._show_point(self._point)

    def _show_point(self, point: MarkedPoint | None) -> None:
        if point is not None and self._simulation is not None:
            labels = self._labels.get(point.mark.ping)
            if labels is not None:
                label = label_bin(self._simulation, labels, point.mark.side, point.mark.bin)
                point = replace(point, label=label)
        self._point = point
        self._show(point)
