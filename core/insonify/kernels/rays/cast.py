"""Cast of one side's rays, straight or along arcs: aim, launch, first hit, arrival and echo.

A ray that stands for the solid angle dΩ lands on q x / cosθ0 · dΩ / cos α of a surface. Its tube is q wide in elevation
and x / cosθ0 across. One way its intensity is I = cosθ0 / (x |q|) of the intensity at 1 m (Jensen et al., Computational
Ocean Acoustics, 3.3). Near a caustic `caustics` gives it. The way back is the way out. So it returns σ dA I² = σ dΩ I /
cos α. A knife is 1 m wide along the track: σ q dθ I² / cos α. Law `light` spreads nothing: a ray stands for the step of
slant range that its landing makes as its elevation grows. A straight ray is an arrival with q = x / cosθ0 = r.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.compiler.jit import inlined_uncounted, kernel, kernel_uncounted
from insonify.kernels.beam.pattern import two_way_response
from insonify.kernels.common.range_bins import range_weight
from insonify.kernels.common.scattering import backscatter_strength
from insonify.kernels.common.types import LIGHT
from insonify.kernels.rays.cell_walk import NO_HIT, empty_bundle, empty_hits, find_first_hits
from insonify.kernels.rays.launch import (
    RayLaunch,
    aim_rays,
    ball_about,
    beam_touches_ball,
    box_about,
    empty_launch,
    highest_elevation,
    list_solids_in_beam,
    rotate_to_world,
    spread_over_pattern,
)
from insonify.kernels.rays.march import march_hits
from insonify.kernels.rays.mixed_paths import MixedEchoes, empty_mixed_echoes, find_mixed_echoes
from insonify.kernels.rays.probe_rays import Landings, Waveguide, aim_refracted_rays, empty_landings
from insonify.kernels.rays.refracted_hits import (
    Arrivals,
    LandedRays,
    VerticalPlane,
    clear_of_nodes,
    empty_arrivals,
    find_refracted_hits,
    lay_in_section,
)

SLACK = 0.1  # share of its distance by which a body insonified along arcs may lie outside a beam of straight rays


class RayAim(NamedTuple):
    """Launch directions of one side, and what they are aimed for: pings that agree in this share them."""

    launch: RayLaunch
    landings: Landings  # of probe rays; empty for straight rays
    z: float  # height of the sonar, m
    top: float  # highest elevation of anything in the beam, rad; its height, m, for refracted rays
    pitch: float  # rad


class RayEchoes(NamedTuple):
    """Echoes of rays, (n,) each."""

    ray: NDArray[np.int64]  # number of the ray out; beside a caustic, of that on its bright side
    bin: NDArray[np.int64]  # -1 without an echo
    value: NDArray[np.float64]  # before the factor that depends on range alone
    distance: NDArray[np.float64]  # slant range, m
    cosine: NDArray[np.float64]  # of incidence of the ray out


class SideCast(NamedTuple):
    """Refracted rays of one side at their hits, and their echoes."""

    rays: LandedRays
    mixed: MixedEchoes
    echoes: RayEchoes  # of each ray, then out by one ray and back by another, then of dark sides of caustics


@kernel
def unaimed(rays):
    """Room for the launch directions of one side, aimed for no ping yet."""
    return RayAim(empty_launch(rays), empty_landings(), math.nan, math.nan, math.nan)


@kernel
def aim_straight(arrays, beam, pitch, near, aim):
    """List the solids in a beam, and aim its straight rays unless they are; return the number of solids and the aim."""
    count, top = list_solids_in_beam(arrays.solids, arrays.mesh, beam, near)
    top = max(top, highest_elevation(arrays.bed.high - beam.z, 0.0, beam.reach))
    if beam.z == aim.z and top == aim.top and pitch == aim.pitch:
        return count, aim
    spreads = arrays.half_width > 0.0 and arrays.pattern.tabulated
    aim_rays(aim.launch, beam.z, top, beam.reach, arrays.half_width, arrays.law, spreads)
    if spreads:
        spread_over_pattern(aim.launch, arrays.pattern, beam.z, beam.reach, pitch)
    return count, RayAim(aim.launch, aim.landings, beam.z, top, pitch)


@kernel
def cast_straight(arrays, beam, near, count, launch, step):
    """Straight rays of one side at their first hits: exact ones, or by a march in steps if ``step`` is positive."""
    n = launch.weight.size
    bundle, hits = empty_bundle(n), empty_hits(n)
    rotate_to_world(launch, beam, bundle)
    if step > 0.0:
        march_hits(arrays.bed, arrays.solids, near, count, arrays.mesh, bundle, beam.reach, step, hits)
    else:
        find_first_hits(arrays.bed, arrays.solids, near, count, arrays.mesh, bundle, beam.reach, hits)
    return arrive_straight(bundle, hits, arrays.water.reference)


@kernel
def arrive_straight(bundle, hits, speed_of_sound):
    """Straight rays with their hits as arrivals: tube and spreading are the range."""
    speed, no_place = np.full(hits.distance.size, speed_of_sound), np.empty(0)
    arrivals = Arrivals(
        bundle.dx, bundle.dy, bundle.dz, hits.distance, hits.distance, speed, no_place, no_place,
        no_place, no_place, no_place,
    )  # fmt: skip
    return LandedRays(bundle, hits, arrivals)


@kernel
def aim_refracted(arrays, beam, pitch, aim):
    """Aim the refracted rays of one side unless they are; return the water before them and the aim."""
    waveguide, water = make_waveguide(arrays, beam), arrays.water
    if beam.z == aim.z and waveguide.ceiling == aim.top and pitch == aim.pitch and water.station.size == 1:
        return waveguide, aim
    spreads = arrays.half_width > 0.0 and arrays.pattern.tabulated
    landings = aim_refracted_rays(aim.launch, waveguide, beam.z, arrays.half_width, arrays.law, spreads)
    if spreads:
        spread_over_pattern(aim.launch, arrays.pattern, beam.z, waveguide.reach, pitch)
    return waveguide, RayAim(aim.launch, landings, beam.z, waveguide.ceiling, pitch)


@kernel
def cast_refracted(arrays, beam, waveguide, aim, step):
    """Refracted rays of one side at their hits, in the scene of the aim or the same without targets."""
    # Rays that march, in steps if ``step`` is positive, have no mixed echoes.
    n = aim.launch.weight.size
    rays = LandedRays(empty_bundle(n), empty_hits(n), empty_arrivals(n))
    rotate_to_world(aim.launch, beam, rays.bundle)
    find_refracted_hits(arrays, rays.bundle, waveguide.reach, step, rays.hits, rays.arrivals)
    weight, mixed = aim.launch.weight, empty_mixed_echoes()
    if arrays.pattern.tabulated:
        weight = weigh_by_pattern(arrays, beam, rays, weight)
    if aim.landings.fold < math.inf and step <= 0.0:
        mixed = find_mixed_echoes(arrays, beam, waveguide, aim.landings, aim.launch.weight, rays)
    own = echo_rays(arrays, rays, weight)
    dark = echo_dark_sides(arrays, rays, own)
    echoes = RayEchoes(
        np.concatenate((own.ray, mixed.ray, dark.ray)),
        np.concatenate((own.bin, mixed.bin, dark.bin)),
        np.concatenate((own.value, mixed.value, dark.value)),
        np.concatenate((own.distance, mixed.distance, dark.distance)),
        np.concatenate((own.cosine, own.cosine[mixed.ray], dark.cosine)),
    )
    return SideCast(rays, mixed, echoes)


@kernel
def echo_dark_sides(arrays, rays, own):
    """Echoes from the dark sides of caustics, of a surface like that where refracted rays land on the bright side."""
    hits, arrivals = rays.hits, rays.arrivals
    ray = np.flatnonzero((own.bin >= 0) & (arrivals.dark > 0.0))
    dark = RayEchoes(ray, np.full(ray.size, -1), np.zeros(ray.size), np.empty(ray.size), own.cosine[ray])
    for m in range(ray.size):
        k = ray[m]
        moved = arrivals.shift[k] * _tilt(hits, arrivals, k) / own.cosine[k]
        distance = hits.distance[k] + arrays.water.reference / arrivals.speed[k] * moved
        dark.distance[m] = distance
        if 0.0 < distance < arrays.bins * arrays.bin_length:
            # Both rays' sound is there, and each brings half of its square.
            ratio = arrivals.dark[k] * (distance / hits.distance[k]) ** 2
            dark.bin[m] = min(int(distance / arrays.bin_length), arrays.bins - 1)
            dark.value[m] = 2.0 * ratio * ratio * own.value[k]
    return dark


@kernel
def make_waveguide(arrays, beam):
    """Water in the plane athwart one side of a ping, and how high there is anything to hit."""
    water = arrays.water
    plane = lay_in_section(water.axis_x, water.axis_y, VerticalPlane(beam.x, beam.y, beam.side_x, beam.side_y))
    return Waveguide(water, plane, clear_of_nodes(water.height, _highest(arrays, beam)), beam.reach)


@kernel
def _highest(arrays, beam):
    """Height of the highest thing that a beam may meet, m."""
    solids, mesh, top = arrays.solids, arrays.mesh, arrays.bed.high
    for k in range(solids.shape.size):
        middle, radius, cx, cy, z = ball_about(solids, k)
        if _may_touch(beam, cx - beam.x, cy - beam.y, z - beam.z, middle + radius):
            top = max(top, z + middle * abs(solids.axis[k, 2]) + radius)
    if mesh.skip.size > 0:
        wx, wy, wz, cx, cy, cz = box_about(mesh, 0)
        if _may_touch(beam, cx - beam.x, cy - beam.y, cz - beam.z, math.sqrt(wx * wx + wy * wy + wz * wz)):
            top = max(top, mesh.high[0, 2])
    return top


@kernel
def _may_touch(beam, cx, cy, cz, bound):
    """Whether a beam of refracted rays may touch a ball, its centre counted from the sonar."""
    distance = math.sqrt(cx * cx + cy * cy + cz * cz)
    return beam_touches_ball(beam, cx, cy, cz, distance, bound + SLACK * distance)


@kernel
def weigh_by_pattern(arrays, beam, rays, weight):
    """Weight of rays by the two-way response of a tabulated pattern towards their hits."""
    bundle, hits, fan, weighed = rays.bundle, rays.hits, arrays.half_width > 0.0, np.zeros(weight.size)
    for k in range(weight.size):
        if hits.body[k] != NO_HIT:
            dx, dy, dz = bundle.dx[k], bundle.dy[k], bundle.dz[k]
            weighed[k] = weight[k] * two_way_response(
                arrays.pattern, beam, fan, arrays.law, dx, dy, dz, hits.distance[k]
            )
    return weighed


@kernel
def add_echoes(arrays, echoes, sums):
    """Add echoes to range bins, before the range factor at the centres of these."""
    decay, per_bin = arrays.range_decay, 1.0 / arrays.bin_length
    for n in range(echoes.bin.size):
        if echoes.bin[n] >= 0:
            b = echoes.bin[n]
            sums[b] += echoes.value[n] * range_weight(decay, b, echoes.distance[n] * per_bin, 0.0)


@kernel
def echo_rays(arrays, rays, weight):
    """Echoes of rays at their hits, each of which stands for an angle as its weight, rad or sr."""
    n = weight.size
    echoes = RayEchoes(np.arange(n), np.empty(n, np.int64), np.empty(n), rays.hits.distance, np.empty(n))
    _fill_echoes(arrays, rays.hits, rays.arrivals, weight, echoes)
    return echoes


@kernel_uncounted
def _fill_echoes(arrays, hits, arrivals, weight, echoes):
    """Set the echoes of rays at their hits."""
    law, reflectivity, bins, bin_length = arrays.law, arrays.reflectivity, arrays.bins, arrays.bin_length
    fan, reference = arrays.half_width > 0.0, arrays.water.reference
    for k in range(weight.size):
        echoes.bin[k], echoes.value[k], echoes.cosine[k] = -1, 0.0, 0.0
        distance = hits.distance[k]
        if hits.body[k] == NO_HIT or not 0.0 < distance < bins * bin_length:
            continue
        b = int(distance / bin_length)
        nx, ny, nz = hits.nx[k], hits.ny[k], hits.nz[k]
        cosine = -(nx * arrivals.dx[k] + ny * arrivals.dy[k] + nz * arrivals.dz[k])
        # A surface exactly edge-on returns nothing.
        if b >= bins or cosine <= 0.0:
            continue
        m, squared = hits.material[k], distance * distance
        value = backscatter_strength(cosine, reflectivity[m, 0], reflectivity[m, 1], reflectivity[m, 2], law)
        value *= weight[k]
        if law == LIGHT:
            value *= _range_growth(reference, hits, arrivals, k) / (cosine * bin_length)
        else:
            # Intensity over that in still water is r² / (tube · spread).
            spread = arrivals.spread[k]
            value *= squared * squared / (cosine * arrivals.tube[k] * spread * (1.0 if fan else spread))
            if arrivals.focus.size > 0:
                value *= arrivals.focus[k] * arrivals.focus[k]
        echoes.bin[k], echoes.value[k], echoes.cosine[k] = b, value, cosine


@kernel_uncounted
def fill_range_growths(reference, hits, arrivals, echoes, growth):
    """Set the growth of the slant range of each ray with an echo, m per radian of its elevation."""
    for k in range(growth.size):
        if echoes.bin[k] >= 0:
            growth[k] = _range_growth(reference, hits, arrivals, k) / echoes.cosine[k]


@inlined_uncounted
def _range_growth(reference, hits, arrivals, k):
    """Growth of the slant range of a ray with its elevation, times the cosine of its incidence."""
    return reference / arrivals.speed[k] * arrivals.tube[k] * abs(_tilt(hits, arrivals, k))


@inlined_uncounted
def _tilt(hits, arrivals, k):
    """n·e of the normal n where a ray lands and the direction e in which a growing elevation moves the ray."""
    dx, dy, dz, nx, ny, nz = arrivals.dx[k], arrivals.dy[k], arrivals.dz[k], hits.nx[k], hits.ny[k], hits.nz[k]
    level = math.sqrt(dx * dx + dy * dy)
    return nz * level - dz * (nx * dx + ny * dy) / level if level > 0.0 else 0.0
