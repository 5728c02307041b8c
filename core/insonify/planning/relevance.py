"""Targets and multipaths out of reach of every ping, which are left out without an error."""

import math

from insonify.errors import located
from insonify.kernels.common.types import Bed
from insonify.scene import Scene
from insonify.scene.targets.shape import Outline
from insonify.scene.water.surfaces import WAYS

FARTHER = 1.1  # bound on how much farther refracted sound travels in the time of a slant range
HIGHEST = 5.0  # bound on heights of waves, in rms heights
OTHER_TILES = 2.0  # bound on the heights of endless ground, in those of the tile at the start


def outline_of(scene: Scene, number: int) -> Outline:
    """Outline of a target of a scene."""
    with located(f"targets.{number}."):
        return scene.targets[number].outline


def find_targets_in_reach(scene: Scene) -> tuple[int, ...]:
    """Return the indices of targets within reach of an endless straight track; all where the track is not straight."""
    track = scene.track
    if not all(motion.keeps_line for motion in track.motions):
        return tuple(range(len(scene.targets)))
    strayed = sum(motion.greatest_sway for motion in track.motions)
    reach = FARTHER * scene.sonar.range + strayed
    c, s = math.cos(math.radians(track.heading)), math.sin(math.radians(track.heading))
    found = []
    for k, target in enumerate(scene.targets):
        x, y = (target.position[axis] - track.start[axis] for axis in (0, 1))
        if math.hypot(min(x * c + y * s, 0.0), y * c - x * s) <= reach + outline_of(scene, k).radius:
            found.append(k)
    return tuple(found)


def find_multipaths_in_reach(scene: Scene) -> dict[str, float]:
    """Return the slant range in metres of the first echo of each multipath by the sea surface that a scene declares."""
    surface, altitude = scene.water.surface, scene.altitude
    depth = scene.seabed.depth - altitude
    first = {
        "surface_bottom": depth + altitude,
        "surface_bottom_surface": 2.0 * depth + altitude,
        "second_bottom": 2.0 * altitude + depth,
        "surface_echo": depth,
    }
    return {way: first[way] for way, is_on in zip(WAYS, surface.paths) if is_on}


def find_audible_multipaths(scene: Scene, bed: Bed) -> frozenset[str]:
    """Return the multipaths by the sea surface with echoes that may arrive within the range."""
    waves = HIGHEST * scene.water.surface.rms_height
    # A measured bed may lie at any depth.
    rise = (
        math.inf
        if scene.seabed.relief.measured
        else max(bed.high, 0.0) * (OTHER_TILES if scene.seabed.endless else 1.0)
    )
    rise += max((2.0 * outline_of(scene, k).radius for k in range(len(scene.targets))), default=0.0)
    sooner = {
        "surface_bottom": rise + waves,
        "surface_bottom_surface": rise + 2.0 * waves,
        "second_bottom": 3.0 * rise + waves,
        "surface_echo": waves,
    }
    first = find_multipaths_in_reach(scene)
    return frozenset(way for way in first if first[way] - sooner[way] <= scene.sonar.range)
