"""Echoes of rays that follow arcs.

A ray that stands for the solid angle dΩ lands on q x / cosθ0 · dΩ / cos α of a surface, q being the width of its tube
in elevation and x / cosθ0 that across; one way its intensity is I = cosθ0 / (x |q|) of that at 1 m (Jensen et al.,
Computational Ocean Acoustics, 3.3), and the way back is the way out. So it returns σ dA I² = σ dΩ I / cos α. A knife
is 1 m wide along the track: σ q dθ I² / cos α. Law `light` spreads nothing: a ray stands for the step of slant range
that its landing makes as its elevation grows. In still water q = x / cosθ0 = r.
"""

from __future__ import annotations

import math

import numpy as np

from insonify.compiler.jit import inlined, kernel
from insonify.kernels.common.scattering import backscatter_strength
from insonify.kernels.common.types import LIGHT, PORT
from insonify.kernels.rays.cell_walk import NOTHING
from insonify.kernels.rays.first_echoes import elevation_tilt, empty_bundle, empty_hits, empty_launch, weigh_by_pattern
from insonify.kernels.rays.launch import (
    ball_about,
    beam_touches_ball,
    find_enclosing_solid,
    orient_beam,
    rotate_to_world,
    spread_over_pattern,
)
from insonify.kernels.refracted_rays.hits import (
    LandedRays,
    VerticalPlane,
    clear_of_nodes,
    empty_arrivals,
    find_refracted_hits,
    lay_in_section,
)
from insonify.kernels.refracted_rays.mixed_paths import find_mixed_echoes
from insonify.kernels.refracted_rays.probe_rays import Waveguide, aim_refracted_rays, empty_landings

SLACK = 0.1  # share of its distance by which a body insonified along arcs may lie outside a beam of straight rays


@kernel
def trace_refracted_pings(arrays, poses, rays, march, out):
    """Intensity per range bin of pings traced ray by ray along arcs.

    Parameters
    ----------
    arrays : SceneArrays
    poses : Poses of ndarrays, shape (n,)
    rays : int
        Rays per side.
    march : float
        Length of a step of the march, m; exact hits along the chords of the arcs if it is 0.
    out : ndarray of float32, shape (n, 2, bins)
        Filled.

    Returns
    -------
    int
        -1 - k if the sonar is inside solid k, else 0.
    """
    port, starboard = empty_launch(rays), empty_launch(rays)
    bundle, hits, arrivals = empty_bundle(rays), empty_hits(rays), empty_arrivals(rays)
    weighed, sums = np.empty(rays), np.empty(arrays.bins)
    aimed_at = np.full((2, 3), math.nan)
    to_port, to_starboard = empty_landings(), empty_landings()
    for ping in range(poses.x.size):
        z, pitch = poses.z[ping], poses.pitch[ping]
        body = find_enclosing_solid(arrays.solids, poses.x[ping], poses.y[ping], z)
        if body >= 0:
            return -1 - body
        for side in range(2):
            beam = orient_beam(arrays, poses, ping, side)
            launch = port if side == PORT else starboard
            waveguide = make_waveguide(arrays, beam)
            aimed = z == aimed_at[side, 0] and waveguide.ceiling == aimed_at[side, 1] and pitch == aimed_at[side, 2]
            if not aimed or arrays.water.station.size > 1:
                landings = aim_side(arrays, waveguide, z, pitch, launch)
                aimed_at[side, 0], aimed_at[side, 1], aimed_at[side, 2] = z, waveguide.ceiling, pitch
                if side == PORT:
                    to_port = landings
                else:
                    to_starboard = landings
            rotate_to_world(launch, beam, bundle)
            find_refracted_hits(arrays, bundle, waveguide.reach, march, hits, arrivals)
            weight = launch.weight
            if arrays.pattern.tabulated:
                weight = weigh_by_pattern(arrays, beam, bundle, hits, launch.weight, weighed)
            _deposit_refracted(arrays, hits, arrivals, weight, sums)
            landings = to_port if side == PORT else to_starboard
            if landings.fold < math.inf and march <= 0.0:
                mixed = find_mixed_echoes(
                    arrays, beam, waveguide, z, landings, launch.weight, LandedRays(bundle, hits, arrivals)
                )
                for m in range(mixed.bin.size):
                    if mixed.bin[m] >= 0:
                        sums[mixed.bin[m]] += mixed.value[m]
            # The range factor is applied after the sum: within it, r⁻⁴ would cost digits.
            for k in range(arrays.bins):
                out[ping, side, k] = sums[k] * arrays.range_factor[k]
    return 0


