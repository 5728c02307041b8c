"""Ghosts by the sweep: what bed and targets send back by way of the sea surface, and what the surface itself does.

Out as from one image of the sonar and back as to another, over R and R', an echo of the area dA comes at slant range
r = (R + R') / 2 with σ dA / (R² R'²), σ the bistatic strength between the two directions, if both images see it: each
has its own running horizon along one and the same profile, and its own screen of targets. Two orders count twice.

What lies higher than the sonar hides bed and targets from an image, but not the surface from the sonar.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.kernels.beam.azimuth_sector import raise_sector
from insonify.kernels.beam.pattern import two_way_response
from insonify.kernels.bed.slice import slice_bed
from insonify.kernels.common.jit import inlined, kernel
from insonify.kernels.common.range_bins import accumulate_bins
from insonify.kernels.common.types import LIGHT, SONAR
from insonify.kernels.geometry.cross_sections import HalfPlane
from insonify.kernels.multipath.echo_list import ENOUGH, deposit_echoes, list_echo
from insonify.kernels.multipath.image_sources import (
    SECOND_BOTTOM,
    SURFACE_BOTTOM,
    SURFACE_ECHO,
    echo_parameters,
    height_delay,
    image_pair,
    pair_response,
    pair_strength,
    spreading_ratio,
    surface_image,
    tilt_delay,
)
from insonify.kernels.multipath.target_multipath import list_target_echoes
from insonify.kernels.rays.launch import orient_beam
from insonify.kernels.refraction.apparent_positions import COLUMNS, straight_grid
from insonify.kernels.sweep.partial_segments import FINE
from insonify.kernels.sweep.sweep import LOWEST, aim_plane, visible_from
from insonify.kernels.sweep.target_echoes import ground_range_at, launch_angle
from insonify.kernels.sweep.visibility import NADIR, weigh_knots
from insonify.kernels.targets.angular_zbuffer import fill_zbuffer
from insonify.kernels.targets.occlusion import next_visible, occlusion_of

HALVINGS = 40  # that find where a segment comes nearest to both images
MOST_PARTS = 1024


class ImageProfile(NamedTuple):
    """A profile as one image sees it; one entry a knot."""

    z: NDArray[np.float64]  # height above the image, m
    launch: NDArray[np.float64]  # tan of the launch angle above the horizontal
    horizon: NDArray[np.float64]  # greatest launch slope so far
    weight: NDArray[np.float64]  # what the plane stands for there
    r: NDArray[np.float64]  # work space: slant range
    rise: NDArray[np.float64]  # work space: height above the sonar of where the sound set out for


class SegmentLine(NamedTuple):
    """A segment's line in the plane, as one image sees it: z = offset + slope · x."""

    offset: float
    slope: float


class PairedSegment(NamedTuple):
    """A segment of the bed by itself, as two images see it."""

    one: SegmentLine
    other: SegmentLine
    area: float  # 1 + |∇z|²
    at_nadir: float  # what its plane stands for there, were it linear
    rate: float  # by which that grows per metre of ground range
    diffuse: float
    specular: float
    shininess: float


def empty_image_profile(capacity: int) -> ImageProfile:
    """Make room for profiles of up to ``capacity`` knots."""
    return ImageProfile(*np.zeros((6, capacity)))


@kernel
def sweep_multipath(arrays, poses, fan, image_fan, profile, image_profiles, zbuffers, echoes, contributions, out):
    """Sweep the ghosts of every ping and add them to ``out`` (pings, 2, bins).

    ``lifted`` are the planes of the beam of the image in the surface.
    """
    bins, line = np.zeros(arrays.bins + 2, np.int64), np.zeros(arrays.bins, np.float32)
    for ping in range(poses.x.size):
        for side in range(2):
            add_multipath(
                arrays,
                poses,
                ping,
                side,
                fan,
                image_fan,
                profile,
                image_profiles,
                zbuffers,
                echoes,
                bins,
                contributions,
                False,
            )
            accumulate_bins(bins, arrays.range_factor, line)
            for k in range(arrays.bins):
                out[ping, side, k] += line[k]


