"""Handles of targets in scene and record, what a drag changes, and where a line of sight ends."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from insonify.arrays import Floats
from insonify.scene import Scene
from insonify.scene.edit import part_at
from insonify.scene.targets import Target
from insonify_viewer.core_types import AnyGround, Simulation
from insonify_viewer.state.inspection import Mark
from insonify_viewer.state.quantities import nearest_within

Place = tuple[float, float, float]
Action = Literal["move", "turn", "resize", "thicken", "raise"]
BESIDE = 0.06  # slant ranges by which the handle that turns stands beyond the end of a target
ASIDE = 0.1  # slant ranges by which the handles that thicken and raise stand off its sides, clear of the one that moves
NEAR = 0.03  # slant ranges about a target within which a place belongs to it
AROUND = 96  # pings about the one that straight tow lines give, in which an echo is looked for
SMALLEST, LARGEST = 0.02, 50.0  # factors by which one drag resizes
DIGITS = 3  # of positions and sizes in metres
BLOCK = 512  # places at which echoes are found in one batch, to bound memory
SAMPLES = 4096  # along the line
HALVINGS = 30
CLEAR = 2.0  # m above the highest bed known, and below the lowest, between which the line is looked at


@dataclass(frozen=True)
class Handle:
    """A place by which a target is dragged."""

    target: int  # position of the target in the scene
    # What a drag does: ``move``, ``turn``, ``resize``, ``thicken`` across the heading alone, or ``raise`` in
    # height.
    action: Action
    place: Place  # (float, float, float) local coordinates, in metres


def handles_of(simulation: Simulation, chosen: int | None) -> tuple[Handle, ...]:
    """List the handles of the targets that are not locked: all can be moved, the chosen one turned and resized too."""
    scene = simulation.scene
    found: list[tuple[int, Action, float, float]] = []  # target, what a drag does, how far ahead and aside
    for number, target in enumerate(scene.targets):
        if target.locked:
            continue
        found.append((number, "move", 0.0, 0.0))
        if number == chosen:
            half = half_length(target)
            if "heading" in type(target).model_fields.keys() - target.idle_fields:
                found.append((number, "turn", half + BESIDE * scene.sonar.range, 0.0))
            aside = half_width(target) + ASIDE * scene.sonar.range
            stands: dict[Action, tuple[float, float]] = {
                "resize": (half, 0.0), "thicken": (0.0, aside), "raise": (0.0, -aside)
            }  # fmt: skip
            found += [(number, action, *stand) for action, stand in stands.items() if target.sizes.get(action)]
    places = _places(simulation, [(scene.targets[number], ahead, aside) for number, _, ahead, aside in found])
    return tuple(Handle(number, action, place) for (number, action, *_), place in zip(found, places))


def half_length(target: Target) -> float:
    """Half of the length of a target along its heading, in metres."""
    return target.outline.extent((1.0, 0.0, 0.0))


def half_width(target: Target) -> float:
    """Half of the width of a target across its heading, in metres."""
    return target.outline.extent((0.0, 1.0, 0.0))


def target_at(scene: Scene, x: float, y: float) -> int | None:
    """Find the target nearest to a place, if it is within its plan or close to it."""
    margin = NEAR * scene.sonar.range
    return nearest_within([_distance(target, x, y) for target in scene.targets], margin)


def drag_edit(scene: Scene, handle: Handle, begun: Place, now: Place) -> dict[str, Any]:
    """Edit that a drag of a handle makes."""
    target, path = scene.targets[handle.target], f"targets.{handle.target}"
    x, y, *height = target.position
    if handle.action == "move":
        there = [round(x + now[0] - begun[0], DIGITS), round(y + now[1] - begun[1], DIGITS)]
        return {f"{path}.position": [*there, *height]}
    # An echo from above the bed arrives before that of the bed beneath it: the mouse shows how far the handle moved.
    first = handle.place[0] - x, handle.place[1] - y
    last = first[0] + now[0] - begun[0], first[1] + now[1] - begun[1]
    if handle.action == "turn":
        turned = math.degrees(math.atan2(last[1], last[0]) - math.atan2(first[1], first[0]))
        heading = float(target.attitude[0]) + turned
        return {f"{path}.heading": round((heading + 180.0) % 360.0 - 180.0, 1)}
    factor = min(max(math.hypot(*last) / max(math.hypot(*first), 1e-6), SMALLEST), LARGEST)
    sizes = {name: part_at(target, name) or target.value_in_force(name) for name in target.sizes[handle.action]}
    return {f"{path}.{name}": _scaled(size, factor) for name, size in sizes.items() if size is not None}


def echo_mark(simulation: Simulation, place: Place) -> Mark | None:
    """Find the bin of the direct echo of a place abeam; None if it is out of range or never abeam."""
    return echo_marks(simulation, [place])[0]


def echo_marks(simulation: Simulation, places: Sequence[Place]) -> list[Mark | None]:
    """Find the bins of the direct echoes of places abeam; None of each out of range or never abeam."""
    blocks = (places[first : first + BLOCK] for first in range(0, len(places), BLOCK))
    return [mark for block in blocks for mark in _echo_marks(simulation, np.array(block))]


def _echo_marks(simulation: Simulation, places: Floats) -> list[Mark | None]:
    """Find the bins of the direct echoes of some places, (n, 3)."""
    scene, arrays = simulation.scene, simulation.arrays
    step = scene.track.speed / scene.sonar.ping_rate
    line = simulation.line(np.zeros(1, dtype=np.int64))
    heading = float(line.heading[0])
    x, y, z = places.T[:, :, None]
    ahead = (x - line.x[0]) * math.cos(heading) + (y - line.y[0]) * math.sin(heading)
    pings = np.rint(ahead / step).astype(np.int64) + np.arange(-AROUND, AROUND + 1)  # (n, 2 AROUND + 1)
    met = pings >= 0
    sent, which = np.unique(np.maximum(pings, 0), return_inverse=True)
    pose = simulation.poses(sent)
    which = which.reshape(pings.shape)
    cosine, sine = np.cos(pose.heading)[which], np.sin(pose.heading)[which]
    dx, dy, dz = x - pose.x[which], y - pose.y[which], z - pose.z[which]
    slant = np.sqrt(dx**2 + dy**2 + dz**2)
    # The beam is a cone about the axis of the fish, squinted from the plane athwart.
    off = np.where(met, np.abs(dx * cosine + dy * sine - arrays.pattern.centre * slant), np.inf)
    nearest = np.arange(len(places)), np.argmin(off, axis=1)
    seen = (off[nearest] <= 2.0 * step) & (slant[nearest] < arrays.bins * arrays.bin_length)
    starboard = (dy * cosine - dx * sine)[nearest] < 0.0
    found = np.stack([pings[nearest], starboard, slant[nearest] / arrays.bin_length], axis=1).astype(np.int64)
    return [Mark(*bins) if is_seen else None for bins, is_seen in zip(found.tolist(), seen.tolist())]


def _places(simulation: Simulation, wanted: Sequence[tuple[Target, float, float]]) -> list[Place]:
    """Places at half the height of targets, some way ahead of their centres and to their port sides."""
    level = []
    for target, ahead, aside in wanted:
        (x, y, *_), angle = target.position, math.radians(float(target.attitude[0]))
        cosine, sine = math.cos(angle), math.sin(angle)
        level.append((x + ahead * cosine - aside * sine, y + ahead * sine + aside * cosine))
    east, north = np.array(level).reshape(-1, 2).T
    beds = np.nan_to_num(simulation.ground.height_at_once(east, north)).tolist()
    return [
        (*place, target.position[2] - simulation.ground.datum)
        if len(target.position) == 3
        else (*place, bed + target.underside + target.outline.extent((0.0, 0.0, 1.0)))
        for place, bed, (target, *_) in zip(level, beds, wanted)
    ]


def _distance(target: Target, x: float, y: float) -> float:
    """Horizontal distance of a place from the box about a target, 0 inside it, in metres."""
    angle = math.radians(float(target.attitude[0]))
    dx, dy = x - target.position[0], y - target.position[1]
    along = abs(dx * math.cos(angle) + dy * math.sin(angle)) - half_length(target)
    across = abs(dy * math.cos(angle) - dx * math.sin(angle)) - half_width(target)
    return math.hypot(max(along, 0.0), max(across, 0.0))


def _scaled(size: float, factor: float) -> float:
    return max(round(size * factor, DIGITS), 10.0**-DIGITS)


def meet_bed(
    ground: AnyGround, begin: Floats, end: Floats, heights: tuple[float, float]
) -> tuple[float, float, float] | None:
    """Find where a line of sight meets the bed first."""
    way = end - begin
    if way[2] >= 0.0:
        return None
    first, last = ((level - begin[2]) / way[2] for level in (heights[1] + CLEAR, heights[0] - CLEAR))
    first, last = max(first, 0.0), min(last, 1.0)
    if first >= last:
        return None
    share = np.linspace(first, last, SAMPLES)
    below = _above(ground, begin, way, share) <= 0.0  # NaN, where there is no bed, compares false
    if not below.any():
        return None
    k = int(np.argmax(below))
    low, high = share[max(k - 1, 0)], share[k]
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if _above(ground, begin, way, np.array([middle]))[0] <= 0.0 else (middle, high)
    x, y, z = begin + high * way
    return float(x), float(y), float(z)


def _above(ground: AnyGround, begin: Floats, way: Floats, share: Floats) -> Floats:
    """Heights of points of the line above the bed, m."""
    points = begin + np.multiply.outer(share, way)
    return np.asarray(points[:, 2] - ground.height_at_once(points[:, 0], points[:, 1]))
