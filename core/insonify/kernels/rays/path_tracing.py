"""Paths by specular reflection and refraction: the next surface of a path, and the split of its energy there.

At every hit the energy splits: R0² is mirrored, 1 − R0² refracts into closed bodies by Snell's law with the body's
speed ratio ν, or is lost in the bed; beyond the critical angle all of it is reflected. The bed's cells are flat
mirrors, and the side of a mesh that faces inwards from the water turns a ray but lets nothing through.

The width of the tube about a path follows from two ray differentials (Igehy 1999, "Tracing ray differentials"): how its
place and direction move per radian of its elevation at the sonar, and per radian at right angles. The cross product of
the two shifts of a place is the area that a unit of solid angle covers.
"""

import math
from typing import NamedTuple

from insonify.compiler.jit import inlined, kernel
from insonify.kernels.common.types import BED
from insonify.kernels.geometry.solids import exit_solid, intersect_solid, is_inside_solid, normal_change
from insonify.kernels.geometry.triangles import NO_TRIANGLE, facing_normal, intersect_mesh
from insonify.kernels.rays.cell_walk import NO_HIT, Ray, meet_bed

WATER = -3  # place of a path that is in no body
OFFSET = 1e-13  # share of all lengths by which a path starts off the surface that it leaves
FAINTEST = 1e-6  # share of energy below which a path is dropped
MOST_PARTS = 64  # bodies of one target that a path may cross without a break


class RayDifferential(NamedTuple):
    """Derivative of a ray's place, m/rad, and of its direction."""

    x: float
    y: float
    z: float
    dx: float
    dy: float
    dz: float


class SpecularPath(NamedTuple):
    """A path on its way: where it is, at its last corner or arrived at the next surface, and what it carries."""

    x: float
    y: float
    z: float
    dx: float
    dy: float
    dz: float
    up: RayDifferential  # per radian of elevation at the sonar
    across: RayDifferential  # per radian at right angles to the elevation
    length: float  # m of water with the travel time of the path
    share: float  # of the energy that set out
    bounce: int
    inside: int  # body, counted as in Hits; WATER if none


class Intersection(NamedTuple):
    """The next surface that a path meets."""

    distance: float
    body: int  # NO_HIT if it meets nothing
    material: int
    nx: float  # unit normal on the path's side
    ny: float
    nz: float


@inlined
def start_path(bundle, k):
    """Path that begins with a ray at the sonar."""
    dx, dy, dz = bundle.dx[k], bundle.dy[k], bundle.dz[k]
    level = max(math.sqrt(dx * dx + dy * dy), 1e-300)
    up = RayDifferential(0.0, 0.0, 0.0, -dz * dx / level, -dz * dy / level, level)
    across = RayDifferential(0.0, 0.0, 0.0, -dy / level, dx / level, 0.0)
    return SpecularPath(bundle.x[k], bundle.y[k], bundle.z[k], dx, dy, dz, up, across, 0.0, 1.0, 0, WATER)


@inlined
def advance_to(arrays, path, meeting):
    """Path advanced to the surface that it meets."""
    t, dx, dy, dz = meeting.distance, path.dx, path.dy, path.dz
    up, across = transfer(path.up, path, meeting), transfer(path.across, path, meeting)
    # The travel time per metre, in metres of water.
    slowness = 1.0 if path.inside == WATER else 1.0 / arrays.interface[_material(arrays, path.inside), 1]
    length = path.length + t * slowness
    return SpecularPath(
        path.x + t * dx, path.y + t * dy, path.z + t * dz, dx, dy, dz, up, across, length, path.share, path.bounce,
        path.inside,
    )  # fmt: skip


@inlined
def offset_from_surface(x, y, z, length):
    """Distance off a surface at which a path starts, so that rounding does not put it on the other side."""
    return OFFSET * (1.0 + abs(x) + abs(y) + abs(z) + length)


@inlined
def _material(arrays, body):
    """Row of the material of a solid or a triangle."""
    solids = arrays.solids.shape.size
    return arrays.solids.material[body] if body < solids else arrays.mesh.material[body - solids]


@kernel
def split_path(arrays, path, meeting, longest, waiting):
    """Queue the paths that leave a hit: the reflected one, and the refracted one if the body is closed."""
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
    """Path after specular reflection, with a share of the energy."""
    nx, ny, nz, dx, dy, dz = meeting.nx, meeting.ny, meeting.nz, path.dx, path.dy, path.dz
    off = offset_from_surface(path.x, path.y, path.z, path.length)
    bent, bent_across = _normal_changes(arrays.solids, path, meeting)
    up = reflect(path.up, cosine, path, meeting, bent)
    across = reflect(path.across, cosine, path, meeting, bent_across)
    return SpecularPath(
        path.x + off * nx, path.y + off * ny, path.z + off * nz,
        dx + 2.0 * cosine * nx, dy + 2.0 * cosine * ny, dz + 2.0 * cosine * nz, up, across,
        path.length, path.share * share, path.bounce + 1, path.inside if path.inside == WATER else meeting.body,
    )  # fmt: skip


@inlined
def _refract_path(arrays, path, meeting, cosine, speeds, root, share):
    """Path after refraction into a body or out of it, with a share of the energy: Snell's law in vectors."""
    nx, ny, nz, dx, dy, dz = meeting.nx, meeting.ny, meeting.nz, path.dx, path.dy, path.dz
    off = offset_from_surface(path.x, path.y, path.z, path.length)
    bend = speeds * cosine - root
    bent, bent_across = _normal_changes(arrays.solids, path, meeting)
    up = refract(path.up, cosine, speeds, root, path, meeting, bent)
    across = refract(path.across, cosine, speeds, root, path, meeting, bent_across)
    return SpecularPath(
        path.x - off * nx, path.y - off * ny, path.z - off * nz,
        speeds * dx + bend * nx, speeds * dy + bend * ny, speeds * dz + bend * nz, up, across,
        path.length, path.share * share, path.bounce + 1, meeting.body if path.inside == WATER else WATER,
    )  # fmt: skip


