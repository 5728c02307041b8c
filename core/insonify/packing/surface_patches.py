"""Patches of the surfaces of a scene's solids and meshes, over which scatterers are distributed."""

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from insonify.arrays import Floats, Integers
from insonify.kernels.common.types import SPHERE, Mesh, Solids
from insonify.kernels.speckle.surface_patches import BALL, FACE, FIRST_CAP, LAST_CAP, ROUND, SurfacePatches

WIDEST = 1.0  # m, of a belt or a triangle's edge


class _Belt(NamedTuple):
    """A patch of a solid's surface: a belt about its axis, or a cap."""

    kind: int
    body: int
    low: float
    high: float
    area: float
    centre: Floats
    bound: float


def make_surface_patches(solids: Solids, mesh: Mesh) -> SurfacePatches:
    """Cut the surfaces of all bodies into patches."""
    belts = [belt for body in range(solids.shape.size) for belt in _belts(solids, body) if belt.area > 0.0]
    corners, triangle = _small_triangles(mesh.corners)
    n, m = len(belts), triangle.size
    body = np.array([belt.body for belt in belts], np.int64)
    target = np.concatenate([solids.target[body], mesh.target[triangle]])
    centre = np.concatenate([np.array([belt.centre for belt in belts]).reshape(-1, 3), corners.mean(axis=1)])
    edges = corners[:, 1:] - corners[:, :1]
    sides = np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1)
    away = np.linalg.norm(corners - corners.mean(axis=1, keepdims=True), axis=2).max(axis=1, initial=0.0)
    # The patches of each target are numbered from 0.
    order = np.argsort(target, kind="stable")
    number = np.empty(target.size, np.int64)
    number[order] = np.arange(target.size) - np.searchsorted(target[order], target[order])
    return SurfacePatches(
        kind=np.concatenate([np.array([belt.kind for belt in belts], np.int64), np.full(m, FACE)]),
        body=np.concatenate([body, triangle]),
        target=target,
        number=number,
        low=np.concatenate([[belt.low for belt in belts], np.zeros(m)]),
        high=np.concatenate([[belt.high for belt in belts], np.zeros(m)]),
        corners=np.concatenate([np.zeros((n, 3, 3)), corners]),
        area=np.concatenate([[belt.area for belt in belts], 0.5 * sides]),
        centre=np.ascontiguousarray(centre),
        bound=np.concatenate([[belt.bound for belt in belts], away]),
    )


def _belts(solids: Solids, body: int) -> Iterator[_Belt]:
    """Patches of one solid."""
    start, axis, radius = solids.start[body], solids.axis[body], float(solids.radius[body])
    if solids.shape[body] == SPHERE:
        for low, high in _steps(-radius, radius):
            centre = start + np.array([0.0, 0.0, 0.5 * (low + high)])
            bound = math.hypot(radius, 0.5 * (high - low))
            yield _Belt(BALL, body, low, high, 2.0 * math.pi * radius * (high - low), centre, bound)
        return
    length, taper = float(solids.length[body]), float(solids.taper[body])
    for low, high in _steps(0.0, length):
        first, last = radius + taper * low, radius + taper * high
        area = math.pi * (first + last) * (high - low) * math.hypot(1.0, taper)
        bound = math.hypot(max(first, last), 0.5 * (high - low))
        yield _Belt(ROUND, body, low, high, area, start + 0.5 * (low + high) * axis, bound)
    yield _Belt(FIRST_CAP, body, 0.0, 0.0, math.pi * radius**2, start, radius)
    last = max(radius + taper * length, 0.0)
    yield _Belt(LAST_CAP, body, length, length, math.pi * last**2, start + length * axis, last)


def _steps(low: float, high: float) -> Iterator[tuple[float, float]]:
    edges = np.linspace(low, high, math.ceil((high - low) / WIDEST) + 1)
    return zip(edges[:-1].tolist(), edges[1:].tolist())


def _small_triangles(corners: Floats) -> tuple[Floats, Integers]:
    """Triangles halved at their longest edges until those are short, and the row that each was part of."""
    whole = np.arange(len(corners), dtype=np.int64)
    done, rows = [corners[:0]], [whole[:0]]
    while len(corners):
        lengths = np.linalg.norm(corners - np.roll(corners, -1, axis=1), axis=2)
        small = lengths.max(axis=1) <= WIDEST
        done.append(corners[small])
        rows.append(whole[small])
        corners, whole, longest = corners[~small], whole[~small], lengths[~small].argmax(axis=1)
        # The longest edge first: from a to b, with c opposite.
        a, b, c = (corners[np.arange(len(corners)), (longest + k) % 3] for k in range(3))
        middle = 0.5 * (a + b)
        corners = np.concatenate([np.stack([a, middle, c], axis=1), np.stack([middle, b, c], axis=1)])
        whole = np.concatenate([whole, whole])
    return np.concatenate(done), np.concatenate(rows)
