"""Apparent positions in layered water: every place is put along its launch angle at its slant range.

From one sonar, a place reached by one ray alone is known by that ray's launch angle θ0 and travel time τ. Put at

    x' = r' cosθ0,  z' = r' sinθ0,  r' = reference speed · τ,

it keeps its order before and behind other places, and sound goes straight to it: horizon, z-buffer and bins can
ignore the refraction. This map is as smooth as the water, straight down and level with the sonar too, so that
tables of x'/x and z' - z are coarse and their errors small.

With q the distance across the ray per launch angle, N = q/r' gives the effect of the map on energy. A piece of surface
ds seen at incidence α spans the launch angle dθ0 = cosα ds / q, and one-way intensity over that at 1 m is
cosθ0 / (x |q|) = (x'/x) / (N r'²). Hence spreading and along-track width follow from N; the true incidence follows from
the direction of arrival. Derived in docs/theory/refraction.md.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.compiler.jit import NOTHING, inlined, inlined_uncounted, kernel_separate

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


@kernel_separate(NOTHING, counting=True)
def _interpolate_table(bending, z, table):
    """Table of a sonar between the heights of two tables."""
    place = (z - bending.sonar_low) / bending.sonar_step
    k = min(max(int(place), 0), bending.tables.shape[0] - 2)
    share = np.float32(place - k)
    below, above, out = bending.tables[k].ravel(), bending.tables[k + 1].ravel(), table.ravel()
    for i in range(out.size):
        out[i] = below[i] + share * (above[i] - below[i])


@inlined_uncounted
def straight_grid():
    """Grid without a table, for water in which sound goes straight."""
    return TableGrid(False, 1.0, 0.0, 1.0, 1.0, 2, 2)


@inlined_uncounted
def prepare_table(bending, z, table):
    """Fill the table of one ping, if water bends sound."""
    if not bending.bent:
        return straight_grid()
    _interpolate_table(bending, z, table)
    _, rows, columns, _ = bending.tables.shape
    per_row, per_column = 1.0 / bending.row_step, 1.0 / bending.column_step
    return TableGrid(True, bending.stretch, bending.low - z, per_row, per_column, rows, columns)


@inlined
def look_up_position(table, grid, x, z):
    """Entries of a table for a place, bilinear, clamped at the table's edges."""
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


@kernel_separate(NOTHING)
def apply_apparent_positions(table, grid, one_wide, profile, count):
    """Put the knots of a profile at their apparent positions, in place.

    Parameters
    ----------
    table : ndarray of float32, shape (rows, columns, 4)
    grid : TableGrid
    one_wide : bool
        Whether the plane stands for a strip of one width everywhere, not for a sector of azimuths.
    profile : Profile
        Changed: ``x``, ``z`` and ``slope`` become apparent ones, and ``area`` what keeps the area of each segment over
        its apparent ground range. ``facing`` takes the true incidence, from the angle at which sound arrives.
        ``range_ratio`` takes x'/x at the knots, and ``gain`` the factor of the energy that the profile would send back
        from its apparent place. It is (x'/x)²/N² for spreading, there and back, times x/x' for the width of a sector.
    count : int
        Knots.
    """
    x, z, level, gain, turn = profile.x, profile.z, profile.range_ratio, profile.gain, profile.facing
    _apply_rise(table, grid, x, z, level, gain, turn, count)
    if _overhangs(x, level, count):
        _remove_overhangs(x, level, count)
    _correct_segments(x, z, level, profile.slope, profile.area, turn, count)
    _finish_knots(x, level, gain, one_wide, count)


