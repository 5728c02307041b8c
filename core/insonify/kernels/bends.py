"""Rays that water bends: what each meets first along the arcs it goes, and how it arrives there.

A ray stays in the vertical plane it is sent in: of water that differs along a line it feels what lies in that plane;
horizontal refraction is left out. Above everything it goes from node to node of the water in one step; from there on
each arc is cut into chords so short that they leave it by no more than a share of a millimetre, and each chord asks
what it meets as a straight ray does. From the hit on the arc itself is taken again: time, direction and the width of
the ray tube are its own.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.kernels.arcs import ENDLESS, HIGH, LOW, RANGE, launch_ray, step
from insonify.kernels.cells import Plane, launch_across, step_across
from insonify.kernels.jit import kernel
from insonify.kernels.march import march_chord
from insonify.kernels.shapes import meet_solid, widest
from insonify.kernels.triangles import NO_TRIANGLE, facing, meet_mesh
from insonify.kernels.types import BED
from insonify.kernels.walk import NOTHING, Ray, fused, meet_bed

SAGITTA = 1e-4  # m, by which a chord may leave its arc
MOST_ARCS = 4096  # of one ray: a trapped one is given up
CLEAR = 1e-3  # m above the highest thing and off any node of the water, where rays are first asked what they meet
OVERLAP = 1e-9  # m, by which chords ask on, so that rounding hides nothing where two of them meet
# At a caustic the tube closes, and only waves say how loud it is. Airy's function peaks where the tube is about
# (λ / πr)^⅓ as wide as one that nothing focuses: 0.02 of it at 400 kHz and 100 m. No tube counts as narrower.
CAUSTIC = 0.02


class Arrivals(NamedTuple):
    """How rays arrive at what they meet, (n,) each."""

    dx: NDArray[np.float64]  # unit direction
    dy: NDArray[np.float64]
    dz: NDArray[np.float64]
    tube: NDArray[np.float64]  # m/rad, distance across the tube per elevation at the sonar
    spread: NDArray[np.float64]  # m/rad, and at right angles to that: ground range over the cosine of that elevation
    speed: NDArray[np.float64]  # of sound there, m/s


class Course(NamedTuple):
    """The vertical plane of a ray: the ground place of its start and the level unit vector it is sent along."""

    x: float
    y: float
    ahead_x: float
    ahead_y: float


class Limits(NamedTuple):
    """Where a ray may meet anything."""

    floor: float  # m, height below which there is nothing
    ceiling: float  # and above which
    x_end: float  # ground range beyond which it comes too late, m
    time: float  # s, likewise


class Chord(NamedTuple):
    """What a chord meets, and the place of that in the ray's plane."""

    distance: float  # infinite if nothing, NaN if it has come into the bed from the side
    body: int
    material: int
    nx: float
    ny: float
    nz: float
    x: float
    z: float
    steep: bool


@kernel
def bent_hits(problem, bundle, reach, march, hits, arrivals):
    """Find what each ray meets first within the slant range ``reach``, by the walk or by steps of ``march`` > 0 metres.

    The distance of a hit is its slant range: time by the speed at the sonar.
    """
    water, solids, mesh = problem.water, problem.solids, problem.mesh
    latest = reach / water.reference
    farthest = latest * water.speed.max()
    near = np.empty(solids.shape.size, np.int64)
    for k in range(bundle.x.size):
        level = math.sqrt(bundle.dx[k] ** 2 + bundle.dy[k] ** 2)
        course = Course(bundle.x[k], bundle.y[k], 1.0, 0.0)
        if level > 0.0:
            course = Course(bundle.x[k], bundle.y[k], bundle.dx[k] / level, bundle.dy[k] / level)
        count, floor, ceiling = _on_course(solids, course, problem.bed.low, problem.bed.high, near)
        if mesh.skip.size > 0:
            floor, ceiling = min(floor, mesh.low[0, 2]), max(ceiling, mesh.high[0, 2])
        limits = Limits(floor - CLEAR, clear_of_nodes(water.height, ceiling), farthest, latest)
        hits.distance[k], hits.body[k], hits.material[k] = math.inf, NOTHING, 0
        hits.nx[k], hits.ny[k], hits.nz[k] = 0.0, 0.0, 0.0
        plane = plane_of(water, course.x, course.y, course.ahead_x, course.ahead_y)
        ray = set_out(water, plane, bundle.z[k], level, bundle.dz[k])
        chord, ray = _land(problem, near, count, course, plane, limits, ray, march)
        if not chord.distance < math.inf or ray.time > latest:
            continue
        hits.distance[k], hits.body[k], hits.material[k] = ray.time * water.reference, chord.body, chord.material
        hits.nx[k], hits.ny[k], hits.nz[k] = chord.nx, chord.ny, chord.nz
        arrivals.dx[k], arrivals.dy[k] = ray.cosine * course.ahead_x, ray.cosine * course.ahead_y
        arrivals.dz[k], arrivals.speed[k] = ray.sine, ray.speed
        spread = ray.x / level if level > 0.0 else abs(ray.q)
        arrivals.tube[k], arrivals.spread[k] = max(abs(ray.q), CAUSTIC * spread), spread


