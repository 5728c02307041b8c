"""Convex bodies in one vertical half-plane: the launch angles that they fill, and where its rays meet them.

Rays are met one by one, and many at once without branches, which would keep the compiler from its vector units.
"""

import math
from typing import NamedTuple

from insonify.compiler.jit import inlined_uncounted, kernel_uncounted
from insonify.kernels.common.types import SPHERE
from insonify.kernels.geometry.solids import (
    FrustumShape,
    frustum_normal,
    greatest_radius,
    intersect_frustum,
    intersect_sphere,
)

DOWN, UP = -math.pi / 2.0, math.pi / 2.0
NEVER = 1e30
ROUNDING = 1e-9  # share of a length by which a point may lie beyond its end


class HalfPlane(NamedTuple):
    """A vertical half-plane from the sonar outwards."""

    x: float
    y: float
    z: float
    ex: float  # azimuth, unit vector
    ey: float


class Conic(NamedTuple):
    """Section of a quadric by a plane: products of the plane's directions e (azimuth), k (up) and of its centre c."""

    # All vectors are taken without their parts along the quadric's axis.
    ec: float  # e · c
    kc: float  # k · c
    ee: float  # e · e
    ek: float  # e · k
    kk: float  # k · k
    cc: float  # c · c, less the squared radius


@inlined_uncounted
def section_solid(solids, k, plane, rim):
    """Interval of launch angles that a body's cross-section by a half-plane fills, ahead of the sonar."""
    for end in range(rim.size):
        rim[end] = NEVER
    radius, length, taper = solids.radius[k], solids.length[k], solids.taper[k]
    cx, cy, cz = solids.start[k, 0] - plane.x, solids.start[k, 1] - plane.y, solids.start[k, 2] - plane.z
    if solids.shape[k] == SPHERE:
        across = cx * plane.ey - cy * plane.ex
        return _sphere_section(cx * plane.ex + cy * plane.ey, cz, radius * radius - across * across)
    ax, ay, az = solids.axis[k, 0], solids.axis[k, 1], solids.axis[k, 2]
    return _frustum_section(FrustumShape(cx, cy, cz, ax, ay, az, length, radius, taper), plane.ex, plane.ey, rim)


@inlined_uncounted
def may_cut_solid(solids, k, plane, reach, height):
    """Whether a half-plane may cut a body within reach, by a capsule around the body."""
    length, bound = solids.length[k], greatest_radius(solids, k)
    cx, cy, cz = solids.start[k, 0] - plane.x, solids.start[k, 1] - plane.y, solids.start[k, 2] - plane.z
    along, rate = cx * plane.ex + cy * plane.ey, solids.axis[k, 0] * plane.ex + solids.axis[k, 1] * plane.ey
    across, drift = cx * plane.ey - cy * plane.ex, solids.axis[k, 0] * plane.ey - solids.axis[k, 1] * plane.ex
    # Part of the axis that comes as near to the plane as the capsule is thick.
    from_, to = 0.0, length
    if abs(drift) * length > ROUNDING * bound:
        middle, half = -across / drift, bound / abs(drift)
        from_, to = max(middle - half, from_), min(middle + half, to)
    elif abs(across) > bound:
        return False
    one, other = along + from_ * rate, along + to * rate
    if from_ > to or max(one, other) <= -bound:
        return False
    rise = solids.axis[k, 2]
    off = max(abs(cz + from_ * rise), abs(cz + to * rise)) + bound
    return (min(one, other) - bound) * height <= reach * max(height, off)


@inlined_uncounted
def solid_distance_bound(solids, k, plane):
    """Lower bound on the distance of a body from the sonar, by a ball around the body."""
    half = 0.5 * solids.length[k]
    mx = solids.start[k, 0] + half * solids.axis[k, 0] - plane.x
    my = solids.start[k, 1] + half * solids.axis[k, 1] - plane.y
    mz = solids.start[k, 2] + half * solids.axis[k, 2] - plane.z
    bound = half + solids.radius[k] + max(solids.taper[k] * solids.length[k], 0.0)
    return math.sqrt(mx * mx + my * my + mz * mz) * (1.0 - ROUNDING) - bound


