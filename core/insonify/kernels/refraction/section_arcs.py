"""Rays through water that differs along a line: in each triangle of its lattice speed is linear, and a ray is an arc.

Every cell between two nodes of height and two stations is cut along the diagonal on which speed differs less, so that
a sloping layer keeps its shape. A ray stays in its vertical plane: horizontal refraction is neglected.
Functions that trace a ray through any water, layered as in `arcs` or a section, are here too.

Theory: docs/theory/refraction.md.
"""

import math
from typing import NamedTuple

from insonify.compiler.jit import inlined
from insonify.kernels.refraction import arcs

LEVEL = 1e-12  # cosine below which a plane lies across the stations; change of gradient that counts as none, 1/s


class SectionPlane(NamedTuple):
    """Position and direction of a ray's vertical plane relative to the stations of the water."""

    place: float  # along their axis of ground range 0, m
    along: float  # metres along their axis per metre of range: the cosine between them


class SectionTriangle(NamedTuple):
    """A triangle of the lattice, or what is left of a cell beyond its ends: gradients of speed, and the diagonal."""

    along: float  # gradient of speed along the axis, 1/s
    up: float  # and upwards
    across_axis: float  # unit normal of the diagonal, out of the triangle; 0, 0 if there is none
    across_up: float
    distance: float  # to the diagonal, m


@inlined
def launch_ray(height, speed, station, plane, z, cosine, sine):
    """Ray at its start through any water, at ground range 0."""
    if station.size == 1:
        return arcs.launch_in_layers(height, speed[0], z, cosine, sine)
    c = speed_in_section(height, speed, station, plane.place, z)
    return arcs.RayState(0.0, z, cosine, sine, c, 0.0, 1.0 / c, 0.0, False)


@inlined
def advance_ray(height, speed, station, plane, ray, x_end, low, high):
    """Follow a ray through any water by one arc, to a border in the water, a ground range or a height."""
    if station.size == 1:
        return arcs.advance_in_layers(height, speed[0], ray, x_end, low, high)
    return _advance_in_section(height, speed, station, plane, ray, x_end, low, high)


@inlined
def reflect_ray(height, speed, station, plane, ray):
    """Ray through any water, reflected by the bed or the surface that it has come to."""
    if station.size == 1:
        return arcs.reflect_at_level(ray, arcs.gradient_behind(height, speed[0], ray))
    # The gradient on the side that the ray comes from.
    back = arcs.RayState(ray.x, ray.z, -ray.cosine, -ray.sine, ray.speed, ray.time, ray.p, ray.q, ray.grazed)
    _, _, piece = find_triangle(height, speed, station, plane, back)
    return arcs.reflect_at_level(ray, piece.up)


@inlined
def _advance_in_section(height, speed, station, plane, ray, x_end, low, high):
    """Follow a ray to the next border of a triangle, to a ground range or to a height, whichever comes first."""
    i, j, piece = find_triangle(height, speed, station, plane, ray)
    gx = piece.along * plane.along
    bend = (ray.cosine * piece.up - ray.sine * gx) / ray.speed
    ahead, behind = _station_ranges(station, plane, i)
    floor = max(height[j] if j >= 0 else -math.inf, low)
    ceiling = min(height[j + 1] if j < height.size - 1 else math.inf, high)

    to_ahead, _ = arcs.reach_line(ray.cosine, -ray.sine, ahead - ray.x, bend)
    to_behind, _ = arcs.reach_line(-ray.cosine, ray.sine, ray.x - behind, bend)
    to_ceiling, _ = arcs.reach_line(ray.sine, ray.cosine, ceiling - ray.z, bend)
    to_floor, _ = arcs.reach_line(-ray.sine, -ray.cosine, ray.z - floor, bend)
    to_end, _ = arcs.reach_line(ray.cosine, -ray.sine, x_end - ray.x, bend)
    to_cut = _reach_diagonal(plane, piece, ray, bend)
    tangents = min(min(min(to_ahead, to_behind), min(to_ceiling, to_floor)), min(to_end, to_cut))
    if tangents == math.inf:
        return arcs.ENDLESS, ray
    there = arcs.follow_arc(ray, gx, piece.up, tangents)
    # Borders are met exactly, so that the next step finds itself on them.
    x, z = there.x, there.z
    if tangents == to_end:
        x = x_end
    elif tangents == to_ahead:
        x = ahead
    elif tangents == to_behind:
        x = behind
    if tangents == to_ceiling:
        z = ceiling
    elif tangents == to_floor:
        z = floor
    there = arcs.RayState(x, z, there.cosine, there.sine, there.speed, there.time, there.p, there.q, there.grazed)
    if tangents == to_ceiling and ceiling == high:
        return arcs.HIGH, there
    if tangents == to_floor and floor == low:
        return arcs.LOW, there
    _, _, beyond = find_triangle(height, speed, station, plane, there)
    there = _enter_triangle(there, (beyond.along - piece.along) * plane.along, beyond.up - piece.up)
    return arcs.RANGE if tangents == to_end else arcs.NODE, there


