"""Rays in sheets, each spread over the step of slant range that it stands for: nearer the truth than as many alone.

The rays of a sheet keep one place within the beam and follow one another in elevation. Where a ray and both its
neighbours land on one surface, what it returns is spread evenly over the step of range that its landing makes as its
elevation grows through its own share. At the edge of a shadow it stays a point: every sheet shares the elevations out
differently, so that over all of them points fill just what is lit, and no edge is blurred.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.kernels.bent_hits import bent_hits, empty_arrivals
from insonify.kernels.bent_pings import echo_of, sea_of
from insonify.kernels.double import mixed_echoes
from insonify.kernels.jit import kernel
from insonify.kernels.launch import aim, cone_azimuth, gather, highest_elevation, inside_body, make_beam, turn
from insonify.kernels.pilots import aim_bent
from insonify.kernels.rays import empty_bundle, empty_hits, empty_launch, returned, tilt
from insonify.kernels.walk import first_hits

STEADY = 2.0  # steps of range that two neighbours may land apart on one surface


class Landed(NamedTuple):
    """What the rays of one sheet return."""

    value: NDArray[np.float64]  # (n,)
    step: NDArray[np.float64]  # (n,) of slant range that each stands for, m


@kernel
def trace_sheets(problem, poses, sheets, rays, out):
    """Trace all pings into ``out`` (pings, 2, bins) with so many sheets a side of about so many rays.

    Return -1 - k if the sonar is inside body k, else 0.
    """
    sums, near = np.empty(problem.bins), np.empty(problem.solids.shape.size, np.int64)
    for ping in range(poses.x.size):
        body = inside_body(problem.solids, poses.x[ping], poses.y[ping], poses.z[ping])
        if body >= 0:
            return -1 - body
        for side in range(2):
            beam = make_beam(problem, poses, ping, side)
            sums[:] = 0.0
            for sheet in range(sheets):
                # Every sheet has another number of rays, so that its shares of the elevations lie differently.
                count, place = rays + sheet - sheets // 2, (sheet + 0.5) / sheets
                if problem.water.bent:
                    _add_bent_sheet(problem, beam, poses.z[ping], count, place, sums)
                else:
                    _add_sheet(problem, beam, poses.z[ping], near, count, place, sums)
            for k in range(problem.bins):
                out[ping, side, k] = sums[k] * problem.range_factor[k] / sheets
    return 0


@kernel
def _add_sheet(problem, beam, z, near, count, place, sums):
    """Sum what one sheet of straight rays returns."""
    launch, bundle, hits = empty_launch(count), empty_bundle(count), empty_hits(count)
    bodies, top = gather(problem.solids, problem.mesh, beam, near)
    top = max(top, highest_elevation(problem.bed.high - z, 0.0, beam.reach))
    aim(launch, z, top, beam.reach, problem.half_width, problem.law, False)
    _lay(launch, problem.half_width, place)
    turn(launch, beam, bundle)
    first_hits(problem.bed, problem.solids, near, bodies, problem.mesh, bundle, beam.reach, hits)
    landed, fan = Landed(np.zeros(count), np.zeros(count)), problem.half_width > 0.0
    for k in range(count):
        value, growth = returned(bundle, hits, k, problem.reflectivity, problem.law, fan, problem.bin_length)
        landed.value[k], landed.step[k] = value * launch.weight[k], growth * _share(launch.up, k)
    _spread(landed, hits, problem.bin_length, sums)


@kernel
def _add_bent_sheet(problem, beam, z, count, place, sums):
    """Sum what one sheet of rays returns that follow arcs."""
    launch, bundle, hits, arrivals = empty_launch(count), empty_bundle(count), empty_hits(count), empty_arrivals(count)
    sea = sea_of(problem, beam)
    landings = aim_bent(launch, sea, z, problem.half_width, problem.law, False)
    _lay(launch, problem.half_width, place)
    turn(launch, beam, bundle)
    bent_hits(problem, bundle, sea.reach, 0.0, hits, arrivals)
    landed = Landed(np.zeros(count), np.zeros(count))
    for k in range(count):
        b, value, cos_incidence = echo_of(problem, hits, arrivals, launch.weight, k)
        if b >= 0:
            rise = tilt(arrivals.dx[k], arrivals.dy[k], arrivals.dz[k], hits.nx[k], hits.ny[k], hits.nz[k])
            growth = problem.water.reference / arrivals.speed[k] * arrivals.tube[k] * rise / cos_incidence
            landed.value[k], landed.step[k] = value, growth * _share(launch.up, k)
    _spread(landed, hits, problem.bin_length, sums)
    if landings.fold < math.inf:
        _, bins, values = mixed_echoes(problem, beam, sea, z, landings, launch, bundle, hits, arrivals)
        for m in range(bins.size):
            if bins[m] >= 0:
                sums[bins[m]] += values[m]


@kernel
def _lay(launch, half_width, place):
    """Turn rays to one place, in [0, 1), within a top-hat beam."""
    if half_width <= 0.0:
        return
    for k in range(launch.up.size):
        c = math.sqrt(launch.ahead[k] * launch.ahead[k] + launch.abeam[k] * launch.abeam[k])
        azimuth = cone_azimuth(c, half_width) * (2.0 * place - 1.0)
        launch.ahead[k], launch.abeam[k] = c * math.sin(azimuth), c * math.cos(azimuth)


@kernel
def _share(up, k):
    """Elevation that a ray stands for: up to halfway to its neighbours, of which one may belong to another run."""
    elevation, share = math.asin(up[k]), math.pi
    if k > 0:
        share = min(share, abs(elevation - math.asin(up[k - 1])))
    if k + 1 < up.size:
        share = min(share, abs(math.asin(up[k + 1]) - elevation))
    return share


@kernel
def _spread(landed, hits, bin_length, sums):
    """Sum what rays return over the bins that each spans."""
    for k in range(landed.value.size):
        value = landed.value[k]
        if value == 0.0:
            continue
        half = 0.5 * landed.step[k] if _goes_on(landed, hits, k - 1, k) and _goes_on(landed, hits, k, k + 1) else 0.0
        near = max(hits.distance[k] - half, 0.0) / bin_length
        far = (hits.distance[k] + half) / bin_length
        first, last = int(near), int(far)
        if first == last:
            if first < sums.size:
                sums[first] += value
            continue
        density = value / (far - near)
        for b in range(first, min(last + 1, sums.size)):
            sums[b] += density * (min(far, b + 1.0) - max(near, b))


@kernel
def _goes_on(landed, hits, one, other):
    """Whether two neighbours land on one surface without a gap between."""
    if one < 0 or other >= landed.value.size or landed.value[one] == 0.0 or landed.value[other] == 0.0:
        return False
    apart = abs(hits.distance[other] - hits.distance[one])
    return hits.body[one] == hits.body[other] and apart <= STEADY * max(landed.step[one], landed.step[other])
