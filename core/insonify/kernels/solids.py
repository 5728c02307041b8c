"""Convex bodies in one plane: where they hide what is behind them, and what they send back themselves.

A vertical plane cuts a ball or a cylinder in a convex figure, which fills one interval of launch angles.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.kernels.bins import FIXED_POINT, spread
from insonify.kernels.jit import fused, kernel
from insonify.kernels.pieces import deposit_piece, next_open
from insonify.kernels.scatter import strength
from insonify.kernels.shapes import meet_solid
from insonify.kernels.types import LIGHT, SPHERE
from insonify.kernels.wedge import beam_share, strip_width

FACETS = 64  # per body and plane, closer together towards its edges
EDGE = 1e-9  # share of an interval by which its outermost rays move inwards, to be sure to meet the body
DOWN, UP = -math.pi / 2.0, math.pi / 2.0
NEVER = 1e30


class Covers(NamedTuple):
    """Bodies that one plane cuts; arrays are longer than their number."""

    low: NDArray[np.float64]  # launch angle above the horizontal where each begins, rad
    high: NDArray[np.float64]  # and where it ends
    solid: NDArray[np.int64]  # row of the table of solids
    in_front: NDArray[np.bool_]  # whether it hides the piece in hand


def empty_covers(solids: int) -> Covers:
    """Make room for as many bodies as a scene has."""
    return Covers(np.zeros(solids), np.zeros(solids), np.zeros(solids, np.int64), np.zeros(solids, np.bool_))


class View(NamedTuple):
    """One plane through the sonar."""

    x: float
    y: float
    z: float
    ex: float  # azimuth, unit vector
    ey: float


@fused
def find_covers(solids, view, reach, covers):
    """Collect the bodies a plane cuts; return their number, -1 - k if the sonar is inside body k."""
    count = 0
    for k in range(solids.shape.size):
        # Most bodies lie off most planes: ask first about a ball around each.
        half, radius = 0.5 * solids.length[k], solids.radius[k]
        mx = solids.start[k, 0] + half * solids.axis[k, 0] - view.x
        my = solids.start[k, 1] + half * solids.axis[k, 1] - view.y
        along, across = mx * view.ex + my * view.ey, mx * view.ey - my * view.ex
        bound = half + radius
        if abs(across) >= bound or along <= -bound or along >= reach + bound:
            continue
        status, low, high = section(solids, k, view)
        if status < 0:
            return -1 - k
        if status > 0:
            covers.low[count], covers.high[count], covers.solid[count] = low, high, k
            count += 1
    return count


@fused
def hidden_slopes(covers, count):
    """Slopes between which any body may hide the bed."""
    low, high = NEVER, -NEVER
    for k in range(count):
        low = min(low, math.tan(covers.low[k]) if covers.low[k] > DOWN else -NEVER)
        high = max(high, math.tan(covers.high[k]) if covers.high[k] < UP else NEVER)
    return low, high


@fused
def section(solids, k, view):
    """Interval of launch angles that body k fills ahead: status 1; 0 if none, -1 if the sonar is inside."""
    radius, length = solids.radius[k], solids.length[k]
    cx, cy, cz = solids.start[k, 0] - view.x, solids.start[k, 1] - view.y, solids.start[k, 2] - view.z
    if solids.shape[k] == SPHERE:
        across = cx * view.ey - cy * view.ex
        return _sphere_section(cx * view.ex + cy * view.ey, cz, radius * radius - across * across)
    ax, ay, az = solids.axis[k, 0], solids.axis[k, 1], solids.axis[k, 2]
    return _cylinder_section(cx, cy, cz, ax, ay, az, length, radius, view)


@kernel
def _sphere_section(along, height, radius_squared):
    """Interval of a circle, from its centre and squared radius in the plane."""
    if radius_squared <= 0.0:
        return 0, 0.0, 0.0
    distance_squared = along * along + height * height
    if distance_squared <= radius_squared:
        return -1, 0.0, 0.0
    centre = math.atan2(height, along)
    half = math.asin(math.sqrt(radius_squared / distance_squared))
    return _forward(centre, centre - half, centre + half)


@kernel
def _cylinder_section(cx, cy, cz, ax, ay, az, length, radius, view):
    """Interval of an ellipse between two end planes: its extremes are tangents and corners."""
    # Axial and perpendicular parts of the plane's directions e (azimuth) and k (up), and of the centre.
    ae, ak = ax * view.ex + ay * view.ey, az
    ac = cx * ax + cy * ay + cz * az
    ec, ee, kk, ek = cx * view.ex + cy * view.ey - ac * ae, 1.0 - ae * ae, 1.0 - ak * ak, -ae * ak
    kc = cz - ac * ak
    cc = cx * cx + cy * cy + cz * cz - ac * ac - radius * radius
    if cc <= 0.0 and 0.0 <= -ac <= length:
        return -1, 0.0, 0.0
    angles = np.empty(6)
    count = 0
    # Tangents: (d·c)² = (d·d)(c·c − R²) for d = (1, u), perpendicular parts: a quadratic in the slope u.
    p, q, w = kc * kc - kk * cc, ec * kc - ek * cc, ec * ec - ee * cc
    root = q * q - p * w
    if root >= 0.0 and p != 0.0:
        root = math.sqrt(root)
        big = -(q + math.copysign(root, q))
        for u in (big / p, w / big if big != 0.0 else -q / p):
            dd = ee + 2.0 * u * ek + u * u * kk
            if dd > 0.0:
                t = (ec + u * kc) / dd
                s = t * (ae + u * ak) - ac
                if 0.0 <= s <= length:
                    angles[count] = math.atan2(t * u, t)
                    count += 1
    # Corners: where the end planes' lines leave the ellipse.
    for end in (0.0, length):
        count = _corners(ae, ak, ac + end, ec, kc, ee, ek, kk, cc, angles, count)
    if count < 2:
        return 0, 0.0, 0.0
    # Angles count from a direction into the figure, so that none wraps.
    sx, sy = 0.0, 0.0
    for k in range(count):
        sx += math.cos(angles[k])
        sy += math.sin(angles[k])
    centre = math.atan2(sy, sx)
    low, high = NEVER, -NEVER
    for k in range(count):
        turned = angles[k] - centre
        turned -= 2.0 * math.pi * math.floor(turned / (2.0 * math.pi) + 0.5)
        low, high = min(low, turned), max(high, turned)
    return _forward(centre, centre + low, centre + high)


@kernel
def _corners(ae, ak, axial, ec, kc, ee, ek, kk, cc, angles, count):
    """Add the ends of the chord that one end plane cuts from the ellipse, as angles."""
    norm = ae * ae + ak * ak
    if norm < 1e-18:
        return count
    # Points axial·(ae, ak)/norm + t·(−ak, ae) of the end plane's line; inside where |P⊥ − c⊥|² <= R².
    fx, fz, gx, gz = axial * ae / norm, axial * ak / norm, -ak, ae
    a = gx * gx * ee + 2.0 * gx * gz * ek + gz * gz * kk
    b = fx * gx * ee + (fx * gz + fz * gx) * ek + fz * gz * kk - gx * ec - gz * kc
    c = fx * fx * ee + 2.0 * fx * fz * ek + fz * fz * kk - 2.0 * (fx * ec + fz * kc) + cc
    root = b * b - a * c
    if a <= 0.0 or root < 0.0:
        return count
    root = math.sqrt(root)
    for t in ((-b - root) / a, (-b + root) / a):
        angles[count] = math.atan2(fz + t * gz, fx + t * gx)
        count += 1
    return count


@kernel
def _forward(centre, low, high):
    """Part of an interval within the half-plane ahead; angles in (−π, π] about ``centre``."""
    low, high = max(low, DOWN), min(high, UP)
    if high <= low:
        return 0, 0.0, 0.0
    return 1, low, high


@fused
def distance_along(solids, k, view, angle):
    """Distance to body k along a launch angle, and the cosine of the incidence there; infinite if missed."""
    dx, dy, dz = math.cos(angle) * view.ex, math.cos(angle) * view.ey, math.sin(angle)
    distance, nx, ny, nz = meet_solid(solids, k, view.x, view.y, view.z, dx, dy, dz)
    return distance, -(nx * dx + ny * dy + nz * dz)


@kernel
def deposit_open(surface, x_from, x_to, wedge, view, solids, covers, count, law, bin_length, bins):
    """Deposit what no body hides of a segment of the bed, between two ground ranges."""
    low, high = shade_bed(surface, x_from, x_to, view, solids, covers, count)
    while low < high:
        opened, closed = next_open(covers.low, covers.high, covers.in_front, count, low, high)
        if opened >= high:
            return
        start = x_from if opened <= low else range_at(surface, opened)
        stop = x_to if closed >= high else range_at(surface, closed)
        deposit_piece(surface, max(start, x_from), min(stop, x_to), wedge, law, bin_length, bins)
        low, x_from = closed, stop


@fused
def shade_bed(surface, x_from, x_to, view, solids, covers, count):
    """Mark the bodies in front of a segment between two ground ranges; return the launch angles of its ends."""
    low = math.atan2(surface.offset + surface.slope * x_from, x_from)
    high = math.atan2(surface.offset + surface.slope * x_to, x_to)
    for k in range(count):
        covers.in_front[k] = False
        if covers.low[k] < high and covers.high[k] > low:
            angle = 0.5 * (max(low, covers.low[k]) + min(high, covers.high[k]))
            distance, _ = distance_along(solids, covers.solid[k], view, angle)
            covers.in_front[k] = distance < range_at(surface, angle) / math.cos(angle)
    return low, high


@fused
def range_at(surface, angle):
    """Ground range at which a launch angle meets a segment's line."""
    return surface.offset / (math.tan(angle) - surface.slope)


