"""Triangles of polygons, which may be concave, bent, or reach their holes by bridges."""

from itertools import pairwise

import numpy as np

from insonify.arrays import Booleans, Floats, Integers
from insonify.io.file_access import FileFault

ROUNDING = 1e-9  # of a polygon's area
CROSSED = 1e-6  # of the square of a polygon's size: an area that may be lost, as rounded digits make slivers cross
FOLDED = 1e-6  # vector area over area, below which a polygon faces nowhere
STARTS = 8  # corners of a polygon from which a fan is tried


def triangulate(points: Floats, indices: Integers, lengths: Integers) -> Floats:
    """Corners of the triangles, (n, 3, 3), of polygons given by successive runs of indices of points."""
    if indices.size and not 0 <= indices.min() <= indices.max() < len(points):
        raise FileFault(f"has a face with a vertex that is not among its {len(points)}", "export it again")
    begins = np.cumsum(lengths) - lengths
    pieces = [np.empty((0, 3, 3))]
    for sides in np.unique(lengths[lengths >= 3]):
        chosen = begins[lengths == sides, None] + np.arange(sides)
        pieces.append(_triangulate_alike(points[indices[chosen]]))
    return np.concatenate(pieces)


def _triangulate_alike(polygons: Floats) -> Floats:
    """Triangles of polygons with one number of sides: fans where one covers the polygon, ears of the others."""
    sides, pieces = polygons.shape[1], [np.empty((0, 3, 3))]
    if sides == 3:
        return polygons
    for start in range(min(sides, STARTS)):
        fans = _fan(np.roll(polygons, -start, axis=1))
        covers = _covers(fans)
        pieces.append(fans[covers].reshape(-1, 3, 3))
        polygons = polygons[~covers]
    return np.concatenate([*pieces, *map(_clip_ears, polygons)])


def _fan(polygons: Floats) -> Floats:
    """Triangles of polygons about their first corners, (n, sides - 2, 3, 3)."""
    first = np.broadcast_to(polygons[:, :1], polygons[:, 2:].shape)
    return np.stack([first, polygons[:, 1:-1], polygons[:, 2:]], axis=2)


def _covers(triangles: Floats) -> Booleans:
    """Whether triangles of polygons, (n, triangles, 3, 3), cover them once as seen along their mean normals."""
    across = np.cross(triangles[..., 1, :] - triangles[..., 0, :], triangles[..., 2, :] - triangles[..., 0, :])
    normal = across.sum(axis=1)  # twice the vector area, which does not depend on the triangles
    size, length = np.linalg.norm(across, axis=2).sum(axis=1), np.linalg.norm(normal, axis=1)
    least = (across @ normal[:, :, None]).min(axis=(1, 2))
    # A polygon without a vector area crosses itself, or all its corners lie on a line.
    longest = np.square(np.ptp(triangles, axis=(1, 2))).sum(axis=1)
    return np.asarray((least >= -ROUNDING * size * length) & ((length > FOLDED * size) | (size <= CROSSED * longest)))


def _clip_ears(polygon: Floats) -> Floats:
    """Triangles of one polygon, cut off corner by corner; collinear corners stay, so that neighbours meet there."""
    edges = polygon - polygon[0]
    normal = np.cross(edges[1:-1], edges[2:]).sum(axis=0)
    aside = np.cross(normal, np.eye(3)[np.abs(normal).argmin()])
    axes = np.stack([aside, np.cross(normal, aside)], axis=1)
    flat = edges @ (axes / np.maximum(np.linalg.norm(axes, axis=0), np.finfo(float).tiny))  # as seen against the normal
    flat /= max(np.abs(flat).max(), np.finfo(float).tiny)
    left, ears = list(range(len(polygon))), []
    while (ear := _find_ear(flat[left])) is not None:
        ears.append([left[ear - 1], left[ear], left[(ear + 1) % len(left)]])
        del left[ear]
    ears += [[left[0], *pair] for pair in pairwise(left[1:])]
    area = _twice_area(*np.moveaxis(flat[ears], 1, 0))
    if not normal.any() or np.abs(area).sum() > area.sum() + CROSSED:
        raise FileFault(f"has a face of {len(polygon)} vertices that crosses itself", "export it as triangles")
    return np.asarray(polygon[ears])


def _find_ear(ring: Floats) -> int | None:
    """Find a corner whose triangle with its neighbours holds no other corner of a polygon in a plane."""
    before, after = np.roll(ring, 1, axis=0), np.roll(ring, -1, axis=0)
    turns = _twice_area(before, ring, after)
    others = np.flatnonzero(turns <= ROUNDING)  # a corner inside an ear is a reflex one, or one of them is
    # A bridge to a hole runs through the same places twice: corners on the rim count only while that leaves an ear.
    for rim in (-ROUNDING, ROUNDING) if len(ring) > 3 else ():
        for k in np.flatnonzero(turns > ROUNDING):
            a, b, c = before[k], ring[k], after[k]
            inside = np.min([_twice_area(*side, ring[others]) for side in ((a, b), (b, c), (c, a))], axis=0) > rim
            if np.isin(others[inside], [k, (k - 1) % len(ring), (k + 1) % len(ring)]).all():
                return int(k)
    return None


def _twice_area(a: Floats, b: Floats, c: Floats) -> Floats:
    """Twice the area of triangles in a plane, positive where they run counter-clockwise."""
    across, along = b - a, c - a
    return np.asarray(across[..., 0] * along[..., 1] - across[..., 1] * along[..., 0])
