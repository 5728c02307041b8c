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

from insonify.compiler.jit import inlined, inlined_uncounted, kernel
from insonify.kernels.common.types import BED
from insonify.kernels.geometry.solids import intersect_solid
from insonify.kernels.geometry.triangles import NO_TRIANGLE, facing_normal, intersect_mesh
from insonify.kernels.rays.caustics import LEAST, MOST_ARCS, field_at_caustic
from insonify.kernels.rays.cell_walk import NO_HIT, Hits, Ray, RayBundle, meet_bed
from insonify.kernels.rays.launch import ball_about, box_about
from insonify.kernels.rays.march import march_chord
from insonify.kernels.rays.path_tracing import Intersection
from insonify.kernels.refraction.arcs import ENDLESS, HIGH, LOW, RANGE, RayState
from insonify.kernels.refraction.section_arcs import SectionPlane, advance_ray, launch_ray

SAGITTA = 1e-4  # m by which a chord may leave its arc
CLEAR = 1e-3  # m above the highest thing and off any node of the water, below which rays are tested for hits
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
    """Heights and ground ranges between which a ray may meet anything, and what that is beside the bed."""

    floor: float  # m, height below which there is nothing
    ceiling: float  # and above which
    bed: float  # m, height above which there is no bed
    near: float  # m, ground ranges between which there are bodies
    far: float
    solids: int  # number of the solids that its plane crosses
    meshed: bool  # whether it may cross the mesh


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
    rays, near = LandedRays(bundle, hits, arrivals), np.empty(solids.shape.size, np.int64)
    chords, begins = np.empty((8, COLUMNS)), np.empty((4, STATE))  # of one ray, enlarged for one that has more
    for n in range(bundle.x.size):
        plane, level = _vertical_plane(bundle, n)
        zone = _find_contact_zone(bed, solids, mesh, water.height, plane, near)
        count, chords, begins = _lay_chords(water, bundle, n, plane, level, zone, reach, march, chords, begins)
        chord, meeting = _meet_chords(bed, solids, mesh, near, zone, chords, count, march > 0.0)
        _arrive(water, rays, n, plane, level, reach, chords[chord], begins, meeting)


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


@inlined_uncounted
def _find_contact_zone(bed, solids, mesh, height, plane, near):
    """List the solids that the plane of a ray crosses, and find where it may meet anything."""
    low, high, nearest, farthest = bed.low, bed.high, math.inf, -math.inf
    count, meshed = 0, False
    for body in range(solids.shape.size):
        middle, radius, cx, cy, z = ball_about(solids, body)
        begin, end = _disc_crossing(plane, cx - plane.x, cy - plane.y, middle + radius)
        if begin < end:
            near[count] = body
            count += 1
            half = middle * abs(solids.axis[body, 2])
            low, high = min(low, z - half - radius), max(high, z + half + radius)
            nearest, farthest = min(nearest, begin), max(farthest, end)
    if mesh.skip.size > 0:
        wx, wy, _, cx, cy, _ = box_about(mesh, 0)
        begin, end = _disc_crossing(plane, cx - plane.x, cy - plane.y, math.sqrt(wx * wx + wy * wy))
        if begin < end:
            meshed = True
            low, high = min(low, mesh.low[0, 2]), max(high, mesh.high[0, 2])
            nearest, farthest = min(nearest, begin), max(farthest, end)
    ceiling = clear_of_nodes(height, high)
    return ContactZone(low - CLEAR, ceiling, bed.high + CLEAR, nearest, farthest, count, meshed)


@inlined
def _disc_crossing(plane, cx, cy, bound):
    """Ground ranges between which a plane may cross a disc, its centre counted from the start; none if they turn."""
    off, ahead = cy * plane.ahead_x - cx * plane.ahead_y, cx * plane.ahead_x + cy * plane.ahead_y
    if abs(off) > bound or ahead < -bound:
        return math.inf, -math.inf
    return ahead - bound, ahead + bound


@inlined
def _lay_chords(water, bundle, n, plane, level, zone, reach, march, chords, begins):
    """Chords of a ray where it may meet anything, and its state at the start of each arc; return also their number."""
    height, speed, station, surface = water.height, water.speed, water.station, water.surface
    section, latest = lay_in_section(water.axis_x, water.axis_y, plane), reach / water.reference
    x_end = latest * speed.max()
    count, arc = 0, 0
    ray = launch_ray(height, speed, station, section, bundle.z[n], level, bundle.dz[n])
    for _ in range(MOST_ARCS):
        above = ray.z > zone.ceiling or (ray.z == zone.ceiling and ray.sine > 0.0)
        low, high = (zone.ceiling, surface) if above else (zone.floor, zone.ceiling)
        status, after = advance_ray(height, speed, station, section, ray, x_end, low, high)
        if status == ENDLESS:
            break
        if not above:
            pieces, turn, whole = _count_chords(ray, after, march)
            if count + pieces > chords.shape[0]:
                chords = _enlarge(chords, count + pieces)
            if arc == begins.shape[0]:
                begins = _enlarge(begins, arc + 1)
            begins[arc, 0], begins[arc, 1], begins[arc, 2], begins[arc, 3] = ray.x, ray.z, ray.cosine, ray.sine
            begins[arc, 4], begins[arc, 5], begins[arc, 6], begins[arc, 7] = ray.speed, ray.time, ray.p, ray.q
            count = _write_chords(chords, count, arc, pieces, turn, whole, plane, zone, ray)
            arc += 1
        if status == RANGE or status == (HIGH if above else LOW) or after.time > latest:
            break
        ray = after
    return count, chords, begins


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


