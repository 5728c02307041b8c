"""Targets as the sonar sees them: how loud their parts are, how long along the track and how deep in range.

Only to first order: a part is lit evenly, hides no other one and lies over a level bed. Vectors are along the track,
away from it and up.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from insonify.files import file_version
from insonify.io.meshes import read_mesh
from insonify.planning import laws
from insonify.planning.scene_summary import BEYOND, View
from insonify.scene import Scene, SceneError
from insonify.scene.materials import Reflectivity
from insonify.scene.targets import AnyTarget, Box, Cone, MeshFile, Pipe, Sphere

Vector = tuple[float, float, float]
SLIGHT = 1e-3  # m, and share of an altitude: nothing is taken to be shorter or lower
AROUND = 12  # lines of a cone that stand for all of it


class Part(NamedTuple):
    """A side of a target, or its shadow."""

    echo: float  # m², of σ over that of a perfect Lambert surface seen straight on; of a shadow 0
    along: float  # m, its length along the track
    depth: float  # m of slant range that one line across the track meets of it
    turn: float  # m of slant range between what its first and its last such line meet


class Seen(NamedTuple):
    """A target from where its ping goes out."""

    number: int  # among all targets of the scene
    kind: str
    place: float  # m along the track
    distance: float  # m of slant range
    length: float  # m along the track
    width: float  # m of the beam there
    parts: tuple[Part, ...]
    shadow: float  # m of slant range, its length beyond BEYOND altitudes
    grazing: float  # sine of the grazing angle of a level bed at that distance


class Solid(NamedTuple):
    """A mesh by its measures, in units of its file."""

    size: Vector  # of its bounding box
    faces: Vector  # area of what faces each axis, from one side


def solid_of(mesh: MeshFile, number: int) -> Solid:
    """Measure a mesh once for each version of its file; the target's number tells which one is wrong."""
    try:
        return _measured(mesh.path, file_version(mesh.path))
    except SceneError as error:
        raise SceneError(f"targets.{number}.path: {error}") from None


@lru_cache(maxsize=64)
def _measured(path: str, version: tuple[int, int] | None) -> Solid:
    del version  # part of the key alone: a file written anew is read anew
    corners = read_mesh(path)
    size = corners.max(axis=(0, 1)) - corners.min(axis=(0, 1))
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    # Half of a triangle's cross product is its area; half of those of a closed surface face one way.
    faces = 0.25 * np.abs(normals).sum(axis=0)
    return Solid(*((float(x), float(y), float(z)) for x, y, z in (size, faces)))


def see(scene: Scene, view: View, number: int) -> Seen | None:
    """Look at a target athwart the track; nothing is seen of one below the bed.

    Parameters
    ----------
    scene : Scene
    view : View
        Its lengths.
    number : int
        Of the target.

    Returns
    -------
    Seen or None

    Raises
    ------
    SceneError
        If its mesh cannot be read.
    """
    target, altitude = scene.targets[number], max(view.altitude, SLIGHT)
    place, away = place_of(scene, target)
    side = math.copysign(1.0, away)
    axes = _axes(target, scene.track.heading, side)
    along, across, up = _half_extents(target, axes, number)
    top = target.position[2] + scene.seabed.depth + up if len(target.position) == 3 else _gap(target) + 2.0 * up
    if top <= 0.0:
        return None
    height, x = min(top, 2.0 * up), min(abs(away), view.ground)
    rise = altitude - top + 0.5 * height
    distance = max(math.hypot(x, rise), SLIGHT)
    towards = (0.0, -x / distance, rise / distance)
    half_depth = across * x / distance + up * abs(rise) / distance
    # The level bed that it hides ends where a line over its top meets that.
    end = min(math.hypot(x * altitude / (altitude - top), altitude) if top < altitude else math.inf, view.reach)
    # What is sunk into the bed or lies nearer does not count.
    share = height / (2.0 * up) * _share(distance - half_depth, distance + half_depth, BEYOND * altitude)
    parts = tuple(
        part._replace(echo=share * part.echo)
        for part in _parts(target, axes, towards, (2.0 * along, half_depth), number)
        if share * part.echo > 0.0
    )
    return Seen(
        number=number,
        kind=target.kind,
        place=place,
        distance=distance,
        length=2.0 * along,
        width=2.0 * distance * math.sin(view.half_width),
        parts=parts,
        shadow=max(end - max(distance, BEYOND * altitude), 0.0),
        grazing=min(altitude / distance, 1.0),
    )