@inlined
def _lets_through(arrays, path, meeting):
    """Whether sound passes a surface: water or a closed body lies behind it."""
    triangle = meeting.body - arrays.solids.shape.size
    if path.inside != WATER or triangle < 0:
        return meeting.body != BED
    normal = arrays.mesh.normal[triangle]
    return normal[0] * path.dx + normal[1] * path.dy + normal[2] * path.dz < 0.0


@inlined
def meet_next(arrays, path, reach):
    """Next surface that a path meets, from outside a body or from inside."""
    if path.inside == WATER:
        return meet_scene(arrays, path.x, path.y, path.z, path.dx, path.dy, path.dz, reach)
    if path.inside < arrays.solids.shape.size:
        return _leave_solids(arrays.solids, path)
    return _leave_mesh(arrays, path)


@kernel
def meet_scene(arrays, x, y, z, dx, dy, dz, reach):
    """Nearest surface of a scene along a straight ray."""
    best, body, material, mx, my, mz = reach, NO_HIT, 0, 0.0, 0.0, 0.0
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
    """Exit from a solid, or from the last of the overlapping solids of the same target."""
    body, total = path.inside, 0.0
    x, y, z = path.x, path.y, path.z
    off = offset_from_surface(x, y, z, path.length)
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
    return Intersection(math.inf, NO_HIT, 0, 0.0, 0.0, 0.0)


@inlined
def _solid_of_target_at(solids, target, x, y, z):
    """Row of a target's solid that a point is inside, -1 if none."""
    for k in range(solids.shape.size):
        if solids.target[k] == target and is_inside_solid(solids, k, x, y, z):
            return k
    return -1


@kernel
def _leave_mesh(arrays, path):
    """Exit from a mesh through the nearest of its triangles that faces the other way."""
    mesh, solids = arrays.mesh, arrays.solids.shape.size
    target, total = mesh.target[path.inside - solids], 0.0
    off = offset_from_surface(path.x, path.y, path.z, path.length)
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
    return Intersection(math.inf, NO_HIT, 0, 0.0, 0.0, 0.0)


@inlined
def transfer(shift, path, surface):
    """Differential of a ray at the surface that it meets; its place then moves along the tangent."""
    dx, dy, dz, nx, ny, nz = path.dx, path.dy, path.dz, surface.nx, surface.ny, surface.nz
    t = surface.distance
    x, y, z = shift.x + t * shift.dx, shift.y + t * shift.dy, shift.z + t * shift.dz
    on = (nx * x + ny * y + nz * z) / (nx * dx + ny * dy + nz * dz)  # Igehy 1999: transfer
    return RayDifferential(x - on * dx, y - on * dy, z - on * dz, shift.dx, shift.dy, shift.dz)


@inlined
def reflect(shift, cosine, path, surface, bent):
    """Differential of a ray after specular reflection."""
    dx, dy, dz, nx, ny, nz = path.dx, path.dy, path.dz, surface.nx, surface.ny, surface.nz
    # Igehy 1999: reflection
    fall = shift.dx * nx + shift.dy * ny + shift.dz * nz + dx * bent[0] + dy * bent[1] + dz * bent[2]
    return RayDifferential(
        shift.x, shift.y, shift.z,
        shift.dx + 2.0 * (cosine * bent[0] - fall * nx),
        shift.dy + 2.0 * (cosine * bent[1] - fall * ny),
        shift.dz + 2.0 * (cosine * bent[2] - fall * nz),
    )  # fmt: skip


@inlined
def refract(shift, cosine, speeds, root, path, surface, bent):
    """Differential of a ray after refraction into or out of a body."""
    dx, dy, dz, nx, ny, nz = path.dx, path.dy, path.dz, surface.nx, surface.ny, surface.nz
    # Igehy 1999: refraction, of Snell's law d' = ν d + (ν cos α − √root) n
    fall = -(shift.dx * nx + shift.dy * ny + shift.dz * nz + dx * bent[0] + dy * bent[1] + dz * bent[2])
    bend, growth = speeds * cosine - root, (speeds - speeds * speeds * cosine / root) * fall
    return RayDifferential(
        shift.x, shift.y, shift.z,
        speeds * shift.dx + bend * bent[0] + growth * nx,
        speeds * shift.dy + bend * bent[1] + growth * ny,
        speeds * shift.dz + bend * bent[2] + growth * nz,
    )  # fmt: skip


@inlined
def _normal_changes(solids, path, surface):
    """Find how a surface's normal changes along both differentials of a ray; facets and the bed's cells are flat."""
    k, up, across = surface.body, path.up, path.across
    if not 0 <= k < solids.shape.size:
        return (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    point, normal = (path.x, path.y, path.z), (surface.nx, surface.ny, surface.nz)
    return (
        normal_change(solids, k, point, normal, (up.x, up.y, up.z)),
        normal_change(solids, k, point, normal, (across.x, across.y, across.z)),
    )


@inlined
def tube_area(up, across):
    """Area that a unit of solid angle covers where both differentials of a ray have landed, m²/sr."""
    x, y, z = up.y * across.z - up.z * across.y, up.z * across.x - up.x * across.z, up.x * across.y - up.y * across.x
    return math.sqrt(x * x + y * y + z * z)
