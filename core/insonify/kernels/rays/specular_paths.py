"""What comes after the first echo: rays that mirror-like surfaces turn and bodies let through.

At every hit the energy splits: R0² goes on as in a mirror, 1 − R0² refracts into a closed body by Snell's law with the
body's speed ratio ν, or is lost in the bed; beyond the critical angle all of it is reflected. A path X of length s,
on which a metre inside a body counts 1/ν because the record counts time, carries the share w of its energy to a point
P. There a tube of solid angle dΩ covers dA = a dΩ, where a follows from the tube's edges, through curved mirrors and
lenses too; it is s² / cos α on the far side of flat ones. Where d_X is the way X arrives, α its incidence and σ the
bistatic strength, P receives w / (a cos α) per area across X, and two ghosts of it come back:

- *retro*, out along X and back along it, at range s: σ(d_X, d_X) dA w² / (a cos α)²;
- *mixed*, out along X and straight back over the distance r, and the other way round, at range R = (s + r) / 2:
  2 σ(d_X, d_D) dA w / (a cos α r²), if P sees the sonar. Here a cancels: what a tube carries is kept.

The record's range factor, 1/R⁴ and absorption over 2R, comes after the sum as for every echo, so that the two enter as
w² σ s⁴ dΩ / (a cos² α) and 2 w σ R⁴ dΩ / (r² cos α). At a caustic, where a vanishes, it counts as no less than a share
of s². Law `light` spreads nothing: a ray stands for the step of range that P makes as its elevation grows,
|(d_X + d_D) · dP| / 2. A knife, 1 m wide at all ranges, knows the tube's width in elevation alone.

A surface scatters to the water alone, the bed's cells are flat mirrors, and the side of a mesh that faces inwards from
the water turns a ray but lets nothing through.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from insonify.kernels.beam.pattern import two_way_response
from insonify.kernels.common.jit import inlined, kernel
from insonify.kernels.common.scattering import bistatic_strength
from insonify.kernels.common.types import BED, LIGHT
from insonify.kernels.geometry.solids import exit_solid, intersect_solid, is_inside_solid
from insonify.kernels.geometry.triangles import NO_TRIANGLE, facing_normal, intersect_mesh
from insonify.kernels.rays.cell_walk import NOTHING, Ray, meet_bed
from insonify.kernels.rays.ray_differentials import (
    RayDifferential,
    differentiate_normal,
    reflect,
    refract,
    start_azimuth_differential,
    start_elevation_differential,
    transfer,
    tube_area,
)

WATER = -3  # where a path is that is in no body
OFFSET = 1e-13  # of all lengths, by which a path starts off the surface it leaves
CAUSTIC = 0.01  # of the area of a tube that nothing focuses: no less is counted
FAINTEST = 1e-6  # share of energy below which a path is dropped
KNIFE = 0.5  # m, half the along-track width of a knife
MOST_PARTS = 64  # bodies of one target that a path may cross at a stretch


class SpecularPath(NamedTuple):
    """A path on its way: where it is, at its last corner or arrived at the next surface, and what it carries."""

    x: float
    y: float
    z: float
    dx: float
    dy: float
    dz: float
    up: RayDifferential  # how it moves as its elevation at the sonar grows
    across: RayDifferential  # and at right angles to that
    length: float  # m of water that take as long as it has taken
    share: float  # of the energy that set out
    bounce: int
    inside: int  # body, counted as in Hits; WATER if none


class Intersection(NamedTuple):
    """What a path meets next."""

    distance: float
    body: int  # NOTHING if it meets nothing
    material: int
    nx: float  # unit normal on the path's side
    ny: float
    nz: float


class PathHit(NamedTuple):
    """One hit of one followed ray."""

    ray: int
    bounce: int
    x: float
    y: float
    z: float
    length: float
    share: float
    body: int


@kernel
def add_specular_echoes(arrays, beam, bundle, hits, weight, sums):
    """Follow the rays of one side beyond their first hits and sum the ghosts they bring."""
    fan, reach = arrays.half_width > 0.0, arrays.bins * arrays.bin_length
    for k in range(weight.size):
        if hits.body[k] == NOTHING or weight[k] == 0.0:
            continue
        meeting = Intersection(hits.distance[k], hits.body[k], hits.material[k], hits.nx[k], hits.ny[k], hits.nz[k])
        path = advance_to(arrays, start_path(bundle, k), meeting)
        waiting = [path]
        waiting.pop()
        _split(arrays, path, meeting, 2.0 * reach, waiting)
        if len(waiting) == 0:
            continue
        out = 1.0
        if arrays.pattern.tabulated:
            out = two_way_response(arrays.pattern, beam, fan, arrays.law, path.dx, path.dy, path.dz, path.length)
        while len(waiting) > 0:
            path = waiting.pop()
            # Beyond twice the range even a mixed ghost comes too late.
            meeting = _meet_next(arrays, path, 2.0 * reach - path.length)
            if meeting.body == NOTHING:
                continue
            path = advance_to(arrays, path, meeting)
            if path.inside == WATER:
                _add_retro_echo(arrays, fan, out * weight[k], path, meeting, sums)
                distance, value = mixed_echo(arrays, beam, fan, out, weight[k], path, meeting)
                b = int(distance / arrays.bin_length)
                if b < sums.size:
                    sums[b] += value
            _split(arrays, path, meeting, 2.0 * reach, waiting)


@kernel
def follow_specular_paths(arrays, bundle, reach):
    """Follow every ray until it fades or leaves; return all hits as columns of whole and of real numbers."""
    steps = [PathHit(0, 0, 0.0, 0.0, 0.0, 0.0, 0.0, 0)]
    steps.pop()
    for k in range(bundle.x.size):
        waiting = [start_path(bundle, k)]
        while len(waiting) > 0:
            path = waiting.pop()
            meeting = _meet_next(arrays, path, reach - path.length)
            if meeting.body == NOTHING:
                continue
            path = advance_to(arrays, path, meeting)
            steps.append(PathHit(k, path.bounce, path.x, path.y, path.z, path.length, path.share, meeting.body))
            _split(arrays, path, meeting, reach, waiting)
    whole, real = np.empty((3, len(steps)), np.int64), np.empty((5, len(steps)))
    for n, step in enumerate(steps):
        whole[0, n], whole[1, n], whole[2, n] = step.ray, step.bounce, step.body
        real[0, n], real[1, n], real[2, n] = step.x, step.y, step.z
        real[3, n], real[4, n] = step.length, step.share
    return whole, real


@inlined
def start_path(bundle, k):
    """Ray k as a path that begins."""
    dx, dy, dz = bundle.dx[k], bundle.dy[k], bundle.dz[k]
    up, across = start_elevation_differential(dx, dy, dz), start_azimuth_differential(dx, dy)
    return SpecularPath(bundle.x[k], bundle.y[k], bundle.z[k], dx, dy, dz, up, across, 0.0, 1.0, 0, WATER)


@inlined
def advance_to(arrays, path, meeting):
    """Go to where a path meets what it meets."""
    t, nx, ny, nz = meeting.distance, meeting.nx, meeting.ny, meeting.nz
    dx, dy, dz = path.dx, path.dy, path.dz
    up, across = transfer(path.up, t, dx, dy, dz, nx, ny, nz), transfer(path.across, t, dx, dy, dz, nx, ny, nz)
    length = path.length + t * _slowness(arrays, path)
    return SpecularPath(
        path.x + t * dx, path.y + t * dy, path.z + t * dz, dx, dy, dz, up, across, length, path.share, path.bounce,
        path.inside,
    )  # fmt: skip


@inlined
def _offset_from_surface(x, y, z, length):
    """How far off a surface a path starts, so that rounding does not put it on the other side."""
    return OFFSET * (1.0 + abs(x) + abs(y) + abs(z) + length)


@inlined
def _slowness(arrays, path):
    """Time of a metre where a path is, in metres of water."""
    return 1.0 if path.inside == WATER else 1.0 / arrays.interface[_material(arrays, path.inside), 1]


@inlined
def _material(arrays, body):
    """Row of a body's material."""
    solids = arrays.solids.shape.size
    return arrays.solids.material[body] if body < solids else arrays.mesh.material[body - solids]