def place_of(scene: Scene, target: AnyTarget) -> tuple[float, float]:
    """Place of a target along the line of the tow, and to port of it."""
    x, y = (target.position[k] - scene.track.start[k] for k in (0, 1))
    c, s = math.cos(math.radians(scene.track.heading)), math.sin(math.radians(scene.track.heading))
    return x * c + y * s, y * c - x * s


def _axes(target: AnyTarget, heading: float, side: float) -> tuple[Vector, Vector, Vector]:
    """Axes of a target: turned by its heading, then its pitch, then its roll."""
    if isinstance(target, Sphere):
        return (1.0, 0.0, 0.0), (0.0, side, 0.0), (0.0, 0.0, 1.0)
    angles = target.heading - heading, target.pitch or 0.0, 0.0 if isinstance(target, Pipe) else target.roll
    (ch, sh), (cp, sp), (cr, sr) = ((math.cos(a), math.sin(a)) for a in map(math.radians, angles))
    bow = (ch * cp, side * sh * cp, sp)
    port = (-ch * sp * sr - sh * cr, side * (ch * cr - sh * sp * sr), cp * sr)
    return bow, port, (sh * sr - ch * sp * cr, -side * (sh * sp * cr + ch * sr), cp * cr)


def _half_extents(target: AnyTarget, axes: tuple[Vector, Vector, Vector], number: int) -> Vector:
    if isinstance(target, Sphere):
        return (target.radius,) * 3
    if isinstance(target, (Pipe, Cone)):
        axis, half = (axes[0], target.length) if isinstance(target, Pipe) else (axes[2], target.height)
        along, across, up = (0.5 * half * abs(a) + target.radius * math.sqrt(max(1.0 - a * a, 0.0)) for a in axis)
        return along, across, up
    size = target.size if isinstance(target, Box) else [target.scale * side for side in solid_of(target, number).size]
    along, across, up = (0.5 * sum(side * abs(axis[k]) for side, axis in zip(size, axes)) for k in range(3))
    return along, across, up


def _gap(target: AnyTarget) -> float:
    """Height of the underside, mean of a pipe's stations."""
    gap = target.gap
    return gap if isinstance(gap, float) else sum(height for _, height in gap) / len(gap)


def _share(low: float, high: float, limit: float) -> float:
    """Share of a stretch that lies beyond a limit."""
    return min(max((high - limit) / max(high - low, SLIGHT), 0.0), 1.0)


def _parts(
    target: AnyTarget,
    axes: tuple[Vector, Vector, Vector],
    towards: Vector,
    extent: tuple[float, float],
    number: int,
) -> Iterator[Part]:
    """Parts of a target; its extent is its length along the track and half its depth in range."""
    of = target.material.reflectivity
    if isinstance(target, Sphere):
        yield from _ball(target, of)
    elif isinstance(target, Pipe):
        yield from _pipe(target, of, axes[0], towards)
    elif isinstance(target, Cone):
        yield from _cone(target, of, axes[2], towards, extent)
    elif isinstance(target, Box):
        yield from _box(target, of, axes, towards)
    else:
        faces = solid_of(target, number).faces
        area = target.scale**2 * sum(face * abs(_dot(axis, towards)) for face, axis in zip(faces, axes))
        # Of all normals towards the sonar: ∫ cos² and the lobe over half a ball, by its cross-section.
        echo = area * (2.0 / 3.0 * of.diffuse + 0.25 * of.specular * (of.shininess + 2.0) / of.shininess)
        yield Part(echo, extent[0], extent[1] * laws.FRONT, extent[1])


def _ball(ball: Sphere, of: Reflectivity) -> Iterator[Part]:
    radius = ball.radius
    yield Part(2.0 / 3.0 * math.pi * radius**2 * of.diffuse, 2.0 * radius, radius * laws.FRONT, 0.5 * radius)
    # cosⁿ 2α falls as exp(−2nα²) about the place that faces the sonar.
    lobe = 0.25 * math.pi * radius**2 * of.specular * (of.shininess + 2.0) / of.shininess
    yield Part(lobe, min(2.5 * radius / math.sqrt(of.shininess), 2.0 * radius), 0.0, 0.0)


