"""Failures over rough beds: one incidence for a cell along which the surface turns through a specular lobe."""

from __future__ import annotations

import math

import numpy as np

from insonify.accuracy.stability.case import Approach, Measured, StabilityTheme
from insonify.accuracy.stability.drawing import common, inked, ours, panel
from insonify.accuracy.stability.level_scenes import make_level_scene
from insonify.acoustics.resolution_cell import bin_centres
from insonify.simulation import prepare
from insonify.statistics.record_errors import compare_records
from insonify.tracers import ray_sheets, sweep

THEME = StabilityTheme("Rough beds", 6)
ROUGH = {
    "seabed.relief": {"kind": "fractal", "beta": 1.2, "peaks": [[0.0, 0.0]], "period": 51.2, "rms": 0.16},
    "seabed.spacing": 0.1,
    "seabed.material": {"name": "fine_sand"},
    "sonar.range": 40.0,
    "sonar.bins": 800,
}


@THEME.case(
    "A lobe narrower than a cell's twist",
    "Within one cell of a rough bed the surface turns by more than a specular lobe is wide.",
    "error of the record against exact rays",
    "%",
    failing=Approach("Takes the incidence at the middle of each cell's segment.", 5.0),
    right=Approach("Divides a segment until a lobe, a twist and a density change little within a part.", 1.0),
)
def _lobe() -> Measured:
    simulation = prepare(make_level_scene(ROUGH))
    arrays, pose = simulation.arrays, simulation.poses(np.zeros(1, dtype=np.int64))
    whole, divided = (  # share of a bin's echo that a segment may misplace
        sweep.trace(arrays._replace(limits=arrays.limits._replace(misplaced=share)), pose, planes=1)
        for share in (math.inf, 0.01)
    )
    exact = ray_sheets.trace(arrays, pose, rays=1 << 14)
    lit = exact[0, 0] > 0.01 * np.median(exact[0, 0][exact[0, 0] > 0.0])
    r, ratios = bin_centres(arrays)[lit], [record[0, 0][lit] / exact[0, 0][lit] for record in (whole, divided)]
    return Measured.by(lambda one: 100.0 * compare_records(arrays, pose, one, exact).beyond, whole, divided, panel(
        common(r, ratios[0], "one incidence a cell", ".", markersize=3),
        ours(r, ratios[1], "cells divided", ".", markersize=3),
        inked(None, 1.0, linewidth=0.6),
        x="slant range (m)", y="echo over that of exact rays", log="y", ylim=(0.1, 10.0), xlim=(10.0, 40.0),
        legend="upper right",
    ))  # fmt: skip