@kernel
def _split(arrays, path, meeting, longest, waiting):
    """Queue what goes on from a hit: the mirrored part, and the refracted one if there is a closed body."""
    if path.bounce >= arrays.bounces or path.length >= longest:
        return
    cosine = -(meeting.nx * path.dx + meeting.ny * path.dy + meeting.nz * path.dz)
    mirrored = arrays.interface[meeting.material, 0] ** 2
    if _lets_through(arrays, path, meeting):
        ratio = arrays.interface[meeting.material, 1]
        speeds = ratio if path.inside == WATER else 1.0 / ratio
        root = 1.0 - speeds * speeds * (1.0 - cosine * cosine)
        if root <= 0.0:
            mirrored = 1.0
        elif path.share * (1.0 - mirrored) >= FAINTEST:
            waiting.append(_refract_path(arrays, path, meeting, cosine, speeds, math.sqrt(root), 1.0 - mirrored))
    if path.share * mirrored >= FAINTEST:
        waiting.append(_reflect_path(arrays, path, meeting, cosine, mirrored))


@inlined
def _reflect_path(arrays, path, meeting, cosine, share):
    """Turn a path that has arrived as a mirror does."""
    nx, ny, nz, dx, dy, dz = meeting.nx, meeting.ny, meeting.nz, path.dx, path.dy, path.dz
    off = _offset_from_surface(path.x, path.y, path.z, path.length)
    up = reflect(path.up, cosine, dx, dy, dz, nx, ny, nz, _differentiate_normal(arrays, path, path.up, meeting))
    across = reflect(
        path.across, cosine, dx, dy, dz, nx, ny, nz, _differentiate_normal(arrays, path, path.across, meeting)
    )
    return SpecularPath(
        path.x + off * nx, path.y + off * ny, path.z + off * nz,
        dx + 2.0 * cosine * nx, dy + 2.0 * cosine * ny, dz + 2.0 * cosine * nz, up, across,
        path.length, path.share * share, path.bounce + 1, path.inside if path.inside == WATER else meeting.body,
    )  # fmt: skip


