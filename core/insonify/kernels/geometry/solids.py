"""Analytic convex bodies: where rays enter and leave them, distances, normals and their change, and what is inside."""

import math
from typing import NamedTuple

from insonify.compiler.jit import inlined, inlined_uncounted, kernel
from insonify.kernels.common.types import SPHERE

MISSED = math.inf
SIDE, FIRST_END, LAST_END = 0, -1, 1
TINY = 1e-300  # m; at the very tip of a cone nothing points away from the axis


class FrustumShape(NamedTuple):
    """A cylinder, a cone or a truncated cone, as scalars."""

    x: float  # centre of its first end, from the origin of the line or plane
    y: float
    z: float
    ax: float  # unit vector along its axis
    ay: float
    az: float
    length: float
    radius: float  # of its first end
    taper: float  # by which the radius grows per metre along the axis


@kernel
def highest_place(arrays):
    """Height above the datum that nothing of a scene's bed and targets exceeds, m."""
    solids, highest = arrays.solids, arrays.bed.high
    for k in range(solids.shape.size):
        rise, growth = solids.length[k] * solids.axis[k, 2], solids.length[k] * solids.taper[k]
        top = solids.start[k, 2] + max(rise, 0.0) + solids.radius[k] + max(growth, 0.0)
        highest = max(highest, top)
    if arrays.mesh.target.size > 0:
        highest = max(highest, arrays.mesh.high[0, 2])
    return highest


@inlined_uncounted
def intersect_solid(solids, k, x, y, z, dx, dy, dz):
    """Intersect a ray with a body from outside."""
    distance, face, _, _ = _cross_solid(solids, k, x, y, z, dx, dy, dz)
    return _hit(solids, k, distance, face, x, y, z, dx, dy, dz)


@inlined_uncounted
def exit_solid(solids, k, x, y, z, dx, dy, dz):
    """Intersect a ray with the far side of a body, from inside it."""
    _, _, distance, face = _cross_solid(solids, k, x, y, z, dx, dy, dz)
    return _hit(solids, k, distance, face, x, y, z, dx, dy, dz)


@inlined_uncounted
def _hit(solids, k, distance, face, x, y, z, dx, dy, dz):
    """Distance of a body along a ray, and the outward normal there."""
    if not 0.0 < distance < MISSED:
        return MISSED, 0.0, 0.0, 0.0
    nx, ny, nz = _normal(solids, k, face, x + distance * dx, y + distance * dy, z + distance * dz)
    return distance, nx, ny, nz


@inlined_uncounted
def greatest_radius(solids, k):
    """Greatest radius of a body."""
    return max(solids.radius[k], solids.radius[k] + solids.taper[k] * solids.length[k])


@inlined_uncounted
def distance_to_solid(solids, k, x, y, z):
    """Distance from a point outside a body to its nearest place."""
    px, py, pz = x - solids.start[k, 0], y - solids.start[k, 1], z - solids.start[k, 2]
    radius, length, taper, squared = solids.radius[k], solids.length[k], solids.taper[k], px * px + py * py + pz * pz
    if solids.shape[k] == SPHERE:
        return math.sqrt(squared) - radius
    along = px * solids.axis[k, 0] + py * solids.axis[k, 1] + pz * solids.axis[k, 2]
    off_axis = math.sqrt(max(squared - along * along, 0.0))
    beyond = max(-along, along - length)
    if beyond > 0.0 and off_axis <= (radius if along < 0.0 else radius + taper * length):
        return beyond
    foot = min(max((along + taper * (off_axis - radius)) / (1.0 + taper * taper), 0.0), length)
    return math.hypot(along - foot, off_axis - radius - taper * foot)


@kernel
def signed_distance(solids, k, x, y, z):
    """Distance of a point from the surface of a body, negative inside; beyond a rim, from the nearer face extended."""
    px, py, pz, along = _off_axis(solids, k, x, y, z)
    side = _distance_to_side(solids, k, math.sqrt(px * px + py * py + pz * pz), along)
    return side if solids.shape[k] == SPHERE else max(side, max(-along, along - solids.length[k]))


@kernel
def nearest_normal(solids, k, x, y, z):
    """Outward normal of the surface of a body nearest to a point."""
    px, py, pz, along = _off_axis(solids, k, x, y, z)
    radial = math.sqrt(px * px + py * py + pz * pz)
    ax, ay, az, taper = solids.axis[k, 0], solids.axis[k, 1], solids.axis[k, 2], solids.taper[k]
    cap = max(-along, along - solids.length[k])
    if solids.shape[k] != SPHERE and cap > _distance_to_side(solids, k, radial, along):
        end = -1.0 if -along > along - solids.length[k] else 1.0
        return end * ax, end * ay, end * az
    norm, radial = math.sqrt(1.0 + taper * taper), max(radial, TINY)
    return (px / radial - taper * ax) / norm, (py / radial - taper * ay) / norm, (pz / radial - taper * az) / norm


