"""Echoes after the first: of rays that surfaces reflect like mirrors and that bodies transmit.

Energy splits at every hit as in `path_tracing`. A path X of length s, on which a metre inside a body counts 1/ν
because the record counts time, carries the share w of its energy to a point P. There a tube of solid angle dΩ covers
dA = a dΩ, where a follows from the tube's differentials, through curved mirrors and lenses too; it is s² / cos α on the
far side of flat ones. Where d_X is the way X arrives, α its incidence and σ the bistatic strength, P receives
w / (a cos α) per area across X, and two echoes of it come back:

- *retro*, out along X and back along it, at range s: σ(d_X, d_X) dA w² / (a cos α)²;
- *mixed*, out along X and straight back over the distance r, and the other way round, at range R = (s + r) / 2:
  2 σ(d_X, d_D) dA w / (a cos α r²), if P sees the sonar. Here a cancels: what a tube carries is kept.

The record's range factor, 1/R⁴ and absorption over 2R, comes after the sum as for every echo, so that the two enter as
w² σ s⁴ dΩ / (a cos² α) and 2 w σ R⁴ dΩ / (r² cos α). At a caustic, where a vanishes, it counts as no less than a share
of s². A knife, 1 m wide at all ranges, uses the tube's width in elevation alone. A surface scatters to the water alone.

Theory: docs/theory/scattering.md.
"""

import math

import numpy as np

from insonify.compiler.jit import inlined, kernel
from insonify.kernels.beam.pattern import two_way_response
from insonify.kernels.common.range_bins import range_weight
from insonify.kernels.common.scattering import bistatic_strength
from insonify.kernels.common.types import LIGHT
from insonify.kernels.rays.cell_walk import NO_HIT
from insonify.kernels.rays.path_tracing import (
    WATER,
    Intersection,
    advance_to,
    meet_next,
    meet_scene,
    offset_from_surface,
    split_path,
    start_path,
    tube_area,
)

CAUSTIC = 0.01  # least area of a tube, as a share of its area where nothing focuses it
KNIFE = 0.5  # m, half the along-track width of a knife


@kernel
def add_specular_echoes(arrays, beam, bundle, hits, weight, sums):
    """Add the echoes of one side's rays after their first hits to the range bins."""
    fan, reach = arrays.half_width > 0.0, arrays.bins * arrays.bin_length
    for k in range(weight.size):
        if hits.body[k] == NO_HIT or weight[k] == 0.0:
            continue
        meeting = Intersection(hits.distance[k], hits.body[k], hits.material[k], hits.nx[k], hits.ny[k], hits.nz[k])
        path = advance_to(arrays, start_path(bundle, k), meeting)
        waiting = [path]
        waiting.pop()
        split_path(arrays, path, meeting, 2.0 * reach, waiting)
        if len(waiting) == 0:
            continue
        out = 1.0
        if arrays.pattern.tabulated:
            out = two_way_response(arrays.pattern, beam, fan, arrays.law, path.dx, path.dy, path.dz, path.length)
        while len(waiting) > 0:
            path = waiting.pop()
            # Beyond twice the range even a mixed echo comes too late.
            meeting = meet_next(arrays, path, 2.0 * reach - path.length)
            if meeting.body == NO_HIT:
                continue
            path = advance_to(arrays, path, meeting)
            if path.inside == WATER:
                _add_retro_echo(arrays, fan, out * weight[k], path, meeting, sums)
                distance, value = mixed_echo(arrays, beam, fan, out, weight[k], path, meeting, reach)
                _add_at(arrays, distance, value, sums)
            split_path(arrays, path, meeting, 2.0 * reach, waiting)


@kernel
def follow_specular_paths(arrays, bundle, reach):
    """All hits of rays followed until they fade or leave, or over a length of water, m.

    Returns
    -------
    whole : ndarray of int64, shape (3, hits)
        Ray, bounces before, and body.
    real : ndarray, shape (5, hits)
        x, y, z and length of the path in metres, and its share of the energy.
    """
    numbers, places = [(0, 0, 0)], [(0.0, 0.0, 0.0, 0.0, 0.0)]
    numbers.pop()
    places.pop()
    for k in range(bundle.x.size):
        waiting = [start_path(bundle, k)]
        while len(waiting) > 0:
            path = waiting.pop()
            meeting = meet_next(arrays, path, reach - path.length)
            if meeting.body == NO_HIT:
                continue
            path = advance_to(arrays, path, meeting)
            numbers.append((k, path.bounce, meeting.body))
            places.append((path.x, path.y, path.z, path.length, path.share))
            split_path(arrays, path, meeting, reach, waiting)
    whole, real = np.empty((3, len(numbers)), np.int64), np.empty((5, len(places)))
    for n in range(len(numbers)):
        whole[0, n], whole[1, n], whole[2, n] = numbers[n]
        real[0, n], real[1, n], real[2, n], real[3, n], real[4, n] = places[n]
    return whole, real


