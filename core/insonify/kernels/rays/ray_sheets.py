"""Sheets of rays, each integrated over elevation: more accurate than as many single rays.

The rays of a sheet keep one place within the beam and follow one another in elevation. Where two neighbours land on one
surface, as far apart as the growths of their ranges predict, the energy between them is spread over the range between
them; their distance also locates a kink of the surface. Any other gap between neighbours, such as the edge of a shadow
or of a target, is halved until it is a small share of a bin.

Where refraction gives several paths to a place, echoes out by the rays of a sheet and back by another path are sheets
of their own, one for each path back.

Theory: docs/theory/error.md.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.compiler.jit import inlined, kernel
from insonify.kernels.beam.pattern import widest_extent
from insonify.kernels.common.range_bins import range_weight
from insonify.kernels.common.types import LIGHT
from insonify.kernels.rays.cast import (
    arrive_straight,
    echo_dark_sides,
    echo_rays,
    fill_range_growths,
    make_waveguide,
    weigh_by_pattern,
)
from insonify.kernels.rays.cell_walk import NO_HIT, empty_bundle, empty_hits, find_first_hits
from insonify.kernels.rays.launch import (
    aim_rays,
    cone_azimuth,
    empty_launch,
    highest_elevation,
    list_solids_in_beam,
    orient_beam,
    rotate_to_world,
)
from insonify.kernels.rays.mixed_paths import MOST_WAYS, find_mixed_echoes
from insonify.kernels.rays.probe_rays import Landings, Waveguide, aim_refracted_rays, empty_landings
from insonify.kernels.rays.refracted_hits import LandedRays, empty_arrivals, find_refracted_hits

DIRECT = -1  # way of a first echo, back along the ray itself
KINKED = 0.02  # share by which growths differ on both sides of a kink
FINE = 1.0 / 64.0  # share of a bin by which neighbours may land apart without being halved, even beside a caustic
FINEST = 1e-9  # rad, the least angle between neighbours
ROUNDED = 0.03  # share by which echoes of neighbours on a round body or at a caustic may differ without being halved
FINEST_ROUNDED = 1e-6  # rad, the least angle between neighbours on one or at a caustic
OF_NADIR = 4  # rays of a sheet per extra ray about nadir
OF_THREE = 3  # rays of a gap: both ends and the middle
REVERSED = 1 << 32  # marks surfaces with mixed echoes that count for both orders of their paths


class SheetFan(NamedTuple):
    """What the rays of all sheets of one side share."""

    pitch: float  # rad
    near: NDArray[np.int64]  # (bodies,) rows of the solids in the beam
    waveguide: Waveguide
    landings: Landings  # of probe rays; empty for straight rays


class SheetEchoes(NamedTuple):
    """Echoes of the rays of one sheet, by ascending elevation."""

    angle: NDArray[np.float64]  # (n,) elevation, rad
    distance: NDArray[np.float64]  # (n,) slant range, m, infinite where nothing is met
    surface: NDArray[np.int64]  # (n,) what is met: a body, all triangles alike, BED or NO_HIT
    value: NDArray[np.float64]  # (n,) per radian of elevation
    growth: NDArray[np.float64]  # (n,) of slant range, m per radian of elevation
    dark: NDArray[np.float64]  # (n,) value of the echo from the dark side of a caustic
    mirrored: NDArray[np.float64]  # (n,) and its slant range, m
    at_caustic: NDArray[np.bool_]  # (n,) whether a caustic is near


@kernel
def trace_ray_sheets(arrays, poses, sheets, rays, out):
    """Intensity per range bin of pings traced by sheets of rays.

    Parameters
    ----------
    arrays : SceneArrays
        Without multipath and bounces: sheets have first echoes alone.
    poses : Poses of ndarrays, shape (n,)
    sheets : int
        Per side.
    rays : int
        Per sheet to begin with.
    out : ndarray of float32, shape (n, 2, bins)
        Filled.
    """
    sums, near = np.empty(arrays.bins), np.empty(arrays.solids.shape.size, np.int64)
    for ping in range(poses.x.size):
        for side in range(2):
            beam = orient_beam(arrays, poses, ping, side)
            sums[:] = 0.0
            _add_sheets(arrays, beam, poses.pitch[ping], near, sheets, rays, sums)
            for k in range(arrays.bins):
                out[ping, side, k] = sums[k] * arrays.range_factor[k] / sheets


@kernel
def _add_sheets(arrays, beam, pitch, near, sheets, rays, sums):
    """Sum the echoes of the sheets of one side."""
    launch, waveguide = empty_launch(rays), make_waveguide(arrays, beam)
    # Law `light` of a knife: weights are the angles that rays stand for.
    if arrays.water.bent:
        bodies, top = 0, 0.5 * math.pi
        landings = aim_refracted_rays(launch, waveguide, beam.z, 0.0, LIGHT, True)
    else:
        bodies, top = list_solids_in_beam(arrays.solids, arrays.mesh, beam, near)
        top = max(top, highest_elevation(arrays.bed.high - beam.z, 0.0, beam.reach))
        landings = empty_landings()
        aim_rays(launch, beam.z, top, beam.reach, 0.0, LIGHT, True)
    fan, angle = SheetFan(pitch, near[:bodies], waveguide, landings), _elevations(launch.up, top)
    for sheet in range(sheets):
        place = (sheet + 0.5) / sheets
        density, rays_out = _follow_rays(arrays, beam, fan, angle, place)
        _add_path(arrays, beam, fan, place, DIRECT, _echo_direct(arrays, beam, angle, density, rays_out), sums)
        if landings.fold < math.inf:
            # The mixed echoes out along the rays of the sheet, one path back after the other.
            mixed = find_mixed_echoes(arrays, beam, waveguide, landings, density, rays_out)
            for way in range(MOST_WAYS):
                landed = _echo_mixed(arrays, beam, angle, rays_out, mixed, way)
                if not np.any(landed.value > 0.0):
                    break
                _add_path(arrays, beam, fan, place, way, landed, sums)


@kernel
def _add_path(arrays, beam, fan, place, way, landed, sums):
    """Sum the echoes of one sheet back by one path, of its first rays and of those that are added between them."""
    together, folds = landed.angle.size, fan.landings.fold < math.inf
    while landed.angle.size > 0:
        gaps = _spread_or_split(landed, together, arrays.solids.shape.size, folds, arrays, sums)
        halfway = 0.5 * (landed.angle[gaps] + landed.angle[gaps + 1])
        density, rays = _follow_rays(arrays, beam, fan, halfway, place)
        if way == DIRECT:
            middles = _echo_direct(arrays, beam, halfway, density, rays)
        else:
            mixed = find_mixed_echoes(arrays, beam, fan.waveguide, fan.landings, density, rays)
            middles = _echo_mixed(arrays, beam, halfway, rays, mixed, way)
        landed, together = _insert_middles(landed, gaps, middles), OF_THREE


@kernel
def _elevations(up, top):
    """Elevations at which a sheet begins, ascending: those aimed at, many about nadir, and both ends of all."""
    n = up.size
    few = max(n // OF_NADIR, 1)
    angle = np.empty(n + few + 1)
    angle[:n] = np.arcsin(up)
    for k in range(few):
        # Equal steps of slant range plus ground range; equal steps of slant range alone are too wide about nadir.
        angle[n + k] = -2.0 * math.atan(1.0 / (1.0 + math.sqrt(2.0) * k / few))
    angle[n + few] = top
    return np.sort(angle)


@kernel
def _follow_rays(arrays, beam, fan, angle, place):
    """Rays of one place within the beam at given elevations, and the weight of each per radian of elevation."""
    bundle, density = _send(arrays, beam, fan.pitch, angle, place)
    if arrays.water.bent:
        rays = LandedRays(bundle, empty_hits(angle.size), empty_arrivals(angle.size))
        find_refracted_hits(arrays, bundle, beam.reach, 0.0, rays.hits, rays.arrivals)
    else:
        hits = empty_hits(angle.size)
        find_first_hits(arrays.bed, arrays.solids, fan.near, fan.near.size, arrays.mesh, bundle, beam.reach, hits)
        rays = arrive_straight(bundle, hits, arrays.water.reference)
    return density, rays


@kernel
def _no_echoes(arrays, angle, rays):
    """Echoes of rays of a sheet that return nothing."""
    n = angle.size
    landed = SheetEchoes(
        angle, np.full(n, math.inf), np.full(n, NO_HIT), np.zeros(n), np.zeros(n), np.zeros(n), np.zeros(n),
        np.zeros(n, np.bool_),
    )  # fmt: skip
    if arrays.water.bent:
        landed.at_caustic[:] = rays.arrivals.dark > 0.0
    return landed


@kernel
def _echo_direct(arrays, beam, angle, density, rays):
    """Echoes of rays of a sheet back along themselves."""
    landed, hits = _no_echoes(arrays, angle, rays), rays.hits
    if arrays.pattern.tabulated:
        density = weigh_by_pattern(arrays, beam, rays, density)
    echoes = echo_rays(arrays, rays, density)
    fill_range_growths(arrays.water.reference, hits, rays.arrivals, echoes, landed.growth)
    if arrays.water.bent:
        dark = echo_dark_sides(arrays, rays, echoes)
        landed.dark[dark.ray], landed.mirrored[dark.ray] = dark.value, dark.distance
    landed.distance[:], landed.surface[:] = hits.distance, np.minimum(hits.body, arrays.solids.shape.size)
    landed.value[:] = echoes.value
    return landed


@kernel
def _echo_mixed(arrays, beam, angle, rays, mixed, way):
    """Echoes of rays of a sheet back by one other path."""
    landed, hits = _no_echoes(arrays, angle, rays), rays.hits
    for m in range(mixed.ray.size):
        if mixed.way[m] == way and mixed.bin[m] >= 0:
            k = mixed.ray[m]
            landed.distance[k], landed.surface[k] = mixed.distance[m], min(hits.body[k], arrays.solids.shape.size)
            if 2.0 * mixed.distance[m] - hits.distance[k] >= beam.reach:
                landed.surface[k] += REVERSED  # it counts for its reverse as well
            landed.value[k], landed.growth[k] = mixed.value[m], mixed.growth[m]
    return landed


@kernel
def _send(arrays, beam, pitch, angle, place):
    """Point rays to one place, in [0, 1), within the beam; return the weight of each per radian of elevation."""
    n, fan, tabulated = angle.size, arrays.half_width > 0.0, arrays.pattern.tabulated
    centre, extent = arrays.pattern.centre, widest_extent(arrays.pattern)
    launch, bundle = empty_launch(n), empty_bundle(n)
    for k in range(n):
        c, s = math.cos(angle[k]), math.sin(angle[k])
        azimuth, wide = 0.0, 1.0
        if fan and tabulated:
            level, tip = math.cos(pitch) * c, math.sin(pitch) * s
            azimuth, wide = _azimuth(centre - tip, extent, math.sin(arrays.half_width), level, place)
        elif fan:
            wide = 2.0 * cone_azimuth(c, arrays.half_width)
            azimuth = wide * (place - 0.5)
            wide = 1.0 if arrays.law == LIGHT else wide  # law `light` averages over the beam
        launch.ahead[k], launch.abeam[k], launch.up[k] = c * math.sin(azimuth), c * math.cos(azimuth), s
        launch.weight[k] = wide * c if fan and arrays.law != LIGHT else wide
    rotate_to_world(launch, beam, bundle)
    return bundle, launch.weight


@inlined
def _azimuth(centre, extent, main, level, place):
    """Azimuth of a place in [0, 1) within a beam with a pattern, and its derivative with respect to that place."""
    # Half the places are in the main lobe, where that is less than half of the beam's extent; away from it they lie
    # ever farther apart. Over azimuths φ, level · sin φ runs from centre - extent to centre + extent.
    low, high = max((centre - extent) / level, -1.0), min((centre + extent) / level, 1.0)
    if not low < high:
        return 0.0, 0.0
    middle = math.asin(min(max(centre / level, low), high))
    side = 2.0 * place - 1.0
    whole = math.asin(high) - middle if side > 0.0 else middle - math.asin(low)
    lobe = math.asin(min(main / level, 1.0)) / max(whole, 1e-300)
    if lobe >= 0.5:
        return middle + whole * side, 2.0 * whole
    # sinh(k/2) / sinh(k) is the lobe's share.
    k = 2.0 * math.acosh(0.5 / lobe)
    return middle + whole * math.sinh(k * side) / math.sinh(k), 2.0 * whole * k * math.cosh(k * side) / math.sinh(k)


@kernel
def _spread_or_split(landed, together, solids, folds, arrays, sums):
    """Spread the energy between neighbouring rays over the bins that it spans; list the gaps that must be halved."""
    # Each run of ``together`` rays is a row of neighbours. Surfaces below ``solids`` are round bodies: the echo changes
    # between two neighbours even where their landings fit an even spread. So it does at a caustic, of water that
    # ``folds`` the bed.
    n, bin_length, decay = landed.angle.size, arrays.bin_length, arrays.range_decay
    gaps, count = np.empty(n, np.int64), 0
    for k in range(n - 1):
        if (k + 1) % together == 0 or (landed.value[k] == 0.0 and landed.value[k + 1] == 0.0):
            continue
        angle = landed.angle[k + 1] - landed.angle[k]
        one, other = landed.growth[k] * angle, landed.growth[k + 1] * angle
        apart = abs(landed.distance[k + 1] - landed.distance[k])
        alike = landed.surface[k] == landed.surface[k + 1] and landed.value[k] > 0.0 and landed.value[k + 1] > 0.0
        is_round = landed.surface[k] >= 0 and landed.surface[k] < solids
        change = abs(landed.value[k] - landed.value[k + 1]) / max(landed.value[k], landed.value[k + 1])
        is_wide = max(one, other) > FINE * bin_length
        at_caustic = is_wide and (landed.at_caustic[k] or landed.at_caustic[k + 1])
        # Ranges that differ by less than both growths lie on either side of the nearest point, where the echo peaks.
        turned = apart < 0.25 * (one + other) and (is_round or (folds and is_wide))
        if alike and angle > FINEST_ROUNDED and (turned or ((is_round or at_caustic) and change > ROUNDED)):
            gaps[count] = k
            count += 1
        elif alike and abs(apart - 0.5 * (one + other)) <= 0.5 * max(one, other):
            _spread_between(landed, k, angle, one, other, bin_length, decay, sums)
        elif is_wide and angle > FINEST:
            gaps[count] = k
            count += 1
        else:
            for m in range(k, k + 2):
                place = landed.distance[m]
                _add_over_ranges(0.5 * angle * landed.value[m], place, place, bin_length, decay, sums)
                place = landed.mirrored[m]
                _add_over_ranges(0.5 * angle * landed.dark[m], place, place, bin_length, decay, sums)
    return gaps[:count]


@inlined
def _spread_between(landed, k, angle, one, other, bin_length, decay, sums):
    """Spread the energy between two neighbours over the range between them, on either side of its kink."""
    near, far, share = landed.distance[k], landed.distance[k + 1], 0.5
    if abs(one - other) > KINKED * max(one, other):
        # The growth is one up to the kink and the other beyond: the distance between both landings gives its place.
        share = min(max((abs(far - near) - other) / (one - other), 0.0), 1.0)
    kink = near + math.copysign(min(share * one, abs(far - near)), far - near)
    _add_over_ranges(share * angle * landed.value[k], near, kink, bin_length, decay, sums)
    _add_over_ranges((1.0 - share) * angle * landed.value[k + 1], kink, far, bin_length, decay, sums)
    # Beside a ray that is too far from the caustic to have a dark side, that of the other one is all but nothing.
    one, other = landed.dark[k], landed.dark[k + 1]
    near = landed.mirrored[k] if one > 0.0 else landed.mirrored[k + 1]
    far = landed.mirrored[k + 1] if other > 0.0 else near
    _add_over_ranges(0.5 * angle * (one + other), near, far, bin_length, decay, sums)


@kernel
def _add_over_ranges(value, one, other, bin_length, decay, sums):
    """Spread a value evenly over the bins between two ranges."""
    if value == 0.0:
        return
    near, far = min(one, other) / bin_length, max(one, other) / bin_length
    first, last = int(near), int(far)
    if first == last:
        if first < sums.size:
            sums[first] += value * range_weight(decay, first, 0.5 * (near + far), far - near)
        return
    density = value / (far - near)
    for b in range(first, min(last + 1, sums.size)):
        start, stop = max(near, float(b)), min(far, b + 1.0)
        sums[b] += density * (stop - start) * range_weight(decay, b, 0.5 * (start + stop), stop - start)


@kernel
def _insert_middles(landed, gaps, middles):
    """Echoes of the rays halfway across gaps, between those that bound them."""
    return SheetEchoes(
        _insert_between(landed.angle, gaps, middles.angle),
        _insert_between(landed.distance, gaps, middles.distance),
        _insert_between(landed.surface, gaps, middles.surface),
        _insert_between(landed.value, gaps, middles.value),
        _insert_between(landed.growth, gaps, middles.growth),
        _insert_between(landed.dark, gaps, middles.dark),
        _insert_between(landed.mirrored, gaps, middles.mirrored),
        _insert_between(landed.at_caustic, gaps, middles.at_caustic),
    )


@kernel
def _insert_between(column, gaps, middle):
    """Values on both sides of gaps, with one between them: before, middle, after."""
    row = np.empty(OF_THREE * gaps.size, column.dtype)
    for m in range(gaps.size):
        first = OF_THREE * m
        row[first], row[first + 1], row[first + 2] = column[gaps[m]], middle[m], column[gaps[m] + 1]
    return row
