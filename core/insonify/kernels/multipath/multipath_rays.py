"""Echoes by way of the sea surface, by single rays from the images of the sonar above it.

Images are exact for level mirrors. The first hit of an image's ray returns an echo to that image along the ray; the
sonar itself receives one if the straight ray back to it is unobstructed. A ray that is obstructed before it passes the
surface is lost.
"""

import math

import numpy as np

from insonify.compiler.jit import inlined, kernel
from insonify.kernels.beam.pattern import two_way_response
from insonify.kernels.common.range_bins import range_weight
from insonify.kernels.common.scattering import backscatter_strength
from insonify.kernels.common.types import LIGHT, SONAR
from insonify.kernels.multipath.image_sources import bottom_image, surface_image, wave_advance
from insonify.kernels.rays.cast import aim_straight, cast_straight, unaimed
from insonify.kernels.rays.cell_walk import NO_HIT
from insonify.kernels.rays.launch import SideBeam, cone_azimuth, orient_beam
from insonify.kernels.rays.path_tracing import Intersection, advance_to, meet_scene, start_path
from insonify.kernels.rays.pings import TOGETHER, take_rays
from insonify.kernels.rays.specular_paths import mixed_echo
from insonify.kernels.sweep.image_paths import height_delay, tilt_delay

MOST_PASSES = 2  # of the sea surface
REACH_STEPS = 16.0  # to a record's length, by which rays reach beyond it


@kernel
def trace_multipath(arrays, poses, rays, out):
    """Add the echoes by way of the sea surface to the records of pings, ray by ray.

    Parameters
    ----------
    arrays : SceneArrays
        Of water without refraction.
    poses : Poses
        n pings.
    rays : int
        A side and image.
    out : ndarray of float, shape (n, 2, bins)
        Added to.
    """
    multipath, sums = arrays.multipath, np.empty(arrays.bins)
    near = np.empty(arrays.solids.shape.size, np.int64)
    aim = unaimed(rays)
    for ping in range(poses.x.size):
        x, y, z, pitch = poses.x[ping], poses.y[ping], poses.z[ping], poses.pitch[ping]
        surface, bottom = surface_image(arrays, z), bottom_image(arrays, x, y, z)
        for side in range(2):
            beam = orient_beam(arrays, poses, ping, side)
            sums[:] = 0.0
            if multipath.surface_bottom or multipath.surface_bottom_surface:
                _add_image(arrays, beam, surface, pitch, near, aim, sums)
            if multipath.second_bottom and bottom.share > 0.0:
                _add_image(arrays, beam, bottom, pitch, near, aim, sums)
            if multipath.surface_echo:
                _add_surface_echo(arrays, beam, surface, sums)
            for k in range(arrays.bins):
                out[ping, side, k] += sums[k] * arrays.range_factor[k]


@kernel
def _add_image(arrays, beam, image, pitch, near, aim, sums):
    """Sum the echoes that one image of the sonar brings."""
    multipath = arrays.multipath
    seen_from = _beam_of_image(arrays, beam, image)
    if image.mirrored:
        pitch = -pitch
    farthest = arrays.bins * arrays.bin_length + wave_advance(multipath, 1)
    count, aim = aim_straight(arrays, seen_from, pitch, near, aim)
    for first in range(0, aim.launch.weight.size, TOGETHER):
        some = take_rays(aim.launch, first, min(first + TOGETHER, aim.launch.weight.size))
        landed = cast_straight(arrays, seen_from, near, count, some, 0.0)
        _add_hits(arrays, beam, image, seen_from, farthest, some, landed.bundle, landed.hits, sums)


@kernel
def _add_hits(arrays, beam, image, seen_from, farthest, launch, bundle, hits, sums):
    """Sum the echoes that one image brings of what some rays have met."""
    fan, multipath = arrays.half_width > 0.0, arrays.multipath
    for k in range(launch.weight.size):
        if hits.body[k] == NO_HIT or launch.weight[k] == 0.0 or _is_blocked(arrays, beam, image, bundle, hits, k):
            continue
        meeting = Intersection(hits.distance[k], hits.body[k], hits.material[k], hits.nx[k], hits.ny[k], hits.nz[k])
        path, out = advance_to(arrays, start_path(bundle, k), meeting), 1.0
        if arrays.pattern.tabulated:
            out = two_way_response(arrays.pattern, seen_from, fan, arrays.law, path.dx, path.dy, path.dz, path.length)
        drop = seen_from.z - path.z
        rise = height_delay(image, drop, path.length, multipath.rms_height)
        tilt = tilt_delay(image, drop, path.length, multipath.slope_variance)
        if multipath.surface_bottom_surface and image.mirrored:
            value = _retro_strength(arrays, fan, out * launch.weight[k], path, meeting)
            _add_spread_echo(path.length, value, 2.0 * rise, 2.0 * tilt, multipath.facets[1], arrays, sums)
        if multipath.surface_bottom or not image.mirrored:
            weight = launch.weight[k] * image.share
            if arrays.law == LIGHT and fan and not arrays.pattern.tabulated:
                weight *= _azimuth_ratio(arrays, beam, path)
            r, value = mixed_echo(arrays, beam, fan, out, weight, path, meeting, farthest)
            _add_spread_echo(r, value, rise, tilt, multipath.facets[0], arrays, sums)


