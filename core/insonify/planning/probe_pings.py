"""Choice of the few pings of a track on which a plan measures errors.

Some pings are spread over the track, one at an irregular place within each of as many equal parts, so that no period of
bed or motion falls in step with them. Where a measured bed ends or has holes, only pings within range of the bed count.
The greatest excursions of the fish are added, and pings in which the beam crosses targets: a target may be met by one
ping in a thousand.
"""

import math
from typing import NamedTuple

import numpy as np

from insonify.arrays import Booleans, Floats, Integers
from insonify.scene import Scene
from insonify.terrain import AnyGround
from insonify.tow.line import tow_line_at
from insonify.tow.poses import make_poses

SPREAD = 16  # pings over the track
ACROSS, MOST_ACROSS = 3, 12  # pings across each target, fewer where there are many targets; across all of them
MADE_AT_ONCE = 512  # pings over endless ground on which errors are measured
OF_PLANES = np.array([0.0, 0.5, -0.25])  # axis, one of two planes, one of four: shares of the half width
EXCURSIONS = 256  # pings among which the greatest excursions of the fish are found
ACROSS_SWATH = 65  # places across the track at which a measured bed is looked for
COARSE_TRACK = 2048  # pings at which distances to targets are first evaluated
FARTHER = 1e-3  # weight of the distance of a target against that from the beam's axis: of two passes the nearer one
GOLDEN = 0.5 * (math.sqrt(5.0) - 1.0)


class ProbePings(NamedTuple):
    """Pings on which errors are measured."""

    spread: Integers  # (n,) pings over the whole track
    across: Integers  # (m,) pings in which the beam crosses targets
    loud: Integers = np.zeros(0, np.int64)  # those over the track that are louder than others

    @property
    def all(self) -> Integers:
        """All of them, (n + m,)."""
        return np.concatenate([self.spread, self.across])

    def interleaved(self) -> tuple[Integers, Booleans]:
        """Return all of them, loud ones first, the others so that few are spread like all; and which cross targets."""
        parts = self.spread, self.across
        place = [(GOLDEN * np.arange(part.size) % 1.0).argsort(kind="stable").argsort() for part in parts]
        order = np.argsort(np.concatenate(place), kind="stable")
        return self.all[order], (order >= self.spread.size)


def choose_probe_pings(
    scene: Scene, ground: AnyGround, targets: tuple[int, ...], half_width: float = 0.0
) -> ProbePings:
    """Choose the pings on which a plan measures errors."""
    spread = spread_over_track(scene, SPREAD)
    if scene.seabed.relief.measured:
        spread = _spread_over_bed(scene, ground, scene.track.pings)
    if scene.track.motions:
        many = spread_over_track(scene, EXCURSIONS)
        # The lowest and highest sonar, and the greatest pitch, roll and yaw about their means.
        poses = make_poses(scene, ground, many)
        columns = (poses.z, -poses.z, *(np.abs(column - column.mean()) for column in poses[3:]))
        greatest = [int(np.argmax(column)) for column in columns if np.ptp(column) > 0.0]
        spread = np.union1d(spread, many[greatest])
    return ProbePings(spread, _across(scene, targets, half_width))


def spread_over_track(scene: Scene, count: int) -> Integers:
    """One ping from each of ``count`` equal parts of the track; far along endless ground the bed has yet to be made."""
    return _spread(min(scene.track.pings, MADE_AT_ONCE) if scene.seabed.endless else scene.track.pings, count)


def _spread(pings: int, count: int) -> Integers:
    """One ping from each of ``count`` equal parts of the track.

    Its place within the part is the fraction of k² times the golden ratio: unlike the fraction of k, it is in step with
    no period.
    """
    edges = np.arange(min(count, pings) + 1) * pings // min(count, pings)
    within = GOLDEN * np.arange(1, edges.size) ** 2 % 1.0
    return edges[:-1] + (within * np.diff(edges)).astype(np.int64)


def _spread_over_bed(scene: Scene, ground: AnyGround, pings: int) -> Integers:
    """Pings spread over those within range of a measured bed, or over all if none is."""
    first, last = 0, pings - 1
    for _ in range(2):  # the second time from the first to the last of them, where they are few
        many = first + _spread(last - first + 1, EXCURSIONS)
        over = many[_is_over_bed(scene, ground, many)]
        if not 0 < over.size < many.size:
            break
        first, last = int(over[0]), int(over[-1])
    if 0 < over.size < many.size:
        return over[_spread(over.size, SPREAD)]
    return first + _spread(last - first + 1, SPREAD)


def _is_over_bed(scene: Scene, ground: AnyGround, pings: Integers) -> Booleans:
    """Whether a measured bed, which may end or have holes, lies within reach to either side of each ping."""
    line = tow_line_at(scene, pings[:, None])
    away = np.linspace(-scene.sonar.range, scene.sonar.range, ACROSS_SWATH)
    heights = ground.height_at(line.x - away * np.sin(line.heading), line.y + away * np.cos(line.heading))
    return np.asarray(np.isfinite(heights).any(axis=1))


def _across(scene: Scene, targets: tuple[int, ...], half_width: float) -> Integers:
    """Pings in which the axis of the beam meets each target, one of two planes or one of four."""
    if not targets:
        return np.zeros(0, dtype=np.int64)
    each = max(min(ACROSS, MOST_ACROSS // len(targets)), 1)
    step = scene.track.speed / scene.sonar.ping_rate
    found: list[int] = []
    nearest = sorted((_nearest_ping(scene, number), number) for number in targets)
    for (distance, ping), number in nearest[:MOST_ACROSS]:
        half = 0.5 * scene.targets[number].outline.radius / step
        widest = max(math.tan(half_width) * distance / step, 2.0 * half, 2.0)
        places = OF_PLANES[:each] * widest + (GOLDEN * (number + 1) % 1.0 - 0.5) * half
        found += (ping + np.rint(places).astype(np.int64)).tolist()
    return np.unique(np.clip(np.array(found, dtype=np.int64), 0, scene.track.pings - 1))


def _nearest_ping(scene: Scene, number: int) -> tuple[float, int]:
    """Distance in metres of a target from the ping with the beam axis nearest to it, and that ping."""
    last = scene.track.pings - 1
    stride = -(-scene.track.pings // COARSE_TRACK)
    pings = np.arange(0, last + 1, stride)
    while True:
        miss, distance = _miss(scene, number, pings)
        best = int(np.argmin(miss + FARTHER * distance))
        if stride == 1:
            return float(distance[best]), int(pings[best])
        pings = np.arange(max(pings[best] - stride, 0), min(pings[best] + stride, last) + 1)
        stride = 1


def _miss(scene: Scene, number: int, pings: Integers) -> tuple[Floats, Floats]:
    """Distance along the track between the beam's axis and a target, and that between sonar and target, m."""
    line = tow_line_at(scene, pings)
    dx, dy = (scene.targets[number].position[k] - column for k, column in enumerate((line.x, line.y)))
    c, s = np.cos(line.heading), np.sin(line.heading)
    along, away = dx * c + dy * s, np.abs(dy * c - dx * s)
    return np.abs(along - math.tan(math.radians(scene.sonar.beam.axis)) * away), np.hypot(along, away)