@kernel
def add_multipath(
    arrays, poses, ping, side, fan, image_fan, profile, image_profiles, zbuffers, echoes, bins, contributions, labelling
):
    """Put the ghosts of one side of one ping into a difference array, and if asked to into the ledger."""
    x, y, z = poses.x[ping], poses.y[ping], poses.z[ping]
    for path in range(SURFACE_BOTTOM, SECOND_BOTTOM + 1):
        pair, wanted = image_pair(arrays, path, x, y, z)
        if not wanted:
            continue
        beam = image_fan if pair.one.mirrored else fan
        for k in range(beam.azimuth.size):
            room = profile, image_profiles, zbuffers, echoes
            _add_plane(arrays, poses, ping, side, beam, k, pair, *room, bins, contributions, labelling)
    if arrays.multipath.surface_echo:
        _add_surface_echo(arrays, poses, ping, side, echoes, bins, contributions, labelling)


@kernel
def _add_plane(
    arrays, poses, ping, side, fan, k, pair, profile, image_profiles, zbuffers, echoes, bins, contributions, labelling
):
    """Likewise for one pair of images in one plane."""
    plane, sector, _ = aim_plane(arrays, poses, ping, side, fan, k, straight_grid())
    near_field, per_height = fan.near_field[k], fan.reach[k]
    height = max(plane.z - arrays.bed.low, LOWEST)
    # A beam that sound passes but once hears what the higher image's takes in, which is farther out; others do not.
    one_way = arrays.pattern.tabulated and not arrays.pattern.two_way
    highest = pair.other.height if one_way else pair.one.height
    reach = min(per_height * (height + highest), arrays.bins * arrays.bin_length)
    count = slice_bed(arrays.bed, plane.x, plane.y, plane.z, plane.ex, plane.ey, reach, profile)
    sector_one = raise_sector(sector, near_field * (height + pair.one.height))
    sector_other = raise_sector(sector, near_field * (height + pair.other.height))
    cells_one = _look_out(arrays, profile, count, pair.one, plane, sector_one, reach, image_profiles[0], zbuffers[0])
    cells_other = _look_out(
        arrays, profile, count, pair.other, plane, sector_other, reach, image_profiles[1], zbuffers[1]
    )
    n = _list_bed(
        arrays,
        profile,
        count,
        pair,
        image_profiles,
        zbuffers,
        cells_one,
        cells_other,
        echoes,
        bins,
        contributions,
        labelling,
    )
    if cells_one > 0:
        sectors = sector_one, sector_other
        n = list_target_echoes(
            arrays, profile, count, pair, plane, sectors, image_profiles, zbuffers, cells_one, cells_other, echoes, n,
            bins, contributions, labelling,
        )  # fmt: skip
    _enter(arrays, pair.passes, pair.path, echoes, n, bins, contributions, labelling)


@inlined
def _enter(arrays, passes, path, echoes, n, bins, contributions, labelling):
    """Enter echoes, smeared by as many passes of the surface."""
    deposit_echoes(
        echoes, n, arrays.multipath.facets[passes - 1], arrays.bin_length, path, bins, contributions, labelling
    )


@kernel
def _look_out(arrays, profile, count, image, plane, sector, reach, image_profile, zbuffer):
    """Tell what of a profile an image sees; return the cells of its screen."""
    x, profile_z = profile.x, profile.z
    z, launch, horizon, r, rise = (
        image_profile.z,
        image_profile.launch,
        image_profile.horizon,
        image_profile.r,
        image_profile.rise,
    )
    highest = NADIR
    for i in range(count):
        z[i] = profile_z[i] - image.height
        launch[i] = z[i] / x[i] if x[i] > 0.0 or z[i] != z[i] else NADIR
        # NaN, a hole in the bed, compares false and hides nothing.
        highest = launch[i] if launch[i] > highest else highest
        horizon[i], r[i] = highest, math.sqrt(x[i] * x[i] + z[i] * z[i])
        rise[i] = -z[i] if image.mirrored else z[i]
    weigh_knots(x[:count], rise, r, sector, arrays.pattern, arrays.law, image_profile.weight)
    if zbuffer.body.size == 0:
        return 0
    seen_from, table = (
        HalfPlane(plane.x, plane.y, plane.z + image.height, plane.ex, plane.ey),
        np.zeros((2, 2, COLUMNS), np.float32),
    )
    return max(fill_zbuffer(arrays, seen_from, sector, reach, straight_grid(), table, zbuffer), 0)


