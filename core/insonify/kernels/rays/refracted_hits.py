"""First hits of rays that water bends, along their arcs, and how the rays arrive there.

A ray stays in the vertical plane in which it is launched: horizontal refraction is neglected. Above the bed and all
targets it advances from node to node of the water in one step. Below, each arc is cut into chords so short that they
deviate from it by a fraction of a millimetre, and the chords are tested for hits. Travel time, direction and the width
of the ray tube at a hit are those of the arc.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.compiler.jit import inlined, kernel
from insonify.kernels.common.types import BED
from insonify.kernels.geometry.solids import intersect_solid
from insonify.kernels.geometry.triangles import NO_TRIANGLE, facing_normal, intersect_mesh
from insonify.kernels.rays.caustics import LEAST, MOST_ARCS, field_at_caustic
from insonify.kernels.rays.cell_walk import NOTHING, Hits, Ray, RayBundle, meet_bed
from insonify.kernels.rays.launch import ball_about, box_about
from insonify.kernels.rays.march import march_chord
from insonify.kernels.refraction.arcs import ENDLESS, HIGH, LOW, RANGE, RayState
from insonify.kernels.refraction.section_arcs import SectionPlane, advance_ray, launch_ray

SAGITTA = 1e-4  # m by which a chord may leave its arc
CLEAR = 1e-3  # m above the highest thing and off any node of the water, below which rays are tested for hits
TOGETHER = 64  # rays of a batch
STATE = 8  # numbers of the state of a ray at the start of an arc
OVERLAP = 1e-9  # m by which chords are extended, so that rounding hides nothing where two of them meet
# Columns of a chord: its start, unit direction and length; the number of its arc; and in the ray's vertical plane the
# ground range of its start and the level part of its direction.
X, Y, Z, DX, DY, DZ, LENGTH, ARC, GROUND, ALONG = 0, 1, 2, 3, 4, 5, 6, 7, 8, 9
COLUMNS = 10


class Arrivals(NamedTuple):
    """Directions, tube widths, sound speeds and places with which rays arrive at their hits, (n,) each."""

    dx: NDArray[np.float64]  # unit direction
    dy: NDArray[np.float64]
    dz: NDArray[np.float64]
    tube: NDArray[np.float64]  # m/rad, distance across the tube per elevation at the sonar
    spread: NDArray[np.float64]  # m/rad, and at right angles to that: ground range over the cosine of that elevation
    speed: NDArray[np.float64]  # of sound there, m/s
    x: NDArray[np.float64]  # ground range, m; none of straight rays
    z: NDArray[np.float64]  # height, m; none of straight rays
    # The fields of `CausticField`; none of straight rays.
    focus: NDArray[np.float64]
    dark: NDArray[np.float64]
    shift: NDArray[np.float64]


class LandedRays(NamedTuple):
    """Rays with their hits, and their arrivals there."""

    bundle: RayBundle
    hits: Hits
    arrivals: Arrivals


class VerticalPlane(NamedTuple):
    """The vertical plane of a ray: ground place of its start, and level unit vector of its direction."""

    x: float
    y: float
    ahead_x: float
    ahead_y: float


class ContactZone(NamedTuple):
    """Heights and ground ranges between which a ray may meet anything."""

    floor: float  # m, height below which there is nothing
    ceiling: float  # and above which
    bed: float  # m, height above which there is no bed
    near: float  # m, ground ranges between which there are bodies
    far: float


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
def find_refracted_hits(arrays, bundle, reach, march, hits, arrivals):
    """First hit of each ray along its arcs.

    Parameters
    ----------
    arrays : SceneArrays
    bundle : RayBundle of ndarrays, shape (n,)
    reach : float
        Slant range after which a ray ends, m.
    march : float
        Length of a step of the march, m; exact hits along the chords of the arcs if it is 0.
    hits : Hits of ndarrays, shape (n,)
        Filled; the distance is the slant range: travel time by the speed at the sonar.
    arrivals : Arrivals of ndarrays, shape (n,)
        Filled where there is a hit.
    """
    bed, solids, mesh, water = arrays.bed, arrays.solids, arrays.mesh, arrays.water
    batch, met = _empty_batch(TOGETHER, solids.shape.size), _empty_chord_hits(TOGETHER)
    limits, begins = np.empty((TOGETHER, 5)), np.empty((4 * TOGETHER, STATE))
    for first in range(0, bundle.x.size, TOGETHER):
        count = min(TOGETHER, bundle.x.size - first)
        _find_contact_zones(bed, solids, mesh, water.height, bundle, first, count, batch, limits)
        rows, begins = _lay_chords(water, bundle, first, count, reach, march, limits, batch, begins)
        batch = ChordBatch(rows, batch.start, batch.near, batch.listed, batch.meshed)
        if march > 0.0:
            _march_chords(bed, solids, mesh, batch, count, met)
        else:
            _meet_chords(bed, solids, mesh, batch, count, met)
        _arrive(water, LandedRays(bundle, hits, arrivals), first, count, reach, batch, begins, met)


@kernel
def empty_arrivals(n):
    """Room for n arrivals."""
    return Arrivals(
        np.empty(n), np.empty(n), np.empty(n), np.empty(n), np.empty(n), np.empty(n), np.empty(n), np.empty(n),
        np.empty(n), np.empty(n), np.empty(n),
    )  # fmt: skip


@kernel
def clear_of_nodes(height, ceiling):
    """Least height clear of a ceiling and of the water's nodes."""
    ceiling += CLEAR
    for k in range(height.size):
        if abs(height[k] - ceiling) < 0.5 * CLEAR:
            ceiling += CLEAR
    return ceiling


