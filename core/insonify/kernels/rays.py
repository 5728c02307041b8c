"""Rays one by one: send, find the first hit by a walk or a march, put what it returns into its time bin."""

from __future__ import annotations

import math

import numpy as np

from insonify.kernels.beam import heard
from insonify.kernels.bounce import add_ghosts
from insonify.kernels.jit import fused, kernel
from insonify.kernels.launch import Launch, aim, gather, highest_elevation, inside_body, make_beam, spread_rays, turn
from insonify.kernels.march import march_hits
from insonify.kernels.scatter import strength
from insonify.kernels.types import LIGHT, PORT
from insonify.kernels.walk import NOTHING, Bundle, Hits, first_hits


@kernel
def trace_pings(problem, poses, rays, step, out):
    """Trace all pings into ``out`` (pings, 2, bins) with ``rays`` a side: a cell walk, or a march if ``step`` > 0.

    Return -1 - k if the sonar is inside body k, else 0.
    """
    port, starboard = empty_launch(rays), empty_launch(rays)
    bundle, hits = empty_bundle(rays), empty_hits(rays)
    near = np.empty(problem.solids.shape.size, np.int64)
    weighed, sums = np.empty(rays), np.empty(problem.bins)
    reach, fan = problem.bins * problem.bin_length, problem.half_width > 0.0
    spreads = fan and problem.pattern.tabled
    aimed_at = np.full((2, 3), math.nan)
    for ping in range(poses.x.size):
        z, pitch = poses.z[ping], poses.pitch[ping]
        body = inside_body(problem.solids, poses.x[ping], poses.y[ping], z)
        if body >= 0:
            return -1 - body
        for side in range(2):
            beam = make_beam(problem, poses, ping, side)
            count, top = gather(problem.solids, problem.mesh, beam, near)
            top = max(top, highest_elevation(problem.bed.high - z, 0.0, reach))
            launch = port if side == PORT else starboard
            if z != aimed_at[side, 0] or top != aimed_at[side, 1] or pitch != aimed_at[side, 2]:
                aim(launch, z, top, reach, problem.half_width, problem.law, spreads)
                if spreads:
                    spread_rays(launch, problem.pattern, z, reach, pitch)
                aimed_at[side, 0], aimed_at[side, 1], aimed_at[side, 2] = z, top, pitch
            turn(launch, beam, bundle)
            if step > 0.0:
                march_hits(problem.bed, problem.solids, near, count, problem.mesh, bundle, reach, step, hits)
            else:
                first_hits(problem.bed, problem.solids, near, count, problem.mesh, bundle, reach, hits)
            weight = launch.weight
            if problem.pattern.tabled:
                weight = weigh(problem, beam, bundle, hits, launch.weight, weighed)
            deposit(bundle, hits, weight, problem.reflectivity, problem.law, fan, problem.bin_length, sums)
            if problem.bounces > 0:
                add_ghosts(problem, beam, bundle, hits, launch.weight, sums)
            # What depends on range alone comes after the sum.
            for k in range(problem.bins):
                out[ping, side, k] = sums[k] * problem.range_factor[k]
    return 0


@kernel
def cast_rays(problem, bundle, reach, hits):
    """Find the first hit of every ray."""
    bodies = np.arange(problem.solids.shape.size)
    first_hits(problem.bed, problem.solids, bodies, bodies.size, problem.mesh, bundle, reach, hits)


@kernel
def empty_launch(n):
    """Room for n rays in the sonar's axes."""
    return Launch(np.empty(n), np.empty(n), np.empty(n), np.empty(n))


@kernel
def empty_bundle(n):
    """Room for n rays."""
    return Bundle(np.empty(n), np.empty(n), np.empty(n), np.empty(n), np.empty(n), np.empty(n))


@kernel
def empty_hits(n):
    """Room for n hits."""
    return Hits(np.empty(n), np.empty(n, np.int64), np.empty(n, np.int64), np.empty(n), np.empty(n), np.empty(n))


@kernel
def weigh(problem, beam, bundle, hits, weight, weighed):
    """Weigh rays by how the beam's pattern hears their hits."""
    for k in range(weight.size):
        weighed[k] = 0.0
        if hits.body[k] != NOTHING:
            dx, dy, dz = bundle.dx[k], bundle.dy[k], bundle.dz[k]
            fan = problem.half_width > 0.0
            weighed[k] = weight[k] * heard(problem.pattern, beam, fan, problem.law, dx, dy, dz, hits.distance[k])
    return weighed


@kernel
def deposit(bundle, hits, weight, reflectivity, law, fan, bin_length, sums):
    """Sum what the hits return into time bins."""
    sums[:] = 0.0
    for k in range(weight.size):
        if hits.body[k] == NOTHING:
            continue
        b = int(hits.distance[k] / bin_length)
        if b < sums.size:
            value, _ = returned(bundle, hits, k, reflectivity, law, fan, bin_length)
            sums[b] += value * weight[k]


@fused
def returned(bundle, hits, k, reflectivity, law, fan, bin_length):
    """Tell what the hit of ray k returns for its weight, and how its slant range grows per radian of elevation."""
    distance = hits.distance[k]
    dx, dy, dz, nx, ny, nz = bundle.dx[k], bundle.dy[k], bundle.dz[k], hits.nx[k], hits.ny[k], hits.nz[k]
    cos_incidence = -(nx * dx + ny * dy + nz * dz)
    # A surface exactly edge-on returns nothing.
    if hits.body[k] == NOTHING or cos_incidence <= 0.0:
        return 0.0, 0.0
    m = hits.material[k]
    value = strength(cos_incidence, reflectivity[m, 0], reflectivity[m, 1], reflectivity[m, 2], law)
    value *= distance / cos_incidence
    growth = tilt(dx, dy, dz, nx, ny, nz)
    if law == LIGHT:
        value *= growth / bin_length
    elif fan:
        value *= distance
    return value, growth * distance / cos_incidence


@kernel
def tilt(dx, dy, dz, nx, ny, nz):
    """|n·e| with e the way a growing elevation moves a ray: on the surface dr/dθ = r |n·e| / cos α."""
    level = math.sqrt(dx * dx + dy * dy)
    if level == 0.0:
        return 0.0
    return abs(nz * level - dz * (nx * dx + ny * dy) / level)
