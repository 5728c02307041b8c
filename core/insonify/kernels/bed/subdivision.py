"""Division of a profile's segments, so that one incidence, one weight and one echo density serve each of the parts.

A segment lies in one bilinear cell: along it the height is a parabola and the gradient across the strip of cells is
linear. Three things may change too much along it. One is the incidence, where it passes a specular lobe or the vertical
beam. The others are the density of the echo over slant range, which is spread evenly, and the line of sight that it
blocks. Derived in docs/theory/sweep.md.
"""

import math

import numpy as np

from insonify.compiler.jit import INTEGER, inlined_uncounted, kernel_separate
from insonify.kernels.bed.grid import is_oblique
from insonify.kernels.bed.profile import AT_ONCE, padded_count

MOST_PARTS = 256
# Turn of the incidence within a part, in units of a lobe's width 1/√n, over the root of the error allowed.
LOBE_TURN = 2.5
# Angle to the normal, in units of 1/√(2n), beyond which a lobe cosⁿ 2α is below e⁻⁶ of its peak.
LOBE_REACH = 2.5
# Parts of a segment on which the surface turns away from the sonar, times the root of the error allowed: its top is
# the horizon of all that lies behind.
SILHOUETTE_PARTS = 0.8
# Share of what the chord misplaces that linear densities leave; and the error of the sum by the midpoint rule, as a
# multiple of its size on one segment, with even densities and linear ones. Measured so that planes at any azimuth err
# alike. Steps of density count in full, because linear densities do not follow the beam's weight.
LEFT_BY_LINEAR, BIAS_EVEN, BIAS_LINEAR = 0.25, 6.0, 2.0
SPAN_ROUNDING = 1e-4  # share of an angle that single precision may miss


@inlined_uncounted
def measure_segments(count, eu, per_ev, bed, limits, profile):
    """Divide the segments of a profile where one incidence is not enough, and fill in their slopes and areas."""
    x, z, gradient, twist = profile.x, profile.z, profile.gradient, profile.twist
    turn = smallest_turn(limits, bed.spacing)
    turned = _fill_segments(padded_count(count - 1), x, z, gradient, twist, eu, per_ev, turn, profile)
    # Nowhere does a segment span a larger angle than it would under the sonar, or the echo fall by more than its cube.
    parted = turned or (eu != 0.0 and limits.misplaced < math.inf)
    if not parted and not 3.0 * bed.spacing * abs(per_ev) <= turn * abs(z[0]):
        # If anything may be misplaced, segments are divided for the angle alone that they span.
        parted = limits.misplaced < math.inf or _span_more(count - 1, x, z, profile.slope, limits.angle)
    return _divide(count, eu, per_ev, bed.mapped, limits, profile) if parted else count


@inlined_uncounted
def smallest_turn(limits, spacing):
    """Smallest turn of the incidence along a segment of a plane along the grid that requires a division."""
    # The density of a Lambert echo changes by half the turn from end to end at most.
    diffuse = min(16.0 * limits.misplaced * limits.bin_length / spacing, math.sqrt(12.0 * limits.misplaced))
    lobe = LOBE_TURN * math.sqrt(limits.misplaced / limits.shininess) if limits.shininess > 0.0 else diffuse
    return min(limits.angle, diffuse, lobe)


@inlined_uncounted
def _span_more(segments, x, z, slope, angle):
    """Whether any segment spans more than an angle as seen from the sonar, or nearly so."""
    real, more = slope.dtype.type, 0
    half, allowed = real(0.5), real((1.0 - SPAN_ROUNDING) * angle)
    for i in range(segments):
        ground, height = real(half * (x[i] + x[i + 1])), real(half * (z[i] + z[i + 1]))
        offset, r_squared = height - slope[i] * ground, ground * ground + height * height
        more |= 1 if real(x[i + 1] - x[i]) * abs(offset) > allowed * r_squared else 0
    return more != 0


@inlined_uncounted
def _fill_segments(segments, x, z, gradient, twist, eu, per_ev, allowed, profile):
    """Slope and area of segments; return whether the normal turns by more than is allowed along any."""
    slope, area = profile.slope, profile.area
    real = area.dtype.type
    eu, per_ev, one, allowed = real(eu), real(per_ev), real(1.0), real(allowed * allowed)
    turned = 0
    for i in range(segments):
        rise = real(z[i + 1] - z[i]) / real(x[i + 1] - x[i])
        across = gradient[i]
        # Across the strip the gradient is linear, along the plane it is the slope.
        along = (rise - eu * across) * per_ev
        slope[i] = rise
        squared = one + across * across + along * along
        area[i] = squared
        turned |= 1 if twist[i] * twist[i] > allowed * squared else 0
    return turned != 0


@kernel_separate(INTEGER)
def _divide(count, eu, per_ev, mapped, limits, profile):
    """Divide the segments of a profile; return its number of knots."""
    segments = count - 1
    level = _mean_square(segments, profile.slope)
    _count_parts(padded_count(segments), eu, per_ev, level, limits, profile)
    added = _limit_parts(segments, profile.parts, max(profile.x.size - count - 2 * AT_ONCE, 0))
    if added > 0:
        _insert_knots(segments, added, eu, mapped, profile)
        total = padded_count(segments + added)
        _fill_segments(total, profile.x, profile.z, profile.gradient, profile.twist, eu, per_ev, 0.0, profile)
    return count + added


@inlined_uncounted
def _mean_square(count, values):
    """Mean square of numbers, NaN apart."""
    total, found = 0.0, 0
    for i in range(count):
        known = values[i] == values[i]
        total += np.float64(values[i]) * values[i] if known else 0.0
        found += 1 if known else 0
    return total / max(found, 1)