@fused
def plane_of(water, x, y, ahead_x, ahead_y):
    """Lay the vertical plane of a ray through the water's stations."""
    return Plane(x * water.axis_x + y * water.axis_y, ahead_x * water.axis_x + ahead_y * water.axis_y)


@kernel
def set_out(water, plane, z, cosine, sine):
    """Start a ray at height z."""
    if water.station.size > 1:
        return launch_across(water.height, water.speed, water.station, plane, z, cosine, sine)
    return launch_ray(water.height, water.speed[0], z, cosine, sine)


@fused
def go_on(height, speed, station, plane, ray, x_end, low, high):
    """Follow a ray to the next border in the water, to range ``x_end``, or to height ``low`` or ``high``."""
    if station.size > 1:
        return step_across(height, speed, station, plane, ray, x_end, low, high)
    return step(height, speed[0], ray, x_end, low, high)


@kernel
def empty_arrivals(n):
    """Room for n arrivals."""
    return Arrivals(np.empty(n), np.empty(n), np.empty(n), np.empty(n), np.empty(n), np.empty(n))


@kernel
def clear_of_nodes(height, ceiling):
    """Raise a ceiling until it is clear of all that is below it and of the water's nodes."""
    ceiling += CLEAR
    for k in range(height.size):
        if abs(height[k] - ceiling) < 0.5 * CLEAR:
            ceiling += CLEAR
    return ceiling


@fused
def _on_course(solids, course, low, high, near):
    """List the bodies that a ray's course may cross; widen the heights between which there is anything."""
    count = 0
    for k in range(solids.shape.size):
        middle, radius = 0.5 * solids.length[k], widest(solids, k)
        cx = solids.start[k, 0] + middle * solids.axis[k, 0] - course.x
        cy = solids.start[k, 1] + middle * solids.axis[k, 1] - course.y
        bound = middle + radius
        off, ahead = cy * course.ahead_x - cx * course.ahead_y, cx * course.ahead_x + cy * course.ahead_y
        if abs(off) > bound or ahead < -bound:
            continue
        near[count] = k
        count += 1
        centre, half = solids.start[k, 2] + middle * solids.axis[k, 2], middle * abs(solids.axis[k, 2]) + radius
        low, high = min(low, centre - half), max(high, centre + half)
    return count, low, high


@fused
def _land(problem, near, count, course, plane, limits, ray, march):
    """Follow a ray to the first thing it meets: what it is, and the ray as it arrives there."""
    surface = problem.water.surface
    height, speed, station = problem.water.height, problem.water.speed, problem.water.station
    for _ in range(MOST_ARCS):
        above = ray.z > limits.ceiling or (ray.z == limits.ceiling and ray.sine > 0.0)
        low, high = (limits.ceiling, surface) if above else (limits.floor, limits.ceiling)
        status, after = go_on(height, speed, station, plane, ray, limits.x_end, low, high)
        if status == ENDLESS:
            break
        if not above:
            chord = _meet_arc(problem, near, count, course, ray, after, march)
            if chord.distance < math.inf:
                return chord, _arrive(height, speed, station, plane, ray, chord)
            if chord.distance != chord.distance:
                break
        gone = status == (HIGH if above else LOW)
        if gone or status == RANGE or after.time > limits.time:
            break
        ray = after
    return Chord(math.inf, NOTHING, 0, 0.0, 0.0, 0.0, 0.0, 0.0, False), ray