@inlined
def _enter_triangle(ray, dgx, dgz):
    """Ray that enters a triangle with a gradient that differs by ``dgx`` and ``dgz`` from that of the last."""
    size = math.sqrt(dgx * dgx + dgz * dgz)
    if size < LEVEL:
        return ray
    # The jump of the gradient is normal to the border: both sines belong to one angle.
    over = (ray.cosine * dgx + ray.sine * dgz) / size
    aside = (ray.cosine * dgz - ray.sine * dgx) / size
    flat = abs(over) < arcs.GRAZING
    over = math.copysign(max(abs(over), arcs.GRAZING), over)
    return arcs.bend_tube(ray, -size * aside * aside / over, flat)


@inlined
def find_triangle(height, speed, station, plane, ray):
    """Triangle that a ray enters next."""
    place, onwards = plane.place + plane.along * ray.x, plane.along * ray.cosine
    i, j = arcs.node_below(station, place), arcs.node_below(height, ray.z)
    on_station = i >= 0 and place - station[i] <= arcs.SNAP
    on_node = j >= 0 and ray.z - height[j] <= arcs.SNAP
    if on_station and onwards < 0.0:
        i -= 1
    if on_node and ray.sine < 0.0:
        j -= 1
    piece = _cut_cell(height, speed, station, i, j, place, ray.z, onwards, ray.sine)
    # A ray along a border belongs to the side that it bends to; one that bends to neither stays on the border.
    if on_station and onwards == 0.0 and piece.along >= 0.0:
        other = _cut_cell(height, speed, station, i - 1, j, place, ray.z, onwards, ray.sine)
        if other.along > 0.0:
            i, piece = i - 1, other
        else:
            piece = SectionTriangle(0.0, piece.up, 0.0, 0.0, math.inf)
    if on_node and ray.sine == 0.0 and piece.up >= 0.0:
        other = _cut_cell(height, speed, station, i, j - 1, place, ray.z, onwards, ray.sine)
        if other.up > 0.0:
            j, piece = j - 1, other
        else:
            piece = SectionTriangle(piece.along, 0.0, 0.0, 0.0, math.inf)
    return i, j, piece


@inlined
def _cut_cell(height, speed, station, i, j, place, z, onwards, upwards):
    """Triangle of cell (i, j) that contains a place; on the diagonal, the one that a direction leads into."""
    last, top = station.size - 1, height.size - 1
    if i < 0 or i >= last:
        return SectionTriangle(0.0, arcs.gradient_above(height, speed[max(i, 0)], j), 0.0, 0.0, math.inf)
    width = station[i + 1] - station[i]
    if j < 0 or j >= top:
        k = max(j, 0)
        return SectionTriangle((speed[i + 1, k] - speed[i, k]) / width, 0.0, 0.0, 0.0, math.inf)
    rise = height[j + 1] - height[j]
    c00, c10, c01, c11 = speed[i, j], speed[i + 1, j], speed[i, j + 1], speed[i + 1, j + 1]
    # The normal of the diagonal, upwards, and how far the place is above it.
    rising = abs(c11 - c00) <= abs(c10 - c01)
    length = math.sqrt(width * width + rise * rise)
    along = -rise / length if rising else rise / length
    up = width / length
    above = (place - station[i]) * along + (z - height[j]) * up
    if not rising:
        above -= width * along
    upper = above > 0.0
    if abs(above) <= arcs.SNAP:
        upper = onwards * along + upwards * up > 0.0
    g_along = (c11 - c01 if upper else c10 - c00) / width
    g_up = (c01 - c00 if upper == rising else c11 - c10) / rise
    if upper:
        return SectionTriangle(g_along, g_up, -along, -up, above)
    return SectionTriangle(g_along, g_up, along, up, -above)


@inlined
def _reach_diagonal(plane, piece, ray, bend):
    """Tangents of the arc to the diagonal of its cell, m."""
    nx, nz = piece.across_axis * plane.along, piece.across_up
    length = math.sqrt(nx * nx + nz * nz)
    if length == 0.0:
        return math.inf
    nx, nz = nx / length, nz / length
    along, across = ray.cosine * nx + ray.sine * nz, ray.cosine * nz - ray.sine * nx
    tangents, _ = arcs.reach_line(along, across, piece.distance / length, bend)
    return tangents


@inlined
def _station_ranges(station, plane, i):
    """Ground ranges of the two stations about a ray, the farther one first; infinite where there is none."""
    if abs(plane.along) < LEVEL:
        return math.inf, -math.inf
    before = (station[i] - plane.place) / plane.along if i >= 0 else -math.copysign(math.inf, plane.along)
    after = math.copysign(math.inf, plane.along)
    if i < station.size - 1:
        after = (station[i + 1] - plane.place) / plane.along
    return max(before, after), min(before, after)


@inlined
def speed_in_section(height, speed, station, place, z):
    """Speed of sound at a place of a section."""
    i, j = arcs.node_below(station, place), arcs.node_below(height, z)
    piece = _cut_cell(height, speed, station, i, j, place, z, 0.0, 0.0)
    # The speed is known at a corner: every triangle has the lower one before it or the upper one behind it.
    k, m = max(i, 0), max(j, 0)
    if piece.across_up < 0.0:
        k, m = k + 1, m + 1
    return speed[k, m] + piece.along * (place - station[k]) + piece.up * (z - height[m])
