"""What comes after the first echo: rays that mirror-like surfaces turn and bodies let through.

At every hit the energy splits: R0² goes on as in a mirror, 1 − R0² refracts into a closed body by Snell's law with the
body's speed ratio ν, or is lost in the bed; beyond the critical angle all of it is reflected. A path X of length s,
on which a metre inside a body counts 1/ν because the record counts time, carries the share w of its energy to a point
P. Two ghosts of P come back, where d_X is the way X arrives, α_X its incidence and σ the bistatic strength:

- *retro*, out along X and back along it, at range s. A flat mirror shows P to an image of the sonar at distance s, so
  that a tube of solid angle dΩ lights dA = s² dΩ / cos α_X, and w² σ(d_X, d_X) dA / s⁴ returns;
- *mixed*, out along X and straight back over the distance r, and the other way round, at range R = (s + r) / 2:
  2 w σ(d_X, d_D) dA / (s² r²), if P sees the sonar.

The record's range factor, 1/R⁴ and absorption over 2R, comes after the sum as for every echo, so that here the two are
w² σ dA and 2 w σ dA R⁴ / (s² r²). Law `light` spreads nothing: a ray stands for the step of range that P makes as its
elevation grows, |(d_X + d_D) · dP| / 2, where dP follows from the elevation's own direction, turned like the ray.

How curved mirrors and refraction widen or focus a tube is not followed: s² dΩ is that of flat ones. A surface scatters
to the water alone; meeting the side of a mesh that faces inwards from the water turns a ray but lets nothing through.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from insonify.kernels.beam import heard
from insonify.kernels.jit import fused, kernel
from insonify.kernels.scatter import bistatic
from insonify.kernels.shapes import leave_solid, meet_solid, within
from insonify.kernels.triangles import NO_TRIANGLE, facing, meet_mesh
from insonify.kernels.types import BED, LIGHT
from insonify.kernels.walk import NOTHING, Ray, meet_bed

WATER = -3  # where a path is that is in no body
OFFSET = 1e-13  # of all lengths, by which a path starts off the surface it leaves
FAINTEST = 1e-6  # share of energy below which a path is dropped
KNIFE = 0.5  # m, half the along-track width of a knife
MOST_PARTS = 64  # bodies of one target that a path may cross at a stretch


class Path(NamedTuple):
    """A path on its way: its last corner, where it goes from there, and what it carries."""

    x: float
    y: float
    z: float
    dx: float
    dy: float
    dz: float
    ex: float  # the way its end moves as its elevation at the sonar grows
    ey: float
    ez: float
    length: float  # m of water that take as long as it has taken
    share: float  # of the energy that set out
    bounce: int
    inside: int  # body, counted as in Hits; WATER if none


class Meeting(NamedTuple):
    """What a path meets next."""

    distance: float
    body: int  # NOTHING if it meets nothing
    material: int
    nx: float  # unit normal on the path's side
    ny: float
    nz: float


class Step(NamedTuple):
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
def add_ghosts(problem, beam, bundle, hits, weight, sums):
    """Follow the rays of one side beyond their first hits and sum the ghosts they bring."""
    fan, reach = problem.half_width > 0.0, problem.bins * problem.bin_length
    for k in range(weight.size):
        if hits.body[k] == NOTHING or weight[k] == 0.0:
            continue
        start = _set_out(bundle, k)
        waiting = [start]
        waiting.pop()
        _split(problem, start, _as_meeting(hits, k), 2.0 * reach, waiting)
        if len(waiting) == 0:
            continue
        out = 1.0
        if problem.pattern.tabled:
            out = heard(problem.pattern, beam, fan, problem.law, start.dx, start.dy, start.dz, hits.distance[k])
        while len(waiting) > 0:
            path = waiting.pop()
            # Beyond twice the range even a mixed ghost comes too late.
            meeting = _meet_next(problem, path, 2.0 * reach - path.length)
            if meeting.body == NOTHING:
                continue
            if path.inside == WATER:
                _add_retro(problem, fan, out * weight[k], path, meeting, sums)
                _add_mixed(problem, beam, fan, out, weight[k], path, meeting, sums)
            _split(problem, path, meeting, 2.0 * reach, waiting)


@kernel
def follow_paths(problem, bundle, reach):
    """Follow every ray until it fades or leaves; return all hits as columns of whole and of real numbers."""
    steps = [Step(0, 0, 0.0, 0.0, 0.0, 0.0, 0.0, 0)]
    steps.pop()
    for k in range(bundle.x.size):
        waiting = [_set_out(bundle, k)]
        while len(waiting) > 0:
            path = waiting.pop()
            meeting = _meet_next(problem, path, reach - path.length)
            if meeting.body == NOTHING:
                continue
            x, y, z = _end(path, meeting)
            length = path.length + meeting.distance * _slowness(problem, path)
            steps.append(Step(k, path.bounce, x, y, z, length, path.share, meeting.body))
            _split(problem, path, meeting, reach, waiting)
    whole, real = np.empty((3, len(steps)), np.int64), np.empty((5, len(steps)))
    for n, step in enumerate(steps):
        whole[0, n], whole[1, n], whole[2, n] = step.ray, step.bounce, step.body
        real[0, n], real[1, n], real[2, n] = step.x, step.y, step.z
        real[3, n], real[4, n] = step.length, step.share
    return whole, real


@fused
def _set_out(bundle, k):
    """Ray k as a path that begins."""
    dx, dy, dz = bundle.dx[k], bundle.dy[k], bundle.dz[k]
    level = max(math.sqrt(dx * dx + dy * dy), 1e-300)
    ex, ey = -dz * dx / level, -dz * dy / level
    return Path(bundle.x[k], bundle.y[k], bundle.z[k], dx, dy, dz, ex, ey, level, 0.0, 1.0, 0, WATER)


@fused
def _as_meeting(hits, k):
    return Meeting(hits.distance[k], hits.body[k], hits.material[k], hits.nx[k], hits.ny[k], hits.nz[k])


@fused
def _end(path, meeting):
    """Where a path meets what it meets."""
    t = meeting.distance
    return path.x + t * path.dx, path.y + t * path.dy, path.z + t * path.dz


@fused
def _clear_of(x, y, z, length):
    """How far off a surface a path starts, so that rounding does not put it on the other side."""
    return OFFSET * (1.0 + abs(x) + abs(y) + abs(z) + length)


@fused
def _slowness(problem, path):
    """Time of a metre where a path is, in metres of water."""
    return 1.0 if path.inside == WATER else 1.0 / problem.interface[_material(problem, path.inside), 1]


@fused
def _material(problem, body):
    """Row of a body's material."""
    solids = problem.solids.shape.size
    return problem.solids.material[body] if body < solids else problem.mesh.material[body - solids]


