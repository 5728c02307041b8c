"""Echoes of targets estimated for a plan: strength of their sides, length along the track and depth in range.

First-order estimates: each side is evenly insonified, hides no other side and lies over a level bed. Vectors have
components along the track, away from it and up.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from insonify.acoustics.error_range import ERROR_ALTITUDES
from insonify.errors import located
from insonify.planning.scene_summary import SceneSummary
from insonify.scene import Scene
from insonify.scene.targets import Target
from insonify.scene.targets.shape import Outline, Triple
from insonify.scene.targets.sides import SLIGHT, Side, Sight


class ObservedTarget(NamedTuple):
    """Dimensions and echoes of a target as seen from the ping abreast of it."""

    number: int  # index among all targets of the scene
    kind: str
    combed: float  # error of a single plane across it, see fitted_laws
    place: float  # along the track, m
    distance: float  # slant range, m
    length: float  # along the track, m
    width: float  # of the beam at the target, m
    sides: tuple[Side, ...]
    shadow: float  # length of the shadow in slant range beyond ERROR_ALTITUDES altitudes, m
    grazing: float  # sine of the grazing angle of a level bed at that distance


def outline_of(scene: Scene, number: int) -> Outline:
    """Outline of a target of a scene.

    Raises
    ------
    SceneError
        If its file cannot be read.
    """
    with located(f"targets.{number}"):
        return scene.targets[number].outline


def observe_target(scene: Scene, view: SceneSummary, number: int) -> ObservedTarget | None:
    """Describe a target as seen at right angles to the track; None for one below the bed.

    Parameters
    ----------
    scene : Scene
    view : SceneSummary
        Lengths of the scene.
    number : int
        Index of the target.

    Returns
    -------
    ObservedTarget or None

    Raises
    ------
    SceneError
        If its file cannot be read.
    """
    target, altitude = scene.targets[number], max(view.altitude, SLIGHT)
    place, away = locate_target(scene, target)
    axes = _axes(target, scene.track.heading, math.copysign(1.0, away))
    outline = outline_of(scene, number)
    along, across, up = (outline.extent([axis[k] for axis in axes]) for k in range(3))
    is_free = len(target.position) == 3
    top = target.position[-1] + scene.seabed.depth + up if is_free else target.underside + 2.0 * up
    if top <= 0.0:
        return None
    height, x = min(top, 2.0 * up), min(abs(away), view.ground)
    rise = altitude - top + 0.5 * height
    distance = max(math.hypot(x, rise), SLIGHT)
    half_depth = across * x / distance + up * abs(rise) / distance
    sight = Sight(*axes, (0.0, -x / distance, rise / distance), 2.0 * along, half_depth)
    # The shadow ends where the line over the top of the target meets the level bed.
    end = min(math.hypot(x * altitude / (altitude - top), altitude) if top < altitude else math.inf, view.reach)
    # Parts sunk into the bed, or nearer than ERROR_ALTITUDES altitudes, do not count.
    share = height / (2.0 * up) * _share(distance - half_depth, distance + half_depth, ERROR_ALTITUDES * altitude)
    sides = (side._replace(echo=share * side.echo) for side in target.sides(sight))
    return ObservedTarget(
        number=number,
        kind=target.kind,
        combed=target.combed,
        place=place,
        distance=distance,
        length=2.0 * along,
        width=2.0 * distance * math.sin(view.half_width),
        sides=tuple(side for side in sides if side.echo > 0.0),
        shadow=max(end - max(distance, ERROR_ALTITUDES * altitude), 0.0),
        grazing=min(altitude / distance, 1.0),
    )


def locate_target(scene: Scene, target: Target) -> tuple[float, float]:
    """Position of a target along the line of the track, and to port of it, in metres."""
    x, y = (target.position[k] - scene.track.start[k] for k in (0, 1))
    c, s = math.cos(math.radians(scene.track.heading)), math.sin(math.radians(scene.track.heading))
    return x * c + y * s, y * c - x * s


def _axes(target: Target, track: float, side: float) -> tuple[Triple, Triple, Triple]:
    """Directions of the bow, port side and top of a target, turned by heading from the track, pitch, then roll."""
    heading, pitch, roll = target.attitude
    angles = map(math.radians, (heading - track, pitch, roll))
    (ch, sh), (cp, sp), (cr, sr) = ((math.cos(angle), math.sin(angle)) for angle in angles)
    bow = (ch * cp, side * sh * cp, sp)
    port = (-ch * sp * sr - sh * cr, side * (ch * cr - sh * sp * sr), cp * sr)
    return bow, port, (sh * sr - ch * sp * cr, -side * (sh * sp * cr + ch * sr), cp * cr)


def _share(low: float, high: float, limit: float) -> float:
    """Share of an interval that lies beyond a limit."""
    return min(max((high - limit) / max(high - low, SLIGHT), 0.0), 1.0)
