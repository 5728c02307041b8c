"""Azimuth sectors: the share of a conical beam that each plane of a fan represents.

A beam is a cone, a plane is not: planes decide what is visible, sectors weigh it. Derived in
docs/theory/beam.md.
"""

import math
from typing import NamedTuple

from insonify.compiler.jit import inlined_uncounted, kernel_uncounted
from insonify.kernels.beam.pattern import (
    azimuthal_response,
    integrated_response,
    is_top_hat,
    lobe_response,
    shared_response,
    vertical_response,
    widest_extent,
)
from insonify.kernels.common.types import EVERY_GRAZING, LIGHT

TRANSITION = 0.3  # of the near field, by which the far field takes over
LINEAR_SINE = 0.3  # sin φ up to which azimuths are proportional to it, to 1 %


class AzimuthSector(NamedTuple):
    """Sector of a beam's azimuths about one plane, which represents all of its echoes."""

    s_low: float  # |sin φ| where the sector begins; with a pattern sin φ itself, positive towards the bow
    s_high: float  # and where it ends
    angle: float  # azimuth it represents, rad; 0 marks a knife
    far_angle: float  # azimuth it represents in the far field, where it widens with the cone; 0 for an outer plane
    near_field: float  # ground range beyond which the far field takes over, m
    s_beam: float  # sin of half the beamwidth
    span: float  # azimuth of the whole beam in the far field, rad
    tabulated: bool  # whether a pattern takes the place of the top-hat
    bent: bool  # whether sound goes along arcs
    ahead_level: float  # the fish's axis: its level part
    ahead_up: float  # and its part upwards
    side_x: float  # the fish's own side and up, as parts of the plane's x and z
    side_z: float
    up_x: float
    up_z: float


@inlined_uncounted
def raise_sector(sector, near_field):
    """Azimuth sector of a plane for a raised image of the sonar; its far field begins farther out."""
    return AzimuthSector(
        sector.s_low, sector.s_high, sector.angle, sector.far_angle, near_field, sector.s_beam, sector.span,
        sector.tabulated, sector.bent, sector.ahead_level, sector.ahead_up, sector.side_x, sector.side_z, sector.up_x,
        sector.up_z,
    )  # fmt: skip


@inlined_uncounted
def sector_weight(x, z, r, sector, pattern, law):
    """Factor by which a plane's sector multiplies an echo at one place."""
    if not sector.tabulated:
        if sector.angle == 0.0:
            return 1.0
        return top_hat_share(x, r, sector) if law == LIGHT else top_hat_width(x, r, sector)
    response = in_plane_response(x / r, z / r, sector, pattern)
    if sector.angle == 0.0 or response == 0.0:
        return response
    share = pattern_share(x, z, r, sector, pattern) if law == LIGHT else pattern_width(x, z, r, sector, pattern)
    return response * share


@inlined_uncounted
def sector_width(x, z, r, sector, pattern):
    """Along-track width of a plane's sector at one place, for any response of the beam in it; 0 of a knife, m."""
    if is_whole_beam(sector):
        return pattern_width(x, z, r, sector, pattern)
    if sector.tabulated or sector.angle == 0.0:
        return x * sector.angle
    return top_hat_width(x, r, sector)


@inlined_uncounted
def top_hat_width(x, r, sector):
    """Along-track width that a plane of a top-hat beam represents."""
    # A beam is a cone: |sin φ_b| = cos θ |sin φ| <= sin(w/2). In the far field the inner sectors stretch with it,
    # nearer by each counts by the share of its azimuths that the cone takes in. Both add up to the whole beam, and so
    # does what lies between them: over a stretch of range one passes into the other.
    near = x * _azimuth_taken_in(x, r, sector) if sector.s_high > LINEAR_SINE else _width_taken_in(x, r, sector)
    return near + _far_field_share(x, sector) * (r * sector.far_angle - near)  # docs/theory/beam.md


@inlined_uncounted
def _far_field_share(x, sector):
    """Weight of the far-field width at a ground range, from 0 to 1."""
    return min(max((x - sector.near_field) * (1.0 / (TRANSITION * sector.near_field)), 0.0), 1.0)


