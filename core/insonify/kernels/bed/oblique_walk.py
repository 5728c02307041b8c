"""Knots of a plane oblique to the grid, in one pass over the grid lines that it crosses most often.

Between two neighbouring lines v the plane crosses at most one line u, because it runs within 45° of v. Four nodes of
each line v, from the one before the plane to the second beyond it, hold all that the cells on either hand of that line
give to a knot or a segment. Derived in docs/theory/sweep.md.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from insonify.kernels.bed.grid import MERGED, first_line, last_line, wrap_index
from insonify.kernels.bed.profile import padded_count
from insonify.kernels.common.jit import INTEGER, inlined_uncounted, kernel_separate, kernel_uncounted


class LineNodes(NamedTuple):
    """Nodes of one line v about the place where the plane crosses it, in the plane's sense along u."""

    before: float  # heights, m: of the node before the cell
    near: float  # of the cell's nearer node
    far: float  # of its farther node
    beyond: float  # of the node beyond the cell


@kernel_separate(INTEGER)
def walk_oblique(nodes, materials, mapped, periodic, spacing, v_is_y, u0, v0, z0, eu, ev, start, end, profile):
    """Fill the knots, gradients, twists and materials of a profile along an oblique plane.

    Parameters
    ----------
    nodes : ndarray of float32, shape (nv, nu)
        Heights, one row for each line v.
    materials : ndarray of uint8
        Of the Bed.
    mapped, periodic : bool
        Of the Bed.
    spacing : float
        Between nodes, m.
    v_is_y : bool
        Whether v is the second axis of the bed's coordinates.
    u0, v0 : float
        Where the plane begins, in nodes.
    z0 : float
        Height that counts as 0, m.
    eu, ev : float
        The plane's azimuth, a unit vector with 0 < abs(eu) <= abs(ev).
    start, end : float
        Ground ranges between which it is cut, both on the bed, m.
    profile : Profile
        Filled.

    Returns
    -------
    int
        Knots of the profile.
    """
    x, z, gradient, twist, material = profile.x, profile.z, profile.gradient, profile.twist, profile.material
    real, per_spacing = gradient.dtype.type, (1.0 if eu > 0.0 else -1.0) / spacing
    nv, nu = nodes.shape
    # w counts cells along u in the plane's own sense; a cell w lies between the nodes sense·w and sense·(w + 1).
    sense, step = 1 if eu > 0.0 else -1, 1 if ev > 0.0 else -1
    w0, rate = sense * u0, abs(eu) / spacing
    lowest, highest = (0, nu - 2) if sense > 0 else (1 - nu, -1)
    per_rate = 1.0 / rate
    v_start, v_end = v0 + start * ev / spacing, v0 + end * ev / spacing
    behind, beyond = first_line(v_start, step), last_line(v_end, step)
    x_behind, per_line = (behind - v0) * spacing / ev, step * spacing / ev
    lines = max((beyond - behind) * step, 1)
    w = w0 + start * rate
    cell = _cell_at(w, lowest, highest, periodic)
    line = wrap_index(behind, nv)
    following = wrap_index(behind + step, nv)
    here = _between(nodes, line, following, (v_start - behind) * step, sense, cell)
    x_here = start
    x[0], z[0] = start, here.near + (here.far - here.near) * (w - cell) - z0
    place = 0
    for k in range(1, lines + 1):
        final = k == lines
        x_next = end if final else x_behind + k * per_line
        w = w0 + x_next * rate
        next_cell = _cell_at(w, lowest, highest, periodic)
        if final:
            share = (v_end - (behind + (k - 1) * step)) * step
            there = _between(nodes, line, following, share, sense, next_cell)
        else:
            there = _line_nodes(nodes[following], sense, next_cell)
        crossed = next_cell != cell
        # Where the plane crosses the line u at the cell's far end, and how far that is on the way between the lines v.
        x_across = (next_cell - w0) * per_rate
        share = min(max((x_across - x_here) / (x_next - x_here), 0.0), 1.0) if crossed else 1.0
        first, last = here.far - here.near, there.far - there.near
        turned = share * ((there.near - there.before if crossed else last) - first)
        gradient[place], twist[place] = real((first + 0.5 * turned) * per_spacing), real(turned * per_spacing)
        if mapped:
            material[place] = _material(materials, v_is_y, sense, step, cell, behind + (k - 1) * step)
        place += 1
        if crossed and w - next_cell > MERGED:
            x[place], z[place] = x_across, here.far + (there.near - here.far) * share - z0
            first = here.beyond - here.far
            turned = (1.0 - share) * (last - first)
            gradient[place], twist[place] = real((last - 0.5 * turned) * per_spacing), real(turned * per_spacing)
            if mapped:
                material[place] = _material(materials, v_is_y, sense, step, next_cell, behind + (k - 1) * step)
            place += 1
        x[place], z[place] = x_next, there.near + last * (w - next_cell) - z0
        here, cell, x_here = there, next_cell, x_next
        line = following
        following += step
        following = 0 if following == nv else nv - 1 if following < 0 else following
    # Vectorised passes run on past the last segment.
    for i in range(place, padded_count(place)):
        gradient[i] = twist[i] = real(0.0)
    return place + 1


@inlined_uncounted
def _cell_at(w, lowest, highest, periodic):
    """Cell along u that holds a place; a line just ahead counts as crossed."""
    cell = math.floor(w + MERGED)
    return cell if periodic else min(max(cell, lowest), highest)


@inlined_uncounted
def _line_nodes(row, sense, cell):
    """Heights of the four nodes about a cell of one line v."""
    near, nu = sense * cell, row.size
    before, far, beyond = near - sense, near + sense, near + 2 * sense
    # One test serves all four: the outermost two lie on the row.
    if not (0 <= min(before, beyond) and max(before, beyond) < nu):
        before, near, far, beyond = (
            wrap_index(before, nu),
            wrap_index(near, nu),
            wrap_index(far, nu),
            wrap_index(beyond, nu),
        )
    return LineNodes(np.float64(row[before]), np.float64(row[near]), np.float64(row[far]), np.float64(row[beyond]))


@kernel_uncounted
def _between(nodes, line, following, share, sense, cell):
    """Heights on a line parallel to two neighbouring lines v: a plane may begin and end between them."""
    a, b = _line_nodes(nodes[line], sense, cell), _line_nodes(nodes[following], sense, cell)
    return LineNodes(
        a.before + (b.before - a.before) * share,
        a.near + (b.near - a.near) * share,
        a.far + (b.far - a.far) * share,
        a.beyond + (b.beyond - a.beyond) * share,
    )


@inlined_uncounted
def _material(materials, v_is_y, sense, step, cell, line):
    """Material of the cell between a line v and the next one in the plane's sense; a cell belongs to its low corner."""
    u, v = (cell if sense > 0 else -cell - 1), (line if step > 0 else line - 1)
    rows, columns = materials.shape
    if v_is_y:
        return materials[wrap_index(v, rows), wrap_index(u, columns)]
    return materials[wrap_index(u, rows), wrap_index(v, columns)]
