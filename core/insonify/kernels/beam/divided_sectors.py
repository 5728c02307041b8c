"""Division of a beam's azimuth sectors at the borders of targets, with equal parts across each."""

import math

import numpy as np

from insonify.compiler.jit import inlined, inlined_uncounted, kernel

LEAST = 1e-9  # rad, by which edges of sectors differ
TURNED = 1e-6  # rad, more than a plane is turned to follow the grid
AT_EDGE = 1e-4  # share of a plane's width within which a border of a target is at its edge
LOW, HIGH, ANGLE, FAR_ANGLE, NEAR_FIELD, REACH, APART, COLUMNS = range(8)  # of a divided sector
BEGIN, END, STEP, NEAREST = range(4)  # of a body


@kernel
def divide_sectors(planes, bodies, corners, height, most):
    """Divide the sectors of each ping that are too wide for the bodies in them or hold their borders.

    Parameters
    ----------
    planes : ndarray of float64, shape (planes, COLUMNS)
        Sectors of every ping in the order of their azimuths, which may have gaps between them.
    bodies : ndarray of float64, shape (pings, bodies, 4)
        Azimuths at which each begins and ends, greatest distance of planes across it, rad, infinite for a body that
        does not count, and bound on its least ground range, m.
    corners : ndarray of float64, shape (pings, bodies, corners)
        Azimuths at which a face of a body ends and another begins; NaN for none.
    height : ndarray of float64, shape (pings,)
        Of the sonar above the lowest bed, m; reaches are per metre of it.
    most : int
        Number of parts to which the demands of a ping's bodies are limited.

    Returns
    -------
    parts : ndarray of float64, shape (n, COLUMNS)
        Parts of all divided pings, ping by ping, in the order of their azimuths; `APART` is 1 where a border of a body
        lies at their beginning.
    counts : ndarray of int64, shape (pings,)
        Parts of each ping; 0 where none of its sectors is to be divided.
    """
    found, counts, size = np.zeros((most, COLUMNS)), np.zeros(height.size, np.int64), 0
    for ping in range(height.size):
        if not _is_any_demanded(planes, bodies[ping], corners[ping], height[ping]):
            continue
        parts = _divide_ping(planes, bodies[ping], corners[ping], height[ping], most)
        counts[ping] = parts.shape[0]
        if size + counts[ping] > found.shape[0]:
            more = np.zeros((2 * (size + counts[ping]), COLUMNS))
            more[:size] = found[:size]
            found = more
        found[size : size + counts[ping]] = parts
        size += counts[ping]
    return found[:size], counts


@inlined_uncounted
def _is_any_demanded(planes, bodies, corners, height):
    """Whether any sector of a ping is to be divided."""
    for j in range(bodies.shape[0]):
        if bodies[j, STEP] < math.inf and bodies[j, END] >= planes[0, LOW] and bodies[j, BEGIN] <= planes[-1, HIGH]:
            for k in range(planes.shape[0]):
                if _is_demanded(planes, k, bodies, j, corners, height):
                    return True
    return False


@inlined
def _divide_ping(planes, bodies, corners, height, most):
    """Parts of the sectors of one ping."""
    # Across a body the parts are alike whatever the planes were: a glint is summed to a high order only by equal steps.
    is_dense, concerned = _find_demands(planes, bodies, corners, height)
    borders = _list_borders(planes, bodies, corners, concerned)
    edges = _place_edges(planes, bodies, is_dense, concerned, borders)
    parents, counts = np.full(edges.size - 1, -1), np.ones(edges.size - 1)
    total = 0.0
    for k in range(parents.size):
        middle = 0.5 * (edges[k] + edges[k + 1])
        parents[k] = _find_parent(planes, middle)
        if parents[k] < 0:
            continue
        if is_dense[parents[k]]:
            step = math.inf
            for j in range(bodies.shape[0]):
                if concerned[j] and bodies[j, 0] <= middle <= bodies[j, 1]:
                    step = min(step, bodies[j, 2])
            counts[k] = max((edges[k + 1] - edges[k]) / step, 1.0)
        total += counts[k]
    # Where many bodies lie in the beam, their planes are laid farther apart in equal parts.
    stretch, size = max(total / most, 1.0), 0
    for k in range(parents.size):
        counts[k] = math.ceil(max(counts[k] / stretch, 1.0) - LEAST) if parents[k] >= 0 else 0.0
        size += int(counts[k])
    parts, n = np.zeros((size, COLUMNS)), 0
    for k in range(parents.size):
        width = (edges[k + 1] - edges[k]) / max(counts[k], 1.0)
        for i in range(int(counts[k])):
            _write_part(planes, parents[k], edges[k] + i * width, edges[k] + (i + 1) * width, parts[n])
            n += 1
    place = 0
    for k in range(size):
        while place < borders.size and borders[place] < parts[k, LOW] - LEAST:
            place += 1
        parts[k, APART] = 1.0 if place < borders.size and borders[place] < parts[k, LOW] + LEAST else 0.0
    return parts


