"""Shows the estimated error of a ping and of the record beside the tolerance."""

import math

import numpy as np

from insonify_viewer.panels.panel import Panel, Place, Workbench
from insonify_viewer.record.marked_point import MarkedPoint
from insonify_viewer.record.record import Record, RecordGrowth
from insonify_viewer.state.quantities import format_share
from insonify_viewer.widgets.buttons import make_label

TIP = (
    "Estimated error of the ping under the mouse, else of the newest, and of the record on screen (root of the mean "
    "square of its pings), beside the tolerance of the plan"
)


class ErrorPanel(Panel):
    """Shows how far the record on screen may be from one of ever more planes."""

    name = "error"
    title = "Error"
    place = Place.STATUS
    rank = 110  # at the right of the readout, because the readout changes its length

    def __init__(self, workbench: Workbench) -> None:
        self._session = workbench.session
        self._record: Record | None = None
        self._ping: int | None = None
        self.view = make_label("")
        self.view.setWordWrap(False)
        self.view.setToolTip(TIP)
        self.view.setAccessibleName("Estimated error")

    def point_marked(self, point: MarkedPoint | None) -> None:
        """Show the error of a ping, or of the newest."""
        self._ping = None if point is None else point.mark.ping
        self._show()

    def record_grown(self, growth: RecordGrowth) -> None:
        """Show the error of the record with the pings that it has taken over."""
        self._record = growth.record
        self._show()

    def _show(self) -> None:
        if self._record is not None:
            ping = int(self._record.ping.max()) if self._ping is None else self._ping
            self.view.setText(describe_errors(self._record, ping, self._session.modelling.tolerance))


def describe_errors(record: Record, ping: int, tolerance: float) -> str:
    """Write the errors of a ping and of a record; nothing where they are not known."""
    known = record.error[(record.ping >= 0) & np.isfinite(record.error)]
    if not known.size:
        return ""
    whole = f"record {format_share(math.sqrt(float(np.mean(np.square(known)))))} of {format_share(tolerance)}"
    own = record.error_of(ping)
    return f"error: {whole}" if math.isnan(own) else f"error: this ping {format_share(own)}, {whole}"
