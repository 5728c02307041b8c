"""Hits of refracted rays: each is a row of short chords, tested one after the other as straight rays are.

Rays come in batches, and solids, meshes and the bed are tested against a whole batch in turn: handing a scene's arrays
over chord by chord costs more than the walk.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.compiler.jit import inlined, kernel
from insonify.kernels.common.types import BED
from insonify.kernels.geometry.solids import intersect_solid
from insonify.kernels.geometry.triangles import NO_TRIANGLE, facing_normal, intersect_mesh
from insonify.kernels.rays.cell_walk import NOTHING, Ray, meet_bed
from insonify.kernels.rays.march import march_chord

OVERLAP = 1e-9  # m by which chords are extended, so that rounding hides nothing where two of them meet
# Columns of a chord: its start, unit direction and length; the number of its arc; and in the ray's vertical plane the
# ground range of its start and the level part of its direction.
X, Y, Z, DX, DY, DZ, LENGTH, ARC, GROUND, ALONG = 0, 1, 2, 3, 4, 5, 6, 7, 8, 9
COLUMNS = 10


class ChordBatch(NamedTuple):
    """The chords of some rays, those of each one after the other, and what each ray may meet."""

    chords: NDArray[np.float64]  # (m, COLUMNS)
    start: NDArray[np.int64]  # (rays + 1,) first chord of each ray
    near: NDArray[np.int64]  # (rays, bodies) bodies that its plane crosses
    listed: NDArray[np.int64]  # (rays,) and their number
    meshed: NDArray[np.bool_]  # (rays,) whether it may cross the mesh


class ChordHits(NamedTuple):
    """First hit of each ray of a batch, (rays,) each."""

    chord: NDArray[np.int64]
    distance: NDArray[np.float64]  # along that chord, m
    body: NDArray[np.int64]  # as in Hits
    material: NDArray[np.int64]
    nx: NDArray[np.float64]
    ny: NDArray[np.float64]
    nz: NDArray[np.float64]


@kernel
def empty_batch(rays, bodies):
    """Room for the chords of some rays."""
    return ChordBatch(
        np.empty((8 * rays, COLUMNS)), np.zeros(rays + 1, np.int64), np.empty((rays, bodies), np.int64),
        np.zeros(rays, np.int64), np.zeros(rays, np.bool_),
    )  # fmt: skip


@kernel
def empty_chord_hits(rays):
    """Room for the hits of some rays."""
    return ChordHits(
        np.empty(rays, np.int64), np.empty(rays), np.empty(rays, np.int64), np.empty(rays, np.int64),
        np.empty(rays), np.empty(rays), np.empty(rays),
    )  # fmt: skip


@kernel
def meet_chords(bed, solids, mesh, batch, rays, met):
    """First hits of the rays of a batch, exact along their chords."""
    _meet_bodies(solids, batch, rays, met)
    if mesh.skip.size > 0:
        _meet_mesh(solids, mesh, batch, rays, met)
    _meet_bed(bed, batch, rays, met)


@kernel
def march_chords(bed, solids, mesh, batch, rays, met):
    """First hits of the rays of a batch, by one sample at the end of each chord; triangles are met where they are."""
    chords = batch.chords
    for k in range(rays):
        met.chord[k], met.distance[k], met.body[k], met.material[k] = (
            batch.start[k + 1],
            math.inf,
            NOTHING,
            0,
        )
        for c in range(batch.start[k], batch.start[k + 1]):
            way = Ray(chords[c, X], chords[c, Y], chords[c, Z], chords[c, DX], chords[c, DY], chords[c, DZ])
            distance, body, material, nx, ny, nz = march_chord(
                bed, solids, batch.near[k], batch.listed[k], way, chords[c, LENGTH]
            )
            if body != NOTHING:
                met.chord[k], met.distance[k], met.body[k], met.material[k] = (
                    c,
                    distance,
                    body,
                    material,
                )
                met.nx[k], met.ny[k], met.nz[k] = nx, ny, nz
                break
    if mesh.skip.size > 0:
        _meet_mesh(solids, mesh, batch, rays, met)


@inlined
def _limit(chords, met, k, c):
    """Distance along chord c up to which a hit of ray k is nearer than the known one, m."""
    limit = chords[c, LENGTH] + OVERLAP
    return min(limit, met.distance[k]) if c == met.chord[k] else limit


@kernel
def _meet_bodies(solids, batch, rays, met):
    """Initialise the hits of a batch with the first solid on each ray."""
    chords = batch.chords
    for k in range(rays):
        met.chord[k], met.distance[k], met.body[k], met.material[k] = (
            batch.start[k + 1],
            math.inf,
            NOTHING,
            0,
        )
        for m in range(batch.listed[k]):
            body = batch.near[k, m]
            for c in range(batch.start[k], min(met.chord[k] + 1, batch.start[k + 1])):
                distance, nx, ny, nz = intersect_solid(
                    solids, body, chords[c, X], chords[c, Y], chords[c, Z], chords[c, DX], chords[c, DY], chords[c, DZ]
                )
                limit = _limit(chords, met, k, c)
                if distance < limit:
                    met.chord[k], met.distance[k], met.body[k], met.material[k] = (
                        c,
                        distance,
                        body,
                        solids.material[body],
                    )
                    met.nx[k], met.ny[k], met.nz[k] = nx, ny, nz
                    break


@kernel
def _meet_mesh(solids, mesh, batch, rays, met):
    """Replace the hit of each ray by its first triangle where that is nearer."""
    chords = batch.chords
    for k in range(rays):
        if not batch.meshed[k]:
            continue
        for c in range(batch.start[k], min(met.chord[k] + 1, batch.start[k + 1])):
            dx, dy, dz = chords[c, DX], chords[c, DY], chords[c, DZ]
            limit = _limit(chords, met, k, c)
            distance, triangle = intersect_mesh(mesh, chords[c, X], chords[c, Y], chords[c, Z], dx, dy, dz, limit)
            if triangle != NO_TRIANGLE:
                met.chord[k], met.distance[k], met.body[k] = (
                    c,
                    distance,
                    solids.shape.size + triangle,
                )
                met.material[k] = mesh.material[triangle]
                met.nx[k], met.ny[k], met.nz[k] = facing_normal(mesh, triangle, dx, dy, dz)
                break


@kernel
def _meet_bed(bed, batch, rays, met):
    """Replace the hit of each ray by the bed where that is nearer; a ray inside the bed ends there."""
    chords = batch.chords
    for k in range(rays):
        for c in range(batch.start[k], min(met.chord[k] + 1, batch.start[k + 1])):
            way = Ray(chords[c, X], chords[c, Y], chords[c, Z], chords[c, DX], chords[c, DY], chords[c, DZ])
            limit = _limit(chords, met, k, c)
            distance, material, nx, ny, nz = meet_bed(bed, way, limit)
            if distance < limit:
                met.chord[k], met.distance[k], met.body[k], met.material[k] = (
                    c,
                    distance,
                    BED,
                    material,
                )
                met.nx[k], met.ny[k], met.nz[k] = nx, ny, nz
                break
            if distance != distance:
                if c < met.chord[k]:
                    met.body[k] = NOTHING
                break