@inlined_uncounted
def _meet_chords(bed, solids, mesh, near, zone, chords, count, marches):
    """First surface that a ray meets, and on which chord: exactly, or by one sample at the end of each in a march."""
    best, body, material, mx, my, mz = math.inf, NO_HIT, 0, 0.0, 0.0, 0.0
    for c in range(count):
        way = Ray(chords[c, X], chords[c, Y], chords[c, Z], chords[c, DX], chords[c, DY], chords[c, DZ])
        best, inside = chords[c, LENGTH] + OVERLAP, False
        if marches:
            distance, body, material, mx, my, mz = march_chord(bed, solids, near, zone.solids, way, chords[c, LENGTH])
            best = min(best, distance)
        else:
            for m in range(zone.solids):
                k = near[m]
                distance, nx, ny, nz = intersect_solid(solids, k, way.x, way.y, way.z, way.dx, way.dy, way.dz)
                if distance < best:
                    best, body, material, mx, my, mz = distance, k, solids.material[k], nx, ny, nz
        if zone.meshed:
            best, triangle = intersect_mesh(mesh, way.x, way.y, way.z, way.dx, way.dy, way.dz, best)
            if triangle != NO_TRIANGLE:
                body, material = solids.shape.size + triangle, mesh.material[triangle]
                mx, my, mz = facing_normal(mesh, triangle, way.dx, way.dy, way.dz)
        if not marches:
            distance, row, nx, ny, nz = meet_bed(bed, way, best)
            if distance < best:
                best, body, material, mx, my, mz = distance, BED, row, nx, ny, nz
            inside = distance != distance  # a ray inside the bed ends there
        if body != NO_HIT or inside:
            return c, Intersection(best, body, material, mx, my, mz)
    return 0, Intersection(best, NO_HIT, 0, 0.0, 0.0, 0.0)


@inlined_uncounted
def _arrive(water, rays, n, plane, level, reach, chord, begins, meeting):
    """Arrival of a ray at its hit, along the arc of the chord that was hit."""
    bundle, hits, arrivals = rays.bundle, rays.hits, rays.arrivals
    hits.distance[n], hits.body[n], hits.material[n] = math.inf, NO_HIT, 0
    hits.nx[n], hits.ny[n], hits.nz[n] = 0.0, 0.0, 0.0
    if meeting.body == NO_HIT:
        return
    distance = meeting.distance
    low, high, x_end, z = -math.inf, math.inf, math.inf, chord[Z] + distance * chord[DZ]
    b = begins[int(chord[ARC])]
    ray = RayState(b[0], b[1], b[2], b[3], b[4], b[5], b[6], b[7], False)
    # To the ground range of the hit, or to its height where the ray is steep.
    if abs(chord[DZ]) <= abs(chord[ALONG]):
        x_end = chord[GROUND] + distance * chord[ALONG]
    elif z < ray.z:
        low = z
    else:
        high = z
    section = lay_in_section(water.axis_x, water.axis_y, plane)
    _, ray = advance_ray(water.height, water.speed, water.station, section, ray, x_end, low, high)
    if ray.time * water.reference > reach:
        return
    hits.distance[n], hits.body[n], hits.material[n] = ray.time * water.reference, meeting.body, meeting.material
    hits.nx[n], hits.ny[n], hits.nz[n] = meeting.nx, meeting.ny, meeting.nz
    arrivals.dx[n], arrivals.dy[n] = ray.cosine * plane.ahead_x, ray.cosine * plane.ahead_y
    arrivals.dz[n], arrivals.speed[n], arrivals.x[n], arrivals.z[n] = ray.sine, ray.speed, ray.x, ray.z
    spread = ray.x / level if level > 0.0 else abs(ray.q)
    arrivals.tube[n], arrivals.spread[n] = max(abs(ray.q), LEAST * spread), spread
    field = field_at_caustic(water, section, bundle.z[n], level, bundle.dz[n], ray, spread)
    arrivals.focus[n], arrivals.dark[n], arrivals.shift[n] = field.focus, field.dark, field.shift