@kernel_uncounted
def _sphere_section(along, height, radius_squared):
    """Interval of launch angles of a circle, from its centre and squared radius in the plane."""
    distance_squared = along * along + height * height
    if not 0.0 < radius_squared < distance_squared:
        return False, 0.0, 0.0
    centre = math.atan2(height, along)
    half = math.asin(math.sqrt(radius_squared / distance_squared))
    return _forward(centre, centre - half, centre + half)


@kernel_uncounted
def _frustum_section(frustum, ex, ey, rim):
    """Interval of launch angles of a frustum's section, from the tangents to its side and the corners of its ends."""
    cx, cy, cz, ax, ay, az, length, radius, taper = frustum
    # Axial and perpendicular parts of the plane's directions e (azimuth) and k (up), and of the centre.
    ae, ak = ax * ex + ay * ey, az
    ac = cx * ax + cy * ay + cz * az
    ec, ee, kk, ek = cx * ex + cy * ey - ac * ae, 1.0 - ae * ae, 1.0 - ak * ak, -ae * ak
    kc = cz - ac * ak
    across = cx * cx + cy * cy + cz * cz - ac * ac
    here = radius - taper * ac  # radius where the sonar stands abeam of the axis
    if across <= here * here and 0.0 <= -ac <= length:
        return False, 0.0, 0.0  # the sonar is inside
    # Corners: where the end planes' lines leave the conic.
    last = radius + taper * length
    corners = _corners(ae, ak, ac, Conic(ec, kc, ee, ek, kk, across - radius * radius), rim, 0)
    corners = _corners(ae, ak, ac + length, Conic(ec, kc, ee, ek, kk, across - last * last), rim, corners)
    # With radius + taper·s in place of the radius the quadric |P⊥|² = radius² keeps its form.
    side = Conic(
        ec + taper * here * ae, kc + taper * here * ak,
        ee - taper * taper * ae * ae, ek - taper * taper * ae * ak, kk - taper * taper * ak * ak, across - here * here,
    )  # fmt: skip
    count = _tangents(ae, ak, ac, length, side, rim, corners)
    if count < 2:
        return False, 0.0, 0.0
    # Angles count from a direction into the figure, so that none wraps.
    sx, sy = 0.0, 0.0
    for k in range(count):
        sx += math.cos(rim[k])
        sy += math.sin(rim[k])
    centre = math.atan2(sy, sx)
    low, high = NEVER, -NEVER
    for k in range(count):
        turned = rim[k] - centre
        turned -= 2.0 * math.pi * math.floor(turned / (2.0 * math.pi) + 0.5)
        low, high = min(low, turned), max(high, turned)
    for k in range(corners, count):
        rim[k] = NEVER  # a point of tangency is not a rim
    return _forward(centre, centre + low, centre + high)


@kernel_uncounted
def _tangents(ae, ak, ac, length, side, angles, count):
    """Add the directions that touch the side: (d·c)² = (d·d)(c·c) for d = (1, u), a quadratic in the slope u."""
    ec, kc, ee, ek, kk, cc = side
    p, q, w = kc * kc - kk * cc, ec * kc - ek * cc, ec * ec - ee * cc
    root = q * q - p * w
    if root < -ROUNDING * q * q or p == 0.0:
        return count
    # Through the apex of a cone both tangents coincide; rounding must not lose this double root.
    root = math.sqrt(max(root, 0.0))
    big = -(q + math.copysign(root, q))
    for u in (big / p, w / big if big != 0.0 else -q / p):
        dd = ee + 2.0 * u * ek + u * u * kk
        if dd != 0.0:
            t = (ec + u * kc) / dd
            s = t * (ae + u * ak) - ac
            if -ROUNDING * length <= s <= length * (1.0 + ROUNDING):
                angles[count] = math.atan2(t * u, t)
                count += 1
    return count


@kernel_uncounted
def _corners(ae, ak, axial, end, angles, count):
    """Add the ends of the chord that one end of a frustum cuts from the conic, as launch angles."""
    ec, kc, ee, ek, kk, cc = end
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