def _pipe(pipe: Pipe, of: Reflectivity, axis: Vector, towards: Vector) -> Iterator[Part]:
    sine, ahead = min(abs(_dot(axis, towards)), 1.0), abs(axis[0])
    side, n = pipe.radius * pipe.length * (1.0 - sine * sine), of.shininess
    along = pipe.length * ahead + 2.0 * pipe.radius * math.sqrt(max(1.0 - ahead * ahead, 0.0))
    # One line meets all of a pipe that lies athwart.
    deep = sine * pipe.length
    depth = min(pipe.radius * laws.FRONT / max(ahead, SLIGHT), deep + pipe.radius * laws.FRONT)
    turn = max(deep - depth, 0.0)
    yield Part(0.5 * math.pi * side * of.diffuse, along, depth, turn)
    lobe = 0.5 * (n + 2.0) * of.specular * math.exp(-2.0 * n * math.asin(sine) ** 2)
    yield Part(math.sqrt(0.5 * math.pi / n) * side * lobe, along, 0.0, turn)
    yield _disc(pipe.radius, of, axis, sine)


def _cone(cone: Cone, of: Reflectivity, axis: Vector, towards: Vector, extent: tuple[float, float]) -> Iterator[Part]:
    slant, n = math.hypot(cone.radius, cone.height), of.shininess
    outwards, upwards = cone.height / slant, cone.radius / slant
    ahead = min(max(_dot(axis, towards), -1.0), 1.0)
    off = math.sqrt(1.0 - ahead * ahead)
    area = math.pi * cone.radius * slant
    cosines = (outwards * off * math.cos(2.0 * math.pi * (k + 0.5) / AROUND) + upwards * ahead for k in range(AROUND))
    diffuse = of.diffuse * sum(max(cosine, 0.0) ** 2 for cosine in cosines) / AROUND
    yield Part(diffuse * area, extent[0], extent[1] * laws.FRONT, 0.5 * extent[1])
    # The line of the side that faces the sonar most, and how far to either hand of it the lobe goes.
    incidence = math.atan2(off, ahead) - math.atan2(outwards, upwards)
    around = min(math.sqrt(0.125 / (math.pi * n * max(outwards * off, SLIGHT))), 1.0)
    lobe = 0.5 * (n + 2.0) * of.specular * math.exp(-2.0 * n * incidence * incidence)
    glint = max(2.5 * cone.radius / math.sqrt(n), abs(axis[0]) * cone.height)
    yield Part(lobe * area * around, min(glint, extent[0]), 0.0, 0.3 * extent[1])
    yield _disc(cone.radius, of, axis, -ahead)


def _disc(radius: float, of: Reflectivity, axis: Vector, cosine: float) -> Part:
    """End of a pipe or a cone."""
    edge = math.sqrt(max(1.0 - axis[0] ** 2, SLIGHT))
    return Part(math.pi * radius**2 * _facing(of, cosine), 2.0 * radius * edge, 0.5 * radius, radius * abs(axis[0]))


def _box(box: Box, of: Reflectivity, axes: tuple[Vector, Vector, Vector], towards: Vector) -> Iterator[Part]:
    """Sides of a box; of two opposite ones the sonar sees one."""
    edges = [tuple(side * a for a in axis) for side, axis in zip(box.size, axes)]
    for k in range(3):
        one, other = edges[k - 2], edges[k - 1]
        ranges, lengths = [_dot(edge, towards) for edge in (one, other)], (abs(one[0]), abs(other[0]))
        deep = sum(map(abs, ranges))
        # A line across a parallelogram, of all that it is deep.
        depth = min(abs(ranges[0] * other[0] - ranges[1] * one[0]) / max(*lengths, 1e-9), deep)
        area = box.size[k - 2] * box.size[k - 1]
        yield Part(area * _facing(of, abs(_dot(axes[k], towards))), max(sum(lengths), SLIGHT), depth, deep - depth)


def _facing(of: Reflectivity, cosine: float) -> float:
    """Strength of a flat side by the cosine of its incidence, over that of a perfect Lambert surface straight on."""
    if cosine <= 0.0:
        return 0.0
    lobe = max(2.0 * cosine * cosine - 1.0, 0.0) ** of.shininess
    return cosine * cosine * (of.diffuse + 0.5 * (of.shininess + 2.0) * of.specular * lobe)


def _dot(one: Vector | tuple[float, ...], other: Vector) -> float:
    return one[0] * other[0] + one[1] * other[1] + one[2] * other[2]
