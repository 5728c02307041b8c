"""Knots of a plane oblique to the grid, in one pass over the grid lines that it crosses most often.

Between two neighbouring lines v the plane crosses at most one line u, because it runs within 45° of v. Four nodes of
each line v, from the one before the plane to the second beyond it, hold all that the cells on either hand of that line
give to a knot or a segment. The knot on the line u is written in any case, and overwritten where the plane crosses
none: a branch would be mispredicted. Derived in docs/theory/sweep.md.
"""

from typing import NamedTuple

import numpy as np

from insonify.compiler.jit import INTEGER, inlined_uncounted, kernel_separate, kernel_uncounted
from insonify.kernels.bed.grid import MERGED, first_line, wrap_index
from insonify.kernels.bed.profile import padded_count

# How a plane crosses a line u between two lines v: between them, or at the second of them.
CROSSED, CORNER = 1, 2


class LineNodes(NamedTuple):
    """Nodes of one line v about the place where the plane crosses it, in the plane's sense along u."""

    before: float  # heights, m: of the node before the cell
    near: float  # of the cell's nearer node
    far: float  # of its farther node
    beyond: float  # of the node beyond the cell


class LineCrossings(NamedTuple):
    """Where a plane crosses the lines v, counted from the one at or behind its beginning."""

    behind: int  # that line
    step: int  # 1 or -1, from one line to the next
    sense: int  # 1 or -1: a cell w along u lies between the nodes sense·w and sense·(w + 1)
    lines: int  # how many lie between it and the first one at or beyond the end, the latter counted
    start: float  # ground ranges at which it begins and ends, m
    end: float
    from_behind: float  # how far beyond line 0 it begins, in cells
    from_last: float  # and how far beyond the last line but one it ends
    x_behind: float  # ground range of line 0, m
    per_line: float  # and between neighbours
    w0: float  # w grows by rate per metre of ground range, from w0
    rate: float
    lowest: int  # first cell of the bed
    cells: int  # how many it has
    periodic: bool  # whether it repeats


@kernel_separate(INTEGER)
def walk_oblique(nodes, materials, mapped, periodic, spacing, v_is_y, u0, v0, z0, eu, ev, start, end, profile):
    """Fill the knots, gradients, twists and materials of a profile along an oblique plane."""
    crossings = _find_crossings(nodes.shape[1], periodic, spacing, u0, v0, eu, ev, start, end)
    cells, into, before, after = profile.cells, profile.into, profile.before, profile.after
    _locate_cells(crossings, cells, into)
    _mark_crossed(padded_count(crossings.lines), cells, into, profile.crossed)
    count = _place_knots(nodes, crossings, z0, cells, into, profile.crossed, profile.x, profile.z, before, after)
    per_spacing = before.dtype.type(crossings.sense / spacing)
    _fill_gradients(padded_count(count - 1), before, after, per_spacing, profile.gradient, profile.twist)
    if mapped:
        _fill_materials(materials, v_is_y, crossings, cells, profile.crossed, profile.material)
    return count


@inlined_uncounted
def _find_crossings(nu, periodic, spacing, u0, v0, eu, ev, start, end):
    """Find the lines v that a plane crosses."""
    sense, step = 1 if eu > 0.0 else -1, 1 if ev > 0.0 else -1
    v_start, v_end = v0 + start * ev / spacing, v0 + end * ev / spacing
    behind, beyond = first_line(v_start, step), first_line(v_end, -step)
    count, cells = max((beyond - behind) * step, 1), nu if periodic else nu - 1
    x_behind, per_line = (behind - v0) * spacing / ev, step * spacing / ev
    from_behind, from_last = (v_start - behind) * step, (v_end - behind) * step - (count - 1)
    low, w0, rate = 0 if sense > 0 else -cells, sense * u0, abs(eu) / spacing
    return LineCrossings(
        behind, step, sense, count, start, end, from_behind, from_last, x_behind, per_line, w0, rate, low, cells,
        periodic,
    )  # fmt: skip


@inlined_uncounted
def _locate_cells(crossings, cells, into):
    """Cell along u at each line v, and how far into it the plane lies; a line u just ahead counts as crossed."""
    # Cells of a bed that repeats are counted from the first one. The first and the last entry are of the places where
    # the plane begins and ends.
    x_behind, per_line, w0, rate = crossings.x_behind, crossings.per_line, crossings.w0, crossings.rate
    real, low, period = into.dtype.type, float(crossings.lowest), float(crossings.cells)
    start, end, wraps = crossings.start, crossings.end, crossings.periodic
    per_period, highest = 1.0 / period, low + period - 1.0
    for k in range(padded_count(crossings.lines + 1)):
        x = x_behind + k * per_line
        x = x if x > start else start
        x = x if x < end else end
        w = w0 + x * rate
        cell = np.floor(w + MERGED)
        clipped = cell if cell > low else low
        clipped = clipped if clipped < highest else highest
        cell = cell if wraps else clipped
        into[k] = real(w - cell)
        wrapped = (cell - low) - period * np.floor((cell - low) * per_period)
        wrapped = wrapped if wrapped < period else wrapped - period
        cells[k] = np.int32(low + (wrapped if wrapped >= 0.0 else wrapped + period))


