"""Failures of echoes along bent paths: an incidence from the slope of a table, pairs of paths binned as points."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from insonify.accuracy.stability.case import Approach, Measured, StabilityTheme
from insonify.accuracy.stability.drawing import common, inked, ours, panel
from insonify.accuracy.stability.level_scenes import level_arrays, make_level_scene, make_pose
from insonify.acoustics.resolution_cell import bin_centres
from insonify.kernels.bed.profile import empty_profile
from insonify.kernels.refraction.apparent_positions import LEVEL, RISE, TUBE, TableGrid, apply_apparent_positions
from insonify.packing.apparent_tables import COLUMN_STEP, ROW_STEP, make_apparent_tables
from insonify.simulation import prepare
from insonify.tracers import ray_sheets, rays

THEME = StabilityTheme("Echoes in layered water", 12)
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


@THEME.case(
    "An incidence from the slope of a table",
    "A table of positions, linear between its places, has a slope in error to first order, and a narrow lobe "
    "takes the 400th power of the cosine that follows from it.",
    "worst error of a facet's lobe",
    "%",
    failing=Approach("Takes the incidence from the slopes of the table.", 20.0),
    right=Approach("Takes it from the direction of arrival, which is tabulated too.", 0.5),
)
def _lobes() -> Measured:
    apparent, _ = make_apparent_tables(level_arrays(SLOWING), make_pose(0.0, 0.0, ALTITUDE))
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
    by_slope = _cosines_from_slopes(table, grid.low, x, z)[::2] ** 2
    plain, own = ((2.0 * each - 1.0) ** EXPONENT for each in (by_slope, squared))
    return Measured.by(lambda echoes: 100.0 * np.abs(echoes - 1.0).max(), plain, own, panel(
        common(middle, plain, "incidence from the slope of a table", ".", markersize=3),
        ours(middle, own, "incidence from the direction of arrival", ".", markersize=3),
        inked(None, 1.0, linewidth=0.6),
        x="ground range (m)", y="echo over the right one", ylim=(0.6, 2.2), legend="upper right",
    ))  # fmt: skip


# Warm water on cold: sound that rises at less than 13 degrees is bent down again and arrives beyond 240 m.
DOUBLE = {
    "water": {"kind": "profile", "depth": [0.0, 12.0, 14.0, 54.0], "sound_speed": [1532.0, 1532.0, 1490.0, 1487.5]},
    "seabed.depth": 54.0,
    "track.altitude": 25.0,
    "sonar.range": 290.0,
    "sonar.bins": 2900,
    "sonar.ping_rate": 2.0,
}
TWICE = slice(2670, 2890)  # bins in which every echo arrives along several paths
RAYS, MANY_RAYS = 1 << 12, 1 << 20


@THEME.case(
    "Pairs of paths binned one by one",
    "Where sound comes along several paths, each ray out and each path back puts its echo into one bin.",
    "error of the record where all is heard several times",
    "%",
    failing=Approach("Puts the echo of each pair into the bin in which it arrives.", 10.0),
    right=Approach("Spreads it over the range between neighbouring rays.", 0.5),
)
def _double() -> Measured:
    simulation = prepare(make_level_scene(DOUBLE))
    arrays, pose = simulation.arrays, simulation.poses(np.zeros(1, dtype=np.int64))
    single, exact = (rays.trace(arrays, pose, rays=count)[0, 0, TWICE] for count in (RAYS, MANY_RAYS))
    sheet = ray_sheets.trace(arrays, pose, sheets=1, rays=RAYS)[0, 0, TWICE]
    r = bin_centres(arrays)[TWICE]

    def error(record: Values) -> float:
        return float(100.0 * np.linalg.norm(record - exact) / np.linalg.norm(exact))

    return Measured.by(error, single, sheet, panel(
        common(r, single / exact, "rays binned one by one", ".", markersize=3),
        ours(r, sheet / exact, "spread between neighbours", ".", markersize=3),
        inked(None, 1.0, linewidth=0.6),
        x="slant range (m)", y="echo over that of many rays", ylim=(0.6, 1.6), legend="upper right",
    ))  # fmt: skip