@inlined_uncounted
def top_hat_share(x, r, sector):
    """Share of a top-hat beam's azimuths at a place that a plane represents."""
    near = _azimuth_taken_in(x, r, sector) / (2.0 * arcsine(min(sector.s_beam * r / x, 1.0)))
    return near + _far_field_share(x, sector) * (sector.far_angle / sector.span - near)


@inlined_uncounted
def _width_taken_in(x, r, sector):
    """Width of the part of a narrow sector inside the beam's cone, with azimuths proportional to their sines."""
    per_sine = sector.angle / (sector.s_high - sector.s_low)
    return min(max((sector.s_beam * r - sector.s_low * x) * per_sine, 0.0), x * sector.angle)


@inlined_uncounted
def _azimuth_taken_in(x, r, sector):
    """Azimuth of the part of a sector inside the beam's cone: |sin φ| <= sin(w/2) / cos θ."""
    low = arcsine(sector.s_low)
    one_hand = arcsine(sector.s_high) - low  # a plane along the axis stands for both
    taken = min(max(arcsine(min(sector.s_beam * r / x, 1.0)) - low, 0.0), one_hand)
    return taken * (sector.angle / one_hand)


@inlined_uncounted
def arcsine(s):
    """Arcsine from 0 to 1, to 2e-8, in a form that vectorises (Abramowitz and Stegun 1964, 4.4.46)."""
    tail = 0.0308918810 + s * (-0.0170881256 + s * (0.0066700901 - s * 0.0012624911))
    series = 1.5707963050 + s * (-0.2145988016 + s * (0.0889789874 + s * (-0.0501743046 + s * tail)))
    return 0.5 * math.pi - math.sqrt(1.0 - s) * series


@kernel_uncounted
def pattern_share(x, z, r, sector, pattern):
    """Share of a tabulated pattern's azimuths at a place that a plane represents: law `light` averages over them."""
    width = pattern_width(x, z, r, sector, pattern)
    if not width > 0.0:
        return 0.0
    if is_whole_beam(sector):
        return 1.0
    whole = _azimuths_in_beam(x / r, z / r, r, sector, pattern)
    return width / (x * whole) if whole > 0.0 else 0.0


@inlined_uncounted
def _azimuths_in_beam(c, s, r, sector, pattern):
    """Azimuth of the whole beam at the cosine and sine of a launch angle, weighted by the two-way response, rad."""
    level, tip = sector.ahead_level * c, sector.ahead_up * s
    centre, extent, integral = pattern.centre, pattern.extent, pattern.integral
    # Along the beam's azimuths ds = level cos φ dφ, and level cos φ hardly changes: to second order its reciprocal's
    # mean differs by (1 + 2 sin²φ) / cos⁴φ times what it does athwart.
    off = centre - tip
    turned = level * level - off * off
    if widest_extent(pattern) * math.sqrt(level * level + 2.0 * off * off) < LINEAR_SINE * turned:
        ends = tip - level, tip + level
        response = integrated_response(
            centre, extent, integral, pattern.first_range, pattern.per_octave, ends[0], ends[1], r
        )
        return response / math.sqrt(turned)
    return azimuthal_response(pattern, level, tip, r)


@inlined_uncounted
def is_whole_beam(sector):
    """Whether a plane of a tabulated pattern represents all azimuths."""
    return sector.tabulated and sector.angle > 0.0 and sector.s_high - sector.s_low >= 2.0


@inlined_uncounted
def pair_response(weights, x, one, other, sector, pattern):
    """Weight of a sector for sound out by one image and back by another, from those there and back by each."""
    # Of each image x is the ground range, (rise, slant range) the place.
    # A top-hat that covers the lower of two images covers the higher one too.
    if not sector.tabulated:
        return weights[0]
    if not pattern.two_way:
        return 0.5 * (weights[0] + weights[1])
    root = math.sqrt(weights[0] * weights[1])
    if sector.angle == 0.0 or root == 0.0 or not is_top_hat(pattern):
        return root
    return root * _overlap_of_both(x, one, other, sector, pattern)