@kernel
def _arrive(height, speed, station, plane, ray, chord):
    """Follow the arc on which a chord has met something to that place."""
    low, high, x_end = -math.inf, math.inf, math.inf
    if not chord.steep:
        x_end = chord.x
    elif chord.z < ray.z:
        low = chord.z
    else:
        high = chord.z
    return go_on(height, speed, station, plane, ray, x_end, low, high)[1]


@fused
def _meet_arc(problem, near, count, course, ray, after, march):
    """Meet the first thing along an arc, by its chords."""
    x, z = ray.x, ray.z
    dx, dz = after.x - x, after.z - z
    whole = math.sqrt(dx * dx + dz * dz)
    # By the way to its end, so that the last chord ends exactly there.
    turn = 2.0 * math.atan2(ray.cosine * dz - ray.sine * dx, ray.cosine * dx + ray.sine * dz)
    # A chord of length L that turns by δ leaves its arc by Lδ/8.
    chords = max(1, math.ceil(math.sqrt(0.125 / SAGITTA * whole * abs(turn))))
    if march > 0.0:
        chords = max(chords, math.ceil(whole / march))
    half = 0.5 * turn / chords
    length = whole / chords
    if half != 0.0:
        length = whole * math.sin(half) / math.sin(chords * half)
    c, s = math.cos(half), math.sin(half)
    dx, dz = ray.cosine * c - ray.sine * s, ray.sine * c + ray.cosine * s
    c, s = c * c - s * s, 2.0 * c * s
    for _ in range(chords):
        gx, gy = course.x + x * course.ahead_x, course.y + x * course.ahead_y
        way = Ray(gx, gy, z, dx * course.ahead_x, dx * course.ahead_y, dz)
        distance, body, material, nx, ny, nz = _meet_chord(problem, near, count, way, length, march)
        if not distance == math.inf:
            steep = abs(dz) > abs(dx)
            return Chord(distance, body, material, nx, ny, nz, x + distance * dx, z + distance * dz, steep)
        x, z = x + length * dx, z + length * dz
        dx, dz = dx * c - dz * s, dz * c + dx * s
    return Chord(math.inf, NOTHING, 0, 0.0, 0.0, 0.0, 0.0, 0.0, False)


@fused
def _meet_chord(problem, near, count, way, length, march):
    """Meet the nearest thing along a chord: (distance, body, material, nx, ny, nz)."""
    solids, mesh = problem.solids, problem.mesh
    best, body, material, nx, ny, nz = math.inf, NOTHING, 0, 0.0, 0.0, 0.0
    limit = length + OVERLAP
    if march > 0.0:
        best, body, material, nx, ny, nz = march_chord(problem.bed, solids, near, count, way, length)
    else:
        for m in range(count):
            distance, mx, my, mz = meet_solid(solids, near[m], way.x, way.y, way.z, way.dx, way.dy, way.dz)
            if distance < min(best, limit):
                best, body, material = distance, near[m], solids.material[near[m]]
                nx, ny, nz = mx, my, mz
        distance, row, mx, my, mz = meet_bed(problem.bed, way, min(best, limit))
        if distance < min(best, limit):
            best, body, material, nx, ny, nz = distance, BED, row, mx, my, mz
        elif distance != distance and body == NOTHING:
            best = distance
    if mesh.skip.size > 0:
        nearest = best if best == best else limit
        distance, triangle = meet_mesh(mesh, way.x, way.y, way.z, way.dx, way.dy, way.dz, min(nearest, limit))
        if triangle != NO_TRIANGLE:
            best, body, material = distance, solids.shape.size + triangle, mesh.material[triangle]
            nx, ny, nz = facing(mesh, triangle, way.dx, way.dy, way.dz)
    return best, body, material, nx, ny, nz