@kernel
def _split(problem, path, meeting, longest, waiting):
    """Queue what goes on from a hit: the mirrored part, and the refracted one if there is a closed body."""
    length = path.length + meeting.distance * _slowness(problem, path)
    if path.bounce >= problem.bounces or length >= longest:
        return
    x, y, z = _end(path, meeting)
    nx, ny, nz = meeting.nx, meeting.ny, meeting.nz
    cosine = -(nx * path.dx + ny * path.dy + nz * path.dz)
    mirrored = problem.interface[meeting.material, 0] ** 2
    off = _clear_of(x, y, z, length)
    if _lets_through(problem, path, meeting):
        into = path.inside == WATER
        speeds = problem.interface[meeting.material, 1] if into else 1.0 / problem.interface[meeting.material, 1]
        root = 1.0 - speeds * speeds * (1.0 - cosine * cosine)
        if root <= 0.0:
            mirrored = 1.0
        elif path.share * (1.0 - mirrored) >= FAINTEST:
            # Snell's law in vectors.
            bend = speeds * cosine - math.sqrt(root)
            dx, dy, dz = speeds * path.dx + bend * nx, speeds * path.dy + bend * ny, speeds * path.dz + bend * nz
            along = path.ex * dx + path.ey * dy + path.ez * dz
            waiting.append(
                Path(
                    x - off * nx, y - off * ny, z - off * nz, dx, dy, dz,
                    path.ex - along * dx, path.ey - along * dy, path.ez - along * dz,
                    length, path.share * (1.0 - mirrored), path.bounce + 1, meeting.body if into else WATER,
                )
            )  # fmt: skip
    if path.share * mirrored >= FAINTEST:
        turn = 2.0 * (nx * path.ex + ny * path.ey + nz * path.ez)
        waiting.append(
            Path(
                x + off * nx, y + off * ny, z + off * nz,
                path.dx + 2.0 * cosine * nx, path.dy + 2.0 * cosine * ny, path.dz + 2.0 * cosine * nz,
                path.ex - turn * nx, path.ey - turn * ny, path.ez - turn * nz,
                length, path.share * mirrored, path.bounce + 1, path.inside if path.inside == WATER else meeting.body,
            )
        )  # fmt: skip