@kernel
def deposit_solids(profile, knots, horizon, problem, wedge, view, covers, count, bins):
    """Deposit what every body in the plane sends back, less what the bed and other bodies hide."""
    solids = problem.solids
    for own in range(count):
        k = covers.solid[own]
        middle, half = 0.5 * (covers.low[own] + covers.high[own]), 0.5 * (covers.high[own] - covers.low[own])
        half *= 1.0 - EDGE
        start = middle - half
        near, _ = distance_along(solids, k, view, start)
        for facet in range(FACETS):
            stop = middle - half * math.cos(math.pi * (facet + 1) / FACETS)
            far, _ = distance_along(solids, k, view, stop)
            centre, cos_incidence = distance_along(solids, k, view, 0.5 * (start + stop))
            ridge = horizon_at(profile, knots, horizon, centre * math.cos(0.5 * (start + stop)))
            lowest = max(start, math.atan(ridge))
            if lowest <= start and not overlapped(covers, count, own, start, stop):
                _deposit_facet(k, start, stop, near, centre, far, cos_incidence, problem, wedge, bins)
            elif lowest < stop:
                _deposit_open_facet(own, lowest, stop, problem, wedge, view, covers, count, bins)
            start, near = stop, far


@fused
def overlapped(covers, count, own, start, stop):
    """Whether any other body's interval meets that of a facet."""
    for k in range(count):
        if k != own and covers.low[k] < stop and covers.high[k] > start:
            return True
    return False


