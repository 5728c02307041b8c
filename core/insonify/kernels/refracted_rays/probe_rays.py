"""Where rays are sent in water that bends them: pilots go first and tell at which elevations there is anything to hit.

Between two pilots that hit a level bed, rays lie at equal steps of its slant range; where a pilot only comes as low as
something may stand, as dense as they lie on a level bed at the end of the range, at most half of all. Elevations from
which nothing is reached get no rays. Each ray stands for exactly the angles that it was given.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.kernels.common.jit import inlined, kernel
from insonify.kernels.common.types import Water
from insonify.kernels.rays.launch import send
from insonify.kernels.refracted_rays.hits import MOST_ARCS, go_on, set_out
from insonify.kernels.refraction.arcs import ENDLESS, HIGH, LOW, RANGE
from insonify.kernels.refraction.section_arcs import Plane

PILOTS = 256
CROWD = 6.0  # the first pilots lie closest about the horizontal, where a degree turns into the most metres
APART = 1.0 / 512.0  # of the range, that two pilots may land apart: then others go between
CLOSE = 1e-9  # rad, between pilots of which one lands far from the other, or nowhere: there rays turn
MOST_PILOTS = 8192


class Sea(NamedTuple):
    """What the rays of one side run through, athwart, and how high there is anything to hit."""

    water: Water
    plane: Plane
    ceiling: float  # m, height of the highest thing
    reach: float  # m, slant range


class Pilot(NamedTuple):
    """What becomes of a ray that is sent at one elevation."""

    angle: float  # rad, up positive
    near: bool  # whether it comes as low as there is anything
    range: float  # slant range at which it meets the mean bed, infinite if not before twice the sonar's
    x: float  # ground range of that, m
    flat: float  # metres of ground range per metre that it comes down there


class Landings(NamedTuple):
    """Where pilots meet the mean bed, by ascending elevation; NaN of those that do not."""

    angle: NDArray[np.float64]  # (n,) rad, up positive
    range: NDArray[np.float64]  # (n,) slant range, m
    x: NDArray[np.float64]  # (n,) ground range, m
    flat: NDArray[np.float64]  # (n,) metres of ground range per metre of height there
    fold: float  # least ground range that is met at more than one elevation, infinite if none is


@kernel
def no_landings():
    """Landings of no pilots."""
    return Landings(np.empty(0), np.empty(0), np.empty(0), np.empty(0), math.inf)


@kernel
def aim_bent(launch, sea, z, half_width, law, spreads):
    """Aim all rays of a side; athwart where a pattern ``spreads`` them later. What is left over has no weight.

    Return the landings of the pilots.
    """
    n = launch.up.size
    landings, share = _weigh_elevations(sea, z)
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
        send(launch, k, 0.5 * math.pi, 0.0, 0.0, half_width, law, spreads)
        k += 1
    return landings


@kernel
def _weigh_elevations(sea, z):
    """Send pilots; return where they land, and how many rays belong between each two by comparison."""
    pilots = [_send_pilot(sea, z, _first_angle(0))]
    waiting = [pilots[0]]
    waiting.pop()
    for i in range(1, PILOTS):
        waiting.append(_send_pilot(sea, z, _first_angle(i)))
        while len(waiting) > 0:
            last, following = pilots[-1], waiting[-1]
            if len(pilots) < MOST_PILOTS and _parted(last, following, sea.reach):
                waiting.append(_send_pilot(sea, z, 0.5 * (last.angle + following.angle)))
            else:
                pilots.append(waiting.pop())
    share, on_bed, aloft = np.zeros(len(pilots) - 1), 0.0, 0.0
    for i in range(share.size):
        one, other = pilots[i], pilots[i + 1]
        if one.range <= sea.reach and other.range <= sea.reach:
            share[i] = min(abs(other.range - one.range), APART * sea.reach)
            on_bed += share[i]
        elif one.near or other.near:
            share[i] = -(other.angle - one.angle)
            aloft -= share[i]
    # dr/dθ of a level bed at the end of the range turns angles into metres of slant range.
    per_angle = sea.reach
    if 0.0 < z < sea.reach:
        per_angle = sea.reach * math.sqrt(sea.reach * sea.reach - z * z) / z
    if on_bed > 0.0 and aloft > 0.0:
        per_angle = min(per_angle, on_bed / aloft)
    for i in range(share.size):
        if share[i] < 0.0:
            share[i] *= -per_angle
    return _landings(pilots), share


@kernel
def _landings(pilots):
    """Lay out where pilots land."""
    n, fold, farthest = len(pilots), math.inf, 0.0
    landings = Landings(np.empty(n), np.full(n, math.nan), np.full(n, math.nan), np.full(n, math.nan), fold)
    for i, pilot in enumerate(pilots):
        landings.angle[i] = pilot.angle
        if pilot.range < math.inf:
            landings.range[i], landings.x[i], landings.flat[i] = pilot.range, pilot.x, pilot.flat
            if pilot.x < farthest:
                fold = min(fold, pilot.x)
            farthest = max(farthest, pilot.x)
    return Landings(landings.angle, landings.range, landings.x, landings.flat, fold)


@inlined
def _first_angle(i):
    """Elevation of one of the first pilots."""
    return 0.5 * math.pi * math.sinh(CROWD * (2.0 * i / (PILOTS - 1) - 1.0)) / math.sinh(CROWD)


@inlined
def _parted(one, other, reach):
    """Whether more pilots belong between two."""
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
        send(launch, first + k, middle, high - low, math.sin(high) - math.sin(low), half_width, law, spreads)
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
def _send_pilot(sea, z, elevation):
    """Send a pilot down to the mean bed."""
    water, plane = sea.water, sea.plane
    ray = set_out(water.height, water.speed, water.station, plane, z, math.cos(elevation), math.sin(elevation))
    in_time, level = sea.reach / water.reference, min(0.0, sea.ceiling)
    x_end, near = 2.0 * in_time * water.speed.max(), False
    for _ in range(MOST_ARCS):
        above = ray.z > sea.ceiling or (ray.z == sea.ceiling and ray.sine > 0.0)
        near = near or (not above and ray.time <= in_time)
        if not above and ray.z <= level:
            break
        low, high = (sea.ceiling, water.surface) if above else (level, sea.ceiling)
        status, after = go_on(water.height, water.speed, water.station, plane, ray, x_end, low, high)
        if status == ENDLESS or status == RANGE or after.time > 2.0 * in_time or (above and status == HIGH):
            break
        if not above and status == LOW:
            return Pilot(elevation, near, after.time * water.reference, after.x, after.cosine / abs(after.sine))
        ray = after
    return Pilot(elevation, near, math.inf, math.inf, 0.0)
