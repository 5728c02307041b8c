"""Pixels of a record in which one place echoes: straight, and by way of the sea surface."""

import math
from dataclasses import dataclass

import numpy as np

from insonify.arrays import Floats, Integers
from insonify.explanation.pixel_parts import arrays_at, whole_window
from insonify.explanation.sound_paths import SURFACE, locate_sonar, path_range
from insonify.kernels.common.types import Poses, SceneArrays
from insonify.kernels.labels.echo_parts import VISIBLE, Window
from insonify.packing.apparent_tables import make_apparent_tables
from insonify.simulation import Simulation
from insonify.tracers.azimuth_fan import lay_planes, lay_planes_of_images
from insonify.tracers.echo_parts import find_direct_parts, find_surface_parts
from insonify.tracers.labels import PATHS

FAINT = 0.01  # two-way response of the beam below which a place counts as outside
STRIP = 0.5  # m, half the width of a knife along the track
BESIDE = 0.3  # m, greatest distance of a place from the surface that echoes
WIDE = 0.03  # share of its ground range by which an echo by way of the sea surface may lie beside a place
SURFACE_BOTTOM = PATHS.index("surface_bottom")


@dataclass(frozen=True, order=True)
class Listener:
    """A pixel in which a place echoes."""

    ping: int
    side: int
    bin: int
    path: str  # of `insonify.tracers.labels.PATHS`


def find_listeners(simulation: Simulation, place: Floats, pings: Integers) -> tuple[Listener, ...]:
    """Find the pixels in which a place of the bed or of a target echoes."""
    found: list[Listener] = []
    for ping, side, azimuth, level in _within_beam(simulation, place, pings):
        found += _listen(simulation, place, int(ping), int(side), float(azimuth), float(level))
    return tuple(sorted(found))


def _within_beam(simulation: Simulation, place: Floats, pings: Integers) -> list[tuple[int, int, float, float]]:
    """Pings with a place in their beam: ping, side, azimuth of its plane (rad), ground range (m)."""
    arrays, poses = simulation.reduced, simulation.poses(pings)
    dx, dy, dz = place[0] - poses.x, place[1] - poses.y, place[2] - poses.z
    cos, sin = np.cos(poses.heading), np.sin(poses.heading)
    ahead, left = dx * cos + dy * sin, dy * cos - dx * sin
    r = np.sqrt(dx * dx + dy * dy + dz * dz)
    along = (ahead * np.cos(poses.pitch) + dz * np.sin(poses.pitch)) / np.maximum(r, 1e-9)
    if arrays.half_width <= 0.0:
        within, azimuth, level = abs(ahead) <= STRIP, np.zeros(r.size), abs(left)
    else:
        within = _response(arrays, along, r) >= FAINT
        azimuth, level = np.arctan2(ahead, abs(left)), np.hypot(dx, dy)
    within &= r < arrays.bins * arrays.bin_length
    side = (left < 0.0).astype(np.int64)
    return [(pings[k], side[k], azimuth[k], level[k]) for k in np.flatnonzero(within)]


def _response(arrays: SceneArrays, along: Floats, r: Floats) -> Floats:
    """Two-way response of the beam along the track, by the part of the direction along the fish's axis."""
    pattern = arrays.pattern
    if not pattern.tabulated:
        return (abs(along) <= math.sin(arrays.half_width)).astype(np.float64)
    octaves = np.log2(np.maximum(r / pattern.first_range, 1.0)) * pattern.per_octave
    rows = np.minimum(np.rint(octaves).astype(np.int64), len(pattern.extent) - 1)
    columns = np.linspace(-1.0, 1.0, pattern.energy.shape[1])
    off = (along - pattern.centre) / pattern.extent[rows]
    return np.array([np.interp(s, columns, pattern.energy[row], left=0.0, right=0.0) for s, row in zip(off, rows)])


def _listen(
    simulation: Simulation, place: Floats, ping: int, side: int, azimuth: float, level: float
) -> list[Listener]:
    """Bins of one side of one ping in which a place in the plane of an azimuth echoes."""
    arrays, pose = arrays_at(simulation, ping)
    _, folded = make_apparent_tables(arrays, pose)
    if folded.any():
        return []
    fan = lay_planes(arrays, pose, 1).of(0)._replace(azimuth=np.array([azimuth]))
    parts = find_direct_parts(arrays, pose, side, whole_window(arrays), fan)
    low, high = np.minimum(parts.begin, parts.end) - BESIDE, np.maximum(parts.begin, parts.end) + BESIDE
    at = np.array([level, place[2]])
    near = (parts.state == VISIBLE) & (low <= at).all(axis=1) & (high >= at).all(axis=1)
    found = []
    if near.any():
        off = np.linalg.norm(parts.middle - at, axis=1)
        k = int(np.argmin(np.where(near, off, np.inf)))
        r = math.hypot(level, float(place[2] - pose.z[0]))
        if arrays.water.bent:
            x = (parts.begin[k, 0], parts.end[k, 0])
            r = float(np.interp(level, np.sort(x), (parts.near[k], parts.far[k])[:: 1 if x[0] <= x[1] else -1]))
        found.append(Listener(ping, side, int(r / arrays.bin_length), "direct"))
    if arrays.multipath.enabled:
        found += _listen_by_surface(simulation, arrays, pose, (ping, side, azimuth, level), place)
    return found


def _listen_by_surface(
    simulation: Simulation, arrays: SceneArrays, pose: Poses, where: tuple[int, int, float, float], place: Floats
) -> list[Listener]:
    """Bins of one side of one ping in which a place echoes by way of the sea surface."""
    ping, side, azimuth, level = where
    sonar, found = locate_sonar(simulation, pose, side), []
    fan, raised = (laid.of(0)._replace(azimuth=np.array([azimuth])) for laid in lay_planes_of_images(arrays, pose, 1))
    fans = fan, raised
    for path in range(SURFACE_BOTTOM, SURFACE):
        k = int(path_range(sonar, path, level, float(place[2])) / arrays.bin_length)
        if not 0 <= k < arrays.bins:
            continue
        first, last = max(k - 1, 0), min(k + 2, arrays.bins)
        parts = find_surface_parts(arrays, pose, side, Window(first, np.ones((3, last - first))), fans)
        near = abs(parts.begin[:, 0] - level) <= max(BESIDE, WIDE * level)
        if (near & (parts.path == path)).any():
            found.append(Listener(ping, side, k, PATHS[path]))
    return found
