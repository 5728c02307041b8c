"""Azimuths in which targets lie, and a fan with denser planes there.

A target returns its energy from an azimuth as wide as itself, a glint from one far narrower. Planes that are farther
apart may all miss it, whatever their number. Derived in docs/theory/beam.md.
"""

import math
from typing import Any, NamedTuple

import numpy as np

from insonify.array_cache import remember_latest
from insonify.arrays import Booleans, Floats, Integers
from insonify.kernels.beam.divided_sectors import LEAST, divide_sectors
from insonify.kernels.beam.divided_sectors import find_pings_met as find_met
from insonify.kernels.common.types import Mesh, Poses, SceneArrays, Solids
from insonify.kernels.sweep.sweep import LOWEST, AzimuthFan, LaidPlanes
from insonify.scene import Scene
from insonify.tow.line import tow_line_at
from insonify.tow.poses import take_poses

# Planes across a glint of the standard deviation 1/(2√n) of incidence: with as many planes across a target, the
# deviations of two are one plane's spacing, and a sum over the planes errs by 2 exp(-π²/2) = 1.4 %.
OF_GLINT = 4.0
MOST_OF_EACH = 64  # planes that a ping gets for its targets, per plane across each
DIRECTIONS = 32  # in which the outline of a mesh is found
BEYOND = 0.5 * math.tan(math.pi / DIRECTIONS)  # by which a mesh may lie beyond it at most, per metre of its breadth
COUNTED = 64  # pings over the track on which planes are counted
MOST_AT_ONCE = 1 << 18  # pairs of pings and bodies of which the sectors are found at once
CORNERS = 4  # of a solid from above
LEANING = 0.5  # sine of the angle with the level below which a body counts as lying


class TargetSectors(NamedTuple):
    """Azimuths of bodies as each ping has them abeam, (pings, sides × bodies) each."""

    low: Floats  # where a body begins, from athwart towards the bow, rad
    high: Floats  # and ends
    step: Floats  # greatest distance of planes across it, rad; infinite for a body on the other side
    nearest: Floats  # bound on its least ground range, m
    corners: Floats  # (pings, sides × bodies, CORNERS) of bodies with that many, where one face ends and another begins


class _Outlines(NamedTuple):
    """Points with radii about them, whose hulls are the bodies' outlines from above."""

    x: Floats  # (points,) m
    y: Floats
    radius: Floats
    first: Integers  # (bodies,) point with which each begins
    lobe: Floats  # (bodies,) 1/√n of its material's specular lobe, infinite where it has none
    curvature: Floats  # (bodies,) of its sides about the vertical, 1/m


def has_bodies(arrays: SceneArrays) -> bool:
    """Whether a scene has targets."""
    return arrays.solids.shape.size + arrays.mesh.target.size > 0


def heights_of(arrays: SceneArrays, poses: Poses) -> Floats:
    """Heights of the sonar above the lowest bed, as reaches of planes count them, m."""
    return np.asarray(np.maximum(poses.z - arrays.bed.low, LOWEST))


