"""Facets of targets in one plane: how their slant range and incidence change along them, and the echo of their parts.

Along a facet the slant range is taken as the parabola through its beginning, middle and end, and the incidence follows
from the parabola's slope: no surface is intersected again. Over the azimuths that its plane represents a facet leans as
its tangent plane does, and its echo is spread over the slant ranges between. Derived in docs/theory/sweep.md.
"""

import math
from typing import NamedTuple

from insonify.compiler.jit import inlined_uncounted
from insonify.kernels.beam.azimuth_sector import sector_width
from insonify.kernels.geometry.cross_sections import NEVER

MOST_PARTS = 16
LOBE_END = 8.0  # n sin²α at which a specular lobe of exponent n has fallen to exp(-16)
LOBE_TURN = 0.15  # n times the squared change of incidence along a facet up to which the lobe's mean is a series
PER_LOBE = 6.0  # parts per 1/√n of incidence beyond it: three per standard deviation of the lobe
MOST_LEAN = 3.0  # across the plane: a body's edge-on rim leans more, but fills no sector
UNEVEN = 100.0  # parts squared, per share of a facet's energy that an even density puts beyond a border between bins


class Facet(NamedTuple):
    """A small part of a body, wholly visible."""

    low: float  # launch angle at which it begins, rad
    high: float  # and ends
    cosine: float  # of the launch angle of its middle
    sine: float
    near: float  # distances along its beginning, its middle and its end
    centre: float
    far: float
    incidence: float  # cosine of the incidence in the middle
    arc: float  # distance across the rays per launch angle, m/rad; the distance where sound goes straight


class SectorSpan(NamedTuple):
    """Slant ranges over which a facet's surface lies within the azimuths that its plane represents, in m or bins."""

    across: float  # change of slant range from one border of the sector to the other
    least: float  # before which nothing of the body lies
    most: float  # and beyond which nothing of it lies


class FacetCurve(NamedTuple):
    """Slant range and incidence along a facet, from the launch angle of its middle."""

    angle: float  # launch angle that it fills, rad
    rate: float  # dr/dθ in the middle, m/rad
    bend: float  # half of d²r/dθ², m/rad²
    gain: float  # tan² of the incidence is gain · tilt² + left, with the tilt in the plane
    left: float
    per_arc: float  # one over the distance across the rays per launch angle
    offset: float  # distance in the middle less that arc, m


@inlined_uncounted
def is_facet_met(facet):
    """Whether a facet is not empty and its beginning, middle and end are all hit, ahead of the sonar."""
    near, centre, far = facet.near, facet.centre, facet.far
    return facet.low < facet.high and 0.0 <= near < NEVER and 0.0 <= centre < NEVER and 0.0 <= far < NEVER


@inlined_uncounted
def facet_curve(facet):
    """Parabola of slant range through the beginning, middle and end of a facet, and the tilt that is left across it."""
    angle = facet.high - facet.low
    rate = (facet.far - facet.near) / angle
    bend = 2.0 * (facet.near - 2.0 * facet.centre + facet.far) / (angle * angle)
    cos_squared = max(facet.incidence * facet.incidence, 1e-12)
    tilt = rate / facet.arc
    tilt_squared, tan_squared = tilt * tilt, (1.0 - cos_squared) / cos_squared
    # At a body's edge, where the slope grows without bound, the parabola's is scaled to the incidence.
    gain = tan_squared / tilt_squared if tan_squared < tilt_squared else 1.0
    left = max(tan_squared - tilt_squared, 0.0)
    return FacetCurve(angle, rate, bend, gain, left, 1.0 / facet.arc, facet.centre - facet.arc)


@inlined_uncounted
def along_curve(facet, curve, share):
    """Slant range at a share of the launch angle of a facet."""
    delta = (share - 0.5) * curve.angle
    # Where a facet is kilometres long the parabola falls below zero, where there are no bins.
    least = 0.5 * min(facet.near, facet.centre, facet.far)
    return max(facet.centre + delta * (curve.rate + delta * curve.bend), least)


@inlined_uncounted
def tilt_in_plane(curve, distance, share):
    """Tangent of the tilt of a facet within the plane, at a share of its launch angle."""
    delta = (share - 0.5) * curve.angle
    return (curve.rate + 2.0 * delta * curve.bend) / (distance - curve.offset)


@inlined_uncounted
def divide_facet(facet, sine_squared, material, near, centre, far):
    """Count the parts in which a facet's echo must be summed; average the specular lobe if one is enough."""
    angle, specular, exponent = facet.high - facet.low, material[1], material[2]
    per_length = 1.0 / (angle * facet.arc)
    tilt = (facet.far - facet.near) * per_length
    turn = 4.0 * (facet.near - 2.0 * facet.centre + facet.far) * per_length - tilt * tilt * angle
    cos_squared = facet.incidence * facet.incidence
    turn *= cos_squared
    width = exponent * turn * turn
    parts, change = 1.0, 0.0
    if specular > 0.0 and exponent * sine_squared < LOBE_END + 0.5 * width:
        change = 0.5 * exponent * math.sqrt(sine_squared * turn * turn)
        if width > LOBE_TURN:
            parts = 1.0 + PER_LOBE * math.sqrt(width)
        else:
            # Mean of exp(-2 n α²) over a change of the tilt in the plane: docs/theory/sweep.md
            specular *= 1.0 + width * (exponent * tilt * tilt * cos_squared * (2.0 / 3.0) - 1.0 / 6.0)
    if int(near) != int(far) or int(near) != int(centre):
        span = max(abs(centre - near), abs(far - centre))
        uneven = 0.5 * abs(near - 2.0 * centre + far) + change * span
        if uneven * UNEVEN > 4.0 * span:
            parts = max(parts, math.sqrt(UNEVEN * uneven / span))
    return int(min(parts, MOST_PARTS)), specular


@inlined_uncounted
def span_of_sector(facet, bounds, sector, pattern):
    """Slant ranges that a facet's tangent plane spans within its plane's sector, and those of its body."""
    width = sector_width(facet.centre * facet.cosine, facet.centre * facet.sine, facet.centre, sector, pattern)
    if not width > 0.0:
        return SectorSpan(0.0, bounds[0], bounds[1])
    cos_squared = max(facet.incidence * facet.incidence, 1e-12)
    tilt = (facet.far - facet.near) / ((facet.high - facet.low) * facet.arc)
    lean = math.sqrt(max((1.0 - cos_squared) / cos_squared - tilt * tilt, 0.0))
    return SectorSpan(width * min(lean, MOST_LEAN), bounds[0], bounds[1])


@inlined_uncounted
def widen(near, far, span):
    """Slant ranges between which the echo of a stretch from near to far spreads over its sector.

    Folded with the even density across the sector, that of the stretch becomes a trapezoid; an even one takes its
    place, of the same mean and variance, the sum of both.
    """
    if not span.across > 0.0:
        return near, far
    middle, length = 0.5 * (near + far), far - near
    half = 0.5 * math.sqrt(length * length + span.across * span.across)
    return max(middle - half, min(span.least, near, far)), min(middle + half, max(span.most, near, far))