@inlined
def _vertical_plane(bundle, k):
    """Vertical plane of ray k, any for a vertical one, and the level part of its direction."""
    level = math.sqrt(bundle.dx[k] * bundle.dx[k] + bundle.dy[k] * bundle.dy[k])
    if level > 0.0:
        return VerticalPlane(bundle.x[k], bundle.y[k], bundle.dx[k] / level, bundle.dy[k] / level), level
    return VerticalPlane(bundle.x[k], bundle.y[k], 1.0, 0.0), 0.0


@kernel
def _find_contact_zones(bed, solids, mesh, height, bundle, first, count, batch, limits):
    """List the solids that the plane of each ray crosses, and where it may meet anything."""
    for k in range(count):
        plane, _ = _vertical_plane(bundle, first + k)
        low, high, nearest, farthest = bed.low, bed.high, math.inf, -math.inf
        listed = 0
        for body in range(solids.shape.size):
            middle, radius, cx, cy, z = ball_about(solids, body)
            cx, cy = cx - plane.x, cy - plane.y
            near, far = _disc_crossing(plane, cx, cy, middle + radius)
            if near < far:
                batch.near[k, listed] = body
                listed += 1
                half = middle * abs(solids.axis[body, 2])
                low, high = min(low, z - half - radius), max(high, z + half + radius)
                nearest, farthest = min(nearest, near), max(farthest, far)
        batch.listed[k], batch.meshed[k] = listed, False
        if mesh.skip.size > 0:
            wx, wy, _, cx, cy, _ = box_about(mesh, 0)
            near, far = _disc_crossing(plane, cx - plane.x, cy - plane.y, math.sqrt(wx * wx + wy * wy))
            if near < far:
                batch.meshed[k] = True
                low, high = min(low, mesh.low[0, 2]), max(high, mesh.high[0, 2])
                nearest, farthest = min(nearest, near), max(farthest, far)
        limits[k, 0], limits[k, 1], limits[k, 2] = low - CLEAR, clear_of_nodes(height, high), bed.high + CLEAR
        limits[k, 3], limits[k, 4] = nearest, farthest


@inlined
def _disc_crossing(plane, cx, cy, bound):
    """Ground ranges between which a plane may cross a disc, its centre counted from the start; none if they turn."""
    off, ahead = cy * plane.ahead_x - cx * plane.ahead_y, cx * plane.ahead_x + cy * plane.ahead_y
    if abs(off) > bound or ahead < -bound:
        return math.inf, -math.inf
    return ahead - bound, ahead + bound


@kernel
def _lay_chords(water, bundle, first, count, reach, march, limits, batch, begins):
    """Chords of rays where they may meet anything, and the state of each ray at the start of each arc."""
    height, speed, station, surface = water.height, water.speed, water.station, water.surface
    axis_x, axis_y, rows, start = water.axis_x, water.axis_y, batch.chords, batch.start
    latest = reach / water.reference
    x_end = latest * speed.max()
    chord, arc = 0, 0
    for k in range(count):
        plane, level = _vertical_plane(bundle, first + k)
        section = lay_in_section(axis_x, axis_y, plane)
        limit = ContactZone(limits[k, 0], limits[k, 1], limits[k, 2], limits[k, 3], limits[k, 4])
        ray = launch_ray(height, speed, station, section, bundle.z[first + k], level, bundle.dz[first + k])
        start[k] = chord
        for _ in range(MOST_ARCS):
            above = ray.z > limit.ceiling or (ray.z == limit.ceiling and ray.sine > 0.0)
            low, high = (limit.ceiling, surface) if above else (limit.floor, limit.ceiling)
            status, after = advance_ray(height, speed, station, section, ray, x_end, low, high)
            if status == ENDLESS:
                break
            if not above:
                pieces, turn, whole = _count_chords(ray, after, march)
                if chord + pieces > rows.shape[0]:
                    rows = _enlarge(rows, chord + pieces)
                if arc == begins.shape[0]:
                    begins = _enlarge(begins, arc + 1)
                _keep_arc_start(begins, arc, ray)
                chord = _write_chords(rows, chord, arc, pieces, turn, whole, plane, limit, ray)
                arc += 1
            if status == RANGE or status == (HIGH if above else LOW) or after.time > latest:
                break
            ray = after
    start[count] = chord
    return rows, begins