@inlined_uncounted
def _count_parts(segments, eu, per_ev, slope_squared, limits, profile):
    """Parts into which each segment is divided: the most that lobes, the vertical beam, bins or the horizon require."""
    x, z, slope, area, parts = profile.x, profile.z, profile.slope, profile.area, profile.parts
    gradient, twist = profile.gradient, profile.twist
    real = area.dtype.type
    nothing, half, one, two, four = real(0.0), real(0.5), real(1.0), real(2.0), real(4.0)
    most, silhouette = real(MOST_PARTS), real(SILHOUETTE_PARTS / math.sqrt(limits.misplaced))
    quarter, eighth = real(1.0 / 4.0), real(1.0 / 8.0)
    linear = limits.linear and is_oblique(eu, 1.0 / per_ev)
    eu, per_ev, slope_squared = real(eu), real(per_ev), real(slope_squared)
    width = real(LOBE_REACH / math.sqrt(2.0 * limits.shininess)) if limits.shininess > 0.0 else real(-100.0)
    per_lobe = real(math.sqrt(limits.shininess / limits.misplaced) / LOBE_TURN)
    per_angle, per_bin = real(1.0 / limits.angle), real(1.0 / limits.bin_length)
    per_error = real(1.0 / limits.misplaced)
    left, bias = real(LEFT_BY_LINEAR if linear else 1.0), real((BIAS_LINEAR if linear else BIAS_EVEN) / 12.0)
    for i in range(segments):
        run, rise = real(x[i + 1] - x[i]), slope[i]
        ground, height = real(0.5 * (x[i] + x[i + 1])), real(0.5 * (z[i] + z[i + 1]))
        r_squared, offset = ground * ground + height * height, height - rise * ground
        per_range, per_area = one / math.sqrt(r_squared), one / area[i]
        # The direction to the sonar spans an angle; the normal turns by the twist of the cell.
        spanned, twisted = abs(run * offset) * per_range * per_range, abs(twist[i] * per_ev)
        turn = twisted * math.sqrt(per_area) + spanned
        sine_squared, reach = one - offset * offset * per_range * per_range * per_area, width + half * turn
        lobe = turn * per_lobe if (sine_squared < reach * reach) & (reach > nothing) else nothing
        # Relative change, from end to end, of the density of the echo: offset² / √area over dr/dx.
        curl, approach = eu * twist[i], ground + height * rise
        change, bent = abs(curl * ground), abs(curl * height)
        uneven = four * change / (abs(offset) + change) + abs(gradient[i] * twist[i]) * per_area
        uneven += two * bent / (abs(approach) + bent) + spanned * abs(offset) / (abs(approach) + bent)
        uneven += two * run * abs(approach) * per_range * per_range
        # The echo of the segment, and its density, against what a bin of this bed takes on average.
        density = offset * offset * math.sqrt(per_area) / (height * height + slope_squared * ground * ground)
        spread, echo = run * abs(approach) * per_range * per_bin, density * run * per_bin
        # Shares that one density and the chord put into neighbouring bins. Over many bins the parts are those that
        # follow the density.
        stepped = eighth * uneven * (spread if spread < one else one) * echo * per_error
        followed = uneven * density * per_error
        moved = left * quarter * bent * run * per_range * per_bin * echo
        # The error of the sum by the midpoint rule, several times: it does not average out over the segments of a bin.
        biased = bias * (quarter * uneven * uneven + twisted * twisted * per_area) * density
        limited = stepped if stepped < followed * followed else followed * followed
        wanted = math.sqrt(limited + (moved + biased) * per_error)
        wanted = wanted if wanted > lobe else lobe
        wanted = wanted if wanted > spanned * per_angle else spanned * per_angle
        wanted = silhouette if (change > abs(offset)) & (wanted < silhouette) else wanted
        wanted = wanted if wanted < most else most
        # What turns away from the sonar is never seen. Beside a hole all of this is NaN, which compares false.
        parts[i] = np.int32(wanted if (wanted > nothing) & (offset < change) else nothing) + np.int32(1)


@inlined_uncounted
def _limit_parts(segments, parts, room):
    """Count the knots to be added; where there is no room for all, every segment gets fewer."""
    added = room + 1
    halved = 0
    while added > room:
        added = 0
        for i in range(segments):
            parts[i] = ((parts[i] - 1) >> halved) + 1
            added += parts[i] - 1
        halved = 1
    return added


@inlined_uncounted
def _insert_knots(segments, added, eu, mapped, profile):
    """Put knots into segments, in place, from the last segment to the first."""
    # Along the plane d²z/dx² = 2 eu ev ∂²z/∂u∂v, and the gradient across changes by ev ∂²z/∂u∂v a metre.
    x, z, gradient, twist, material = profile.x, profile.z, profile.gradient, profile.twist, profile.material
    real = gradient.dtype.type
    place = segments + added
    x[place], z[place] = x[segments], z[segments]
    for k in range(segments - 1, -1, -1):
        if place == k + 1:
            return  # nothing nearer is divided
        count = profile.parts[k]
        place -= count
        # x[k + 1] is still in place: what has been written lies beyond it, or is that knot itself.
        x0, dx, z0, dz, across, change = x[k], x[k + 1] - x[k], z[k], z[k + 1] - z[k], gradient[k], twist[k]
        if mapped:
            material[place : place + count] = material[k]
        x[place], z[place], gradient[place], twist[place] = x0, z0, across, change
        if count > 1:
            bend, share = eu * change * dx, 1.0 / count
            for part in range(count):
                t = part * share
                x[place + part] = x0 + dx * t
                z[place + part] = z0 + dz * t - bend * t * (1.0 - t)
                gradient[place + part] = across + change * real(t + 0.5 * share - 0.5)
                twist[place + part] = change * real(share)
