"""Targets and multipaths out of reach of every ping, which are left out without an error."""

from __future__ import annotations

import math

from insonify.planning.target_errors import locate_target, outline_of
from insonify.scene import Scene
from insonify.scene.surfaces import WAYS
from insonify.scene.targets import Target

FARTHER = 1.1  # bound on how much farther refracted sound travels in the time of a slant range
HIGHEST = 5.0  # bound on heights of bed and waves, in rms heights


def find_targets_in_reach(scene: Scene) -> tuple[int, ...]:
    """Return the indices of targets within reach of an endless straight track; all where the track is not straight."""
    track = scene.track
    if not all(motion.keeps_line for motion in track.motions):
        return tuple(range(len(scene.targets)))
    strayed = sum(motion.greatest_sway for motion in track.motions)
    reach = FARTHER * scene.sonar.range + strayed
    distances = (_distance(scene, target) for target in scene.targets)
    return tuple(k for k, distance in enumerate(distances) if distance <= reach + outline_of(scene, k).radius)


def _distance(scene: Scene, target: Target) -> float:
    """Horizontal distance of a target from the line of the track, continued endlessly from its start."""
    along, athwart = locate_target(scene, target)
    return math.hypot(min(along, 0.0), athwart)


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


def bound_echo_advance(scene: Scene, rms_bed: float) -> dict[str, float]:
    """Bound by how much slant range the first echo of each multipath may precede that over a level bed, in metres.

    Parameters
    ----------
    scene : Scene
    rms_bed : float
        Rms height of the bed, in metres.
    """
    surface = scene.water.surface
    waves = HIGHEST * surface.rms_height
    # A measured bed may lie at any depth.
    bed = math.inf if scene.seabed.relief.measured else HIGHEST * rms_bed
    bed += max((2.0 * outline_of(scene, k).radius for k in range(len(scene.targets))), default=0.0)
    return {
        "surface_bottom": bed + waves,
        "surface_bottom_surface": bed + 2.0 * waves,
        "second_bottom": 3.0 * bed + waves,
        "surface_echo": waves,
    }