@inlined
def _find_demands(planes, bodies, corners, height):
    """Which planes are to be divided, and which bodies demand it."""
    is_dense, concerned = np.zeros(planes.shape[0], np.bool_), np.zeros(bodies.shape[0], np.bool_)
    for j in range(bodies.shape[0]):
        for k in range(planes.shape[0]):
            if _is_demanded(planes, k, bodies, j, corners, height):
                is_dense[k] = concerned[j] = True
    return is_dense, concerned


@inlined_uncounted
def _is_demanded(planes, k, bodies, j, corners, height):
    """Whether plane k is too wide for body j, or contains a border of the body."""
    low, high = planes[k, LOW], planes[k, HIGH]
    begin, end, step = bodies[j, BEGIN], bodies[j, END], bodies[j, STEP]
    if not step < math.inf or end < low or begin > high or bodies[j, NEAREST] > planes[k, REACH] * height:
        return False
    # Little of a plane may hold much of its echo: a face of steel is a hundred times as bright as the bed.
    inward = AT_EDGE * (high - low)
    demanded = low < end and high > begin and high - low > (1.0 + LEAST) * step
    demanded |= (low + inward < begin < high - inward) or (low + inward < end < high - inward)
    for c in range(corners.shape[1]):
        demanded |= low + inward < corners[j, c] < high - inward
    return demanded


@kernel
def find_pings_met(planes, first, last, bodies, height):
    """Whether any plane of each ping may cut a body, (pings,).

    Parameters
    ----------
    planes : ndarray of float64, shape (planes, 2)
        Azimuths of the planes of all pings, rad, and their reaches per metre of height.
    first, last : ndarray of int64, shape (pings,)
        First plane of each ping, and that after its last one.
    bodies, height : ndarray of float64, shapes (pings, bodies, 4) and (pings,)
        As `divide_sectors` has them.
    """
    met = np.zeros(height.size, np.bool_)
    for ping in range(height.size):
        for j in range(bodies.shape[1]):
            begin, end = bodies[ping, j, BEGIN] - TURNED, bodies[ping, j, END] + TURNED
            if not bodies[ping, j, STEP] < math.inf:
                continue
            for k in range(first[ping], last[ping]):
                is_reached = bodies[ping, j, NEAREST] <= planes[k, 1] * height[ping]
                met[ping] |= is_reached and begin <= planes[k, 0] <= end
    return met


@inlined
def _list_borders(planes, bodies, corners, concerned):
    """Borders of the bodies that demand a division, in order and within the beam."""
    least, most, n = planes[0, LOW], planes[-1, HIGH], 0
    found = np.zeros((2 + corners.shape[1]) * bodies.shape[0])
    for j in range(bodies.shape[0]):
        if concerned[j]:
            found[n] = min(max(bodies[j, 0], least), most)
            found[n + 1] = min(max(bodies[j, 1], least), most)
            n += 2
            for c in range(corners.shape[1]):
                if least < corners[j, c] < most:
                    found[n] = corners[j, c]
                    n += 1
    return np.sort(found[:n])


@inlined
def _place_edges(planes, bodies, is_dense, concerned, borders):
    """Edges of planes and of bodies, without those of divided planes that lie across a body."""
    count = planes.shape[0]
    edges, n = np.zeros(2 * count + borders.size + 1), 0
    for k in range(count):
        for column in range(2):
            edge, across = planes[k, column], False
            for j in range(bodies.shape[0]):
                across |= concerned[j] and bodies[j, 0] + LEAST < edge < bodies[j, 1] - LEAST
            if across and edge != 0.0:
                dense = True
                for i in range(max(k - 1, 0), min(k + 2, count)):
                    touches = abs(planes[i, LOW] - edge) < LEAST or abs(planes[i, HIGH] - edge) < LEAST
                    dense &= is_dense[i] or not touches
                if dense:
                    continue
            edges[n] = edge
            n += 1
    edges[n : n + borders.size] = borders
    n += borders.size
    if planes[0, LOW] < 0.0 < planes[-1, HIGH]:
        n += 1  # sectors of a top-hat lie on one side of athwart
    edges = np.sort(edges[:n])
    kept = 1
    for k in range(1, n):
        if edges[k] - edges[kept - 1] > LEAST:
            edges[kept] = edges[k]
            kept += 1
    return edges[:kept]


@inlined
def _find_parent(planes, azimuth):
    """Plane in which an azimuth lies; -1 for none."""
    for k in range(planes.shape[0]):
        if planes[k, LOW] <= azimuth <= planes[k, HIGH]:
            return k
    return -1


@inlined
def _write_part(planes, parent, low, high, part):
    """Fill in a part of a plane's sector."""
    share = (high - low) / (planes[parent, HIGH] - planes[parent, LOW])
    part[LOW], part[HIGH] = low, high
    part[ANGLE], part[FAR_ANGLE] = planes[parent, ANGLE] * share, planes[parent, FAR_ANGLE] * share
    part[NEAR_FIELD], part[REACH] = planes[parent, NEAR_FIELD], planes[parent, REACH]
    for azimuth in (low + LEAST, high - LEAST):
        other = _find_parent(planes, azimuth)
        if other >= 0:
            part[REACH] = max(part[REACH], planes[other, REACH])
