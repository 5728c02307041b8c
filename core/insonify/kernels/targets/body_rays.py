"""Rays of one plane to a convex body, many at once: the arithmetic of `meet_primitive` without branches.

Branches would keep the compiler from its vector units: ray by ray, a pipe's z-buffer takes four times as long.

Theory: docs/theory/sweep.md.
"""

import math

from insonify.compiler.jit import inlined_uncounted
from insonify.kernels.common.types import SPHERE
from insonify.kernels.targets.apparent_targets import arrival_direction


@inlined_uncounted
def meet_body(body, count, normals, distance, incidence, lean):
    """Slant range of a body along many rays of its plane, and the inward normal there, as parts within the plane."""
    source = body.source
    if source.bent:
        for i in range(count):
            distance[i], incidence[i] = arrival_direction(source, distance[i], incidence[i])
    if body.kind == SPHERE:
        _meet_sphere(body, count, normals, distance, incidence, lean)
    else:
        _meet_frustum(body, count, normals, distance, incidence, lean)
    if source.bent:
        for i in range(count):
            distance[i] = source.offset + source.gauge * distance[i]


@inlined_uncounted
def _in_plane(x, y, ex, ey):
    """Parts of a level vector along the plane's azimuth and at right angles to the plane."""
    return x * ex + y * ey, y * ex - x * ey


@inlined_uncounted
def _meet_sphere(body, count, normals, distance, incidence, lean):
    """Rays to a sphere, as `intersect_sphere` meets it with one."""
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
def _meet_frustum(body, count, normals, distance, incidence, lean):
    """Rays to a frustum, as `intersect_frustum` meets it with one: the stretch inside both a cone and a slab."""
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