@fused
def _lets_through(problem, path, meeting):
    """Whether there is water, or a body, behind what is met."""
    triangle = meeting.body - problem.solids.shape.size
    if path.inside != WATER or triangle < 0:
        return meeting.body != BED
    normal = problem.mesh.normal[triangle]
    return normal[0] * path.dx + normal[1] * path.dy + normal[2] * path.dz < 0.0


@fused
def _meet_next(problem, path, reach):
    """Meet what a path comes to within ``reach``, from outside or inside."""
    if path.inside == WATER:
        return meet_any(problem, path.x, path.y, path.z, path.dx, path.dy, path.dz, reach)
    if path.inside < problem.solids.shape.size:
        return _leave_target(problem.solids, path)
    return _leave_mesh(problem, path)


@kernel
def meet_any(problem, x, y, z, dx, dy, dz, reach):
    """Meet the nearest thing within ``reach``."""
    best, body, material, mx, my, mz = reach, NOTHING, 0, 0.0, 0.0, 0.0
    for k in range(problem.solids.shape.size):
        distance, nx, ny, nz = meet_solid(problem.solids, k, x, y, z, dx, dy, dz)
        if distance < best:
            best, body, material, mx, my, mz = distance, k, problem.solids.material[k], nx, ny, nz
    best, triangle = meet_mesh(problem.mesh, x, y, z, dx, dy, dz, best)
    if triangle != NO_TRIANGLE:
        body, material = problem.solids.shape.size + triangle, problem.mesh.material[triangle]
        mx, my, mz = facing(problem.mesh, triangle, dx, dy, dz)
    distance, row, nx, ny, nz = meet_bed(problem.bed, Ray(x, y, z, dx, dy, dz), best)
    if distance < best:
        return Meeting(distance, BED, row, nx, ny, nz)
    return Meeting(best, body, material, mx, my, mz)


@kernel
def _leave_target(solids, path):
    """Leave a body; where another of the same target goes on, leave that."""
    body, total = path.inside, 0.0
    x, y, z = path.x, path.y, path.z
    off = _clear_of(x, y, z, path.length)
    for _ in range(MOST_PARTS):
        distance, nx, ny, nz = leave_solid(solids, body, x, y, z, path.dx, path.dy, path.dz)
        if not distance < math.inf:
            break
        total += distance + off
        x, y, z = path.x + total * path.dx, path.y + total * path.dy, path.z + total * path.dz
        other = _part_at(solids, solids.target[body], x, y, z)
        if other < 0:
            return Meeting(total - off, body, solids.material[body], -nx, -ny, -nz)
        body = other
    return Meeting(math.inf, NOTHING, 0, 0.0, 0.0, 0.0)


@fused
def _part_at(solids, target, x, y, z):
    """Row of a target's body that a point is inside, -1 if none."""
    for k in range(solids.shape.size):
        if solids.target[k] == target and within(solids, k, x, y, z):
            return k
    return -1


@kernel
def _leave_mesh(problem, path):
    """Leave a mesh through the nearest of its triangles that faces the other way."""
    mesh, solids = problem.mesh, problem.solids.shape.size
    target, total = mesh.target[path.inside - solids], 0.0
    off = _clear_of(path.x, path.y, path.z, path.length)
    for _ in range(MOST_PARTS):
        distance, triangle = meet_mesh(
            mesh, path.x + total * path.dx, path.y + total * path.dy, path.z + total * path.dz,
            path.dx, path.dy, path.dz, math.inf,
        )  # fmt: skip
        if triangle == NO_TRIANGLE:
            break
        total += distance
        normal = mesh.normal[triangle]
        outwards = normal[0] * path.dx + normal[1] * path.dy + normal[2] * path.dz
        if mesh.target[triangle] == target and outwards > 0.0:
            return Meeting(total, solids + triangle, mesh.material[triangle], -normal[0], -normal[1], -normal[2])
        total += off
    return Meeting(math.inf, NOTHING, 0, 0.0, 0.0, 0.0)


