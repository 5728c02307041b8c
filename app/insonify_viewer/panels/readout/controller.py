"""Describes the point of the record under the mouse."""

import math

from insonify_viewer.panels.panel import Panel, Place, Workbench
from insonify_viewer.record.comparison.recording import summarise_point
from insonify_viewer.record.marked_point import MarkedPoint
from insonify_viewer.state.inspection import Mark
from insonify_viewer.widgets.buttons import make_label


class ReadoutPanel(Panel):
    """Shows ranges, bed height and intensity at the point under the mouse."""

    name = "readout"
    title = "Readout"
    place = Place.STATUS

    def __init__(self, workbench: Workbench) -> None:
        self.view = make_label("")
        self.view.setWordWrap(False)
        self._recordings = workbench.recordings
        self._recordings.pointed.connect(self._show_recorded)

    def point_marked(self, point: MarkedPoint | None) -> None:
        """Describe a point, or nothing."""
        self.view.setText("" if point is None else described(point))

    def _show_recorded(self, mark: Mark | None) -> None:
        """Describe a point of the recording beside, or nothing."""
        recording = self._recordings.recording
        self.view.setText("" if mark is None or recording is None else summarise_point(recording, mark))


def described(point: MarkedPoint) -> str:
    """Write a point as ping, side, ranges, what it shows, and intensity."""
    parts = [f"ping {point.mark.ping}", point.mark.side_name, f"slant {point.slant_range:.2f} m"]
    parts += _what_is_there(point)
    if point.intensity > 0.0:
        parts.append(f"{point.intensity:.3g} ({10.0 * math.log10(point.intensity):.1f} dB)")
    return "  ·  ".join(parts)


def _what_is_there(point: MarkedPoint) -> list[str]:
    """Ground range, source and height where known; height of the bed only where its own echo is recorded."""
    label = point.label
    if label is None:
        return [] if point.ground_range is None else [f"ground {point.ground_range:.2f} m"]
    across = label.ground_range if label.source else point.ground_range
    parts = ([] if across is None else [f"ground {across:.2f} m"]) + label.words
    if label.source == "bed" and not label.ghost and point.position is not None:
        parts.append(f"bed {point.position[2]:+.2f} m")
    if label.words:
        return parts
    without_bed = "water column" if point.ground_range is None else "no bed"
    return [*parts, without_bed if point.position is None else "hidden by the bed"]
