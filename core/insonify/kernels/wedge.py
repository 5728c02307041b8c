"""What a plane of the beam stands for: a beam is a cone, a plane is not."""

from __future__ import annotations

import math
from typing import NamedTuple

from insonify.kernels.jit import fused

BENT = 0.3  # sin φ up to which azimuths are proportional to it, to 1 %


class Wedge(NamedTuple):
    """One plane of a beam: a wedge of azimuths on either hand of it."""

    s_low: float  # |sin φ| where the wedge begins
    s_high: float  # and where it ends
    angle: float  # azimuth it stands for, rad; 0 marks a knife
    far_angle: float  # azimuth it stands for in the far field, where it widens with the cone; 0 for an outer plane
    near_field: float  # ground range at which the far field begins, m
    s_beam: float  # sin of half the beamwidth
    span: float  # azimuth of the whole beam in the far field, rad


@fused
def strip_width(x, r, wedge):
    """Along-track width that a plane stands for at ground range x, slant range r; 1 m for a knife.

    A beam is a cone: |sin φ_b| = cos θ |sin φ| <= sin(w/2). In the far field the inner wedges stretch with it, nearer
    by each counts by the share of its azimuths that the cone takes in.
    """
    if wedge.angle == 0.0:
        return 1.0
    if x > wedge.near_field:
        return r * wedge.far_angle
    return x * wedge.angle * taken_in(wedge.s_beam * r / x, wedge)


@fused
def beam_share(x, r, wedge):
    """Share of the beam's azimuths at that place which the plane stands for; law `light` averages with it."""
    if wedge.angle == 0.0:
        return 1.0
    if x > wedge.near_field:
        return wedge.far_angle / wedge.span
    reach = min(wedge.s_beam * r / x, 1.0)
    return wedge.angle * taken_in(reach, wedge) / (2.0 * math.asin(reach))


@fused
def taken_in(reach, wedge):
    """Share of a wedge's azimuths within |sin φ| <= reach."""
    if wedge.s_high > BENT:
        share = (math.asin(min(reach, 1.0)) - math.asin(wedge.s_low)) / wedge.angle
    else:
        share = (reach - wedge.s_low) / (wedge.s_high - wedge.s_low)
    return min(max(share, 0.0), 1.0)