def split_pings(arrays: SceneArrays, places: Integers) -> list[Integers]:
    """Split pings into parts, so that the sectors of all targets fit in little memory."""
    bodies = 2 * (arrays.solids.shape.size + np.unique(arrays.mesh.target).size)
    return np.array_split(places, max(places.size * bodies // MOST_AT_ONCE, 1))


def find_target_sectors(arrays: SceneArrays, poses: Poses, across: int) -> TargetSectors:
    """Find the azimuths in which the bodies of a scene lie, and how far apart planes across them may be."""
    return _find_sectors(_outlines_of(arrays.solids, arrays.mesh, arrays.reflectivity), arrays, poses, across)


def _find_sectors(outlines: _Outlines, arrays: SceneArrays, poses: Poses, across: int) -> TargetSectors:
    """Sectors of outlines, as `find_target_sectors` has those of bodies."""
    dx, dy = outlines.x - poses.x[:, None], outlines.y - poses.y[:, None]
    cosine, sine = np.cos(poses.heading)[:, None], np.sin(poses.heading)[:, None]
    ahead, port = dx * cosine + dy * sine, dy * cosine - dx * sine
    height = heights_of(arrays, poses)[:, None]
    sides = (_find_one_side(outlines, ahead, abeam, height, across, arrays) for abeam in (port, -port))
    return TargetSectors(*(np.concatenate(columns, axis=1) for columns in zip(*sides)))


def _find_one_side(
    outlines: _Outlines, ahead: Floats, abeam: Floats, height: Floats, across: int, arrays: SceneArrays
) -> TargetSectors:
    """Sectors on one side; points on the other side count as at its border."""
    first, radius = outlines.first, outlines.radius
    distance = np.hypot(ahead, abeam)
    azimuth = np.arctan2(ahead, np.maximum(abeam, 0.0))
    half = np.where(distance > radius, np.arcsin(np.minimum(radius / np.maximum(distance, LEAST), 1.0)), math.pi)
    low = np.minimum.reduceat(azimuth - half, first, axis=1)
    high = np.maximum.reduceat(azimuth + half, first, axis=1)
    farthest = np.maximum(np.maximum.reduceat(distance, first, axis=1), LEAST)
    # Both limits: docs/theory/beam.md
    glint = OF_GLINT * outlines.lobe / np.hypot(1.0, outlines.curvature * farthest)
    onset = np.where(outlines.curvature > 0.0, OF_GLINT * arrays.bin_length / (outlines.lobe * farthest), math.inf)
    glint = np.where(np.isfinite(outlines.lobe), np.minimum(glint, onset), math.inf)
    is_other_side = np.maximum.reduceat(abeam + radius, first, axis=1) <= 0.0
    nearest = np.maximum(np.minimum.reduceat(abeam - radius, first, axis=1), 0.0)
    # Of a body at the border of the beam the part inside counts: |sin φ - axis| <= sin(w/2) / cos θ.
    farther = np.sin(arrays.half_width) * np.hypot(1.0, height / np.maximum(nearest, LEAST))
    inside = [np.arcsin(np.clip(arrays.pattern.centre + way * farther, -1.0, 1.0)) for way in (-1.0, 1.0)]
    seen = np.minimum(high, inside[1]) - np.maximum(low, inside[0])
    step = np.maximum(np.minimum(np.where(seen > 0.0, seen, high - low), glint) / across, LEAST)
    corners = np.full((*low.shape, CORNERS), math.nan)
    has_corners = (np.diff(np.append(first, radius.size)) == CORNERS) & (radius[first] == 0.0)
    corners[:, has_corners] = azimuth[:, first[has_corners][:, None] + np.arange(CORNERS)]
    return TargetSectors(low, high, np.where(is_other_side, math.inf, step), nearest, corners)


def find_pings_met(arrays: SceneArrays, poses: Poses, laid: LaidPlanes) -> Booleans:
    """Whether a plane of each ping may cut a target."""
    if not has_bodies(arrays):
        return np.zeros(poses.x.size, np.bool_)
    covers, planes = _covers_of(arrays.solids, arrays.mesh), np.column_stack([laid.fan.azimuth, laid.fan.reach])
    met = np.zeros(poses.x.size, np.bool_)
    for part in split_pings(arrays, np.arange(poses.x.size)):
        some = take_poses(poses, part)
        bodies = np.stack(_find_sectors(covers, arrays, some, 1)[:4], axis=2)
        met[part] = find_met(planes, laid.first[part], laid.last[part], bodies, heights_of(arrays, some))
    return met


def count_added_planes(scene: Scene, arrays: SceneArrays, across: int, fan: AzimuthFan) -> tuple[float, float]:
    """Planes that a ping of a track gets for its targets beyond those of a fan, and share of pings that get any."""
    sectors, known = _sectors_over_track(scene, arrays, across)
    planes, pings = fan.azimuth.size, sectors.low.shape[0]
    if planes not in known:
        divided = np.flatnonzero(divide_at_targets(fan, sectors, np.full(pings, scene.altitude), across)[1])
        half, axis = arrays.half_width, math.asin(min(max(arrays.pattern.centre, -1.0), 1.0))
        low, high, step, nearest = (column[divided] for column in sectors[:4])
        within = np.maximum(np.clip(high, axis - half, axis + half) - np.clip(low, axis - half, axis + half), 0.0)
        spacing = float(np.subtract(*_edges(fan)[::-1]).min())
        counted = (step < spacing) & (nearest < scene.sonar.range)
        added = np.where(counted, within * (1.0 / step - 1.0 / spacing), 0.0).sum(axis=1)
        known[planes] = float(np.minimum(added, MOST_OF_EACH * across).sum()) / pings, divided.size / pings
    return known[planes]


@remember_latest
def _sectors_over_track(
    scene: Scene, arrays: SceneArrays, across: int
) -> tuple[TargetSectors, dict[int, tuple[float, float]]]:
    """Sectors of targets at pings over a track, of a fish without motion; what is counted of fans, by their planes."""
    pings = np.unique(np.linspace(0, scene.track.pings - 1, COUNTED).astype(np.int64))
    line, level = tow_line_at(scene, pings), np.zeros(pings.size)
    return find_target_sectors(arrays, Poses(line.x, line.y, level, line.heading, level, level), across), {}


def divide_at_targets(
    fan: AzimuthFan, sectors: TargetSectors, height: Floats, across: int
) -> tuple[AzimuthFan, Integers]:
    """Divide the planes of a fan that are too wide for the targets of each ping, or hold their borders.

    Return the planes of all divided pings, ping by ping, and their number for each ping, by height above the lowest
    bed, m; pings whose planes are not to be divided have none.
    """
    low, high = _edges(fan)
    planes = np.column_stack([low, high, fan.angle, fan.far_angle, fan.near_field, fan.reach, fan.apart])
    bodies, most = np.stack(sectors[:4], axis=2), MOST_OF_EACH * across + len(planes)
    parts, counts = divide_sectors(planes, bodies, sectors.corners, height, most)
    low, high, angle, far_angle, near_field, reach, apart = parts.T
    sines = np.sin(low), np.sin(high)
    if (fan.s_low >= 0.0).all():  # of a top-hat, for which both sides of athwart are alike
        sines = np.minimum(*np.abs(sines)), np.maximum(*np.abs(sines))
    columns: tuple[Any, ...] = (0.5 * (low + high), *sines, angle, far_angle, near_field, reach, apart > 0.5)
    return AzimuthFan(*map(np.ascontiguousarray, columns)), counts


def _edges(fan: AzimuthFan) -> tuple[Floats, Floats]:
    """Azimuths at which the sectors of planes begin and end, rad; those of a top-hat's planes lie on either side."""
    low, high = np.arcsin(fan.s_low), np.arcsin(fan.s_high)
    is_central = (fan.azimuth == 0.0) & (fan.s_low == 0.0)
    turned = (fan.azimuth < 0.0) & (fan.s_low >= 0.0)
    return np.where(turned | is_central, -high, low), np.where(turned, -low, high)


@remember_latest
def _covers_of(solids: Solids, mesh: Mesh) -> _Outlines:
    """Outlines that hold all of the solids and of the meshes of each target."""
    x, y, radius, first, hulls = _hulls_of(solids, mesh)
    beyond = [np.full(len(hull), BEYOND * math.hypot(*np.ptp(hull, axis=0))) for hull in hulls]
    bare = np.full(first.size, math.inf), np.zeros(first.size)
    return _Outlines(x, y, np.concatenate([radius, *beyond]), first, *bare)


@remember_latest
def _outlines_of(solids: Solids, mesh: Mesh, reflectivity: Floats) -> _Outlines:
    """Outlines of solids and of the meshes of each target; balls at the joints of a pipe hardly show."""
    is_ball = solids.length == 0.0
    kept = ~(is_ball & np.isin(solids.target, solids.target[~is_ball]))
    some = Solids(*(column[kept] for column in solids))
    x, y, radius, first, hulls = _hulls_of(some, mesh)
    materials = reflectivity[np.append(some.material, mesh.material[np.unique(mesh.target, return_index=True)[1]])]
    # The end of a body that lies nearly level is seen from aside at its middle, which leans by as much to both sides.
    radius[: CORNERS * some.length.size][
        np.repeat((some.length > 0.0) & (np.abs(some.axis[:, 2]) < LEANING), CORNERS)
    ] = 0.0
    # A ball turns its side with azimuth as an upright cylinder does, a level one and a flat side do not.
    upright = np.where(is_ball[kept], 1.0, np.abs(some.axis[:, 2]))
    lobe = 1.0 / np.sqrt(np.maximum(materials[:, 2], 1.0))
    return _Outlines(
        x,
        y,
        radius=np.append(radius, np.zeros(x.size - radius.size)),
        first=first,
        lobe=np.where(materials[:, 1] > 0.0, lobe, math.inf),
        curvature=np.append(upright / np.maximum(some.radius, LEAST), np.zeros(len(hulls))),
    )


def _hulls_of(solids: Solids, mesh: Mesh) -> tuple[Floats, Floats, Floats, Integers, list[Floats]]:
    """Points about solids and then about meshes: x, y, radii about the points, first point of each body, hulls."""
    ends = np.stack([solids.start, solids.start + solids.length[:, None] * solids.axis], axis=1)
    radius = np.maximum(solids.radius, solids.radius + solids.taper * solids.length)
    # Seen from above the flat end of a body is as wide as the body across its axis, and as deep as the axis is steep.
    level = np.hypot(solids.axis[:, 0], solids.axis[:, 1])
    flat = np.where((solids.length > 0.0) & (level > LEAST), radius / np.maximum(level, LEAST), 0.0)
    aside = flat[:, None] * np.column_stack([-solids.axis[:, 1], solids.axis[:, 0]])
    corners = np.concatenate([ends[:, :, :2] + aside[:, None], ends[:, :, :2] - aside[:, None]], axis=1)
    about = np.where(flat > 0.0, radius * np.abs(solids.axis[:, 2]), radius)
    hulls = [_hull_from_above(mesh.corners[mesh.target == target]) for target in np.unique(mesh.target)]
    points = np.concatenate([corners.reshape(-1, 2), *hulls])
    sizes = [CORNERS] * radius.size + [len(hull) for hull in hulls]
    first = np.append(0, np.cumsum(sizes)[:-1]).astype(np.int64)
    return points[:, 0], points[:, 1], np.repeat(about, CORNERS), first, hulls


def _hull_from_above(corners: Floats) -> Floats:
    """Corners that lie outermost in some direction, (n, 2)."""
    points = corners.reshape(-1, 3)[:, :2]
    ways = np.linspace(0.0, 2.0 * math.pi, DIRECTIONS, endpoint=False)
    return np.asarray(points[np.unique((points @ np.array([np.cos(ways), np.sin(ways)])).argmax(axis=0))])