@inlined
def lay_in_section(axis_x, axis_y, plane):
    """Position and direction of a ray's vertical plane relative to the stations of the water."""
    return SectionPlane(plane.x * axis_x + plane.y * axis_y, plane.ahead_x * axis_x + plane.ahead_y * axis_y)


@kernel
def _enlarge(rows, needed):
    """Copy rows into room for as many as are needed, or twice as many as there were."""
    more = np.empty((max(needed, 2 * rows.shape[0]), rows.shape[1]))
    more[: rows.shape[0]] = rows
    return more


@inlined
def _count_chords(ray, after, march):
    """Count the chords that an arc is cut into; return also its turn, and the straight distance between its ends."""
    dx, dz = after.x - ray.x, after.z - ray.z
    whole = math.sqrt(dx * dx + dz * dz)
    # Turn of the direction, from that to the end of the arc, so that the last chord ends exactly there.
    turn = 2.0 * math.atan2(ray.cosine * dz - ray.sine * dx, ray.cosine * dx + ray.sine * dz)
    # A chord of length L that turns by δ leaves its arc by Lδ/8.
    pieces = max(1, math.ceil(math.sqrt(0.125 / SAGITTA * whole * abs(turn))))
    if march > 0.0:
        pieces = max(pieces, math.ceil(whole / march))
    return pieces, turn, whole


@inlined
def _write_chords(rows, chord, arc, pieces, turn, whole, plane, limit, ray):
    """Write the chords of an arc that may meet anything; return the number of the next."""
    half, length = 0.5 * turn / pieces, whole / pieces
    if half != 0.0:
        length = whole * math.sin(half) / math.sin(pieces * half)
    c, s = math.cos(half), math.sin(half)
    x, z, dx, dz = ray.x, ray.z, ray.cosine * c - ray.sine * s, ray.sine * c + ray.cosine * s
    c, s = c * c - s * s, 2.0 * c * s
    for _ in range(pieces):
        on_x, on_z = x + length * dx, z + length * dz
        if min(z, on_z) < limit.bed or (max(x, on_x) > limit.near and min(x, on_x) < limit.far):
            rows[chord, X], rows[chord, Y] = plane.x + x * plane.ahead_x, plane.y + x * plane.ahead_y
            rows[chord, Z], rows[chord, LENGTH] = z, length
            rows[chord, DX], rows[chord, DY], rows[chord, DZ] = dx * plane.ahead_x, dx * plane.ahead_y, dz
            rows[chord, ARC], rows[chord, GROUND], rows[chord, ALONG] = arc, x, dx
            chord += 1
        x, z, dx, dz = on_x, on_z, dx * c - dz * s, dz * c + dx * s
    return chord


@inlined
def _keep_arc_start(begins, arc, ray):
    """Write the state of a ray at the start of an arc."""
    begins[arc, 0], begins[arc, 1], begins[arc, 2], begins[arc, 3] = ray.x, ray.z, ray.cosine, ray.sine
    begins[arc, 4], begins[arc, 5], begins[arc, 6], begins[arc, 7] = ray.speed, ray.time, ray.p, ray.q