@kernel_uncounted
def _forward(centre, low, high):
    """Part of an interval of launch angles within the half-plane ahead; angles in (−π, π] about ``centre``."""
    low, high = max(low, DOWN), min(high, UP)
    if high <= low:
        return False, 0.0, 0.0
    return True, low, high


@inlined_uncounted
def middle_of_section(solids, k, plane):
    """Ground range and height above the sonar of the middle of a body's cross-section."""
    x, y, z = solids.start[k, 0] - plane.x, solids.start[k, 1] - plane.y, solids.start[k, 2] - plane.z
    if solids.shape[k] == SPHERE:
        return x * plane.ex + y * plane.ey, z
    # The part of the axis that is nearer to the plane than the body is thick.
    length, thick = solids.length[k], solids.radius[k] + max(solids.taper[k] * solids.length[k], 0.0)
    ax, ay, az = solids.axis[k, 0], solids.axis[k, 1], solids.axis[k, 2]
    across, rate = x * plane.ey - y * plane.ex, ax * plane.ey - ay * plane.ex
    begin, end = 0.0, length
    if rate != 0.0:
        one, other = (-thick - across) / rate, (thick - across) / rate
        begin, end = max(begin, min(one, other)), min(end, max(one, other))
    along = min(max(0.5 * (begin + end), 0.0), length)
    return (x + along * ax) * plane.ex + (y + along * ay) * plane.ey, z + along * az


@inlined_uncounted
def meet_solid(body, c, s):
    """Distance of a body along a straight ray of its plane, and both parts of the inward normal within the plane.

    The body has the numbers of a `Primitive`: its place from the origin of the ray, its shape, and the plane's azimuth.
    """
    dx, dy = c * body.level_x, c * body.level_y
    if body.kind == SPHERE:
        distance, _ = intersect_sphere(body.x, body.y, body.z, body.radius, dx, dy, s)
        inwards = (body.x * dx + body.y * dy + body.z * s - distance) / body.radius
        level = body.x * body.level_x + body.y * body.level_y
        return (distance if distance > 0.0 else math.inf), inwards, (c * body.z - s * level) / body.radius
    frustum = FrustumShape(body.x, body.y, body.z, body.ax, body.ay, body.az, body.length, body.radius, body.taper)
    distance, face, _, _ = intersect_frustum(frustum, dx, dy, s)
    if not 0.0 < distance < math.inf:
        return math.inf, 0.0, 0.0
    px, py, pz = distance * dx - body.x, distance * dy - body.y, distance * s - body.z
    nx, ny, nz = frustum_normal(px, py, pz, body.ax, body.ay, body.az, body.radius, body.taper, face)
    return distance, -(nx * dx + ny * dy + nz * s), s * (nx * body.level_x + ny * body.level_y) - c * nz


@inlined_uncounted
def meet_solid_by_rays(body, count, normals, distance, incidence, lean):
    """Meet a body with many rays of its plane, as `meet_solid` with one.

    ``distance`` and ``incidence`` enter as cosine and sine of the rays' angles, which are not needed afterwards.
    """
    if body.kind == SPHERE:
        _meet_sphere_by_rays(body, count, normals, distance, incidence, lean)
    else:
        _meet_frustum_by_rays(body, count, normals, distance, incidence, lean)


@inlined_uncounted
def _in_plane(x, y, ex, ey):
    """Parts of a level vector along the plane's azimuth and at right angles to the plane."""
    return x * ex + y * ey, y * ex - x * ey


@inlined_uncounted
def _meet_sphere_by_rays(body, count, normals, distance, incidence, lean):
    """Meet a sphere."""
    (x, y), z, radius = _in_plane(body.x, body.y, body.level_x, body.level_y), body.z, body.radius
    squared, per_radius = radius * radius - y * y, 1.0 / radius
    for i in range(count):
        c, s = distance[i], incidence[i]
        along = x * c + z * s
        # The perpendicular, not c² − along², keeps its digits far away.
        px, pz = x - along * c, z - along * s
        root = squared - (px * px + pz * pz)
        half = math.sqrt(root if root > 0.0 else 0.0)
        met = (root >= 0.0) & (along > half)
        distance[i] = along - half if met else math.inf
        if normals:
            incidence[i] = half * per_radius if met else 0.0
            lean[i] = (c * z - s * x) * per_radius