@inlined_uncounted
def _mark_crossed(intervals, cells, into, crossed):
    """Mark how a plane crosses a line u between every two lines v: not at all (0), CROSSED or CORNER."""
    merged, between, corner, nothing = into.dtype.type(MERGED), np.int64(CROSSED), np.int64(CORNER), np.int64(0)
    for k in range(intervals):
        crossed[k] = nothing if cells[k + 1] == cells[k] else between if into[k + 1] > merged else corner


@inlined_uncounted
def _place_knots(nodes, crossings, z0, cells, into, crossed, x, z, before, after):
    """Place the knots on lines of both families, with the differences across on either hand; return their number."""
    # A difference is that of the heights of two neighbouring nodes of a line v, interpolated between two lines.
    real, nv, sense, step, last = before.dtype.type, nodes.shape[0], crossings.sense, crossings.step, crossings.lines
    x_behind, per_line, rate = crossings.x_behind, crossings.per_line, crossings.rate
    line = wrap_index(crossings.behind, nv)
    following = wrap_index(crossings.behind + step, nv)
    here = _between(nodes, line, following, crossings.from_behind, sense, np.int64(cells[0]))
    difference = here.far - here.near
    x[0], z[0], after[0] = crossings.start, here.near + difference * np.float64(into[0]) - z0, real(difference)
    # Unsigned places: an index that might be negative takes three more instructions.
    place, one = np.uint64(1), np.uint64(1)
    per_cell, x_next = 1.0 / rate, x_behind + per_line
    per_run = 1.0 / (rate * (x_next - crossings.start))
    for number in range(1, last):
        k = np.uint64(number)
        there = _line_nodes(nodes[np.uint64(following)], sense, np.int64(cells[k]))
        knots = (x_next, np.float64(into[k]), crossed[k - one], per_run, per_cell, z0)
        place = _add_knots(here, there, knots, place, x, z, before, after)
        here, per_run, x_next = there, 1.0 / (rate * per_line), x_behind + (number + 1) * per_line
        line = following
        following += step
        following = 0 if following == nv else nv - 1 if following < 0 else following
    there = _between(nodes, line, following, crossings.from_last, sense, np.int64(cells[last]))
    per_run = 1.0 / (rate * (crossings.end - max(x_next - per_line, crossings.start)))
    knots = (crossings.end, np.float64(into[last]), crossed[last - 1], per_run, per_cell, z0)
    return np.int64(_add_knots(here, there, knots, place, x, z, before, after))


@inlined_uncounted
def _add_knots(here, there, knots, place, x, z, before, after):
    """Add the knot on the line u between two lines v, if the plane crosses one, and the one on the second line v."""
    x_next, beyond, crossed, per_run, per_cell, z0 = knots
    real, one = before.dtype.type, np.uint64(1)
    first, last = here.far - here.near, there.far - there.near
    left, right = there.near - there.before, here.beyond - here.far
    # How far on the way between the lines v the plane crosses the line u.
    share = 1.0 - beyond * per_run
    x[place], z[place] = x_next - beyond * per_cell, here.far + (there.near - here.far) * share - z0
    before[place], after[place] = real(first + share * (left - first)), real(right + share * (last - right))
    place += np.uint64(crossed) & one
    x[place], z[place] = x_next, there.near + last * beyond - z0
    before[place], after[place] = real(left if crossed == CORNER else last), real(last)
    return place + one


@inlined_uncounted
def _fill_gradients(segments, before, after, per_spacing, gradient, twist):
    """Gradient across the strip at the middle of segments, and its change along them."""
    half = gradient.dtype.type(0.5) * per_spacing
    for i in range(segments):
        gradient[i] = half * (after[i] + before[i + 1])
        twist[i] = per_spacing * (before[i + 1] - after[i])


@inlined_uncounted
def _line_nodes(row, sense, cell):
    """Heights of the four nodes about a cell of one line v."""
    near, nu = sense * cell, row.size
    before, far, beyond = near - sense, near + sense, near + 2 * sense
    # One test serves all four: the outermost two lie on the row.
    if not (0 <= min(before, beyond) and max(before, beyond) < nu):
        before, near = wrap_index(before, nu), wrap_index(near, nu)
        far, beyond = wrap_index(far, nu), wrap_index(beyond, nu)
    return LineNodes(
        np.float64(row[np.uint64(before)]),
        np.float64(row[np.uint64(near)]),
        np.float64(row[np.uint64(far)]),
        np.float64(row[np.uint64(beyond)]),
    )


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
def _fill_materials(materials, v_is_y, crossings, cells, crossed, out):
    """Material of each segment's cell."""
    place, step, sense = 0, crossings.step, crossings.sense
    for k in range(crossings.lines):
        line = crossings.behind + k * step
        out[place] = _material(materials, v_is_y, sense, step, np.int64(cells[k]), line)
        place += 1
        if crossed[k] == CROSSED:
            out[place] = _material(materials, v_is_y, sense, step, np.int64(cells[k + 1]), line)
            place += 1


@inlined_uncounted
def _material(materials, v_is_y, sense, step, cell, line):
    """Material of the cell between a line v and the next one in the plane's sense; a cell belongs to its low corner."""
    u, v = (cell if sense > 0 else -cell - 1), (line if step > 0 else line - 1)
    rows, columns = materials.shape
    if v_is_y:
        return materials[wrap_index(v, rows), wrap_index(u, columns)]
    return materials[wrap_index(u, rows), wrap_index(v, columns)]