@kernel
def _deposit_open_facet(own, start, stop, problem, wedge, view, covers, count, bins):
    """Deposit what other bodies leave open of a facet."""
    solids = problem.solids
    shade_facet(own, start, stop, solids, view, covers, count)
    while start < stop:
        opened, closed = next_open(covers.low, covers.high, covers.in_front, count, start, stop)
        if opened >= stop:
            return
        near, _ = distance_along(solids, covers.solid[own], view, opened)
        far, _ = distance_along(solids, covers.solid[own], view, closed)
        centre, cos_incidence = distance_along(solids, covers.solid[own], view, 0.5 * (opened + closed))
        _deposit_facet(covers.solid[own], opened, closed, near, centre, far, cos_incidence, problem, wedge, bins)
        start = closed


@fused
def shade_facet(own, start, stop, solids, view, covers, count):
    """Mark the other bodies in front of a facet."""
    for k in range(count):
        covers.in_front[k] = False
        if k != own and covers.low[k] < stop and covers.high[k] > start:
            angle = 0.5 * (max(start, covers.low[k]) + min(stop, covers.high[k]))
            here, _ = distance_along(solids, covers.solid[own], view, angle)
            other, _ = distance_along(solids, covers.solid[k], view, angle)
            # Where two bodies touch the first of the table is heard.
            covers.in_front[k] = other < here or (other == here and k < own)


@fused
def _deposit_facet(k, start, stop, near, centre, far, cos_incidence, problem, wedge, bins):
    """Deposit one facet wholly heard: its ends give the slant ranges, its middle the strength."""
    if not (near < NEVER and far < NEVER and centre < NEVER):
        return
    last, per_bin = bins.size - 2, 1.0 / problem.bin_length
    first, second = facet_energies(k, start, stop, near, centre, far, cos_incidence, problem, wedge)
    spread(bins, near * per_bin, centre * per_bin, first, last)
    spread(bins, centre * per_bin, far * per_bin, second, last)


@fused
def facet_energies(k, start, stop, near, centre, far, cos_incidence, problem, wedge):
    """Energies of a facet, in fixed-point units, on either hand of its middle."""
    row = problem.solids.material[k]
    diffuse, specular = problem.reflectivity[row, 0], problem.reflectivity[row, 1]
    value = strength(cos_incidence, diffuse, specular, problem.reflectivity[row, 2], problem.law)
    x = centre * math.cos(0.5 * (start + stop))
    if problem.law == LIGHT:
        density = value * beam_share(x, centre, wedge) / problem.bin_length * FIXED_POINT
        return density * abs(centre - near), density * abs(far - centre)
    # The strip seen along the ray: width · r dθ, laid out on the surface: / cos of the incidence.
    seen = strip_width(x, centre, wedge) * centre * (stop - start)
    half = 0.5 * value * seen / max(cos_incidence, 1e-6) * FIXED_POINT
    return half, half


@fused
def horizon_at(profile, knots, horizon, x):
    """Greatest slope of the bed up to ground range x."""
    if knots == 0 or x < profile.x[0]:
        return -NEVER
    i = np.searchsorted(profile.x[:knots], x, side="right") - 1
    ridge = horizon[i]
    if i + 1 < knots and x > 0.0:
        share = (x - profile.x[i]) / (profile.x[i + 1] - profile.x[i])
        slope = (profile.z[i] + share * (profile.z[i + 1] - profile.z[i])) / x
        if slope > ridge:
            ridge = slope
    return ridge