@kernel
def make_waveguide(arrays, beam):
    """Water in the plane athwart one side of a ping, and how high there is anything to hit."""
    water = arrays.water
    plane = lay_in_section(water.axis_x, water.axis_y, VerticalPlane(beam.x, beam.y, beam.side_x, beam.side_y))
    return Waveguide(
        water, plane, clear_of_nodes(water.height, _highest(arrays, beam)), arrays.bins * arrays.bin_length
    )


@kernel
def aim_side(arrays, waveguide, z, pitch, launch):
    """Aim all rays of a side over elevations and, where a pattern spreads them, over azimuths."""
    spreads = arrays.half_width > 0.0 and arrays.pattern.tabulated
    landings = aim_refracted_rays(launch, waveguide, z, arrays.half_width, arrays.law, spreads)
    if spreads:
        spread_over_pattern(launch, arrays.pattern, z, waveguide.reach, pitch)
    return landings


@kernel
def _highest(arrays, beam):
    """Height of the highest thing that a beam may meet, m."""
    solids, mesh, top = arrays.solids, arrays.mesh, arrays.bed.high
    for k in range(solids.shape.size):
        middle, radius, cx, cy, z = ball_about(solids, k)
        if _may_touch(beam, cx - beam.x, cy - beam.y, z - beam.z, middle + radius):
            top = max(top, z + middle * abs(solids.axis[k, 2]) + radius)
    if mesh.skip.size > 0:
        wx, wy = 0.5 * (mesh.high[0, 0] - mesh.low[0, 0]), 0.5 * (mesh.high[0, 1] - mesh.low[0, 1])
        wz, z = 0.5 * (mesh.high[0, 2] - mesh.low[0, 2]), 0.5 * (mesh.high[0, 2] + mesh.low[0, 2])
        cx, cy = mesh.low[0, 0] + wx - beam.x, mesh.low[0, 1] + wy - beam.y
        if _may_touch(beam, cx, cy, z - beam.z, math.sqrt(wx * wx + wy * wy + wz * wz)):
            top = max(top, mesh.high[0, 2])
    return top


@kernel
def _may_touch(beam, cx, cy, cz, bound):
    """Whether a beam of refracted rays may touch a ball, its centre counted from the sonar."""
    distance = math.sqrt(cx * cx + cy * cy + cz * cz)
    return beam_touches_ball(beam, cx, cy, cz, distance, bound + SLACK * distance)


@kernel
def _deposit_refracted(arrays, hits, arrivals, weight, sums):
    """Sum the echoes of hits into range bins, before the range factor, which holds 1/r⁴."""
    sums[:] = 0.0
    for k in range(weight.size):
        b, value, _ = refracted_echo(arrays, hits, arrivals, weight, k)
        if b >= 0:
            sums[b] += value


@inlined
def refracted_echo(arrays, hits, arrivals, weight, k):
    """Echo of the hit of one ray along arcs."""
    distance = hits.distance[k]
    if hits.body[k] == NOTHING or distance >= arrays.bins * arrays.bin_length:
        return -1, 0.0, 0.0
    b = int(distance / arrays.bin_length)
    dx, dy, dz = arrivals.dx[k], arrivals.dy[k], arrivals.dz[k]
    nx, ny, nz = hits.nx[k], hits.ny[k], hits.nz[k]
    cos_incidence = -(nx * dx + ny * dy + nz * dz)
    # A surface exactly edge-on returns nothing.
    if b >= arrays.bins or cos_incidence <= 0.0:
        return -1, 0.0, 0.0
    row, law = arrays.reflectivity[hits.material[k]], arrays.law
    value = backscatter_strength(cos_incidence, row[0], row[1], row[2], law) * weight[k] / cos_incidence
    tube, spread = arrivals.tube[k], arrivals.spread[k]
    if law == LIGHT:
        speeds = arrays.water.reference / arrivals.speed[k]
        return b, value * speeds * tube * elevation_tilt(dx, dy, dz, nx, ny, nz) / arrays.bin_length, cos_incidence
    # Over that in still water; Jensen et al., Computational Ocean Acoustics, 3.3: I = cosθ0 / (x |q|).
    intensity = distance * distance / (tube * spread)
    if arrays.half_width > 0.0:
        return b, value * distance * distance * intensity, cos_incidence
    return b, value * tube * intensity * intensity, cos_incidence
