"""First echoes of straight rays: each ray's first hit is weighed and summed into its range bin."""

from __future__ import annotations

import math

import numpy as np

from insonify.compiler.jit import inlined, kernel
from insonify.kernels.beam.pattern import two_way_response
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

TOGETHER = 4096  # rays that are held beyond their directions, in the processor cache


@kernel
def trace_straight_pings(arrays, poses, rays, step, out):
    """Intensity per range bin of pings traced ray by ray along straight lines.

    Parameters
    ----------
    arrays : SceneArrays
    poses : Poses of ndarrays, shape (n,)
    rays : int
        Rays per side.
    step : float
        Length of a step of the march, m; a cell walk if it is 0.
    out : ndarray of float32, shape (n, 2, bins)
        Filled.

    Returns
    -------
    int
        -1 - k if the sonar is inside solid k, else 0.
    """
    port, starboard = empty_launch(rays), empty_launch(rays)
    bundle, hits = empty_bundle(TOGETHER), empty_hits(TOGETHER)
    near = np.empty(arrays.solids.shape.size, np.int64)
    weighed, sums = np.empty(TOGETHER), np.empty(arrays.bins)
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
            sums[:] = 0.0
            for first in range(0, rays, TOGETHER):
                some = take_rays(launch, first, min(first + TOGETHER, rays))
                these, met = take_room(bundle, hits, some.weight.size)
                rotate_to_world(some, beam, these)
                if step > 0.0:
                    march_hits(arrays.bed, arrays.solids, near, count, arrays.mesh, these, reach, step, met)
                else:
                    find_first_hits(arrays.bed, arrays.solids, near, count, arrays.mesh, these, reach, met)
                weight = some.weight
                if arrays.pattern.tabulated:
                    weight = weigh_by_pattern(arrays, beam, these, met, some.weight, weighed[: some.weight.size])
                deposit_hits(these, met, weight, arrays.reflectivity, arrays.law, fan, arrays.bin_length, sums)
                if arrays.bounces > 0:
                    add_specular_echoes(arrays, beam, these, met, some.weight, sums)
            # The range factor is applied after the sum: within it, r⁻⁴ would cost digits.
            for k in range(arrays.bins):
                out[ping, side, k] = sums[k] * arrays.range_factor[k]
    return 0


@kernel
def cast_straight_rays(arrays, bundle, reach, hits):
    """First hit of each of some rays on anything in a scene.

    Parameters
    ----------
    arrays : SceneArrays
    bundle : RayBundle of ndarrays, shape (n,)
    reach : float
        Distance after which a ray ends, m.
    hits : Hits of ndarrays, shape (n,)
        Filled.
    """
    bodies = np.arange(arrays.solids.shape.size)
    find_first_hits(arrays.bed, arrays.solids, bodies, bodies.size, arrays.mesh, bundle, reach, hits)


@kernel
def empty_launch(n):
    """Room for the directions of n rays.

    Parameters
    ----------
    n : int

    Returns
    -------
    RayLaunch
    """
    return RayLaunch(np.empty(n), np.empty(n), np.empty(n), np.empty(n))


@kernel
def empty_bundle(n):
    """Room for n rays.

    Parameters
    ----------
    n : int

    Returns
    -------
    RayBundle
    """
    return RayBundle(np.empty(n), np.empty(n), np.empty(n), np.empty(n), np.empty(n), np.empty(n))


@kernel
def empty_hits(n):
    """Room for n hits.

    Parameters
    ----------
    n : int

    Returns
    -------
    Hits
    """
    return Hits(np.empty(n), np.empty(n, np.int64), np.empty(n, np.int64), np.empty(n), np.empty(n), np.empty(n))


@inlined
def take_rays(launch, first, last):
    """Return some of the rays of a side."""
    ahead, abeam, up, weight = launch
    return RayLaunch(ahead[first:last], abeam[first:last], up[first:last], weight[first:last])


@inlined
def take_room(bundle, hits, n):
    """Return room for some rays and their hits."""
    x, y, z, dx, dy, dz = bundle
    distance, body, material, nx, ny, nz = hits
    return (
        RayBundle(x[:n], y[:n], z[:n], dx[:n], dy[:n], dz[:n]),
        Hits(distance[:n], body[:n], material[:n], nx[:n], ny[:n], nz[:n]),
    )


@kernel
def weigh_by_pattern(arrays, beam, bundle, hits, weight, weighed):
    """Weight of rays times the two-way response of the beam towards their hits."""
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
    """Add the echoes of hits to the range bins.

    Parameters
    ----------
    bundle, hits : RayBundle, Hits of ndarrays, shape (n,)
    weight : ndarray, shape (n,)
        What each ray stands for: rad or sr.
    reflectivity : ndarray, shape (materials, 3)
    law : int
        LIGHT or SONAR.
    fan : bool
        Whether the beam has a width; else a knife edge 1 m wide along the track.
    bin_length : float
        m.
    sums : ndarray, shape (bins,)
        Added to, but for the factor that depends on range alone.
    """
    for k in range(weight.size):
        if hits.body[k] == NOTHING:
            continue
        b = int(hits.distance[k] / bin_length)
        if b < sums.size:
            value, _ = ray_echo(bundle, hits, k, reflectivity, law, fan, bin_length)
            sums[b] += value * weight[k]


@inlined
def ray_echo(bundle, hits, k, reflectivity, law, fan, bin_length):
    """Echo of the hit of one ray per unit of its weight."""
    distance = hits.distance[k]
    dx, dy, dz, nx, ny, nz = bundle.dx[k], bundle.dy[k], bundle.dz[k], hits.nx[k], hits.ny[k], hits.nz[k]
    cos_incidence = -(nx * dx + ny * dy + nz * dz)
    # A surface exactly edge-on returns nothing.
    if hits.body[k] == NOTHING or cos_incidence <= 0.0:
        return 0.0, 0.0
    m = hits.material[k]
    value = backscatter_strength(cos_incidence, reflectivity[m, 0], reflectivity[m, 1], reflectivity[m, 2], law)
    value *= distance / cos_incidence  # dA / dΩ = r² / cos α; derived in docs/theory/scattering.md
    growth = elevation_tilt(dx, dy, dz, nx, ny, nz)
    if law == LIGHT:
        value *= growth / bin_length
    elif fan:
        value *= distance
    return value, growth * distance / cos_incidence


@kernel
def elevation_tilt(dx, dy, dz, nx, ny, nz):
    """|n·e| of a surface's normal n and the direction e in which a growing elevation moves a ray."""
    level = math.sqrt(dx * dx + dy * dy)
    if level == 0.0:
        return 0.0
    return abs(nz * level - dz * (nx * dx + ny * dy) / level)