@inlined
def _beam_of_image(arrays, beam, image):
    """Axes of one side of a ping's beam for an image of the sonar: raised, and upside down by the sea surface."""
    turned = -1.0 if image.mirrored else 1.0
    record = arrays.bins * arrays.bin_length
    # In whole steps, so that a calm sea and most rough ones have the same rays.
    steps = max(math.ceil(REACH_STEPS * wave_advance(arrays.multipath, MOST_PASSES) / record), 1)
    # R + R' <= 2r and R' - R <= the height of the image.
    reach = record * (1.0 + steps / REACH_STEPS) + 0.5 * image.height
    return SideBeam(
        beam.x, beam.y, beam.z + image.height, beam.ahead_x, beam.ahead_y, beam.side_x, beam.side_y,
        beam.axis_x, beam.axis_y, turned * beam.axis_z, beam.s_low, beam.s_high,
        beam.own_x, beam.own_y, turned * beam.own_z, beam.up_x, beam.up_y, turned * beam.up_z, reach,
    )  # fmt: skip


@inlined
def _retro_strength(arrays, fan, weight, path, meeting):
    """Strength of the echo that returns to an image along its own ray, with the record's 1/r⁴ taken out."""
    cosine = -(meeting.nx * path.dx + meeting.ny * path.dy + meeting.nz * path.dz)
    if cosine <= 0.0:
        return 0.0
    row, up = arrays.reflectivity[meeting.material], path.up
    value = weight * backscatter_strength(cosine, row[0], row[1], row[2], arrays.law)
    if arrays.law == LIGHT:
        return value * abs(up.x * path.dx + up.y * path.dy + up.z * path.dz) / arrays.bin_length
    return value * path.length / cosine * (path.length if fan else 1.0)


@inlined
def _azimuth_ratio(arrays, beam, path):
    """Azimuths of a top-hat at an image over those at the sonar: law `light` averages over the latter."""
    dx, dy, dz = path.x - beam.x, path.y - beam.y, path.z - beam.z
    level = math.sqrt(dx * dx + dy * dy)
    straight = level / math.sqrt(level * level + dz * dz)
    by_image = math.sqrt(path.dx * path.dx + path.dy * path.dy)
    return cone_azimuth(by_image, arrays.half_width) / cone_azimuth(straight, arrays.half_width)


@kernel
def _is_blocked(arrays, beam, image, bundle, hits, k):
    """Whether a ray does not pass the surface, or is obstructed on its way up to it."""
    if not -bundle.dz[k] * hits.distance[k] > image.above:
        return True
    if not image.mirrored:
        return False
    length = image.above / -bundle.dz[k]
    blocker = meet_scene(arrays, beam.x, beam.y, beam.z, bundle.dx[k], bundle.dy[k], -bundle.dz[k], length)
    return blocker.body != NO_HIT


@inlined
def _add_spread_echo(r, value, rise, tilt, facets, arrays, sums):
    """Spread an echo at one slant range over the delays of the facets of the sea surface."""
    share, bin_length, decay = value / facets.shape[0], arrays.bin_length, arrays.range_decay
    for f in range(facets.shape[0]):
        start = max(r + rise * facets[f, 0] + tilt * facets[f, 2], 0.0) / bin_length
        stop = max((r + rise * facets[f, 1] + tilt * facets[f, 3]) / bin_length, start)
        first, last = int(start), int(stop)
        if first == last and first < sums.size:
            sums[first] += share * range_weight(decay, first, 0.5 * (start + stop), stop - start)
        for b in range(first, min(last + 1, sums.size)) if last > first else range(0):
            low, high = max(start, float(b)), min(stop, b + 1.0)
            weight = range_weight(decay, b, 0.5 * (low + high), high - low)
            sums[b] += share * weight * (high - low) / (stop - start)


@inlined
def _add_surface_echo(arrays, beam, image, sums):
    """Add the echo of the sea surface straight above, 1 / (2d)² with the record's 1/d⁴ taken out."""
    depth, fan = image.above, arrays.half_width > 0.0
    if not 0.0 < depth < arrays.bins * arrays.bin_length:
        return
    value = (
        two_way_response(arrays.pattern, beam, fan, SONAR, 0.0, 0.0, 1.0, depth) if arrays.pattern.tabulated else 1.0
    )
    value *= 1.0 if arrays.law == LIGHT else 0.25 * depth * depth
    rise = height_delay(image, 2.0 * depth, 2.0 * depth, arrays.multipath.rms_height)
    tilt = tilt_delay(image, 2.0 * depth, 2.0 * depth, arrays.multipath.slope_variance)
    _add_spread_echo(depth, value, rise, tilt, arrays.multipath.facets[0], arrays, sums)
