"""Rays one by one: send, find the first hit by a walk or a march, put what it returns into its time bin."""

from __future__ import annotations

import math

import numpy as np

from insonify.kernels.beam.pattern import two_way_response
from insonify.kernels.common.jit import inlined, kernel
from insonify.kernels.common.scattering import backscatter_strength
from insonify.kernels.common.types import LIGHT, PORT
from insonify.kernels.rays.cell_walk import NOTHING, Hits, RayBundle, find_first_hits
from insonify.kernels.rays.launch import (
    RayLaunch,
    aim_rays,
    find_enclosing_solid,
    highest_elevation,
    list_solids_in_beam,
    orient_beam,
    rotate_to_world,
    spread_over_pattern,
)
from insonify.kernels.rays.march import march_hits
from insonify.kernels.rays.specular_paths import add_specular_echoes


@kernel
def trace_straight_pings(arrays, poses, rays, step, out):
    """Trace all pings into ``out`` (pings, 2, bins) with ``rays`` a side: a cell walk, or a march if ``step`` > 0.

    Return -1 - k if the sonar is inside body k, else 0.
    """
    port, starboard = empty_launch(rays), empty_launch(rays)
    bundle, hits = empty_bundle(rays), empty_hits(rays)
    near = np.empty(arrays.solids.shape.size, np.int64)
    weighed, sums = np.empty(rays), np.empty(arrays.bins)
    reach, fan = arrays.bins * arrays.bin_length, arrays.half_width > 0.0
    spreads = fan and arrays.pattern.tabulated
    aimed_at = np.full((2, 3), math.nan)
    for ping in range(poses.x.size):
        z, pitch = poses.z[ping], poses.pitch[ping]
        body = find_enclosing_solid(arrays.solids, poses.x[ping], poses.y[ping], z)
        if body >= 0:
            return -1 - body
        for side in range(2):
            beam = orient_beam(arrays, poses, ping, side)
            count, top = list_solids_in_beam(arrays.solids, arrays.mesh, beam, near)
            top = max(top, highest_elevation(arrays.bed.high - z, 0.0, reach))
            launch = port if side == PORT else starboard
            if z != aimed_at[side, 0] or top != aimed_at[side, 1] or pitch != aimed_at[side, 2]:
                aim_rays(launch, z, top, reach, arrays.half_width, arrays.law, spreads)
                if spreads:
                    spread_over_pattern(launch, arrays.pattern, z, reach, pitch)
                aimed_at[side, 0], aimed_at[side, 1], aimed_at[side, 2] = z, top, pitch
            rotate_to_world(launch, beam, bundle)
            if step > 0.0:
                march_hits(arrays.bed, arrays.solids, near, count, arrays.mesh, bundle, reach, step, hits)
            else:
                find_first_hits(arrays.bed, arrays.solids, near, count, arrays.mesh, bundle, reach, hits)
            weight = launch.weight
            if arrays.pattern.tabulated:
                weight = weigh_by_pattern(arrays, beam, bundle, hits, launch.weight, weighed)
            deposit_hits(bundle, hits, weight, arrays.reflectivity, arrays.law, fan, arrays.bin_length, sums)
            if arrays.bounces > 0:
                add_specular_echoes(arrays, beam, bundle, hits, launch.weight, sums)
            # What depends on range alone comes after the sum.
            for k in range(arrays.bins):
                out[ping, side, k] = sums[k] * arrays.range_factor[k]
    return 0


@kernel
def cast_straight_rays(arrays, bundle, reach, hits):
    """Find the first hit of every ray."""
    bodies = np.arange(arrays.solids.shape.size)
    find_first_hits(arrays.bed, arrays.solids, bodies, bodies.size, arrays.mesh, bundle, reach, hits)


@kernel
def empty_launch(n):
    """Room for n rays in the sonar's axes."""
    return RayLaunch(np.empty(n), np.empty(n), np.empty(n), np.empty(n))


@kernel
def empty_bundle(n):
    """Room for n rays."""
    return RayBundle(np.empty(n), np.empty(n), np.empty(n), np.empty(n), np.empty(n), np.empty(n))


@kernel
def empty_hits(n):
    """Room for n hits."""
    return Hits(np.empty(n), np.empty(n, np.int64), np.empty(n, np.int64), np.empty(n), np.empty(n), np.empty(n))


@kernel
def weigh_by_pattern(arrays, beam, bundle, hits, weight, weighed):
    """Weigh rays by how the beam's pattern hears their hits."""
    for k in range(weight.size):
        weighed[k] = 0.0
        if hits.body[k] != NOTHING:
            dx, dy, dz = bundle.dx[k], bundle.dy[k], bundle.dz[k]
            fan = arrays.half_width > 0.0
            weighed[k] = weight[k] * two_way_response(
                arrays.pattern, beam, fan, arrays.law, dx, dy, dz, hits.distance[k]
            )
    return weighed


@kernel
def deposit_hits(bundle, hits, weight, reflectivity, law, fan, bin_length, sums):
    """Sum what the hits return into time bins."""
    sums[:] = 0.0
    for k in range(weight.size):
        if hits.body[k] == NOTHING:
            continue
        b = int(hits.distance[k] / bin_length)
        if b < sums.size:
            value, _ = ray_echo(bundle, hits, k, reflectivity, law, fan, bin_length)
            sums[b] += value * weight[k]


@inlined
def ray_echo(bundle, hits, k, reflectivity, law, fan, bin_length):
    """Tell what the hit of ray k returns for its weight, and how its slant range grows per radian of elevation."""
    distance = hits.distance[k]
    dx, dy, dz, nx, ny, nz = bundle.dx[k], bundle.dy[k], bundle.dz[k], hits.nx[k], hits.ny[k], hits.nz[k]
    cos_incidence = -(nx * dx + ny * dy + nz * dz)
    # A surface exactly edge-on returns nothing.
    if hits.body[k] == NOTHING or cos_incidence <= 0.0:
        return 0.0, 0.0
    m = hits.material[k]
    value = backscatter_strength(cos_incidence, reflectivity[m, 0], reflectivity[m, 1], reflectivity[m, 2], law)
    value *= distance / cos_incidence
    growth = elevation_tilt(dx, dy, dz, nx, ny, nz)
    if law == LIGHT:
        value *= growth / bin_length
    elif fan:
        value *= distance
    return value, growth * distance / cos_incidence


@kernel
def elevation_tilt(dx, dy, dz, nx, ny, nz):
    """|n·e| with e the way a growing elevation moves a ray: on the surface dr/dθ = r |n·e| / cos α."""
    level = math.sqrt(dx * dx + dy * dy)
    if level == 0.0:
        return 0.0
    return abs(nz * level - dz * (nx * dx + ny * dy) / level)