@inlined
def _add_retro_echo(arrays, fan, weight, path, meeting, sums):
    """Add the echo of a path's hit that returns along the path itself."""
    cosine = -(meeting.nx * path.dx + meeting.ny * path.dy + meeting.nz * path.dz)
    if cosine <= 0.0:
        return
    row = arrays.reflectivity[meeting.material]
    value = bistatic_strength(cosine, cosine, 2.0 * cosine * cosine - 1.0, row[0], row[1], row[2], arrays.law)
    value *= path.share * path.share * weight
    up, squared = path.up, path.length * path.length
    if fan:
        value *= squared * squared / (cosine * max(tube_area(up, path.across) * cosine, CAUSTIC * squared))
    else:
        width = math.sqrt(up.x * up.x + up.y * up.y + up.z * up.z)
        value *= squared / (cosine * max(width * cosine, CAUSTIC * path.length))
    _add_at(arrays, path.length, value, sums)


@inlined
def _add_at(arrays, distance, value, sums):
    """Add an echo at a slant range to its bin, before the range factor at the centre of that."""
    b = int(distance / arrays.bin_length)
    if b < sums.size:
        sums[b] += value * range_weight(arrays.range_decay, b, distance / arrays.bin_length, 0.0)


@inlined
def mixed_echo(arrays, beam, fan, out, weight, path, meeting, reach):
    """Echo out along a path that has arrived and straight back, and the other way round."""
    sx, sy, sz = path.x - beam.x, path.y - beam.y, path.z - beam.z
    r, nx, ny, nz = math.sqrt(sx * sx + sy * sy + sz * sz), meeting.nx, meeting.ny, meeting.nz
    sx, sy, sz, distance = sx / r, sy / r, sz / r, 0.5 * (path.length + r)
    cosine, straight = -(nx * path.dx + ny * path.dy + nz * path.dz), -(nx * sx + ny * sy + nz * sz)
    if distance >= reach or cosine <= 0.0 or straight <= 0.0:
        return distance, 0.0
    passed = pair_sensitivity(arrays, beam, fan, out, sx, sy, sz, r)
    if passed == 0.0:
        return distance, 0.0
    off = offset_from_surface(path.x, path.y, path.z, path.length)
    blocker = meet_scene(arrays, path.x + off * nx, path.y + off * ny, path.z + off * nz, -sx, -sy, -sz, r)
    if blocker.body != NO_HIT:
        return distance, 0.0
    row, up = arrays.reflectivity[meeting.material], path.up
    mirrored = 2.0 * cosine * straight - (sx * path.dx + sy * path.dy + sz * path.dz)
    value = bistatic_strength(cosine, straight, mirrored, row[0], row[1], row[2], arrays.law)
    value += bistatic_strength(straight, cosine, mirrored, row[0], row[1], row[2], arrays.law)
    value *= path.share * passed * weight
    if arrays.law == LIGHT:
        rate = up.x * (path.dx + sx) + up.y * (path.dy + sy) + up.z * (path.dz + sz)
        value *= 0.5 * abs(rate) / arrays.bin_length
    else:
        value *= (distance * distance / r) ** 2 / (cosine * (1.0 if fan else path.length))
    return distance, value


@inlined
def pair_sensitivity(arrays, beam, fan, out, sx, sy, sz, r):
    """Response of the beam to what leaves in one direction and returns from another, the mean of both orders."""
    if sx * beam.side_x + sy * beam.side_y < 0.0:
        return 0.0
    along = sx * beam.axis_x + sy * beam.axis_y + sz * beam.axis_z
    one_way = arrays.pattern.tabulated and not arrays.pattern.two_way
    wide = 0.0 if fan else KNIFE / r
    if not one_way and not beam.s_low - wide <= along <= beam.s_high + wide:
        return 0.0
    if not arrays.pattern.tabulated:
        return 1.0
    back = two_way_response(arrays.pattern, beam, fan, arrays.law, sx, sy, sz, r)
    return math.sqrt(out * back) if arrays.pattern.two_way else 0.5 * (out + back)
