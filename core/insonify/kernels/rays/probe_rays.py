"""Launch directions of refracted rays, from probe rays that show where there is anything to hit.

Between two probes that hit a level bed, rays lie at equal steps of its slant range. Between probes that only come as
low as a target may stand, rays are as dense as on a level bed at the end of the range, at most half of all. Elevations
that reach nothing get no rays. The angles of all rays add up exactly to those that reach anything.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.compiler.jit import inlined, kernel
from insonify.kernels.common.types import Water
from insonify.kernels.rays.caustics import MOST_ARCS
from insonify.kernels.rays.launch import set_ray
from insonify.kernels.refraction.arcs import ENDLESS, HIGH, LOW, RANGE
from insonify.kernels.refraction.section_arcs import SectionPlane, advance_ray, launch_ray

PROBE_RAYS = 256
CROWD = 6.0  # concentration of the first probe rays about the horizontal, where range changes most per degree
APART = 1.0 / 512.0  # share of the range by which two probe rays may land apart; farther apart others go between
CLOSE = 1e-9  # rad between two probe rays that land far apart, or one nowhere, below which none goes between
MOST_PROBE_RAYS = 8192
FOLD_HALVINGS = (
    8  # of the elevations between probe rays about a fold, so that both paths to a place beside it are found
)


class Waveguide(NamedTuple):
    """Water in the plane athwart one side of a ping, and how high and how far there is anything to hit."""

    water: Water
    plane: SectionPlane
    ceiling: float  # m, height of the highest thing
    reach: float  # m, slant range


class ProbeRay(NamedTuple):
    """Landing of a probe ray of one elevation on the mean bed."""

    angle: float  # rad, up positive
    near: bool  # whether it comes below the highest thing
    range: float  # slant range at which it meets the mean bed, infinite if not before twice the sonar's
    x: float  # ground range of that, m
    flat: float  # ground range per metre of descent there


class Landings(NamedTuple):
    """Where probe rays meet the mean bed, by ascending elevation; NaN of those that do not."""

    angle: NDArray[np.float64]  # (n,) rad, up positive
    range: NDArray[np.float64]  # (n,) slant range, m
    x: NDArray[np.float64]  # (n,) ground range, m
    flat: NDArray[np.float64]  # (n,) metres of ground range per metre of height there
    fold: float  # least ground range that is met at more than one elevation, infinite if none is


@kernel
def empty_landings():
    """Landings of no probe rays."""
    return Landings(np.empty(0), np.empty(0), np.empty(0), np.empty(0), math.inf)


@kernel
def aim_refracted_rays(launch, waveguide, z, half_width, law, spreads):
    """Aim all rays of a side; rays that are not needed get weight 0."""
    n = launch.up.size
    landings, share = _weigh_elevations(waveguide, z)
    angle = landings.angle
    total, runs = share.sum(), _runs(share)
    k, first = 0, 0
    while first < share.size:
        last = first
        while last < share.size and share[last] > 0.0:
            last += 1
        if last > first and runs <= n:
            count = min(1 + int((n - runs) * (share[first:last].sum() / total)), n - k)
            _send_run(launch, k, count, angle[first : last + 1], share[first:last], half_width, law, spreads)
            k += count
        first = last + 1
    while k < n:
        set_ray(launch, k, 0.5 * math.pi, 0.0, 0.0, half_width, law, spreads)
        k += 1
    return landings


@kernel
def _weigh_elevations(waveguide, z):
    """Send probe rays; return where they land, and the relative number of rays between each two."""
    probes = [_send_probe(waveguide, z, _first_angle(0))]
    waiting = [probes[0]]
    waiting.pop()
    for i in range(1, PROBE_RAYS):
        waiting.append(_send_probe(waveguide, z, _first_angle(i)))
        while len(waiting) > 0:
            last, following = probes[-1], waiting[-1]
            if len(probes) < MOST_PROBE_RAYS and _needs_probe_between(last, following, waveguide.reach):
                waiting.append(_send_probe(waveguide, z, 0.5 * (last.angle + following.angle)))
            else:
                probes.append(waiting.pop())
    for _ in range(FOLD_HALVINGS):
        probes = _halve_about_folds(waveguide, z, probes)
    share, on_bed, aloft = np.zeros(len(probes) - 1), 0.0, 0.0
    for i in range(share.size):
        one, other = probes[i], probes[i + 1]
        if one.range <= waveguide.reach and other.range <= waveguide.reach:
            share[i] = min(abs(other.range - one.range), APART * waveguide.reach)
            on_bed += share[i]
        elif one.near or other.near:
            share[i] = -(other.angle - one.angle)
            aloft -= share[i]
    # dr/dθ of a level bed at the end of the range turns angles into metres of slant range.
    per_angle = waveguide.reach
    if 0.0 < z < waveguide.reach:
        per_angle = waveguide.reach * math.sqrt(waveguide.reach * waveguide.reach - z * z) / z
    if on_bed > 0.0 and aloft > 0.0:
        per_angle = min(per_angle, on_bed / aloft)
    for i in range(share.size):
        if share[i] < 0.0:
            share[i] *= -per_angle
    return _landings(probes), share


@kernel
def _landings(probes):
    """Landings of a list of probe rays."""
    n, fold, farthest = len(probes), math.inf, 0.0
    landings = Landings(np.empty(n), np.full(n, math.nan), np.full(n, math.nan), np.full(n, math.nan), fold)
    for i, probe in enumerate(probes):
        landings.angle[i] = probe.angle
        if probe.range < math.inf:
            landings.range[i], landings.x[i], landings.flat[i] = probe.range, probe.x, probe.flat
            if probe.x < farthest:
                fold = min(fold, probe.x)
            farthest = max(farthest, probe.x)
    return Landings(landings.angle, landings.range, landings.x, landings.flat, fold)


@kernel
def _halve_about_folds(waveguide, z, probes):
    """Probe rays with others halfway to their neighbours where their ground range is least or greatest."""
    more = [probes[0]]
    for i in range(1, len(probes)):
        if _is_fold(probes, i - 1) or _is_fold(probes, i):
            more.append(_send_probe(waveguide, z, 0.5 * (probes[i - 1].angle + probes[i].angle)))
        more.append(probes[i])
    return more


@inlined
def _is_fold(probes, i):
    """Whether both neighbours of a probe ray land nearer than it, or both farther."""
    if i == 0 or i == len(probes) - 1:
        return False
    one, here, other = probes[i - 1].x, probes[i].x, probes[i + 1].x
    return max(one, here, other) < math.inf and (here - one) * (other - here) < 0.0


@inlined
def _first_angle(i):
    """Elevation of one of the first probe rays, rad."""
    return 0.5 * math.pi * math.sinh(CROWD * (2.0 * i / (PROBE_RAYS - 1) - 1.0)) / math.sinh(CROWD)


@inlined
def _needs_probe_between(one, other, reach):
    """Whether more probe rays belong between two."""
    if other.angle - one.angle < CLOSE:
        return False
    if one.range <= reach and other.range <= reach:
        return abs(other.range - one.range) > APART * reach
    return one.near != other.near or (one.range <= reach) != (other.range <= reach)


@kernel
def _runs(share):
    """Count the stretches of elevations that get rays."""
    runs = 0
    for i in range(share.size):
        if share[i] > 0.0 and (i == 0 or share[i - 1] == 0.0):
            runs += 1
    return runs


@kernel
def _send_run(launch, first, count, angle, share, half_width, law, spreads):
    """Send rays over a stretch of elevations, each for an equal part of its shares."""
    per_ray, i, before = share.sum() / count, 0, 0.0
    low = angle[0]
    for k in range(count):
        middle, i, before = _reach_share(angle, share, (k + 0.5) * per_ray, i, before)
        high, i, before = _reach_share(angle, share, (k + 1.0) * per_ray, i, before)
        if k == count - 1:
            high = angle[share.size]
        set_ray(launch, first + k, middle, high - low, math.sin(high) - math.sin(low), half_width, law, spreads)
        low = high


@kernel
def _reach_share(angle, share, wanted, i, before):
    """Elevation up to which shares sum to what is wanted, from interval i on, before which they sum to ``before``."""
    while i < share.size - 1 and before + share[i] < wanted:
        before += share[i]
        i += 1
    part = min((wanted - before) / share[i], 1.0)
    return angle[i] + part * (angle[i + 1] - angle[i]), i, before


@kernel
def _send_probe(waveguide, z, elevation):
    """Send a probe ray down to the mean bed."""
    water, plane = waveguide.water, waveguide.plane
    ray = launch_ray(water.height, water.speed, water.station, plane, z, math.cos(elevation), math.sin(elevation))
    in_time, level = waveguide.reach / water.reference, min(0.0, waveguide.ceiling)
    x_end, near = 2.0 * in_time * water.speed.max(), False
    for _ in range(MOST_ARCS):
        above = ray.z > waveguide.ceiling or (ray.z == waveguide.ceiling and ray.sine > 0.0)
        near = near or (not above and ray.time <= in_time)
        if not above and ray.z <= level:
            break
        low, high = (waveguide.ceiling, water.surface) if above else (level, waveguide.ceiling)
        status, after = advance_ray(water.height, water.speed, water.station, plane, ray, x_end, low, high)
        if status == ENDLESS or status == RANGE or after.time > 2.0 * in_time or (above and status == HIGH):
            break
        if not above and status == LOW:
            return ProbeRay(elevation, near, after.time * water.reference, after.x, after.cosine / abs(after.sine))
        ray = after
    return ProbeRay(elevation, near, math.inf, math.inf, 0.0)