@kernel
def _off_axis(solids, k, x, y, z):
    """Point from a body's start: across its axis and along it."""
    px, py, pz = x - solids.start[k, 0], y - solids.start[k, 1], z - solids.start[k, 2]
    along = px * solids.axis[k, 0] + py * solids.axis[k, 1] + pz * solids.axis[k, 2]
    return px - along * solids.axis[k, 0], py - along * solids.axis[k, 1], pz - along * solids.axis[k, 2], along


@kernel
def _distance_to_side(solids, k, radial, along):
    """Distance of a point from the side of a body, by how far off its axis and along it the point is."""
    taper = solids.taper[k]
    return (radial - solids.radius[k] - taper * along) / math.sqrt(1.0 + taper * taper)


@inlined
def normal_change(solids, k, point, normal, shift):
    """Change of a body's normal at a point along a shift of the point; zero on the flat ends."""
    (x, y, z), (nx, ny, nz), (sx, sy, sz) = point, normal, shift
    px, py, pz = x - solids.start[k, 0], y - solids.start[k, 1], z - solids.start[k, 2]
    if solids.shape[k] == SPHERE:
        # Positive where the normal points outwards.
        over = math.copysign(1.0 / solids.radius[k], px * nx + py * ny + pz * nz)
        return sx * over, sy * over, sz * over
    ax, ay, az, taper = solids.axis[k, 0], solids.axis[k, 1], solids.axis[k, 2], solids.taper[k]
    slope = math.sqrt(1.0 + taper * taper)
    if abs(abs(nx * ax + ny * ay + nz * az) * slope - abs(taper)) > 1e-6 * slope:
        return 0.0, 0.0, 0.0
    rx, ry, rz, _ = _off_axis(solids, k, x, y, z)
    radius = max(math.sqrt(rx * rx + ry * ry + rz * rz), TINY)
    # The side is curved around the axis and straight along it.
    cx, cy, cz = (ay * rz - az * ry) / radius, (az * rx - ax * rz) / radius, (ax * ry - ay * rx) / radius
    over = math.copysign(1.0 / (radius * slope), rx * nx + ry * ny + rz * nz)
    over *= sx * cx + sy * cy + sz * cz
    return over * cx, over * cy, over * cz


@inlined_uncounted
def reach_of_solid(solids, k, x, y, z):
    """Distance from a point beyond which nothing of a body lies."""
    px, py, pz, length = solids.start[k, 0] - x, solids.start[k, 1] - y, solids.start[k, 2] - z, solids.length[k]
    qx, qy, qz = px + length * solids.axis[k, 0], py + length * solids.axis[k, 1], pz + length * solids.axis[k, 2]
    return math.sqrt(max(px * px + py * py + pz * pz, qx * qx + qy * qy + qz * qz)) + greatest_radius(solids, k)


@inlined_uncounted
def is_inside_solid(solids, k, x, y, z):
    """Whether a point is inside a body."""
    px, py, pz = x - solids.start[k, 0], y - solids.start[k, 1], z - solids.start[k, 2]
    along = px * solids.axis[k, 0] + py * solids.axis[k, 1] + pz * solids.axis[k, 2]
    if solids.shape[k] != SPHERE and not 0.0 <= along <= solids.length[k]:
        return False
    return px * px + py * py + pz * pz - along * along <= (solids.radius[k] + solids.taper[k] * along) ** 2


@kernel
def find_enclosing_solid(solids, x, y, z):
    """First solid that any of several points is inside, -1 if there is none."""
    for n in range(x.size):
        for k in range(solids.shape.size):
            if is_inside_solid(solids, k, x[n], y[n], z[n]):
                return k
    return -1


@inlined_uncounted
def _cross_solid(solids, k, x, y, z, dx, dy, dz):
    """Distances and faces at which a line enters a body and leaves it: (distance, face, distance, face)."""
    cx, cy, cz = solids.start[k, 0] - x, solids.start[k, 1] - y, solids.start[k, 2] - z
    if solids.shape[k] == SPHERE:
        near, far = intersect_sphere(cx, cy, cz, solids.radius[k], dx, dy, dz)
        return near, SIDE, far, SIDE
    ax, ay, az = solids.axis[k, 0], solids.axis[k, 1], solids.axis[k, 2]
    frustum = FrustumShape(cx, cy, cz, ax, ay, az, solids.length[k], solids.radius[k], solids.taper[k])
    return intersect_frustum(frustum, dx, dy, dz)


