"""Lines of a survey in order, and the track that joins them."""

import math
from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.errors import SceneError
from insonify.surveys.lines.specification import Area, SurveySpecification

MOST_LINES = 9999
ARC_STEP = math.radians(1.0)  # between fixes of a turn; the chord misses an arc of 30 m by 1 mm


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

    time: NDArray[np.float64]  # (n,) seconds, metres, degrees
    x: NDArray[np.float64]
    y: NDArray[np.float64]
    heading: NDArray[np.float64]
    pings: list[range]  # of each line, with its turn


def lay_lines(specification: SurveySpecification) -> list[SurveyLine]:
    """Return the lines of a survey, in order."""
    if specification.area is not None:
        return lay_lawnmower(specification.area)
    return [SurveyLine(line.start, line.end) for line in specification.lines]


def lay_lawnmower(area: Area) -> list[SurveyLine]:
    """Cover an area by parallel lines, to and fro, in the middle of strips of equal width."""
    ahead = np.array([math.cos(math.radians(area.heading)), math.sin(math.radians(area.heading))])
    aside = np.array([-ahead[1], ahead[0]])
    corners = np.array(area.corners) @ np.stack([ahead, aside], axis=1)
    low, high = float(corners[:, 1].min()), float(corners[:, 1].max())
    count = max(math.ceil((high - low) / area.spacing), 1)
    if count > MOST_LINES:
        raise SceneError(f"area.spacing: {area.spacing:g} m makes {count} lines; widen it, {MOST_LINES} are the most")
    offsets = 0.5 * (low + high) + area.spacing * (np.arange(count) - 0.5 * (count - 1))
    spans = [_crossed(corners, offset) for offset in offsets]
    if area.turns == "in":
        spans = _flush(spans)
    lines = []
    for number, (offset, span) in enumerate(zip(offsets, spans)):
        onward = number % 2 == 0
        begin, end = (float(along) * ahead + offset * aside for along in (span if onward else span[::-1]))
        has_turn = area.turns == "in" and number < count - 1
        turn = (0.5 if onward else -0.5) * area.spacing if has_turn else 0.0
        lines.append(SurveyLine((float(begin[0]), float(begin[1])), (float(end[0]), float(end[1])), turn))
    return lines


def _crossed(corners: NDArray[np.float64], offset: float) -> tuple[float, float]:
    """Least and greatest distance ahead at which a line at some distance aside crosses the edges of an area."""
    found = []
    for (x, y), (x_next, y_next) in pairwise([*corners, corners[0]]):
        if min(y, y_next) <= offset <= max(y, y_next):
            share = (offset - y) / (y_next - y) if y != y_next else 0.0
            found += [x + share * (x_next - x)] if y != y_next else [x, x_next]
    return float(min(found)), float(max(found))


def _flush(spans: Sequence[tuple[float, float]]) -> list[tuple[float, float]]:
    """Lengthen lines so that each ends abeam of where the next one begins."""
    flushed = [list(span) for span in spans]
    for number, (one, following) in enumerate(pairwise(flushed)):
        end = 1 - number % 2  # where the line ends: the far edge of every other one
        one[end] = following[end] = max(one[1], following[1]) if end else min(one[0], following[0])
    return [(low, high) for low, high in flushed]


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
        centre = (
            line.end[0] - line.turn * math.sin(line.heading),
            line.end[1] + line.turn * math.cos(line.heading),
        )
        steps = math.ceil(math.pi / ARC_STEP)
        for step in range(1, steps + 1):
            turned = line.heading + math.copysign(math.pi * step / steps, line.turn)
            x = centre[0] + line.turn * math.sin(turned)
            y = centre[1] - line.turn * math.cos(turned)
            yield line.length + abs(line.turn) * math.pi * step / steps, x, y, turned
