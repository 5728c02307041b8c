"""Describes the point of the record under the mouse."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from insonify_viewer.panels.panel import Panel, Place, Workbench
from insonify_viewer.panels.readout.view import ReadoutView

if TYPE_CHECKING:
    from insonify_viewer.marked_point import MarkedPoint

SIDES = ("port", "starboard")


class ReadoutPanel(Panel):
    """Shows ranges, bed height and intensity at the point under the mouse."""

    name = "readout"
    title = "Readout"
    place = Place.STATUS

    def __init__(self, workbench: Workbench) -> None:
        del workbench
        self._view = ReadoutView()

    @property
    def widget(self) -> Any:
        """The line of text."""
        return self._view

    def point_marked(self, point: MarkedPoint | None) -> None:
        """Describe a point, or nothing."""
        self._view.setText("" if point is None else described(point))


def described(point: MarkedPoint) -> str:
    """Write a point as ping, side, slant range, ground range, height of the bed over its mean, and intensity."""
    parts = [f"ping {point.mark.ping}", SIDES[point.mark.side], f"slant {point.slant_range:.2f} m"]
    parts.append("water column" if point.ground_range is None else f"ground {point.ground_range:.2f} m")
    if point.position is not None:
        parts.append(f"bed {point.position[2]:+.2f} m")
    decibels = f" ({10.0 * math.log10(point.intensity):.1f} dB)" if point.intensity > 0.0 else ""
    return "  ·  ".join([*parts, f"{point.intensity:.3g}{decibels}"])