@fused
def _add_retro(problem, fan, weight, path, meeting, sums):
    """Add what returns along the path itself."""
    length = path.length + meeting.distance
    b = int(length / problem.bin_length)
    nx, ny, nz = meeting.nx, meeting.ny, meeting.nz
    cosine = -(nx * path.dx + ny * path.dy + nz * path.dz)
    if b >= sums.size or cosine <= 0.0:
        return
    row = problem.reflectivity[meeting.material]
    value = bistatic(cosine, cosine, 2.0 * cosine * cosine - 1.0, row[0], row[1], row[2], problem.law)
    value *= path.share * path.share * weight * length / cosine
    if problem.law == LIGHT:
        value *= abs(nx * path.ex + ny * path.ey + nz * path.ez) / problem.bin_length
    elif fan:
        value *= length
    sums[b] += value


@fused
def _add_mixed(problem, beam, fan, out, weight, path, meeting, sums):
    """Add what goes out along the path and straight back, and the other way round."""
    x, y, z = _end(path, meeting)
    sx, sy, sz = x - beam.x, y - beam.y, z - beam.z
    r = math.sqrt(sx * sx + sy * sy + sz * sz)
    length = path.length + meeting.distance
    b = int(0.5 * (length + r) / problem.bin_length)
    nx, ny, nz = meeting.nx, meeting.ny, meeting.nz
    cosine, straight = -(nx * path.dx + ny * path.dy + nz * path.dz), -(nx * sx + ny * sy + nz * sz) / r
    if b >= sums.size or cosine <= 0.0 or straight <= 0.0:
        return
    sx, sy, sz = sx / r, sy / r, sz / r
    passed = _both_ways(problem, beam, fan, out, sx, sy, sz, r)
    if passed == 0.0:
        return
    off = _clear_of(x, y, z, length)
    if meet_any(problem, x + off * nx, y + off * ny, z + off * nz, -sx, -sy, -sz, r).body != NOTHING:
        return
    row = problem.reflectivity[meeting.material]
    mirrored = 2.0 * cosine * straight - (sx * path.dx + sy * path.dy + sz * path.dz)
    value = bistatic(cosine, straight, mirrored, row[0], row[1], row[2], problem.law)
    value += bistatic(straight, cosine, mirrored, row[0], row[1], row[2], problem.law)
    value *= path.share * passed * weight * length / cosine
    if problem.law == LIGHT:
        # How fast R grows with the elevation.
        lean = (nx * path.ex + ny * path.ey + nz * path.ez) / cosine
        px, py, pz = path.ex + lean * path.dx, path.ey + lean * path.dy, path.ez + lean * path.dz
        rate = px * (path.dx + sx) + py * (path.dy + sy) + pz * (path.dz + sz)
        value *= 0.5 * abs(rate) * cosine / problem.bin_length
    else:
        ratio = (0.5 * (length + r)) ** 2 / (length * r)
        value *= ratio * ratio * (length if fan else 1.0)
    sums[b] += value


@fused
def _both_ways(problem, beam, fan, out, sx, sy, sz, r):
    """Sensitivity of the beam to what leaves one way and returns another, the mean of both orders."""
    if sx * beam.side_x + sy * beam.side_y < 0.0:
        return 0.0
    along = sx * beam.axis_x + sy * beam.axis_y + sz * beam.axis_z
    if not beam.s_low - (0.0 if fan else KNIFE / r) <= along <= beam.s_high + (0.0 if fan else KNIFE / r):
        return 0.0
    if not problem.pattern.tabled:
        return 1.0
    back = heard(problem.pattern, beam, fan, problem.law, sx, sy, sz, r)
    return math.sqrt(out * back) if problem.pattern.two_way else 0.5 * (out + back)
