"""Bounding volume hierarchy over triangles, built by the surface area heuristic."""

import numpy as np
from numpy.typing import NDArray

from insonify.compiler.jit import inlined, kernel
from insonify.kernels.common.types import Mesh

LEAF = 4  # triangles at most
SLABS = 8  # per axis, between which a branch may be cut
ONE_PLACE = 1e-9  # m, twice the distance of centres that are not split


def build_mesh(
    corners: NDArray[np.float64],
    material: NDArray[np.int64],
    target: NDArray[np.int64],
    closed: NDArray[np.bool_] | None = None,
) -> Mesh:
    """Build the hierarchy over triangles, none degenerate, and put all that belongs to each into its order."""
    closed = np.zeros(len(corners), np.bool_) if closed is None else closed
    edges = corners[:, 1:] - corners[:, :1]
    normal = np.cross(edges[:, 0], edges[:, 1])
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    # Without triangles, as in many scenes, the kernel is not loaded: its code takes 70 ms.
    boxes, none = np.empty((0, 3)), np.empty(0, np.int64)
    tree = _build_tree(corners) if len(corners) else (none, boxes, boxes, none, none, none)
    order, low, high, skip, first, leaf_size = tree
    return Mesh(
        np.ascontiguousarray(corners[order]), normal[order], material[order], target[order], closed[order],
        low, high, skip, first, leaf_size,
    )  # fmt: skip


@kernel
def _build_tree(corners):
    """Split branches until they are leaves; return the order of the triangles and the nodes, depth first."""
    n = corners.shape[0]
    low, high = np.empty((n, 3)), np.empty((n, 3))  # of each triangle
    for i in range(n):
        for axis in range(3):
            a, b, c = corners[i, 0, axis], corners[i, 1, axis], corners[i, 2, axis]
            low[i, axis], high[i, axis] = min(a, b, c), max(a, b, c)
    order = np.arange(n)
    node_low, node_high = np.empty((2 * n, 3)), np.empty((2 * n, 3))
    skip, first, leaf_size = np.empty(2 * n, np.int64), np.empty(2 * n, np.int64), np.zeros(2 * n, np.int64)
    waiting = np.empty((n + 1, 2), np.int64)
    nodes, depth = 0, 0
    if n > 0:
        waiting[0, 0], waiting[0, 1] = 0, n
        depth = 1
    while depth > 0:
        depth -= 1
        start, stop = waiting[depth, 0], waiting[depth, 1]
        _enclose(order, low, high, start, stop, node_low[nodes], node_high[nodes])
        first[nodes] = start
        if stop - start <= LEAF:
            leaf_size[nodes] = stop - start
        else:
            middle = _split_triangles(order, low, high, start, stop)
            # The nearer branch is taken up next, so that it follows its parent.
            waiting[depth, 0], waiting[depth, 1] = middle, stop
            waiting[depth + 1, 0], waiting[depth + 1, 1] = start, middle
            depth += 2
        nodes += 1
    # Children come after their parents: from the end, every branch below is complete.
    for i in range(nodes - 1, -1, -1):
        skip[i] = i + 1 if leaf_size[i] > 0 else skip[skip[i + 1]]
    return order, node_low[:nodes], node_high[:nodes], skip[:nodes], first[:nodes], leaf_size[:nodes]


@inlined
def _enclose(order, low, high, start, stop, box_low, box_high):
    """Fit the tightest box around some triangles."""
    box_low[:], box_high[:] = np.inf, -np.inf
    for k in range(start, stop):
        for axis in range(3):
            box_low[axis] = min(box_low[axis], low[order[k], axis])
            box_high[axis] = max(box_high[axis], high[order[k], axis])


@kernel
def _split_triangles(order, low, high, start, stop):
    """Split some triangles in two where rays cost least by the surface areas of both boxes; return the border."""
    # Wald (2007), *On fast construction of SAH-based bounding volume hierarchies*, with slabs between centres.
    best, best_axis, best_slab = np.inf, -1, 0
    best_from, best_per_metre = 0.0, 0.0
    counts, lows, highs = np.empty(SLABS, np.int64), np.empty((SLABS, 3)), np.empty((SLABS, 3))
    behind = np.zeros(SLABS)
    for axis in range(3):
        centre_low, centre_high = np.inf, -np.inf
        for k in range(start, stop):
            centre = low[order[k], axis] + high[order[k], axis]
            centre_low, centre_high = min(centre_low, centre), max(centre_high, centre)
        if centre_high - centre_low < ONE_PLACE:
            continue
        per_metre = SLABS * (1.0 - 1e-9) / (centre_high - centre_low)
        counts[:], lows[:], highs[:] = 0, np.inf, -np.inf
        for k in range(start, stop):
            i = order[k]
            slab = slab_of(low[i, axis], high[i, axis], centre_low, per_metre)
            counts[slab] += 1
            for side in range(3):
                lows[slab, side] = min(lows[slab, side], low[i, side])
                highs[slab, side] = max(highs[slab, side], high[i, side])
        _costs_behind(counts, lows, highs, behind)
        slab, price = _cheapest_split(counts, lows, highs, behind)
        if price < best:
            best, best_axis, best_slab, best_from, best_per_metre = price, axis, slab, centre_low, per_metre
    if best_axis < 0:
        return (start + stop) // 2  # all centres coincide: any split will do
    return _partition(order, low, high, start, stop, best_axis, best_slab, best_from, best_per_metre)


@inlined
def slab_of(low, high, centre_low, per_metre):
    """Slab in which the centre of a triangle lies, of one as small as the rounding of its place too."""
    return min(max(int((low + high - centre_low) * per_metre), 0), SLABS - 1)


@inlined
def _costs_behind(counts, lows, highs, behind):
    """Cost of a box around all the slabs after each slab."""
    box_low, box_high = np.full(3, np.inf), np.full(3, -np.inf)
    count = 0
    for slab in range(SLABS - 1, 0, -1):
        count += counts[slab]
        for axis in range(3):
            box_low[axis] = min(box_low[axis], lows[slab, axis])
            box_high[axis] = max(box_high[axis], highs[slab, axis])
        behind[slab - 1] = count * _half_surface(box_low, box_high) if count > 0 else 0.0


@inlined
def _cheapest_split(counts, lows, highs, behind):
    """Find the slab after which a split costs least; neither side may be empty."""
    box_low, box_high = np.full(3, np.inf), np.full(3, -np.inf)
    count, total = 0, counts.sum()
    best, best_price = 0, np.inf
    for slab in range(SLABS - 1):
        count += counts[slab]
        for axis in range(3):
            box_low[axis] = min(box_low[axis], lows[slab, axis])
            box_high[axis] = max(box_high[axis], highs[slab, axis])
        if 0 < count < total:
            price = count * _half_surface(box_low, box_high) + behind[slab]
            if price < best_price:
                best, best_price = slab, price
    return best, best_price


@inlined
def _half_surface(low, high):
    """Half the surface area of a box."""
    x, y, z = high[0] - low[0], high[1] - low[1], high[2] - low[2]
    return x * y + y * z + z * x


@inlined
def _partition(order, low, high, start, stop, axis, last_slab, centre_low, per_metre):
    """Bring the triangles up to a slab to the front, in place; return where the others begin."""
    front, back = start, stop - 1
    while front <= back:
        i = order[front]
        if slab_of(low[i, axis], high[i, axis], centre_low, per_metre) <= last_slab:
            front += 1
        else:
            order[front], order[back] = order[back], i
            back -= 1
    return front if start < front < stop else (start + stop) // 2