@inlined
def _apply_rise(table, grid, x, z, level, tube, turn, count):
    """Read LEVEL, TUBE and TURN at the knots of a profile, and add RISE to their heights."""
    right, top, last_column, last_row = grid.columns - 1.0, grid.rows - 1.0, grid.columns - 2, grid.rows - 2
    low, per_row, per_column = grid.low, grid.per_row, grid.per_column
    column, row = -math.inf, -math.inf
    wide, high = _curved(table, 0, 0, LEVEL), _curved(table, 0, 0, RISE)
    tall, turned = _planar(table, 0, 0, TUBE), _planar(table, 0, 0, TURN)
    for k in range(count):
        u, v = x[k] * per_column - column, (z[k] - low) * per_row - row
        if not (u >= 0.0 and u < 1.0 and v >= 0.0 and v < 1.0):
            # Neighbouring knots mostly share a cell: its coefficients stay in registers.
            u, v = min(x[k] * per_column, right), (z[k] - low) * per_row
            v = min(v if v > 0.0 else 0.0, top)  # NaN, a hole in the bed, compares false
            i, j = min(int(u), last_column), min(int(v), last_row)
            column, row = np.float64(i), np.float64(j)
            u, v = u - column, v - row
            wide, high = _curved(table, j, i, LEVEL), _curved(table, j, i, RISE)
            tall, turned = _planar(table, j, i, TUBE), _planar(table, j, i, TURN)
        fu, fv = np.float32(u), np.float32(v)
        level[k] = wide[0] + fu * (wide[1] + fu * wide[2]) + fv * (wide[3] + fu * wide[4])
        z[k] += high[0] + fu * (high[1] + fu * high[2]) + fv * (high[3] + fu * high[4])
        tube[k] = tall[0] + fu * tall[1] + fv * tall[2]
        turn[k] = turned[0] + fu * turned[1] + fv * turned[2]


@inlined
def _curved(table, j, i, what):
    """Coefficients of 1, u, u², v and uv of one entry within a cell, curved along u by its second difference."""
    # Without the curvature slant ranges err by 0.1 mm, which is all that a facet may span that faces the sonar.
    here, right, up, across = table[j, i, what], table[j, i + 1, what], table[j + 1, i, what], table[j + 1, i + 1, what]
    # Entries are even functions of ground range.
    before = table[j, i - 1 if i > 0 else 1, what]
    beyond = table[j, i + 2 if i + 2 < table.shape[1] else i + 1, what]
    curvature = np.float32(0.25) * ((before - here) - (right - beyond))
    return here, right - here - curvature, curvature, up - here, (across - up) - (right - here)


@inlined
def _planar(table, j, i, what):
    """Coefficients of 1, u and v of one entry within a cell."""
    # That of uv is left out: at most 4e-4 of TUBE and 4e-5 rad of TURN in water that changes by 10 m/s within 4 m.
    here = table[j, i, what]
    return here, table[j, i + 1, what] - here, table[j + 1, i, what] - here


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
def _correct_segments(x, z, level, slope, area, facing, count):
    """Give segments their apparent slopes and areas, and their true incidence; ``facing`` holds TURN at the knots."""
    # The slope of the tables, which are linear between their places, is off by first order: no incidence comes from it.
    nothing, half, one, sixth = np.float32(0.0), np.float32(0.5), np.float32(1.0), np.float32(1.0 / 6.0)
    for k in range(count - 1):
        run, seen = x[k + 1] - x[k], x[k + 1] * level[k + 1] - x[k] * level[k]
        per_run = one / np.float32(run + seen)
        widened, true_slope = np.float32(run) * per_run, slope[k]
        slope[k] = np.float32(z[k + 1] - z[k]) * per_run
        area[k] *= widened * widened
        # The direction of launch, times slant range, at the middle; and that of arrival, of which r cosα √A follows.
        level_part = half * np.float32(x[k] + x[k + 1] + x[k] * level[k] + x[k + 1] * level[k + 1])
        upright = half * np.float32(z[k] + z[k + 1])
        turn = half * (facing[k] + facing[k + 1])
        squared = turn * turn
        sine, cosine = turn - turn * squared * sixth, one - half * squared
        away = upright * cosine + level_part * sine - true_slope * (level_part * cosine - upright * sine)
        facing[k] = widened * (away if away < nothing else nothing)


@inlined
def _finish_knots(x, level, gain, one_wide, count):
    """Put knots at their apparent ground ranges, and turn TUBE into the gain."""
    one = np.float32(1.0)
    for k in range(count):
        x[k] += x[k] * level[k]
        level[k] = one + level[k]
        tube = one + gain[k]
        gain[k] = (level[k] * level[k] if one_wide else level[k]) / (tube * tube)