@inlined_uncounted
def _meet_frustum_by_rays(body, count, normals, distance, incidence, lean):
    """Meet a frustum: the stretch inside both a cone and a slab."""
    ex, ey, length, radius, taper = body.level_x, body.level_y, body.length, body.radius, body.taper
    (x, y), z = _in_plane(body.x, body.y, ex, ey), body.z
    (ax, ay), az = _in_plane(body.ax, body.ay, ex, ey), body.az
    tip = -math.copysign(1.0, taper)
    for i in range(count):
        c, s = distance[i], incidence[i]
        da = c * ax + s * az
        # Counted from where the line passes the middle, so that far away no digits are lost.
        middle = x * c + z * s + 0.5 * length * da
        mx, mz = middle * c - x, middle * s - z
        axial = mx * ax + mz * az - y * ay
        # Cone: |p + u w| <= here + growth u, a quadratic a u² + 2 b u + q <= 0.
        wx, wy, wz = c - da * ax, da * ay, s - da * az
        px, py, pz = mx - axial * ax, y + axial * ay, mz - axial * az
        here, growth = radius + taper * axial, taper * da
        a = wx * wx + wy * wy + wz * wz - growth * growth
        b = wx * px + wy * py + wz * pz - growth * here
        q = px * px + py * py + pz * pz - here * here
        root = b * b - a * q
        # The form without cancellation.
        big = -b - math.copysign(math.sqrt(root if root > 0.0 else 0.0), b)
        other = q / big
        one = big / a if a != 0.0 else other
        low, high = (one if one < other else other), (other if one < other else one)
        # Steeper than the cone, a ray stays inside on one side, where the radius grows.
        side_near = low if a > 0.0 else (high if growth > 0.0 else -math.inf)
        side_far = high if a > 0.0 else (math.inf if growth > 0.0 else low)
        side_near = side_near if big != 0.0 else (-math.inf if q < 0.0 else math.inf)
        side_far = side_far if big != 0.0 else (math.inf if q < 0.0 else -math.inf)
        # Slab between the ends.
        per_rate, between = 1.0 / da, (axial >= 0.0) & (axial <= length)
        first, last = -axial * per_rate, (length - axial) * per_rate
        slab_near, slab_far = (first if first < last else last), (last if first < last else first)
        slab_near = slab_near if da != 0.0 else (-math.inf if between else math.inf)
        slab_far = slab_far if da != 0.0 else (math.inf if between else -math.inf)
        on_side = side_near >= slab_near
        near, far = (side_near if on_side else slab_near), (side_far if side_far <= slab_far else slab_far)
        reached = middle + near
        met = (side_near < side_far) & (near < far) & (reached > 0.0) & (reached < math.inf)
        met = met & ((root >= 0.0) | (a <= 0.0))
        distance[i] = reached if met else math.inf
        if normals:
            # Outwards: the gradient of |p⊥|² − (radius + taper axial)² on the side, the axis on an end.
            px, pz = reached * c - x, reached * s - z
            axial = px * ax + pz * az - y * ay
            inwards = axial + taper * (radius + taper * axial)
            nx, ny, nz = px - inwards * ax, y + inwards * ay, pz - inwards * az
            squared = nx * nx + ny * ny + nz * nz
            per_norm = 1.0 / math.sqrt(squared)
            # The apex has no normal; the axis is the mean of the normals around it.
            end = tip if on_side else (-1.0 if da > 0.0 else 1.0)
            curved = on_side & (squared != 0.0)
            nx, nz = (nx * per_norm if curved else end * ax), (nz * per_norm if curved else end * az)
            incidence[i] = -(nx * c + nz * s) if met else 0.0
            lean[i] = s * nx - c * nz
