"""Failures of echoes along bent paths: an incidence from the slope of a table, pairs of paths binned as points."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from insonify.accuracy.stability.case import Approach, StabilityCase, StabilityTheme
from insonify.accuracy.stability.drawing import RIGHT, WRONG, add_legend, add_panel
from insonify.accuracy.stability.level_scenes import make_level_scene, make_pose
from insonify.acoustics.resolution_cell import bin_centres
from insonify.display.style import INK
from insonify.kernels.bed.profile import empty_profile
from insonify.kernels.refraction.apparent_positions import (
    LEVEL,
    RISE,
    TUBE,
    TableGrid,
    apply_apparent_positions,
)
from insonify.packing.apparent_tables import COLUMN_STEP, ROW_STEP, make_apparent_tables
from insonify.simulation import prepare
from insonify.tracers import ray_sheets, rays
from insonify.tracers.base import Record

Values = NDArray[np.float64]
# Sound slows down by 2 m/s per metre of depth: rays are arcs of circles, with closed forms.
SPEED, RATE, ALTITUDE = 1500.0, 2.0, 30.0
SLOWING = {
    "water": {"kind": "profile", "depth": [0.0, 45.0], "sound_speed": [SPEED + 10.0 * RATE, SPEED - 35.0 * RATE]},
    "seabed.depth": 40.0,
    "track.altitude": ALTITUDE,
    "sonar.range": 60.0,
    "sonar.bins": 600,
}
FACETS, HALF, EXPONENT = 400, 0.05, 400  # facets that face the sonar, half their length along the level, m, and lobe
# Warm water on cold: what goes up flatter than 13 degrees is bent down again and heard beyond 240 m.
DOUBLE = {
    "water": {"kind": "profile", "depth": [0.0, 12.0, 14.0, 54.0], "sound_speed": [1532.0, 1532.0, 1490.0, 1487.5]},
    "seabed.depth": 54.0,
    "track.altitude": 25.0,
    "sonar.range": 290.0,
    "sonar.bins": 2900,
    "sonar.ping_rate": 2.0,
}
TWICE = slice(2670, 2890)  # bins in which all is heard along several paths
RAYS, MANY_RAYS = 1 << 12, 1 << 20


@lru_cache(maxsize=1)
def _lobes() -> tuple[Values, Values, Values]:
    """Ground ranges of facets that face the sonar, and the echoes of their lobes: by slopes, and by the sweep."""
    arrays = prepare(make_level_scene(SLOWING)).arrays
    apparent, _ = make_apparent_tables(arrays, make_pose(0.0, 0.0, ALTITUDE))
    middle = np.linspace(0.4, 50.0, FACETS)
    # The arrival at the end of an arc of constant gradient: docs/theory/refraction.md.
    away = RATE * (middle**2 + ALTITUDE**2) / (2.0 * middle * (SPEED - RATE * ALTITUDE))
    slope = 1.0 / (ALTITUDE / middle + away)
    x = np.ravel(middle[:, None] + [-HALF, HALF])
    z = np.ravel(slope[:, None] * [-HALF, HALF]) - ALTITUDE
    # The table of this height, as the sonar is at a whole step.
    table, profile = apparent.tables[0], empty_profile(4 * FACETS, np.float64)
    rows, columns, _ = table.shape
    grid = TableGrid(True, 1.0, apparent.low - ALTITUDE, 1.0 / ROW_STEP, 1.0 / COLUMN_STEP, rows, columns)
    area = 1.0 + (np.diff(z) / np.diff(x)) ** 2
    profile.x[: x.size], profile.z[: x.size] = x, z
    profile.slope[: x.size - 1], profile.area[: x.size - 1] = np.diff(z) / np.diff(x), area
    apply_apparent_positions(table, grid, True, profile, x.size)
    seen_x, seen_z = (0.5 * (knots[0 : x.size : 2] + knots[1 : x.size : 2]) for knots in (profile.x, profile.z))
    squared = profile.facing[0 : x.size - 1 : 2] ** 2 / (seen_x**2 + seen_z**2) / profile.area[0 : x.size - 1 : 2]
    plain = _cosines_from_slopes(table, grid.low, x, z)[::2] ** 2
    return middle, (2.0 * plain - 1.0) ** EXPONENT, (2.0 * squared - 1.0) ** EXPONENT


def _cosines_from_slopes(table: NDArray[np.float32], low: float, x: Values, z: Values) -> Values:
    """Cosines of the incidence, q dθ / ds, from launch angles that tables give, linear between their places."""
    u, v = x / COLUMN_STEP, (z - low) / ROW_STEP
    i, j = u.astype(int), v.astype(int)
    fu, fv = (u - i)[:, None], (v - j)[:, None]
    cells = table.astype(np.float64)
    near, far = ((1.0 - fu) * cells[row, i] + fu * cells[row, i + 1] for row in (j, j + 1))
    entry = ((1.0 - fv) * near + fv * far).T
    seen_x, seen_z = x * (1.0 + entry[LEVEL]), z + entry[RISE]
    q = (1.0 + entry[TUBE]) * np.hypot(seen_x, seen_z)
    angles = np.diff(np.arctan2(seen_z, seen_x))
    return 0.5 * (q[1:] + q[:-1]) * angles / np.hypot(np.diff(x), np.diff(z))


def _worst(echoes: Values) -> float:
    return float(100.0 * np.abs(echoes - 1.0).max())


def _draw_lobes(figure: Figure) -> None:
    x, plain, ours = _lobes()
    axes = add_panel(figure, x="ground range (m)", y="echo over the right one")
    axes.plot(x, plain, ".", color=WRONG, markersize=3, label="incidence from the slope of a table")
    axes.plot(x, ours, ".", color=RIGHT, markersize=3, label="incidence from the direction of arrival")
    axes.axhline(1.0, color=INK, linewidth=0.6)
    axes.set(ylim=(0.6, 2.2))
    add_legend(axes, "upper right")


@lru_cache(maxsize=1)
def _double() -> tuple[Values, Record, Record, Record]:
    """Slant range, and a level bed heard along several paths: by single rays, by a sheet, and by very many rays."""
    simulation = prepare(make_level_scene(DOUBLE))
    arrays, pose = simulation.arrays, simulation.poses(np.zeros(1, dtype=np.int64))
    single, right = (rays.trace(arrays, pose, rays=count)[0, 0, TWICE] for count in (RAYS, MANY_RAYS))
    sheet = ray_sheets.trace(arrays, pose, sheets=1, rays=RAYS)[0, 0, TWICE]
    return bin_centres(arrays)[TWICE], single, sheet, right


def _off(record: Record) -> float:
    right = _double()[3]
    return float(100.0 * np.linalg.norm(record - right) / np.linalg.norm(right))


def _draw_double(figure: Figure) -> None:
    r, single, sheet, right = _double()
    axes = add_panel(figure, x="slant range (m)", y="echo over that of many rays")
    axes.plot(r, single / right, ".", color=WRONG, markersize=3, label="rays binned one by one")
    axes.plot(r, sheet / right, ".", color=RIGHT, markersize=3, label="spread between neighbours")
    axes.axhline(1.0, color=INK, linewidth=0.6)
    axes.set(ylim=(0.6, 1.6))
    add_legend(axes, "upper right")


THEME = StabilityTheme("Echoes in layered water", 12, (
    StabilityCase(
        "An incidence from the slope of a table",
        "A table of positions, linear between its places, has a slope in error to first order, and a narrow lobe "
        "takes the 400th power of the cosine that follows from it.",
        "worst error of a facet's lobe", "%",
        Approach("Takes the incidence from the slopes of the table.", lambda: _worst(_lobes()[1]), 20.0),
        Approach("Takes it from the direction of arrival, which is tabulated too.",
                 lambda: _worst(_lobes()[2]), 0.5),
        _draw_lobes,
    ),
    StabilityCase(
        "Pairs of paths binned one by one",
        "Where sound comes along several paths, each ray out and each path back puts its echo into one bin.",
        "error of the record where all is heard several times", "%",
        Approach("Puts the echo of each pair into the bin in which it arrives.", lambda: _off(_double()[1]), 10.0),
        Approach("Spreads it over the range between neighbouring rays.", lambda: _off(_double()[2]), 0.5),
        _draw_double,
    ),
))  # fmt: skip
