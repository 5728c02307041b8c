"""Failures over rough beds: one incidence for a cell along which the surface turns through a specular lobe."""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np
from matplotlib.figure import Figure

from insonify.accuracy.stability.case import Approach, StabilityCase, StabilityTheme
from insonify.accuracy.stability.drawing import RIGHT, WRONG, add_legend, add_panel
from insonify.accuracy.stability.level_scenes import make_level_scene
from insonify.acoustics.resolution_cell import bin_centres
from insonify.display.style import INK
from insonify.simulation import prepare
from insonify.statistics.record_errors import compare_records
from insonify.tracers import ray_sheets, sweep
from insonify.tracers.base import Record

RMS = 0.16  # m, with nodes 0.1 m apart
ROUGH = {
    "seabed.relief": {"kind": "fractal", "beta": 1.2, "peaks": [[0.0, 0.0]], "period": 51.2, "rms": RMS},
    "seabed.spacing": 0.1,
    "seabed.material": {"name": "fine_sand"},
    "sonar.range": 40.0,
    "sonar.bins": 800,
}
WHOLE, DIVIDED = math.inf, 0.01  # shares of a bin's echo that a segment may misplace


@lru_cache(maxsize=1)
def _records() -> tuple[dict[float, Record], Record]:
    """Trace by the sweep with and without division of segments, and by exact rays."""
    simulation = prepare(make_level_scene(ROUGH))
    arrays, pose = simulation.arrays, simulation.poses(np.zeros(1, dtype=np.int64))
    ours = {
        share: sweep.trace(arrays._replace(limits=arrays.limits._replace(misplaced=share)), pose, planes=1)
        for share in (WHOLE, DIVIDED)
    }
    return ours, ray_sheets.trace(arrays, pose, rays=1 << 14)


def _error(share: float) -> float:
    """Percentage by which a record is off that of exact rays."""
    simulation = prepare(make_level_scene(ROUGH))
    arrays, pose = simulation.arrays, simulation.poses(np.zeros(1, dtype=np.int64))
    ours, right = _records()
    return 100.0 * compare_records(arrays, pose, ours[share], right).beyond


def _draw_lobes(figure: Figure) -> None:
    ours, right = _records()
    r = bin_centres(prepare(make_level_scene(ROUGH)).arrays)
    axes = add_panel(figure, x="slant range (m)", y="echo over that of exact rays")
    heard = right[0, 0] > 0.01 * np.median(right[0, 0][right[0, 0] > 0.0])
    for share, colour, label in ((WHOLE, WRONG, "one incidence a cell"), (DIVIDED, RIGHT, "cells divided")):
        axes.plot(r[heard], ours[share][0, 0][heard] / right[0, 0][heard], ".", color=colour, markersize=3, label=label)
    axes.axhline(1.0, color=INK, linewidth=0.6)
    axes.set(yscale="log", ylim=(0.1, 10.0), xlim=(10.0, 40.0))
    add_legend(axes, "upper right")


THEME = StabilityTheme("Rough beds", 6, (
    StabilityCase(
        "A lobe narrower than a cell's twist",
        "Within one cell of a rough bed the surface turns by more than a specular lobe is wide.",
        "error of the record against exact rays", "%",
        Approach("Takes the incidence at the middle of each cell's segment.", lambda: _error(WHOLE), 5.0),
        Approach("Divides a segment until a lobe, a twist and a density change little within a part.",
                 lambda: _error(DIVIDED), 1.0),
        _draw_lobes,
    ),
))  # fmt: skip
