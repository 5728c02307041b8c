"""Closed parts of triangles from which generated targets are put together: skins of plates, bars and blocks."""

import hashlib
import math

import numpy as np
from numpy.typing import ArrayLike

from insonify.arrays import Booleans, Floats
from insonify.scene.targets.shape import block, rotation_matrix

Triangles = Floats  # (triangles, 3, 3) corners, counter-clockwise from outside


def draw_shares(seed: int, name: str, *shape: int) -> Floats:
    """Hash a seed and a name to uniform numbers inside (0, 1); a larger array begins with the smaller one."""
    digest = hashlib.shake_128(f"{seed}\n{name}".encode()).digest(8 * math.prod(shape))
    bits = np.frombuffer(digest, "<u8") >> np.uint64(12)
    return np.asarray(((bits + 0.5) * 2.0**-52).reshape(shape), dtype=np.float64)


def skin(grid: Floats, thickness: float, present: Booleans | None = None) -> Triangles:
    """Plates of one thickness, m, inwards of a right-handed grid (rows, columns, 3), closed where some are missing."""
    along, across = (np.gradient(grid, axis=axis) for axis in (0, 1))
    normal = np.cross(along, across)
    inner = grid - thickness * normal / np.maximum(np.linalg.norm(normal, axis=-1, keepdims=True), 1e-12)
    there = np.ones((grid.shape[0] - 1, grid.shape[1] - 1), np.bool_) if present is None else present
    ring = np.pad(there, 1)
    # Corners of every plate in the sense of rotation about the outward normal.
    (a, b, c, d), (e, f, g, h) = ((at[:-1, :-1], at[1:, :-1], at[1:, 1:], at[:-1, 1:]) for at in (grid, inner))
    edges = [(a, b, f, e, ring[1:-1, :-2]), (b, c, g, f, ring[2:, 1:-1])]
    edges += [(c, d, h, g, ring[1:-1, 2:]), (d, a, e, h, ring[:-2, 1:-1])]
    quads = [np.stack(four, axis=-2)[there] for four in ((a, b, c, d), (h, g, f, e))]
    quads += [np.stack([q, p, s, r], axis=-2)[there & ~beside] for p, q, r, s, beside in edges]
    return _halved(np.concatenate(quads))


def bars(starts: ArrayLike, ends: ArrayLike, radius: ArrayLike, faces: int = 4, taper: float = 1.0) -> Triangles:
    """Straight bars with regular polygons as sections; ``taper`` is the last radius over the first."""
    first, last = np.atleast_2d(np.asarray(starts, float)), np.atleast_2d(np.asarray(ends, float))
    axis = last - first
    steep = np.abs(axis[:, 2:]) > 0.9 * np.linalg.norm(axis, axis=1, keepdims=True)
    aside = np.cross(axis, np.where(steep, [[1.0, 0.0, 0.0]], [[0.0, 0.0, 1.0]]))
    aside /= np.maximum(np.linalg.norm(aside, axis=1, keepdims=True), 1e-12)
    beside = np.cross(axis, aside)
    beside /= np.maximum(np.linalg.norm(beside, axis=1, keepdims=True), 1e-12)
    angle = 2.0 * np.pi * (np.arange(faces) + 0.5) / faces
    circle = np.cos(angle)[:, None] * aside[:, None] + np.sin(angle)[:, None] * beside[:, None]
    circle *= np.broadcast_to(np.asarray(radius, float), (len(first),))[:, None, None]
    low, high = first[:, None] + circle, last[:, None] + taper * circle
    walls = np.stack([low, np.roll(low, -1, 1), np.roll(high, -1, 1), high], axis=2)
    fan = [np.stack([ring[:, :1].repeat(faces - 2, 1), ring[:, 1:-1], ring[:, 2:]], axis=2) for ring in (low, high)]
    fan[0] = fan[0][:, :, ::-1]
    return np.concatenate([_halved(walls.reshape(-1, 4, 3)), *(part.reshape(-1, 3, 3) for part in fan)])


def blocks(centres: ArrayLike, sizes: ArrayLike, angles: ArrayLike = (0.0, 0.0, 0.0)) -> Triangles:
    """Blocks of (length, width, height), each turned by heading, pitch and roll in degrees about its centre."""
    places = np.atleast_2d(np.asarray(centres, float))
    extents, turns = (np.broadcast_to(np.asarray(values, float), places.shape) for values in (sizes, angles))
    each = [
        block((size[0], size[1], size[2])) @ rotation_matrix(*turn).T + place
        for place, size, turn in zip(places, extents, turns)
    ]
    return np.concatenate([np.zeros((0, 3, 3)), *each])


def tube(middles: Floats, radii: ArrayLike, faces: int, squash: float = 1.0) -> Floats:
    """Grid (stations, faces + 1, 3) of a round surface about points along x, ``squash`` times as high as wide."""
    angle = 2.0 * np.pi * np.arange(faces + 1) / faces
    around = np.stack([np.zeros_like(angle), -np.sin(angle), -squash * np.cos(angle)], axis=1)
    return np.asarray(middles[:, None] + np.asarray(radii, float)[:, None, None] * around)


def roughen(triangles: Triangles, height: float, seed: int) -> Triangles:
    """Move every distinct corner by up to a height in a random direction, so that closed parts stay closed."""
    if height == 0.0:
        return triangles
    corners, index = np.unique(np.rint(triangles.reshape(-1, 3) * 1e6), axis=0, return_inverse=True)
    moved = 1e-6 * corners + height * (2.0 * draw_shares(seed, "growth", len(corners), 3) - 1.0)
    return np.asarray(moved[index.reshape(-1)].reshape(-1, 3, 3))


def _halved(quads: Floats) -> Triangles:
    """Two triangles of each quadrangle."""
    return np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
