"""The line of a tow: straight, with turns, or recorded; in closed form, so that no ping needs those before it."""

import math
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from insonify.arrays import Floats, Integers, Reals
from insonify.io.georeference import Georeference, convergence, project
from insonify.io.navigation import RecordedNavigation
from insonify.scene import Scene, SceneError
from insonify.scene.targets.shape import exact_cos
from insonify.scene.track import Track

STRAIGHT = 1e-30  # rad/m, below which a turn is a straight line
ANGLES = ("heading", "pitch", "roll")


class TowLine(NamedTuple):
    """Positions and headings along the line of a tow."""

    x: Floats  # local coordinates in metres
    y: Floats
    heading: Floats  # radians counter-clockwise from +x


def tow_line_at(scene: Scene, pings: Reals | Integers) -> TowLine:
    """Positions along the line of a tow, without the motion of the fish about it."""
    track = scene.track
    line = _follow_turns(track, np.asarray(pings, dtype=np.float64) * (track.speed / scene.sonar.ping_rate))
    known = recorded_at(scene, pings)
    return TowLine(known.get("x", line.x), known.get("y", line.y), known.get("heading", line.heading))


class _Pieces(NamedTuple):
    """Successive arcs; each begins where the last one ends."""

    begin: Floats  # (k,) metres along the line
    x: Floats
    y: Floats
    heading: Floats  # degrees
    curvature: Floats  # rad/m, to port
    cos: Floats  # of the heading, exact on the axes
    sin: Floats


def _follow_turns(track: Track, along: Floats) -> TowLine:
    """Positions at given distances along a line with turns, in metres."""
    pieces = _pieces(track)
    at = np.maximum(np.searchsorted(pieces.begin, along, side="right") - 1, 0)
    x, y, heading, curvature = pieces.x[at], pieces.y[at], pieces.heading[at], pieces.curvature[at]
    beyond = along - pieces.begin[at]
    # The chord of an arc through the angle 2a is 2 sin(a) / curvature long and lies at a to its beginning.
    # Whole circles are taken off first, so that it is as exact far along the tow.
    half = np.fmod(0.5 * curvature * beyond, 2.0 * math.pi)
    curved = np.abs(curvature) > STRAIGHT
    chord = np.where(curved, 2.0 * np.sin(half) / np.where(curved, curvature, 1.0), beyond)
    way = np.radians(heading) + half
    return TowLine(
        x=x + np.where(curved, np.cos(way), pieces.cos[at]) * chord,
        y=y + np.where(curved, np.sin(way), pieces.sin[at]) * chord,
        heading=np.radians(heading) + curvature * beyond,
    )


@lru_cache(maxsize=16)
def _pieces(track: Track) -> _Pieces:
    """Arcs of a line, cut where a turn begins or ends; turns that overlap add up."""
    turnings = [motion.turning for motion in track.motions if motion.turning is not None]
    changes = [(begin, rate) for begin, _, rate in turnings if rate]
    changes += [(begin + duration, -rate) for begin, duration, rate in turnings if rate]
    times = sorted({0.0, *(time for time, _ in changes)})
    rates = [math.fsum(rate for time, rate in changes if time <= began) for began in times]
    rows = [(0.0, *track.start, track.heading, math.radians(rates[0]) / track.speed)]
    for time, rate in zip(times[1:], rates[1:]):
        began, x, y, heading, curvature = rows[-1]
        along = time * track.speed
        half = 0.5 * curvature * (along - began)
        chord = 2.0 * math.sin(half) / curvature if abs(curvature) > STRAIGHT else along - began
        way = heading + math.degrees(half)
        end = (along, x + exact_cos(way) * chord, y + exact_cos(way - 90.0) * chord, heading + math.degrees(2.0 * half))
        rows.append((*end, math.radians(rate) / track.speed))
    columns = np.array(rows).T
    cosines = [[exact_cos(heading - turned) for heading in columns[3]] for turned in (0.0, 90.0)]
    return _Pieces(*columns, *np.array(cosines))


def recorded_at(scene: Scene, pings: Reals | Integers) -> dict[str, Floats]:
    """Interpolate the recorded position and attitude of the fish at pings; the first row is the first ping."""
    track = scene.track
    recordings = [recording for motion in track.motions if (recording := motion.recording()) is not None]
    if not recordings:
        return {}
    time = np.asarray(pings, dtype=np.float64) / scene.sonar.ping_rate
    known: dict[str, Floats] = {}
    for path, unplaced in recordings:
        tow = unplaced if unplaced.place is None else _on_the_map(unplaced, scene.georeference)
        both = sorted(known.keys() & tow.columns.keys())
        if both:
            raise SceneError(f"track.motion.of: {path!r} repeats {both[0]} of another file; leave it out of one")
        known |= _at(tow, time, track.speed)
    _reject_conflicting_settings(track, known)
    return known


@lru_cache(maxsize=4)
def _on_the_map(tow: RecordedNavigation, place: Georeference | None) -> RecordedNavigation:
    """Turn positions on Earth and true headings to the scene's; without its place, the first fix is (0, 0)."""
    if tow.place is None or place is None or not place.crs:
        return tow
    x, y = project(tow.place.crs, place.crs, tow.columns["x"], tow.columns["y"])
    turned = {"heading": tow.columns["heading"] + convergence(place)}
    columns = {**tow.columns, **turned, "x": x - place.origin[0], "y": y - place.origin[1]}
    return RecordedNavigation(tow.time, columns, place)


def _at(tow: RecordedNavigation, time: Floats, speed: float) -> dict[str, Floats]:
    known = {
        name: np.interp(time, tow.time, np.radians(np.unwrap(values, period=360.0)) if name in ANGLES else values)
        for name, values in tow.columns.items()
    }
    if "x" in known:
        onward, last = speed * np.maximum(time - tow.time[-1], 0.0), math.radians(float(tow.columns["heading"][-1]))
        known["x"] = known["x"] + math.cos(last) * onward
        known["y"] = known["y"] + math.sin(last) * onward
    return known


def _reject_conflicting_settings(track: Track, known: dict[str, Floats]) -> None:
    if "x" in known and any(motion.turning is not None for motion in track.motions):
        raise SceneError(
            "track.motion.of: a turn has no effect when the recorded track gives x and y; leave one of them out"
        )
    if track.terrain_following and ("depth" in known or "altitude" in known):
        raise SceneError(
            "track.terrain_following: has no effect when the recorded track gives the depth; leave one of them out"
        )
