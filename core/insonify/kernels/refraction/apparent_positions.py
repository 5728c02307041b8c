"""Apparent positions in layered water: every place is put along its launch angle at its slant range.

From one sonar, a place reached by one ray alone is known by that ray's launch angle θ0 and travel time τ. Put at

    x' = r' cosθ0,  z' = r' sinθ0,  r' = reference speed · τ,

it keeps its order before and behind other places, and sound goes straight to it: horizon, z-buffer and bins can
ignore the refraction. This map is as smooth as the water, straight down and level with the sonar too, so that
tables of x'/x and z' - z are coarse and their errors small.

With q the distance across the ray per launch angle, N = q/r' gives the effect of the map on energy. A piece of surface
ds seen at incidence α spans the launch angle dθ0 = cosα ds / q, and one-way intensity over that at 1 m is
cosθ0 / (x |q|) = (x'/x) / (N r'²). Hence the true incidence, spreading and along-track width follow from N. Derived in
docs/theory/refraction.md.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.kernels.common.jit import inlined, inlined_uncounted, kernel

COLUMNS = 4
LEVEL, RISE, TUBE, TURN = 0, 1, 2, 3  # x'/x - 1; z' - z, m; N - 1; angle of arrival above that of launch, rad
UPRIGHT = 1e-3  # least apparent ground range between two knots, as a share of the true one


class ApparentTables(NamedTuple):
    """Tables of layered water for the sonar at evenly spaced heights; without them sound goes straight."""

    bent: bool
    tables: NDArray[np.float32]  # (heights, rows, columns, 4) LEVEL, RISE, TUBE and TURN at each height of a place
    sonar_low: float  # height of the sonar of the first table, m
    sonar_step: float  # and between tables
    low: float  # height of the first row, m
    row_step: float
    column_step: float  # of ground range, from 0
    stretch: float  # ground range over slant range, at most


class TableGrid(NamedTuple):
    """How to read the table of one ping."""

    bent: bool  # whether there is one
    stretch: float  # ground range over slant range, at most
    low: float  # height of the first row above the sonar, m
    per_row: float  # rows per metre
    per_column: float
    rows: int
    columns: int


def no_apparent_tables() -> ApparentTables:
    """Return the tables of water in which sound goes straight: none."""
    return ApparentTables(False, np.zeros((0, 2, 2, COLUMNS), np.float32), 0.0, 1.0, 0.0, 1.0, 1.0, 1.0)


def empty_table(bending: ApparentTables) -> NDArray[np.float32]:
    """Make room for the table of one ping."""
    return np.zeros(bending.tables.shape[1:], np.float32)


@kernel
def _interpolate_table(bending, z, table):
    """Table of a sonar between the heights of two tables.

    Parameters
    ----------
    bending : ApparentTables
    z : float
        Height of the sonar, m.
    table : ndarray of float32, shape (rows, columns, 4)
        Filled.
    """
    place = (z - bending.sonar_low) / bending.sonar_step
    k = min(max(int(place), 0), bending.tables.shape[0] - 2)
    share = np.float32(place - k)
    below, above, out = bending.tables[k].ravel(), bending.tables[k + 1].ravel(), table.ravel()
    for i in range(out.size):
        out[i] = below[i] + share * (above[i] - below[i])


@inlined_uncounted
def straight_grid():
    """Grid without a table, for water in which sound goes straight.

    Returns
    -------
    TableGrid
    """
    return TableGrid(False, 1.0, 0.0, 1.0, 1.0, 2, 2)


@inlined_uncounted
def prepare_table(bending, z, table):
    """Fill the table of one ping, if water bends sound.

    Parameters
    ----------
    bending, z, table
        As in `_interpolate_table`.

    Returns
    -------
    TableGrid
        How to read it.
    """
    if not bending.bent:
        return straight_grid()
    _interpolate_table(bending, z, table)
    _, rows, columns, _ = bending.tables.shape
    per_row, per_column = 1.0 / bending.row_step, 1.0 / bending.column_step
    return TableGrid(True, bending.stretch, bending.low - z, per_row, per_column, rows, columns)


@inlined
def look_up_position(table, grid, x, z):
    """Entries of a table for a place, bilinear, clamped at the table's edges.

    Parameters
    ----------
    table : ndarray of float32, shape (rows, columns, 4)
    grid : TableGrid
    x, z : float
        Ground range, and height above the sonar, m.

    Returns
    -------
    level, rise, tube, turn : float32
        Entries LEVEL, RISE (m), TUBE and TURN (rad).
    """
    i, j, fu, fv = _locate_cell(grid, x, z)
    gu, gv = np.float32(1.0) - fu, np.float32(1.0) - fv
    a, b, c, d = gu * gv, fu * gv, gu * fv, fu * fv
    level = a * table[j, i, LEVEL] + b * table[j, i + 1, LEVEL] + c * table[j + 1, i, LEVEL]
    rise = a * table[j, i, RISE] + b * table[j, i + 1, RISE] + c * table[j + 1, i, RISE]
    tube = a * table[j, i, TUBE] + b * table[j, i + 1, TUBE] + c * table[j + 1, i, TUBE]
    turn = a * table[j, i, TURN] + b * table[j, i + 1, TURN] + c * table[j + 1, i, TURN]
    return (
        level + d * table[j + 1, i + 1, LEVEL],
        rise + d * table[j + 1, i + 1, RISE],
        tube + d * table[j + 1, i + 1, TUBE],
        turn + d * table[j + 1, i + 1, TURN],
    )


@inlined
def _locate_cell(grid, x, z):
    """Column and row of the cell of a place, and how far into it the place lies."""
    u, v = x * grid.per_column, (z - grid.low) * grid.per_row
    v = v if v > 0.0 else 0.0  # NaN, a hole in the bed, compares false
    u, v = min(u, grid.columns - 1.0), min(v, grid.rows - 1.0)
    i, j = min(int(u), grid.columns - 2), min(int(v), grid.rows - 2)
    return i, j, np.float32(u - i), np.float32(v - j)


@kernel
def apply_apparent_positions(table, grid, one_wide, profile, count):
    """Put the knots of a profile at their apparent positions, in place.

    Parameters
    ----------
    table : ndarray of float32, shape (rows, columns, 4)
    grid : TableGrid
    one_wide : bool
        Whether the plane stands for a strip of one width everywhere, not for a sector of azimuths.
    profile : Profile
        Changed: ``x``, ``z`` and ``slope`` become apparent ones, and ``area`` what makes the cosine of the incidence
        come out as it is: (ds cosα)² = (q dθ0)². ``range_ratio`` takes x'/x at the knots, and ``gain`` what multiplies
        the energy that the profile would send back were it where it appears: of the spreading (x'/x)²/N², there and
        back, of the surface N, and of a sector's width x/x'.
    count : int
        Knots.
    """
    x, z, level, gain = profile.x, profile.z, profile.range_ratio, profile.gain
    _apply_rise(table, grid, x, z, level, gain, count)
    if _overhangs(x, level, count):
        _remove_overhangs(x, level, count)
    _correct_slopes(x, z, level, gain, profile.slope, profile.area, count)
    _finish_knots(x, level, gain, one_wide, count)


@inlined
def _apply_rise(table, grid, x, z, level, tube, count):
    """Read LEVEL and TUBE at the knots of a profile, and add RISE to their heights."""
    right, top, last_column, last_row = grid.columns - 1.0, grid.rows - 1.0, grid.columns - 2, grid.rows - 2
    low, per_row, per_column = grid.low, grid.per_row, grid.per_column
    column, row = -1, -1
    wide, high, tall = _bilinear(table, 0, 0, LEVEL), _bilinear(table, 0, 0, RISE), _bilinear(table, 0, 0, TUBE)
    for k in range(count):
        u, v = min(x[k] * per_column, right), (z[k] - low) * per_row
        v = min(v if v > 0.0 else 0.0, top)  # NaN, a hole in the bed, compares false
        i, j = min(int(u), last_column), min(int(v), last_row)
        if i != column or j != row:
            # Neighbouring knots mostly share a cell: its coefficients stay in registers.
            column, row = i, j
            wide, high, tall = _bilinear(table, j, i, LEVEL), _bilinear(table, j, i, RISE), _bilinear(table, j, i, TUBE)
        fu, fv = np.float32(u - i), np.float32(v - j)
        level[k] = wide[0] + fu * wide[1] + fv * (wide[2] + fu * wide[3])
        tube[k] = tall[0] + fu * tall[1] + fv * (tall[2] + fu * tall[3])
        z[k] += high[0] + fu * high[1] + fv * (high[2] + fu * high[3])


@inlined
def _bilinear(table, j, i, what):
    """Coefficients of 1, u, v and uv of one entry within a cell."""
    here, right, up, across = table[j, i, what], table[j, i + 1, what], table[j + 1, i, what], table[j + 1, i + 1, what]
    return here, right - here, up - here, across - up - right + here


@inlined
def _overhangs(x, level, count):
    """Whether any steep wall of a profile would overhang at its apparent position."""
    leaning = 0
    for k in range(count - 1):
        run = x[k + 1] - x[k]
        leaning += run + (x[k + 1] * level[k + 1] - x[k] * level[k]) < UPRIGHT * run
    return leaning > 0


@inlined
def _remove_overhangs(x, level, count):
    """Move every knot a little beyond the one before it."""
    for k in range(1, count):
        least = x[k - 1] * (1.0 + level[k - 1]) + 2.0 * UPRIGHT * (x[k] - x[k - 1])
        level[k] = max(level[k], np.float32(least / x[k] - 1.0))


@inlined
def _correct_slopes(x, z, level, tube, slope, area, count):
    """Give segments their apparent slopes, and the areas that leave their incidence as it is."""
    two = np.float32(2.0)
    for k in range(count - 1):
        run = x[k + 1] - x[k]
        per_run = np.float32(1.0) / np.float32(run + (x[k + 1] * level[k + 1] - x[k] * level[k]))
        slope[k] = np.float32(z[k + 1] - z[k]) * per_run
        widened = two * np.float32(run) * per_run / (two + tube[k] + tube[k + 1])
        area[k] *= widened * widened


@inlined
def _finish_knots(x, level, gain, one_wide, count):
    """Put knots at their apparent ground ranges, and turn TUBE into the gain."""
    one = np.float32(1.0)
    for k in range(count):
        x[k] += x[k] * level[k]
        level[k] = one + level[k]
        gain[k] = (level[k] * level[k] if one_wide else level[k]) / (one + gain[k])