@kernel
def _list_bed(
    arrays,
    profile,
    count,
    pair,
    image_profiles,
    zbuffers,
    cells_one,
    cells_other,
    echoes,
    bins,
    contributions,
    labelling,
):
    """List what of a profile both images see; return the number of echoes not entered yet."""
    x, slope, area, material = profile.x, profile.slope, profile.area, profile.material
    z_one, launch_one, horizon_one = image_profiles[0].z, image_profiles[0].launch, image_profiles[0].horizon
    z_other, launch_other, horizon_other = image_profiles[1].z, image_profiles[1].launch, image_profiles[1].horizon
    r_one, r_other, weight_one, weight_other = (
        image_profiles[0].r,
        image_profiles[1].r,
        image_profiles[0].weight,
        image_profiles[1].weight,
    )
    table, tabulated, two_way = arrays.reflectivity, arrays.pattern.tabulated, arrays.pattern.two_way
    occlusion_one, occlusion_other = occlusion_of(zbuffers[0], cells_one), occlusion_of(zbuffers[1], cells_other)
    farthest, open_to_all, n = arrays.bins * arrays.bin_length, cells_one == 0 and cells_other == 0, 0
    sea = echo_parameters(arrays)
    for i in range(count - 1):
        if not (launch_one[i + 1] > horizon_one[i] and launch_other[i + 1] > horizon_other[i]):
            continue
        near = pair_response(weight_one[i], weight_other[i], tabulated, two_way)
        far = pair_response(weight_one[i + 1], weight_other[i + 1], tabulated, two_way)
        dx, rise = x[i + 1] - x[i], np.float64(slope[i])
        beyond = 0.5 * (r_one[i] + r_other[i]) - dx * math.sqrt(1.0 + rise * rise) > farthest
        if beyond or not near + far > 0.0 or not area[i] > 0.0:
            continue
        row, rate = material[i], (far - near) / dx
        one, other = SegmentLine(z_one[i] - rise * x[i], rise), SegmentLine(z_other[i] - rise * x[i], rise)
        at_nadir = near - rate * x[i]
        segment = PairedSegment(one, other, area[i], at_nadir, rate, table[row, 0], table[row, 1], table[row, 2])
        start = visible_from(one, x[i], x[i + 1], launch_one[i], horizon_one[i])
        start = max(start, visible_from(other, x[i], x[i + 1], launch_other[i], horizon_other[i]))
        if open_to_all:
            n = _list_piece(sea, segment, pair, start, x[i + 1], row, echoes, n)
        else:
            n = _list_open(sea, segment, pair, start, x[i + 1], row, occlusion_one, occlusion_other, echoes, n)
        if n > ENOUGH:
            _enter(arrays, pair.passes, pair.path, echoes, n, bins, contributions, labelling)
            n = 0
    return n


@kernel
def _list_open(sea, segment, pair, x_from, x_to, row, occlusion_one, occlusion_other, echoes, n):
    """List what no target hides from either image of a segment, between two ground ranges."""
    low, high = launch_angle(segment.one, x_from), launch_angle(segment.one, x_to)
    while low < high:
        opened, closed = next_visible(occlusion_one, segment.one, low, high)
        if opened >= high:
            break
        start = x_from if opened <= low else max(ground_range_at(segment.one, opened), x_from)
        stop = x_to if closed >= high else min(ground_range_at(segment.one, closed), x_to)
        n = _list_open_to_other(sea, segment, pair, start, stop, row, occlusion_other, echoes, n)
        low, x_from = closed, stop
    return n


@kernel
def _list_open_to_other(sea, segment, pair, x_from, x_to, row, occlusion, echoes, n):
    """Likewise what is not hidden from the higher image."""
    low, high = launch_angle(segment.other, x_from), launch_angle(segment.other, x_to)
    while low < high:
        opened, closed = next_visible(occlusion, segment.other, low, high)
        if opened >= high:
            break
        start = x_from if opened <= low else max(ground_range_at(segment.other, opened), x_from)
        stop = x_to if closed >= high else min(ground_range_at(segment.other, closed), x_to)
        n = _list_piece(sea, segment, pair, start, stop, row, echoes, n)
        low, x_from = closed, stop
    return n


@inlined
def _slant(segment, x):
    """Slant range at which a place is heard."""
    a, b = segment.one.offset + segment.one.slope * x, segment.other.offset + segment.other.slope * x
    return 0.5 * (math.sqrt(x * x + a * a) + math.sqrt(x * x + b * b))


@inlined
def _grows(segment, x):
    """Twice the rate at which that grows with ground range."""
    slope = segment.one.slope
    a, b = segment.one.offset + slope * x, segment.other.offset + slope * x
    return (x + slope * a) / math.sqrt(x * x + a * a) + (x + slope * b) / math.sqrt(x * x + b * b)


