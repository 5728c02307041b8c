"""Pings through water that bends rays: what comes back from hits along arcs.

A ray that stands for the solid angle dΩ lands on q x / cosθ0 · dΩ / cos α of a surface, q being the width of its tube
in elevation and x / cosθ0 that across; one way its intensity is I = cosθ0 / (x |q|) of that at 1 m, and the way back is
the way out. So it returns σ dA I² = σ dΩ I / cos α. A knife is 1 m wide along the track: σ q dθ I² / cos α. Law `light`
spreads nothing: a ray stands for the step of slant range that its landing makes as its elevation grows. In still water
q = x / cosθ0 = r.
"""

from __future__ import annotations

import math

import numpy as np

from insonify.kernels.bent_hits import Course, bent_hits, clear_of_nodes, empty_arrivals, plane_of
from insonify.kernels.double import mixed_echoes
from insonify.kernels.jit import fused, kernel
from insonify.kernels.launch import inside_body, make_beam, spread_rays, touches, turn
from insonify.kernels.pilots import Sea, aim_bent, no_landings
from insonify.kernels.rays import empty_bundle, empty_hits, empty_launch, tilt, weigh
from insonify.kernels.scatter import strength
from insonify.kernels.shapes import widest
from insonify.kernels.types import LIGHT, PORT
from insonify.kernels.walk import NOTHING

SLACK = 0.1  # of its distance, by which a body may be beside a beam of straight rays and yet be heard


@kernel
def trace_bent_pings(problem, poses, rays, march, out):
    """Trace all pings into ``out`` (pings, 2, bins) with ``rays`` a side: a walk along arcs, or a march if that is > 0.

    Return -1 - k if the sonar is inside body k, else 0.
    """
    port, starboard = empty_launch(rays), empty_launch(rays)
    bundle, hits, arrivals = empty_bundle(rays), empty_hits(rays), empty_arrivals(rays)
    weighed, sums = np.empty(rays), np.empty(problem.bins)
    aimed_at = np.full((2, 3), math.nan)
    to_port, to_starboard = no_landings(), no_landings()
    for ping in range(poses.x.size):
        z, pitch = poses.z[ping], poses.pitch[ping]
        body = inside_body(problem.solids, poses.x[ping], poses.y[ping], z)
        if body >= 0:
            return -1 - body
        for side in range(2):
            beam = make_beam(problem, poses, ping, side)
            launch = port if side == PORT else starboard
            sea = sea_of(problem, beam)
            aimed = z == aimed_at[side, 0] and sea.ceiling == aimed_at[side, 1] and pitch == aimed_at[side, 2]
            if not aimed or problem.water.station.size > 1:
                landings = aim_side(problem, sea, z, pitch, launch)
                aimed_at[side, 0], aimed_at[side, 1], aimed_at[side, 2] = z, sea.ceiling, pitch
                if side == PORT:
                    to_port = landings
                else:
                    to_starboard = landings
            turn(launch, beam, bundle)
            bent_hits(problem, bundle, sea.reach, march, hits, arrivals)
            weight = launch.weight
            if problem.pattern.tabled:
                weight = weigh(problem, beam, bundle, hits, launch.weight, weighed)
            deposit_bent(problem, hits, arrivals, weight, sums)
            landings = to_port if side == PORT else to_starboard
            if landings.fold < math.inf and march <= 0.0:
                _, bins, values = mixed_echoes(problem, beam, sea, z, landings, launch, bundle, hits, arrivals)
                for m in range(bins.size):
                    if bins[m] >= 0:
                        sums[bins[m]] += values[m]
            # What depends on range alone comes after the sum.
            for k in range(problem.bins):
                out[ping, side, k] = sums[k] * problem.range_factor[k]
    return 0


@kernel
def sea_of(problem, beam):
    """Tell what the rays of one side run through."""
    water = problem.water
    plane = plane_of(water.axis_x, water.axis_y, Course(beam.x, beam.y, beam.side_x, beam.side_y))
    return Sea(water, plane, clear_of_nodes(water.height, _highest(problem, beam)), problem.bins * problem.bin_length)


@kernel
def aim_side(problem, sea, z, pitch, launch):
    """Aim all rays of a side over elevations and, where a pattern spreads them, over azimuths."""
    spreads = problem.half_width > 0.0 and problem.pattern.tabled
    landings = aim_bent(launch, sea, z, problem.half_width, problem.law, spreads)
    if spreads:
        spread_rays(launch, problem.pattern, z, sea.reach, pitch)
    return landings


@kernel
def _highest(problem, beam):
    """Height of the highest thing that a beam may meet."""
    solids, mesh, top = problem.solids, problem.mesh, problem.bed.high
    for k in range(solids.shape.size):
        middle, radius = 0.5 * solids.length[k], widest(solids, k)
        cx = solids.start[k, 0] + middle * solids.axis[k, 0] - beam.x
        cy = solids.start[k, 1] + middle * solids.axis[k, 1] - beam.y
        z = solids.start[k, 2] + middle * solids.axis[k, 2]
        if _may_touch(beam, cx, cy, z - beam.z, middle + radius):
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
    """Whether a beam of bent rays may touch a ball, its centre counted from the sonar."""
    distance = math.sqrt(cx * cx + cy * cy + cz * cz)
    return touches(beam, cx, cy, cz, distance, bound + SLACK * distance)


@kernel
def deposit_bent(problem, hits, arrivals, weight, sums):
    """Sum what the hits return into time bins; the range factor, which holds 1/r⁴, comes after."""
    sums[:] = 0.0
    for k in range(weight.size):
        b, value, _ = echo_of(problem, hits, arrivals, weight, k)
        if b >= 0:
            sums[b] += value


@fused
def echo_of(problem, hits, arrivals, weight, k):
    """Bin and value of what the hit of ray k returns, and its cosine of incidence; bin −1 if it returns nothing."""
    distance = hits.distance[k]
    if hits.body[k] == NOTHING or distance >= problem.bins * problem.bin_length:
        return -1, 0.0, 0.0
    b = int(distance / problem.bin_length)
    dx, dy, dz = arrivals.dx[k], arrivals.dy[k], arrivals.dz[k]
    nx, ny, nz = hits.nx[k], hits.ny[k], hits.nz[k]
    cos_incidence = -(nx * dx + ny * dy + nz * dz)
    # A surface exactly edge-on returns nothing.
    if b >= problem.bins or cos_incidence <= 0.0:
        return -1, 0.0, 0.0
    row, law = problem.reflectivity[hits.material[k]], problem.law
    value = strength(cos_incidence, row[0], row[1], row[2], law) * weight[k] / cos_incidence
    tube, spread = arrivals.tube[k], arrivals.spread[k]
    if law == LIGHT:
        speeds = problem.water.reference / arrivals.speed[k]
        return b, value * speeds * tube * tilt(dx, dy, dz, nx, ny, nz) / problem.bin_length, cos_incidence
    intensity = distance * distance / (tube * spread)  # beside still water's
    if problem.half_width > 0.0:
        return b, value * distance * distance * intensity, cos_incidence
    return b, value * tube * intensity * intensity, cos_incidence