@inlined
def _refract_path(arrays, path, meeting, cosine, speeds, root, share):
    """Pass a path that has arrived into a body, or out of it: Snell's law in vectors."""
    nx, ny, nz, dx, dy, dz = meeting.nx, meeting.ny, meeting.nz, path.dx, path.dy, path.dz
    off = _offset_from_surface(path.x, path.y, path.z, path.length)
    bend = speeds * cosine - root
    bent, bent_across = (
        _differentiate_normal(arrays, path, path.up, meeting),
        _differentiate_normal(arrays, path, path.across, meeting),
    )
    up = refract(path.up, cosine, speeds, root, dx, dy, dz, nx, ny, nz, bent)
    across = refract(path.across, cosine, speeds, root, dx, dy, dz, nx, ny, nz, bent_across)
    return SpecularPath(
        path.x - off * nx, path.y - off * ny, path.z - off * nz,
        speeds * dx + bend * nx, speeds * dy + bend * ny, speeds * dz + bend * nz, up, across,
        path.length, path.share * share, path.bounce + 1, meeting.body if path.inside == WATER else WATER,
    )  # fmt: skip


@inlined
def _differentiate_normal(arrays, path, edge, meeting):
    """How the normal moves with an edge's place: facets and cells are flat."""
    if not 0 <= meeting.body < arrays.solids.shape.size:
        return 0.0, 0.0, 0.0
    return differentiate_normal(
        arrays.solids, meeting.body, edge, path.x, path.y, path.z, meeting.nx, meeting.ny, meeting.nz
    )