@kernel
def _list_piece(sea, segment, pair, x_from, x_to, row, echoes, n):
    """List a part of a segment that both images see."""
    if not x_to > x_from:
        return n
    near, far, slope = _slant(segment, x_from), _slant(segment, x_to), segment.one.slope
    squared = (x_to - x_from) ** 2 * (1.0 + slope * slope)
    if squared <= min(abs(far - near), FINE * FINE * near) * near:
        return _list_part(sea, segment, pair, x_from, x_to, near, far, row, echoes, n)
    foot = _foot(segment, x_from, x_to)
    n = _list_monotone(sea, segment, pair, x_from, foot, row, echoes, n)
    return _list_monotone(sea, segment, pair, foot, x_to, row, echoes, n)


@kernel
def _foot(segment, x_from, x_to):
    """Ground range at which a segment is heard nearest; slant range falls towards it and grows beyond."""
    if _grows(segment, x_from) >= 0.0:
        return x_from
    if _grows(segment, x_to) <= 0.0:
        return x_to
    low, high = x_from, x_to
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        if _grows(segment, middle) < 0.0:
            low = middle
        else:
            high = middle
    return 0.5 * (low + high)


@kernel
def _list_monotone(sea, segment, pair, x_from, x_to, row, echoes, n):
    """List a piece along which slant range grows or falls, in parts short against their range."""
    if not x_to > x_from:
        return n
    near, slope = _slant(segment, x_from), segment.one.slope
    nearest = max(min(near, _slant(segment, x_to)), sea.bin_length)
    parts = 1 + int(min((x_to - x_from) * math.sqrt(1.0 + slope * slope) / (FINE * nearest), MOST_PARTS - 1.0))
    dx = (x_to - x_from) / parts
    for k in range(parts):
        start = x_from + k * dx
        far = _slant(segment, start + dx)
        n = _list_part(sea, segment, pair, start, start + dx, near, far, row, echoes, n)
        near = far
    return n


@inlined
def _list_part(sea, segment, pair, x_from, x_to, near, far, row, echoes, n):
    """List one part, whose energy is spread evenly over the slant ranges it spans, ``near`` to ``far``."""
    x, stretch, law = 0.5 * (x_from + x_to), math.sqrt(segment.area), sea.law
    a, b = segment.one.offset + segment.one.slope * x, segment.other.offset + segment.other.slope * x
    if -b <= pair.other.above:
        return n  # land
    r_one, r_other = math.sqrt(x * x + a * a), math.sqrt(x * x + b * b)
    cos_one, cos_other = -segment.one.offset / (r_one * stretch), -segment.other.offset / (r_other * stretch)
    mirrored = 2.0 * cos_one * cos_other - (x * x + a * b) / (r_one * r_other)
    value = pair_strength(cos_one, cos_other, mirrored, segment.diffuse, segment.specular, segment.shininess, pair, law)
    value *= (segment.at_nadir + segment.rate * x) * spreading_ratio(r_one, r_other, law)
    energy = value * abs(far - near) / sea.bin_length if law == LIGHT else value * stretch * (x_to - x_from)
    rms, variance = sea.rms_height, sea.slope_variance
    rise = height_delay(pair.one, -a, r_one, rms) + height_delay(pair.other, -b, r_other, rms)
    tilt = tilt_delay(pair.one, -a, r_one, variance) + tilt_delay(pair.other, -b, r_other, variance)
    return list_echo(echoes, n, near, far, energy, rise, tilt, x, min(cos_one, cos_other), row)


@kernel
def _add_surface_echo(arrays, poses, ping, side, echoes, bins, contributions, labelling):
    """Add the echo of the surface straight above: that of an image of the source, twice as far away as the surface.

    It is 1 / (2d)² in the bin of the depth d, with the record's 1/d⁴ taken out; in law `light`, a lamp in a mirror.
    """
    image = surface_image(arrays, poses.z[ping])
    depth, law = image.above, arrays.law
    if not 0.0 < depth < arrays.bins * arrays.bin_length:
        return
    value = 1.0
    if arrays.pattern.tabulated:
        beam, fan = orient_beam(arrays, poses, ping, side), arrays.half_width > 0.0
        value = two_way_response(arrays.pattern, beam, fan, SONAR, 0.0, 0.0, 1.0, depth)
    energy = value if law == LIGHT else 0.25 * value * depth * depth
    rise = height_delay(image, 2.0 * depth, 2.0 * depth, arrays.multipath.rms_height)
    tilt = tilt_delay(image, 2.0 * depth, 2.0 * depth, arrays.multipath.slope_variance)
    n = list_echo(echoes, 0, depth, depth, energy, rise, tilt, 0.0, 1.0, 0)
    _enter(arrays, 1, SURFACE_ECHO, echoes, n, bins, contributions, labelling)
