"""Layered water made straight: every place is put where it seems to be, along its launch angle at its slant range.

From one sonar, a place reached by one ray alone is known by that ray's launch angle θ0 and travel time τ. Put at

    x' = r' cosθ0,  z' = r' sinθ0,  r' = reference speed · τ,

it stays behind and before the same places as it is in truth, and sound goes straight to it: horizon, screen and bins
need not know of the water. This map is as smooth as the water, straight down and level with the sonar too, so that
tables of x'/x and z' - z are coarse and their errors small.

With q the distance across the ray per launch angle, N = q/r' tells what the map does to energy. A piece of surface
ds seen at incidence α spans the launch angle dθ0 = cosα ds / q, and one-way intensity over that at 1 m is
cosθ0 / (x |q|) = (x'/x) / (N r'²). Hence the true incidence, spreading and along-track width follow from N.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.kernels.jit import fused, kernel

COLUMNS = 4
LEVEL, RISE, TUBE, TURN = 0, 1, 2, 3  # x'/x - 1; z' - z, m; N - 1; angle of arrival above that of launch, rad
UPRIGHT = 1e-3  # ground range between two knots, at least, as a share of what it is in truth


class Bending(NamedTuple):
    """Tables of layered water for the sonar at evenly spaced heights; without them sound goes straight."""

    bent: bool
    tables: NDArray[np.float32]  # (heights, rows, columns, 4) LEVEL, RISE, TUBE and TURN at each height of a place
    sonar_low: float  # height of the sonar of the first table, m
    sonar_step: float  # and between tables
    low: float  # height of the first row, m
    row_step: float
    column_step: float  # of ground range, from 0
    stretch: float  # ground range over slant range, at most


class Sheet(NamedTuple):
    """How to read the table of one ping."""

    bent: bool  # whether there is one
    stretch: float  # ground range over slant range, at most
    low: float  # height of the first row above the sonar, m
    per_row: float  # rows per metre
    per_column: float
    rows: int
    columns: int


def no_bending() -> Bending:
    """Return the tables of water in which sound goes straight: none."""
    return Bending(False, np.zeros((0, 2, 2, COLUMNS), np.float32), 0.0, 1.0, 0.0, 1.0, 1.0, 1.0)


def empty_table(bending: Bending) -> NDArray[np.float32]:
    """Make room for the table of one ping."""
    return np.zeros(bending.tables.shape[1:], np.float32)


@kernel
def blend_tables(bending, z, table):
    """Fill the table of a sonar at height z from those of the heights below and above."""
    place = (z - bending.sonar_low) / bending.sonar_step
    k = min(max(int(place), 0), bending.tables.shape[0] - 2)
    share = np.float32(place - k)
    below, above, out = bending.tables[k].ravel(), bending.tables[k + 1].ravel(), table.ravel()
    for i in range(out.size):
        out[i] = below[i] + share * (above[i] - below[i])


@fused
def straight_sheet():
    """Tell that sound goes straight."""
    return Sheet(False, 1.0, 0.0, 1.0, 1.0, 2, 2)


@fused
def turn_to(bending, z, table):
    """Fill the table of a sonar at height z, if sound bends; return how to read it."""
    if not bending.bent:
        return straight_sheet()
    blend_tables(bending, z, table)
    _, rows, columns, _ = bending.tables.shape
    per_row, per_column = 1.0 / bending.row_step, 1.0 / bending.column_step
    return Sheet(True, bending.stretch, bending.low - z, per_row, per_column, rows, columns)


@fused
def look_up(table, sheet, x, z):
    """Read LEVEL, RISE, TUBE and TURN of a place at ground range x and height z above the sonar.

    Bilinear; beyond the table as at its edge.
    """
    i, j, fu, fv = cell_of(sheet, x, z)
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


@fused
def cell_of(sheet, x, z):
    """Find the column and row of the cell of a place, and how far into it the place lies."""
    u, v = x * sheet.per_column, (z - sheet.low) * sheet.per_row
    v = v if v > 0.0 else 0.0  # NaN, a hole in the bed, compares false
    u, v = min(u, sheet.columns - 1.0), min(v, sheet.rows - 1.0)
    i, j = min(int(u), sheet.columns - 2), min(int(v), sheet.rows - 2)
    return i, j, np.float32(u - i), np.float32(v - j)


@kernel
def bend_profile(table, sheet, one_wide, x, z, slope, area, level, gain, count):
    """Put the knots of a profile where they seem to be, in place.

    Parameters
    ----------
    table : ndarray of float32, shape (rows, columns, 4)
    sheet : Sheet
    one_wide : bool
        Whether the plane stands for a strip of one width everywhere, not for a wedge of azimuths.
    x, z, slope, area : ndarray
        Of the profile. Slope becomes that of the segment as it seems, and area what makes the cosine of the incidence
        come out as it is: (ds cosα)² = (q dθ0)².
    level : ndarray of float32
        Takes x'/x at the knots.
    gain : ndarray of float32
        Takes what multiplies the energy that the profile would send back were it where it seems: of the spreading
        (x'/x)²/N², there and back, of the surface N, and of a wedge's width x/x'.
    count : int
        Knots.
    """
    one = np.float32(1.0)
    x_before, z_before, true_before, tube_before = 0.0, 0.0, 0.0, one
    for i in range(count):
        correction, rise, tube, _ = look_up(table, sheet, x[i], z[i])
        true, wide, tube = x[i], one + correction, one + tube
        x_here, z_here = true + true * correction, z[i] + rise
        if i > 0:
            # A wall so steep that it would hang over as it seems stays upright.
            x_here = max(x_here, x_before + UPRIGHT * (true - true_before))
            run = np.float32(1.0 / (x_here - x_before))
            slope[i - 1] = np.float32(z_here - z_before) * run
            widened = np.float32(2.0) * np.float32(true - true_before) * run / (tube_before + tube)
            area[i - 1] *= widened * widened
        x[i], z[i], level[i] = x_here, z_here, wide
        gain[i] = (wide * wide if one_wide else wide) / tube
        x_before, z_before, true_before, tube_before = x_here, z_here, true, tube
