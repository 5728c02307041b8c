"""Marks of an exercise: a student's contacts and records beside the truth."""

import csv
import io
import json
import math
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from insonify.arrays import Floats
from insonify.errors import SceneError
from insonify.exercises.exercise import Exercise, Hidden, lie_within
from insonify.io.contacts import CSV, GEOJSON
from insonify.io.file_access import FileFault, read_text
from insonify.io.georeference import from_degrees
from insonify.io.records import read_record

LARGEST = 2**27  # bytes of a file of contacts
CELL = 0.5  # m, of the grid on which coverage is counted
# Names of a column or a property in files of various programs; the first that there is counts.
NAMES = {
    "name": ("name", "label", "id", "contact"),
    "x": ("x", "easting"),
    "y": ("y", "northing"),
    "longitude": ("longitude", "lon", "long"),
    "latitude": ("latitude", "lat"),
    "height": ("height", "target_height"),
}


class Found(NamedTuple):
    """A contact that a student hands in."""

    name: str
    x: float  # m of the scene
    y: float
    height: float = math.nan  # above the bed; NaN where it was not measured


class Track(NamedTuple):
    """Where a record was made."""

    x: Floats  # (pings,) m of the scene
    y: Floats
    altitude: float  # m, its median
    slant_range: float  # m, of the last bin
    seconds: float


class Match(NamedTuple):
    """A contact with the target that it is."""

    found: Found
    target: Hidden

    @property
    def away(self) -> float:
        """Distance of the contact from the target, in metres."""
        return math.dist(self.found[1:3], self.target[2:4])


class Marks(NamedTuple):
    """What was found of what was hidden."""

    found: list[Match]  # of targets that are wanted, nearest contact each
    missed: list[Hidden]
    others: list[Match]  # contacts of what is not wanted
    repeated: list[Match]  # further contacts of the same target
    false: list[Found]  # contacts where nothing lies
    coverage: float  # share of the area; NaN without records
    seconds: float  # of the records


def mark_contacts(exercise: Exercise, contacts: Sequence[Found], tracks: Iterable[Track] = ()) -> Marks:
    """Compare contacts with the truth: as many targets as possible get one, the nearest within the tolerance."""
    # lazy: slow to import
    from scipy.optimize import linear_sum_assignment

    targets, laid = exercise.hidden, list(tracks)
    away = np.array([[Match(one, target).away for target in targets] for one in contacts])
    away = away.reshape(len(contacts), len(targets))
    cost = np.where(away <= exercise.tolerance, away, 1e6)  # beyond it, more than all others together
    pairs = {int(i): int(j) for i, j in zip(*linear_sum_assignment(cost)) if cost[i, j] < 1e6}
    matches = [Match(contacts[i], targets[j]) for i, j in pairs.items()]
    rest = [i for i in range(len(contacts)) if i not in pairs]
    again = [i for i in rest if away[i].min(initial=math.inf) <= exercise.tolerance]
    return Marks(
        [match for match in matches if match.target.wanted],
        [target for j, target in enumerate(targets) if target.wanted and j not in pairs.values()],
        [match for match in matches if not match.target.wanted],
        [Match(contacts[i], targets[int(away[i].argmin())]) for i in again],
        [contacts[i] for i in rest if i not in again],
        _coverage(exercise.area, laid) if laid else math.nan,
        sum(track.seconds for track in laid),
    )


def describe_marks(exercise: Exercise, marks: Marks) -> list[str]:
    """Lines that tell the student."""
    counts = (len(marks.found), len(marks.found) + len(marks.missed), len(marks.missed), len(marks.false))
    lines = ["{}: {} of {} found, {} missed, {} false".format(exercise.title, *counts)]
    lines[0] += f", {len(marks.others)} of other things, {len(marks.repeated)} repeated"
    for match in (*marks.found, *marks.others):
        over = match.found.height - match.target.height
        tall = "" if math.isnan(over) else f", height {over:+.2f} m of {match.target.height:.2f} m"
        lines.append(f"  {match.found.name}: {match.target.name}, {match.away:.2f} m away{tall}")
    lines += [f"  {match.found.name}: {match.target.name} again" for match in marks.repeated]
    lines += [f"  {one.name}: nothing lies at {one.x:.1f}, {one.y:.1f}" for one in marks.false]
    lines += [f"  missed: {one.name} at {one.x:.1f}, {one.y:.1f}, {one.height:.2f} m high" for one in marks.missed]
    if marks.found:
        errors = np.array([match.found.height - match.target.height for match in marks.found])
        errors = errors[np.isfinite(errors)]
        tall = f", of heights {np.sqrt(np.mean(errors**2)):.2f} m over {errors.size}" if errors.size else ""
        rms = np.sqrt(np.mean([match.away**2 for match in marks.found]))
        lines.append(f"rms error of positions {rms:.2f} m{tall}")
    if not math.isnan(marks.coverage):
        minutes = marks.seconds / 60.0
        late = f", {minutes - exercise.minutes:.1f} over" if minutes > exercise.minutes else ""
        covered = f"{100.0 * marks.coverage:.1f} % of the area covered"
        lines.append(f"{covered}, in {minutes:.1f} of {exercise.minutes:g} minutes{late}")
    return lines