@kernel
def _arrive(water, rays, first, count, reach, batch, begins, met):
    """Arrivals of rays at their hits, along the arcs of the chords that were hit."""
    bundle, hits, arrivals = rays.bundle, rays.hits, rays.arrivals
    height, speed, station, reference = water.height, water.speed, water.station, water.reference
    axis_x, axis_y, rows = water.axis_x, water.axis_y, batch.chords
    for k in range(count):
        n = first + k
        hits.distance[n], hits.body[n], hits.material[n] = math.inf, NOTHING, 0
        hits.nx[n], hits.ny[n], hits.nz[n] = 0.0, 0.0, 0.0
        if met.body[k] == NOTHING:
            continue
        plane, level = _vertical_plane(bundle, n)
        row, distance = met.chord[k], met.distance[k]
        low, high, x_end, z = -math.inf, math.inf, math.inf, rows[row, Z] + distance * rows[row, DZ]
        b = begins[int(rows[row, ARC])]
        ray = RayState(b[0], b[1], b[2], b[3], b[4], b[5], b[6], b[7], False)
        # To the ground range of the hit, or to its height where the ray is steep.
        if abs(rows[row, DZ]) <= abs(rows[row, ALONG]):
            x_end = rows[row, GROUND] + distance * rows[row, ALONG]
        elif z < ray.z:
            low = z
        else:
            high = z
        section = lay_in_section(axis_x, axis_y, plane)
        _, ray = advance_ray(height, speed, station, section, ray, x_end, low, high)
        if ray.time * reference > reach:
            continue
        hits.distance[n], hits.body[n], hits.material[n] = ray.time * reference, met.body[k], met.material[k]
        hits.nx[n], hits.ny[n], hits.nz[n] = met.nx[k], met.ny[k], met.nz[k]
        arrivals.dx[n], arrivals.dy[n] = ray.cosine * plane.ahead_x, ray.cosine * plane.ahead_y
        arrivals.dz[n], arrivals.speed[n], arrivals.x[n], arrivals.z[n] = ray.sine, ray.speed, ray.x, ray.z
        spread = ray.x / level if level > 0.0 else abs(ray.q)
        arrivals.tube[n], arrivals.spread[n] = max(abs(ray.q), LEAST * spread), spread
        field = field_at_caustic(water, section, bundle.z[n], level, bundle.dz[n], ray, spread)
        arrivals.focus[n], arrivals.dark[n], arrivals.shift[n] = field.focus, field.dark, field.shift


@kernel
def _empty_batch(rays, bodies):
    """Room for the chords of some rays."""
    return ChordBatch(
        np.empty((8 * rays, COLUMNS)), np.zeros(rays + 1, np.int64), np.empty((rays, bodies), np.int64),
        np.zeros(rays, np.int64), np.zeros(rays, np.bool_),
    )  # fmt: skip


@kernel
def _empty_chord_hits(rays):
    """Room for the hits of some rays."""
    return ChordHits(
        np.empty(rays, np.int64), np.empty(rays), np.empty(rays, np.int64), np.empty(rays, np.int64),
        np.empty(rays), np.empty(rays), np.empty(rays),
    )  # fmt: skip


@kernel
def _meet_chords(bed, solids, mesh, batch, rays, met):
    """First hits of the rays of a batch, exact along their chords."""
    _meet_bodies(solids, batch, rays, met)
    if mesh.skip.size > 0:
        _meet_mesh(solids, mesh, batch, rays, met)
    _meet_bed(bed, batch, rays, met)


@kernel
def _march_chords(bed, solids, mesh, batch, rays, met):
    """First hits of the rays of a batch, by one sample at the end of each chord; triangles are met where they are."""
    chords = batch.chords
    for k in range(rays):
        met.chord[k], met.distance[k], met.body[k], met.material[k] = batch.start[k + 1], math.inf, NOTHING, 0
        for c in range(batch.start[k], batch.start[k + 1]):
            way = Ray(chords[c, X], chords[c, Y], chords[c, Z], chords[c, DX], chords[c, DY], chords[c, DZ])
            distance, body, material, nx, ny, nz = march_chord(
                bed, solids, batch.near[k], batch.listed[k], way, chords[c, LENGTH]
            )
            if body != NOTHING:
                met.chord[k], met.distance[k], met.body[k], met.material[k] = c, distance, body, material
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
        met.chord[k], met.distance[k], met.body[k], met.material[k] = batch.start[k + 1], math.inf, NOTHING, 0
        for m in range(batch.listed[k]):
            body = batch.near[k, m]
            for c in range(batch.start[k], min(met.chord[k] + 1, batch.start[k + 1])):
                distance, nx, ny, nz = intersect_solid(
                    solids, body, chords[c, X], chords[c, Y], chords[c, Z], chords[c, DX], chords[c, DY], chords[c, DZ]
                )
                limit = _limit(chords, met, k, c)
                if distance < limit:
                    met.chord[k], met.distance[k], met.body[k] = c, distance, body
                    met.material[k] = solids.material[body]
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
                met.chord[k], met.distance[k], met.body[k] = c, distance, solids.shape.size + triangle
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
                met.chord[k], met.distance[k], met.body[k], met.material[k] = c, distance, BED, material
                met.nx[k], met.ny[k], met.nz[k] = nx, ny, nz
                break
            if distance != distance:
                if c < met.chord[k]:
                    met.body[k] = NOTHING
                break