@inlined_uncounted
def _normal(solids, k, face, x, y, z):
    """Outward unit normal of a body at a point of one of its faces."""
    px, py, pz = x - solids.start[k, 0], y - solids.start[k, 1], z - solids.start[k, 2]
    if solids.shape[k] == SPHERE:
        return px / solids.radius[k], py / solids.radius[k], pz / solids.radius[k]
    ax, ay, az = solids.axis[k, 0], solids.axis[k, 1], solids.axis[k, 2]
    return frustum_normal(px, py, pz, ax, ay, az, solids.radius[k], solids.taper[k], face)


@kernel
def intersect_sphere(cx, cy, cz, radius, dx, dy, dz):
    """Distances at which a line enters a sphere and leaves it."""
    along = cx * dx + cy * dy + cz * dz
    # The perpendicular, not c² − along², keeps its digits far away.
    px, py, pz = cx - along * dx, cy - along * dy, cz - along * dz
    root = radius * radius - (px * px + py * py + pz * pz)
    if root < 0.0:
        return MISSED, MISSED
    root = math.sqrt(root)
    return along - root, along + root


@kernel
def intersect_frustum(frustum, dx, dy, dz):
    """Distances and faces at which a line enters a frustum and leaves it."""
    # A frustum is the intersection of a cone and a slab. The stretch of a line inside it is the intersection of its
    # stretches inside both, so that no ray slips between the side and an end at the rim.
    cx, cy, cz, ax, ay, az, length, radius, taper = frustum
    da = dx * ax + dy * ay + dz * az
    # Counted from where the line passes the middle, so that far away no digits are lost.
    middle = cx * dx + cy * dy + cz * dz + 0.5 * length * da
    mx, my, mz = middle * dx - cx, middle * dy - cy, middle * dz - cz
    axial = mx * ax + my * ay + mz * az
    side_near, side_far = _inside_cone(
        dx - da * ax, dy - da * ay, dz - da * az,
        mx - axial * ax, my - axial * ay, mz - axial * az,
        radius + taper * axial, taper * da,
    )  # fmt: skip
    if not side_near < side_far:
        return MISSED, SIDE, MISSED, SIDE
    near, far = _between(axial, da, length)
    first, last = (FIRST_END, LAST_END) if da > 0.0 else (LAST_END, FIRST_END)
    if side_near >= near:
        near, first = side_near, SIDE
    if side_far <= far:
        far, last = side_far, SIDE
    if not near < far:
        return MISSED, SIDE, MISSED, SIDE
    return middle + near, first, middle + far, last


@kernel
def _between(axial, rate, length):
    """Stretch of a line on which its axial coordinate lies within the frustum's."""
    if rate == 0.0:
        return (-math.inf, math.inf) if 0.0 <= axial <= length else (math.inf, -math.inf)
    per_axial = 1.0 / rate
    one, other = -axial * per_axial, (length - axial) * per_axial
    return min(one, other), max(one, other)


@kernel
def _inside_cone(ex, ey, ez, px, py, pz, radius, growth):
    """Stretch of a line on which |p + u e| <= radius + growth u: a quadratic a u² + 2 b u + c <= 0."""
    a = ex * ex + ey * ey + ez * ez - growth * growth
    b = ex * px + ey * py + ez * pz - growth * radius
    c = px * px + py * py + pz * pz - radius * radius
    root = b * b - a * c
    if root < 0.0:
        if a > 0.0:
            return math.inf, -math.inf
        root = 0.0
    # The form without cancellation.
    big = -b - math.copysign(math.sqrt(root), b)
    if big == 0.0:
        return (-math.inf, math.inf) if c < 0.0 else (math.inf, -math.inf)
    other = c / big
    one = big / a if a != 0.0 else other
    if a > 0.0:
        return min(one, other), max(one, other)
    # Steeper than the cone: it stays inside on one side, where the radius grows; the other side is the cone's mirror.
    return (max(one, other), math.inf) if growth > 0.0 else (-math.inf, min(one, other))


@kernel
def frustum_normal(px, py, pz, ax, ay, az, radius, taper, face):
    """Outward unit normal of a frustum's face."""
    if face != SIDE:
        return face * ax, face * ay, face * az
    axial = px * ax + py * ay + pz * az
    # Gradient of |p⊥|² − (radius + taper axial)².
    lean = axial + taper * (radius + taper * axial)
    nx, ny, nz = px - lean * ax, py - lean * ay, pz - lean * az
    squared = nx * nx + ny * ny + nz * nz
    if squared == 0.0:
        # The apex has no normal; the axis is the mean of the normals around it.
        tip = -math.copysign(1.0, taper)
        return tip * ax, tip * ay, tip * az
    per_norm = 1.0 / math.sqrt(squared)
    return nx * per_norm, ny * per_norm, nz * per_norm