def read_found(exercise: Exercise, path: Path) -> list[Found]:
    """Read contacts of the viewer or of another program by the suffix of their file."""
    kinds = f"give {CSV} or {GEOJSON} with columns longitude and latitude, or x and y"
    try:
        text = read_text(path, largest=LARGEST)
        if path.suffix.lower() == CSV:
            rows: list[dict[Any, Any]] = list(csv.DictReader(io.StringIO(text)))
        elif path.suffix.lower() == GEOJSON:
            features = json.loads(text)["features"]
            points = (((each.get("geometry") or {}).get("coordinates") or ()) for each in features)
            rows = [dict(zip(("lon", "lat"), at)) | dict(each["properties"]) for at, each in zip(points, features)]
        else:
            raise FileFault("is no list of contacts by its suffix", kinds)
        return [_found(exercise, number, row, kinds) for number, row in enumerate(rows, start=1)]
    except (FileFault, OSError) as fault:
        raise SceneError(f"{path.name}: {fault}") from None
    except (ValueError, LookupError, TypeError, AttributeError, csv.Error, RecursionError):
        raise SceneError(f"{path.name}: is not a list of contacts; {kinds}") from None


def _found(exercise: Exercise, number: int, row: dict[Any, Any], kinds: str) -> Found:
    """Contact of one row; its place on Earth counts where there is one."""
    cells = {str(key).strip().lower(): value for key, value in row.items() if value not in (None, "")}
    known = {name: next((cells[key] for key in keys if key in cells), None) for name, keys in NAMES.items()}
    name = str(known.pop("name") or f"contact {number}")
    x, y, longitude, latitude, height = (math.nan if value is None else float(value) for value in known.values())
    place = exercise.scene.georeference
    if math.isfinite(longitude + latitude) and place is not None and place.crs:
        x, y = (float(each[0]) for each in from_degrees(place, np.array([longitude]), np.array([latitude])))
    if not math.isfinite(x + y):
        raise FileFault(f"contact {number} has no place", kinds)
    return Found(name, x, y, height)


def read_track(exercise: Exercise, name: str) -> Track:
    """Read where a record of the exercise was made."""
    record, place = read_record(name), exercise.scene.georeference
    x, y = (record[f"platform_{axis}"].values.astype(np.float64) for axis in "xy")
    if "platform_longitude" in record and place is not None and place.crs:
        x, y = from_degrees(place, record["platform_longitude"].values, record["platform_latitude"].values)
    times, altitude = record["ping_time"].values, float(np.nanmedian(record["platform_altitude"].values))
    return Track(x, y, altitude, float(record["slant_range"].values[-1]), float(times[-1] - times[0]))


def _coverage(corners: Floats, tracks: Iterable[Track]) -> float:
    """Share of an area that the swaths of tracks cover."""
    low = corners.min(axis=0)
    columns, rows = (math.ceil(side / CELL) for side in corners.max(axis=0) - low)
    x, y = np.meshgrid(low[0] + CELL * (np.arange(columns) + 0.5), low[1] + CELL * (np.arange(rows) + 0.5))
    within = lie_within(corners, np.stack([x.ravel(), y.ravel()], axis=1)).reshape(rows, columns)
    seen = np.zeros((rows, columns), bool)
    for track in tracks:
        along = np.hypot(np.diff(track.x, prepend=track.x[0]), np.diff(track.y, prepend=track.y[0])).cumsum()
        steps = np.arange(0.0, along[-1], 0.5 * CELL)
        if steps.size < 2:
            continue
        place = np.interp(steps, along, track.x) + 1j * np.interp(steps, along, track.y)
        aside = 1j * np.exp(1j * np.angle(np.gradient(place)))
        reach = math.sqrt(max(track.slant_range**2 - track.altitude**2, 0.0))
        swath = place[:, None] + aside[:, None] * np.arange(-reach, reach, 0.5 * CELL) - complex(*low)
        column, row = (np.floor(part / CELL).astype(np.int64) for part in (swath.real, swath.imag))
        inside = (column >= 0) & (column < columns) & (row >= 0) & (row < rows)
        seen[row[inside], column[inside]] = True
    return float((seen & within).sum() / within.sum())