@inlined
def _lets_through(arrays, path, meeting):
    """Whether there is water, or a body, behind what is met."""
    triangle = meeting.body - arrays.solids.shape.size
    if path.inside != WATER or triangle < 0:
        return meeting.body != BED
    normal = arrays.mesh.normal[triangle]
    return normal[0] * path.dx + normal[1] * path.dy + normal[2] * path.dz < 0.0


@inlined
def _meet_next(arrays, path, reach):
    """Meet what a path comes to within ``reach``, from outside or inside."""
    if path.inside == WATER:
        return meet_scene(arrays, path.x, path.y, path.z, path.dx, path.dy, path.dz, reach)
    if path.inside < arrays.solids.shape.size:
        return _leave_solids(arrays.solids, path)
    return _leave_mesh(arrays, path)


@kernel
def meet_scene(arrays, x, y, z, dx, dy, dz, reach):
    """Meet the nearest thing within ``reach``."""
    best, body, material, mx, my, mz = reach, NOTHING, 0, 0.0, 0.0, 0.0
    for k in range(arrays.solids.shape.size):
        distance, nx, ny, nz = intersect_solid(arrays.solids, k, x, y, z, dx, dy, dz)
        if distance < best:
            best, body, material, mx, my, mz = distance, k, arrays.solids.material[k], nx, ny, nz
    best, triangle = intersect_mesh(arrays.mesh, x, y, z, dx, dy, dz, best)
    if triangle != NO_TRIANGLE:
        body, material = arrays.solids.shape.size + triangle, arrays.mesh.material[triangle]
        mx, my, mz = facing_normal(arrays.mesh, triangle, dx, dy, dz)
    distance, row, nx, ny, nz = meet_bed(arrays.bed, Ray(x, y, z, dx, dy, dz), best)
    if distance < best:
        return Intersection(distance, BED, row, nx, ny, nz)
    return Intersection(best, body, material, mx, my, mz)


@kernel
def _leave_solids(solids, path):
    """Leave a body; where another of the same target goes on, leave that."""
    body, total = path.inside, 0.0
    x, y, z = path.x, path.y, path.z
    off = _offset_from_surface(x, y, z, path.length)
    for _ in range(MOST_PARTS):
        distance, nx, ny, nz = exit_solid(solids, body, x, y, z, path.dx, path.dy, path.dz)
        if not distance < math.inf:
            break
        total += distance + off
        x, y, z = path.x + total * path.dx, path.y + total * path.dy, path.z + total * path.dz
        other = _solid_of_target_at(solids, solids.target[body], x, y, z)
        if other < 0:
            return Intersection(total - off, body, solids.material[body], -nx, -ny, -nz)
        body = other
    return Intersection(math.inf, NOTHING, 0, 0.0, 0.0, 0.0)


@inlined
def _solid_of_target_at(solids, target, x, y, z):
    """Row of a target's body that a point is inside, -1 if none."""
    for k in range(solids.shape.size):
        if solids.target[k] == target and is_inside_solid(solids, k, x, y, z):
            return k
    return -1


@kernel
def _leave_mesh(arrays, path):
    """Leave a mesh through the nearest of its triangles that faces the other way."""
    mesh, solids = arrays.mesh, arrays.solids.shape.size
    target, total = mesh.target[path.inside - solids], 0.0
    off = _offset_from_surface(path.x, path.y, path.z, path.length)
    for _ in range(MOST_PARTS):
        distance, triangle = intersect_mesh(
            mesh, path.x + total * path.dx, path.y + total * path.dy, path.z + total * path.dz,
            path.dx, path.dy, path.dz, math.inf,
        )  # fmt: skip
        if triangle == NO_TRIANGLE:
            break
        total += distance
        normal = mesh.normal[triangle]
        outwards = normal[0] * path.dx + normal[1] * path.dy + normal[2] * path.dz
        if mesh.target[triangle] == target and outwards > 0.0:
            return Intersection(total, solids + triangle, mesh.material[triangle], -normal[0], -normal[1], -normal[2])
        total += off
    return Intersection(math.inf, NOTHING, 0, 0.0, 0.0, 0.0)


