"""Lines of the sound of a pixel in the three-dimensional view: rays, and what echoes or is hidden."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import pyvista
from numpy.typing import NDArray

from insonify_viewer.widgets.theme import MARK_IN_WATER

if TYPE_CHECKING:
    from insonify_viewer.state.inspection import SoundDrawing

# PyVista is untyped.
pv: Any = pyvista

Points = NDArray[np.float64]
BLOCKED, HIDDEN = "#ff7a5c", "#2a0f0a"
LIFT = 0.002  # share of the slant range by which stretches of the bed are drawn above it


class SoundActors:
    """Actors of one plotter that draw a `SoundDrawing`."""

    def __init__(self, plotter: Any) -> None:
        add: dict[str, Any] = {"render": False, "reset_camera": False, "lighting": False}
        styles = {
            "rays": {"color": MARK_IN_WATER, "line_width": 1.5, "opacity": 0.85},
            "blocked": {"color": BLOCKED, "line_width": 1.5, "opacity": 0.85},
            "heard": {"color": MARK_IN_WATER, "line_width": 6.0},
            "hidden": {"color": HIDDEN, "line_width": 6.0},
        }
        self.actors = {name: plotter.add_mesh(_line(), **add, **style) for name, style in styles.items()}

    def show(self, drawing: SoundDrawing | None, reach: float) -> None:
        """Draw the sound of a pixel, at a view's slant range in metres; None hides it."""
        lines: dict[str, Sequence[Points]] = dict.fromkeys(self.actors, ())
        if drawing is not None:
            lift = np.array([0.0, 0.0, LIFT * reach])
            lines = {
                "rays": drawing.rays,
                "blocked": drawing.blocked,
                "heard": list(drawing.heard + lift),
                "hidden": list(drawing.hidden + lift),
            }
        for name, actor in self.actors.items():
            actor.visibility = len(lines[name]) > 0
            if len(lines[name]):
                actor.mapper.SetInputData(polylines(lines[name]))


def polylines(lines: Sequence[Points]) -> Any:
    """Mesh of several lines, each of (n, 3) points."""
    mesh = pv.PolyData(np.concatenate(lines).astype(np.float32))
    first, cells = 0, []
    for line in lines:
        cells += [len(line), *range(first, first + len(line))]
        first += len(line)
    mesh.lines = np.array(cells)
    mesh.verts = np.empty(0, np.int64)
    return mesh


def _line() -> Any:
    return polylines([np.zeros((2, 3))])
