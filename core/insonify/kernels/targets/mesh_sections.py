"""Cross-sections of triangle meshes by one vertical half-plane: a straight line from each triangle that it cuts."""

from __future__ import annotations

import math

from insonify.compiler.jit import INTEGER, inlined_uncounted, kernel_on_demand

SAME = 1e-9  # rad; ends of primitives closer together are one


@kernel_on_demand(INTEGER)
def cut_mesh(mesh, first_body, plane, reach, zbuffer, primitives):
    """Add the lines in which a plane cuts the triangles ahead of the sonar to the primitives of a z-buffer."""
    node = 0
    while node < mesh.skip.size:
        if not _may_cut_box(mesh.low[node], mesh.high[node], plane, reach):
            node = mesh.skip[node]
            continue
        for k in range(mesh.first[node], mesh.first[node] + mesh.held[node]):
            primitives = _cut_triangle(mesh.corners[k], first_body + k, plane, zbuffer, primitives)
        node += 1
    return primitives


@inlined_uncounted
def _may_cut_box(low, high, plane, reach):
    """Whether a plane may cut a box ahead of the sonar, within reach."""
    cx, cy = 0.5 * (low[0] + high[0]) - plane.x, 0.5 * (low[1] + high[1]) - plane.y
    hx, hy = 0.5 * (high[0] - low[0]), 0.5 * (high[1] - low[1])
    wide, long = hx * abs(plane.ey) + hy * abs(plane.ex), hx * abs(plane.ex) + hy * abs(plane.ey)
    across, along = cx * plane.ey - cy * plane.ex, cx * plane.ex + cy * plane.ey
    return abs(across) <= wide and -long <= along <= reach + long


@inlined_uncounted
def _cut_triangle(corners, body, plane, zbuffer, primitives):
    """Add the line in which the plane cuts one triangle, if it does; return the number of primitives."""
    ends = 0
    for k in range(3):
        following = k + 1 if k < 2 else 0
        here, there = _signed_distance(corners[k], plane), _signed_distance(corners[following], plane)
        if (here < 0.0) == (there < 0.0):
            continue
        # From the negative side to the positive: both triangles at an edge find the same point to the last bit.
        a, b = (k, following) if here < 0.0 else (following, k)
        below, above = min(here, there), max(here, there)
        share = below / (below - above)
        px = corners[a, 0] + (corners[b, 0] - corners[a, 0]) * share - plane.x
        py = corners[a, 1] + (corners[b, 1] - corners[a, 1]) * share - plane.y
        zbuffer.line[primitives, 2 * ends] = px * plane.ex + py * plane.ey
        zbuffer.line[primitives, 2 * ends + 1] = corners[a, 2] + (corners[b, 2] - corners[a, 2]) * share - plane.z
        ends += 1
        if ends == 2:
            break
    if ends < 2 or not _clip_ahead(zbuffer.line[primitives]):
        return primitives
    line = zbuffer.line[primitives]
    one, other = math.atan2(line[1], line[0]), math.atan2(line[3], line[2])
    if abs(one - other) <= SAME:
        return primitives  # seen edge-on
    zbuffer.body[primitives], zbuffer.low[primitives], zbuffer.high[primitives] = body, min(one, other), max(one, other)
    return primitives + 1


@inlined_uncounted
def _signed_distance(corner, plane):
    """Signed distance of a corner from the plane."""
    return (corner[0] - plane.x) * plane.ey - (corner[1] - plane.y) * plane.ex


@inlined_uncounted
def _clip_ahead(line):
    """Cut off what of a line lies behind the sonar; return whether anything is left."""
    if line[0] <= 0.0 and line[2] <= 0.0:
        return False
    if line[0] < 0.0:
        line[1] -= line[0] * (line[3] - line[1]) / (line[2] - line[0])
        line[0] = 0.0
    elif line[2] < 0.0:
        line[3] -= line[2] * (line[1] - line[3]) / (line[0] - line[2])
        line[2] = 0.0
    return True
