"""Altitude of the fish, arc of the slant range and swath along the track, drawn in the three-dimensional view."""

import math
from typing import Any

import numpy as np
from vtkmodules.vtkRenderingCore import vtkBillboardTextActor3D

from insonify.arrays import Floats
from insonify.kernels.common.types import Poses
from insonify_viewer.seabed.lean_pyvista import pv
from insonify_viewer.seabed.pv_meshes import LINE_POINTS, PATH, PATH_POINTS, ScanLine, polylines
from insonify_viewer.widgets.theme import OVER_WATER

SWATH, LEVEL_BED = "#bfeaff", "#b59a6c"
ASIDE = 0.12  # share of the slant range by which the number of the altitude stands beside its line
LIFT = 0.008  # share of the slant range by which the swath lies above the bed beneath the fish
SMALL = 15  # px, type at the usual size of the text
ARC_POINTS = 24
TOWED = round(PATH_POINTS * PATH[0] / sum(PATH))  # points of a path that lie behind the fish
Window = tuple[float, float, float]  # m: middle of the bed on screen, and half of its side


class SwathGuides:
    """Actors of one plotter that make altitude and range of the sonar visible."""

    def __init__(self, plotter: Any) -> None:
        add: dict[str, Any] = {"render": False, "reset_camera": False, "lighting": False}
        self._lines = plotter.add_mesh(
            polylines([np.zeros((2, 3))]), color=OVER_WATER, line_width=1.5, opacity=0.7, **add
        )
        swath = pv.StructuredGrid()
        swath.points = np.zeros((2 * TOWED, 3), np.float32)
        swath.dimensions = (2, TOWED, 1)
        self._swath = swath
        self._swath_actor = plotter.add_mesh(swath, color=SWATH, opacity=0.12, **add)
        self._borders = plotter.add_mesh(polylines([np.zeros((2, 3))]), color=SWATH, opacity=0.5, **add)
        self.level = plotter.add_mesh(pv.Plane(), color=LEVEL_BED, **add)
        self.altitude, self.range = _label(plotter), _label(plotter)
        self.range.GetTextProperty().SetJustificationToRight()
        self._half, self._beneath, self._placed = 0.0, 0.0, False

    def show(self, pose: Poses, scanned: ScanLine, reach: float, type_size: float, window: Window) -> None:
        """Show altitude and range of the sonar at a pose, over the bed in a window."""
        line, _ = scanned
        fish, nadir = np.array([pose.x[0], pose.y[0], pose.z[0]], dtype=np.float64), line[LINE_POINTS]
        arcs = [_arc(fish, end, reach) for end in (line[0], line[-1])]
        self._lines.mapper.SetInputData(polylines([np.stack([fish, nadir]), *arcs]))
        self._half, self._beneath = float(np.hypot(*(line[0] - nadir)[:2])), float(nadir[2])
        self.level.position, self.level.scale = (fish[0], fish[1], self._beneath), 4.0 * reach
        self._lines.visibility = self._placed = True
        self.cover(window)
        beside = nadir + ASIDE * reach * (line[-1] - nadir) / max(float(np.linalg.norm(line[-1] - nadir)), 1e-9)
        _write(self.altitude, f"{fish[2] - nadir[2]:.1f} m", 0.6 * fish + 0.8 * beside - 0.4 * nadir, type_size)
        _write(self.range, f"{reach:g} m", arcs[1][0], type_size)

    def cover(self, window: Window) -> None:
        """Show a level bed about the fish unless it is over the bed in a window."""
        away = np.abs(np.array(self.level.position[:2]) - window[:2]).max()
        self.level.visibility = self._placed and bool(away >= window[2])

    def show_path(self, path: Poses, reach: float) -> None:
        """Show the swath behind the fish on a track of `PATH_POINTS` poses, as wide as the last one that was shown."""
        aside = self._half * np.stack([-np.sin(path.heading), np.cos(path.heading), np.zeros(path.x.size)], axis=1)
        middle = np.column_stack([path.x, path.y, np.full(path.x.size, self._beneath + LIFT * reach)])
        borders = (middle - aside)[:TOWED], (middle + aside)[:TOWED]
        self._swath.points = np.stack(borders, axis=1).reshape(-1, 3).astype(np.float32)
        self._borders.mapper.SetInputData(polylines(borders))
        self._swath_actor.visibility = self._borders.visibility = self._half > 0.0


def _arc(fish: Floats, end: Floats, reach: float) -> Floats:
    """Arc of one slant range about the fish, from its height down to the end of the scan line on one side."""
    across = (end - fish)[:2] / max(float(np.hypot(*(end - fish)[:2])), 1e-9)
    angle = np.linspace(0.0, math.asin(min(max((fish[2] - end[2]) / reach, 0.0), 1.0)), ARC_POINTS)
    return fish + reach * np.column_stack([np.cos(angle)[:, None] * across, -np.sin(angle)])


def _label(plotter: Any) -> Any:
    label = vtkBillboardTextActor3D()
    style = label.GetTextProperty()
    style.SetColor(*pv.Color(OVER_WATER).float_rgb)
    style.SetShadow(True)
    style.SetBold(True)
    label.VisibilityOff()
    plotter.renderer.AddViewProp(label)
    return label


def _write(label: Any, words: str, place: Floats, type_size: float) -> None:
    label.SetInput(words)
    label.SetPosition(*place)
    label.GetTextProperty().SetFontSize(round(SMALL * type_size))
    label.VisibilityOn()
