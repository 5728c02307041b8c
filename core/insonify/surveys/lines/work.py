"""Work of a survey: each job simulates the record of one line of the one scene, by the plan of the whole.

The lines are joined to one track with consecutive pings.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple, Self

import numpy as np

from insonify.arrays import Floats
from insonify.errors import SceneError
from insonify.io.atomic import replacing
from insonify.io.record_block import RecordBlock
from insonify.io.records import write_record
from insonify.planning import Plan, plan
from insonify.record.variables import make_block, record_attributes
from insonify.scene import Scene, edit
from insonify.simulation import prepare
from insonify.surveys.engine import FLAGS, digest_of, job_number, name_job
from insonify.surveys.lines.specification import Area, SurveySpecification
from insonify.surveys.specification import contents_of

MOST_LINES = 9999
ARC_STEP = math.radians(1.0)  # between fixes of a turn; the chord misses an arc of 30 m by 1 mm
TRACK = "track.csv"
RECORDS = "records"
WARMING = 4  # pings that compile the kernels
TOLERANCE = 0.03
ROUNDING = 1e-9  # of a strip, by which an oblique area may be wider than a whole number of strips


class SurveyLine(NamedTuple):
    """A line of a survey."""

    start: tuple[float, float]  # (float, float) in metres
    end: tuple[float, float]
    # Radius in metres of a half circle that follows and is recorded, to port if positive; 0 without one.
    turn: float = 0.0

    @property
    def length(self) -> float:
        """Length of the straight, in metres."""
        return math.dist(self.start, self.end)

    @property
    def heading(self) -> float:
        """Direction in radians, counter-clockwise from +x."""
        return math.atan2(self.end[1] - self.start[1], self.end[0] - self.start[0])


class SurveyTrack(NamedTuple):
    """Fixes of a whole survey, and the pings of each line."""

    time: Floats  # (n,) seconds, metres, degrees
    x: Floats
    y: Floats
    heading: Floats
    pings: list[range]  # of each line, with its turn


def lay_lawnmower(area: Area) -> list[SurveyLine]:
    """Cover an area by parallel lines, to and fro, in the middle of strips of equal width."""
    ahead = np.array([math.cos(math.radians(area.heading)), math.sin(math.radians(area.heading))])
    aside = np.array([-ahead[1], ahead[0]])
    corners = np.array(area.corners) @ np.stack([ahead, aside], axis=1)
    low, high = float(corners[:, 1].min()), float(corners[:, 1].max())
    count = max(math.ceil((high - low) / area.spacing - ROUNDING), 1)
    if count > MOST_LINES:
        raise SceneError(f"area.spacing: {area.spacing:g} m makes {count} lines; widen it, {MOST_LINES} are the most")
    offsets = 0.5 * (low + high) + area.spacing * (np.arange(count) - 0.5 * (count - 1))
    spans = [_crossed(corners, offset) for offset in offsets]
    if area.turns == "in":
        # Lengthened, so that each ends abeam of where the next one begins.
        for number, (one, following) in enumerate(pairwise(spans)):
            end = 1 - number % 2  # where the line ends: the far edge of every other one
            one[end] = following[end] = max(one[1], following[1]) if end else min(one[0], following[0])
    lines = []
    for number, (offset, span) in enumerate(zip(offsets, spans)):
        onward = number % 2 == 0
        begin, end = (along * ahead + offset * aside for along in (span if onward else span[::-1]))
        has_turn = area.turns == "in" and number < count - 1
        turn = (0.5 if onward else -0.5) * area.spacing if has_turn else 0.0
        lines.append(SurveyLine((float(begin[0]), float(begin[1])), (float(end[0]), float(end[1])), turn))
    return lines


def _crossed(corners: Floats, offset: float) -> list[float]:
    """Least and greatest distance ahead at which a line at some distance aside crosses the edges of an area."""
    found = []
    for (x, y), (x_next, y_next) in pairwise([*corners, corners[0]]):
        if min(y, y_next) <= offset <= max(y, y_next):
            share = (offset - y) / (y_next - y) if y != y_next else 0.0
            found += [x + share * (x_next - x)] if y != y_next else [x, x_next]
    return [float(min(found)), float(max(found))]


def join_lines(lines: Sequence[SurveyLine], speed: float, ping_rate: float) -> SurveyTrack:
    """Join the lines of a survey to one track with consecutive pings."""
    rows: list[tuple[float, float, float, float]] = []
    pings: list[range] = []
    time = 0.0
    for number, line in enumerate(lines):
        begin = time
        if number > 0 and lines[number - 1].turn:
            rows.pop()  # the turn ends where this line begins
        rows += [(begin + along / speed, x, y, math.degrees(heading)) for along, x, y, heading in _fixes(line)]
        time = rows[-1][0]
        # A ping at the very end belongs to a line unless the next line begins there.
        last = math.ceil(time * ping_rate - 1e-9) if line.turn else math.floor(time * ping_rate + 1e-9) + 1
        pings.append(range(math.ceil(begin * ping_rate - 1e-9), last))
        if not line.turn and number + 1 < len(lines):
            away = math.dist(line.end, lines[number + 1].start)
            time = (math.floor((time + away / speed) * ping_rate) + 1) / ping_rate  # the next line begins with a ping
    columns = np.array(rows).T
    columns[3] = np.unwrap(columns[3], period=360.0)
    return SurveyTrack(columns[0], columns[1], columns[2], columns[3], pings)


def _fixes(line: SurveyLine) -> Iterator[tuple[float, float, float, float]]:
    """Distance along a line, place and heading in radians, of its ends and of points of its turn."""
    yield 0.0, *line.start, line.heading
    yield line.length, *line.end, line.heading
    if line.turn:
        x_centre = line.end[0] - line.turn * math.sin(line.heading)
        y_centre = line.end[1] + line.turn * math.cos(line.heading)
        steps = math.ceil(math.pi / ARC_STEP)
        for step in range(1, steps + 1):
            turned = line.heading + math.copysign(math.pi * step / steps, line.turn)
            x = x_centre + line.turn * math.sin(turned)
            y = y_centre - line.turn * math.cos(turned)
            yield line.length + abs(line.turn) * math.pi * step / steps, x, y, turned


@dataclass(frozen=True)
class SurveyWork:
    """The jobs of a survey."""

    specification: SurveySpecification
    base: Scene  # scene; its track is replaced
    folder: Path  # folder of the survey
    plan: Plan | None = None  # plan of the whole survey, which is sent to the workers

    @cached_property
    def lines(self) -> list[SurveyLine]:
        """The lines, in order."""
        if self.specification.area is not None:
            return lay_lawnmower(self.specification.area)
        return [SurveyLine(line.start, line.end) for line in self.specification.lines]

    @cached_property
    def track(self) -> SurveyTrack:
        """The track that joins the lines."""
        surveyed = edit(self.base, self.specification.set)
        return join_lines(self.lines, surveyed.track.speed, surveyed.sonar.ping_rate)

    @cached_property
    def digest(self) -> str:
        """Hash of all that every job depends on."""
        return digest_of(*contents_of(self.specification, self.base))

    @cached_property
    def scene(self) -> Scene:
        """The scene with the track of the whole survey; the fixes are in a file of the survey's folder."""
        return self._towed_along(str(self.folder / FLAGS / TRACK))

    def _towed_along(self, path: str) -> Scene:
        """Return the scene with the fixes in a file."""
        surveyed = edit(self.base, self.specification.set)
        recorded = {"kind": "recorded", "path": path}
        others = [motion.model_dump(mode="json") for motion in surveyed.track.motions if motion.moves]
        motion = {"kind": "sum", "of": [recorded, *others]} if others else recorded
        first = self.lines[0]
        changes = {
            "track.start": list(first.start),
            "track.heading": math.degrees(first.heading),
            "track.pings": self.track.pings[-1].stop,
            "track.motion": motion,
        }
        return edit(surveyed, changes)

    def names(self) -> list[str]:
        """Names of all jobs."""
        return [name_job(number, self.digest) for number in range(len(self.lines))]

    def begun(self) -> Self:
        """Write the track, and plan the survey."""
        path = self.folder / FLAGS / TRACK
        path.parent.mkdir(parents=True, exist_ok=True)
        rows = np.column_stack(self.track[:4])
        with replacing(path) as beside:
            np.savetxt(beside, rows, fmt="%.9g", delimiter=",", header="time,x,y,heading", comments="")
        return replace(self, plan=plan(self.scene, TOLERANCE))

    def make(self, name: str, beside: Path) -> dict[str, Any]:
        """Simulate the record of a line below a folder, and describe it."""
        number = job_number(name)
        file = f"{RECORDS}/line-{number + 1:04d}{self.specification.suffix}"
        (beside / file).parent.mkdir()
        pings = self.track.pings[number]
        write_record(beside / file, self._blocks(pings))
        line = self.lines[number]
        return {
            "made": 1,
            "line": number,
            "file": file,
            "start": list(line.start),
            "end": list(line.end),
            "heading": round(math.degrees(line.heading), 6),
            "length": round(line.length, 6),
            "turn": round(line.turn, 6),
            "first_ping": pings.start,
            "pings": len(pings),
        }

    def warm_up(self) -> None:
        """Simulate a few pings."""
        prepare(self.scene, plan=self.plan).intensity(np.arange(WARMING))

    def _blocks(self, pings: range) -> Iterator[RecordBlock]:
        """Record of some pings, block by block."""
        simulation = prepare(self.scene, plan=self.plan)
        # In the file, the track's path begins at the folder of records: the folder of the survey can be moved.
        scene = self._towed_along(f"../{FLAGS}/{TRACK}")
        attributes = record_attributes(scene, simulation.plan, "auto", TOLERANCE, None)
        for block in simulation.record_blocks(pings=pings):
            yield make_block(self.scene, simulation.ground, *block, None, attributes)