@inlined
def _add_retro_echo(arrays, fan, weight, path, meeting, sums):
    """Add what returns along the path itself, of one that has arrived."""
    b = int(path.length / arrays.bin_length)
    cosine = -(meeting.nx * path.dx + meeting.ny * path.dy + meeting.nz * path.dz)
    if b >= sums.size or cosine <= 0.0:
        return
    row = arrays.reflectivity[meeting.material]
    value = bistatic_strength(cosine, cosine, 2.0 * cosine * cosine - 1.0, row[0], row[1], row[2], arrays.law)
    value *= path.share * path.share * weight
    up, squared = path.up, path.length * path.length
    if arrays.law == LIGHT:
        value *= abs(up.x * path.dx + up.y * path.dy + up.z * path.dz) / arrays.bin_length
    elif fan:
        value *= squared * squared / (cosine * max(tube_area(up, path.across) * cosine, CAUSTIC * squared))
    else:
        width = math.sqrt(up.x * up.x + up.y * up.y + up.z * up.z)
        value *= squared / (cosine * max(width * cosine, CAUSTIC * path.length))
    sums[b] += value


@inlined
def mixed_echo(arrays, beam, fan, out, weight, path, meeting):
    """Slant range and strength of what goes out along a path that has arrived and straight back, or the other way."""
    sx, sy, sz = path.x - beam.x, path.y - beam.y, path.z - beam.z
    r, nx, ny, nz = math.sqrt(sx * sx + sy * sy + sz * sz), meeting.nx, meeting.ny, meeting.nz
    sx, sy, sz, distance = sx / r, sy / r, sz / r, 0.5 * (path.length + r)
    cosine, straight = -(nx * path.dx + ny * path.dy + nz * path.dz), -(nx * sx + ny * sy + nz * sz)
    if distance >= arrays.bins * arrays.bin_length or cosine <= 0.0 or straight <= 0.0:
        return distance, 0.0
    passed = pair_sensitivity(arrays, beam, fan, out, sx, sy, sz, r)
    if passed == 0.0:
        return distance, 0.0
    off = _offset_from_surface(path.x, path.y, path.z, path.length)
    blocker = meet_scene(arrays, path.x + off * nx, path.y + off * ny, path.z + off * nz, -sx, -sy, -sz, r)
    if blocker.body != NOTHING:
        return distance, 0.0
    row, up = arrays.reflectivity[meeting.material], path.up
    mirrored = 2.0 * cosine * straight - (sx * path.dx + sy * path.dy + sz * path.dz)
    value = bistatic_strength(cosine, straight, mirrored, row[0], row[1], row[2], arrays.law)
    value += bistatic_strength(straight, cosine, mirrored, row[0], row[1], row[2], arrays.law)
    value *= path.share * passed * weight
    if arrays.law == LIGHT:
        rate = up.x * (path.dx + sx) + up.y * (path.dy + sy) + up.z * (path.dz + sz)
        value *= 0.5 * abs(rate) / arrays.bin_length
    else:
        value *= (distance * distance / r) ** 2 / (cosine * (1.0 if fan else path.length))
    return distance, value


@inlined
def pair_sensitivity(arrays, beam, fan, out, sx, sy, sz, r):
    """Sensitivity of the beam to what leaves one way and returns another, the mean of both orders."""
    if sx * beam.side_x + sy * beam.side_y < 0.0:
        return 0.0
    along = sx * beam.axis_x + sy * beam.axis_y + sz * beam.axis_z
    one_way = arrays.pattern.tabulated and not arrays.pattern.two_way
    wide = 0.0 if fan else KNIFE / r
    if not one_way and not beam.s_low - wide <= along <= beam.s_high + wide:
        return 0.0
    if not arrays.pattern.tabulated:
        return 1.0
    back = two_way_response(arrays.pattern, beam, fan, arrays.law, sx, sy, sz, r)
    return math.sqrt(out * back) if arrays.pattern.two_way else 0.5 * (out + back)