@inlined_uncounted
def _overlap_of_both(x, one, other, sector, pattern):
    """Share of a sector in which a top-hat takes in both of two directions, over the root of those for each."""
    # A sector that the beam's edge crosses is taken in to a different part by each image.
    half, centre, per_x = pattern.extent[0], pattern.centre, 1.0 / (sector.ahead_level * x)
    middle = (centre * one[1] - sector.ahead_up * one[0]) * per_x
    middle_other = (centre * other[1] - sector.ahead_up * other[0]) * per_x
    reach, reach_other = half * one[1] * per_x, half * other[1] * per_x
    low, high = max(middle - reach, sector.s_low), min(middle + reach, sector.s_high)
    low_other = max(middle_other - reach_other, sector.s_low)
    high_other = min(middle_other + reach_other, sector.s_high)
    shared = min(high, high_other) - max(low, low_other)
    return shared / math.sqrt((high - low) * (high_other - low_other)) if shared > 0.0 else 0.0


@inlined_uncounted
def paired_weight(x, one, other, sector, pattern, law):
    """Weight of a plane that represents a whole beam, for sound that leaves by one image and returns by another."""
    # A narrow sector has one response to each; over a whole beam the azimuths matter at which both respond.
    vertical = in_plane_response(x / one[1], one[0] / one[1], sector, pattern)
    vertical *= in_plane_response(x / other[1], other[0] / other[1], sector, pattern)
    if not (vertical > 0.0 and x > 0.0):
        return 0.0
    return math.sqrt(vertical) * paired_width(x, one, other, sector, pattern, law)


@kernel_uncounted
def paired_width(x, one, other, sector, pattern, law):
    """Along-track width of `paired_weight`, or of law `light` the share of the azimuths; but for the vertical beam."""
    level_one, tip_one = sector.ahead_level * x / one[1], sector.ahead_up * one[0] / one[1]
    level_other, tip_other = sector.ahead_level * x / other[1], sector.ahead_up * other[0] / other[1]
    azimuths = shared_response(pattern, level_one, tip_one, one[1], level_other, tip_other, other[1])
    if law != LIGHT:
        return azimuths * x
    # Law `light` averages over the azimuths inside the beam there.
    whole = azimuthal_response(pattern, level_one, tip_one, one[1])
    whole *= azimuthal_response(pattern, level_other, tip_other, other[1])
    return azimuths / math.sqrt(whole) if whole > 0.0 else 0.0


@inlined_uncounted
def in_plane_response(c, s, sector, pattern):
    """Two-way response of the vertical beam along a plane."""
    if pattern.vertical == EVERY_GRAZING:
        return 1.0
    return vertical_response(pattern, sector.side_x * c + sector.side_z * s, sector.up_x * c + sector.up_z * s)


@inlined_uncounted
def pattern_width(x, z, r, sector, pattern):
    """Along-track width that a plane of a tabulated pattern represents."""
    # Along the plane of azimuth φ, s = cos p cos θ sin φ + sin p sin θ is the part of the direction along the fish's
    # axis; the mean of the pattern over the sector is its integral over s between the sector's borders.
    level, tip = sector.ahead_level * x / r, sector.ahead_up * z / r
    span = level * (sector.s_high - sector.s_low)
    s_low, s_high = level * sector.s_low + tip, level * sector.s_high + tip
    centre, extent, integral = pattern.centre, pattern.extent, pattern.integral
    response = integrated_response(centre, extent, integral, pattern.first_range, pattern.per_octave, s_low, s_high, r)
    return x * sector.angle * response / span if span > 0.0 else 0.0


@inlined_uncounted
def in_plane_lobe(c, s, sector, pattern):
    """Two-way response of a vertical beam of a single lobe along a plane; arguments as of `in_plane_response`."""
    return lobe_response(pattern, sector.side_x * c + sector.side_z * s, sector.up_x * c + sector.up_z * s)
