"""Footprint of a beam on the bed, and the squares of a lattice that lie in it."""

from __future__ import annotations

import math

import numpy as np

from insonify.compiler.jit import inlined

STEEPEST = 0.999  # sine from athwart beyond which a beam is taken to reach all ahead
EMPTY = 1e300


@inlined
def lattice_rows(beam, corners, pitch):
    """Rows of a lattice that a footprint meets within reach."""
    low, high = max(corners[:, 1].min(), beam.y - beam.reach), min(corners[:, 1].max(), beam.y + beam.reach)
    return math.floor(low / pitch), math.floor(high / pitch) + 1


@inlined
def lattice_columns(beam, corners, pitch, row):
    """Columns of a lattice that a footprint meets within reach, in one row."""
    low, high = _extent_in_x(corners, row * pitch, (row + 1) * pitch)
    low, high = max(low, beam.x - beam.reach), min(high, beam.x + beam.reach)
    return math.floor(low / pitch), math.floor(high / pitch) + 1


@inlined
def beam_footprint(beam, lowest, highest):
    """Trapezoid that encloses all the bed inside one side's beam."""
    depth = max(abs(lowest - beam.z), abs(highest - beam.z))
    corners = np.empty((4, 2))
    for k in range(4):
        across = 0.0 if k == 0 or k == 3 else beam.reach
        if k < 2:
            along = -_foremost(beam, -beam.s_low, depth, across)
        else:
            along = _foremost(beam, beam.s_high, depth, across)
        corners[k, 0] = beam.x + across * beam.side_x + along * beam.ahead_x
        corners[k, 1] = beam.y + across * beam.side_y + along * beam.ahead_y
    return corners


@inlined
def _foremost(beam, sine, depth, across):
    """Greatest distance ahead of bed inside the beam, at a distance across: a·cos p + z·sin p = s·√(x² + a² + z²).

    The distance ahead is convex in the distance across, so that the chord over its ends encloses all between.
    """
    cos_pitch = math.sqrt(1.0 - beam.axis_z * beam.axis_z)
    s, tip = min(sine / cos_pitch, STEEPEST), abs(beam.axis_z) * depth / cos_pitch
    if s <= 0.0:
        return s * across + tip
    open_to = 1.0 - s * s
    return (tip + s * math.sqrt(tip * tip + open_to * (across * across + depth * depth))) / open_to


@inlined
def _extent_in_x(corners, low, high):
    """Least and greatest x of a convex figure between two values of y."""
    least, greatest = EMPTY, -EMPTY
    for k in range(4):
        x, y = corners[k, 0], corners[k, 1]
        dx, dy = corners[(k + 1) % 4, 0] - x, corners[(k + 1) % 4, 1] - y
        start, stop = 0.0, 1.0
        if dy != 0.0:
            one, other = (low - y) / dy, (high - y) / dy
            start, stop = max(start, min(one, other)), min(stop, max(one, other))
        elif not low <= y <= high:
            continue
        if start <= stop:
            least = min(least, x + start * dx, x + stop * dx)
            greatest = max(greatest, x + start * dx, x + stop * dx)
    return least, greatest
