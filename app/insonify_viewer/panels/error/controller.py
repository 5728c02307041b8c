"""Shows the estimated error of a ping and of the record beside the tolerance."""

import math

import numpy as np

from insonify_viewer.panels.panel import Panel, Place, Workbench
from insonify_viewer.record.marked_point import MarkedPoint
from insonify_viewer.record.record import Record, RecordGrowth
from insonify_viewer.state.quantities import format_share
from insonify_viewer.widgets.buttons import make_label

TIP = (
    "Estimated error of the pixel under the mouse as a share of its mean echo, of its ping, else of the newest, and of "
    "the record on screen (root of the mean square of its pings), beside the tolerance of the plan. Shift+E shows the "
    "errors of all bins"
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
        self._pixel = math.nan
        self.view = make_label("")
        self.view.setWordWrap(False)
        self.view.setToolTip(TIP)
        self.view.setAccessibleName("Estimated error")

    def point_marked(self, point: MarkedPoint | None) -> None:
        """Show the error of a pixel and its ping, or of the newest ping."""
        self._ping = None if point is None else point.mark.ping
        self._pixel = math.nan if point is None else point.error
        self._show()

    def record_grown(self, growth: RecordGrowth) -> None:
        """Show the error of the record with the pings that it has taken over."""
        self._record = growth.record
        self._show()

    def _show(self) -> None:
        if self._record is not None:
            ping = int(self._record.ping.max()) if self._ping is None else self._ping
            self.view.setText(describe_errors(self._record, ping, self._session.modelling.tolerance, self._pixel))


def describe_errors(record: Record, ping: int, tolerance: float, pixel: float = math.nan) -> str:
    """Write the errors of a pixel, of its ping and of a record; nothing where they are not known."""
    known = record.error[(record.ping >= 0) & np.isfinite(record.error)]
    if not known.size:
        return ""
    parts = [("pixel", pixel), ("this ping", record.error_of(ping))]
    own = [f"{what} {format_share(share)}" for what, share in parts if not math.isnan(share)]
    whole = f"record {format_share(math.sqrt(float(np.mean(np.square(known)))))} of {format_share(tolerance)}"
    return f"error: {', '.join([*own, whole])}"
