"""Marks of an exercise: what a student's contacts and records say, beside the truth."""

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
# Names of a column or a property in files of various programs, the first that there is.
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
    """Compare contacts with the truth: each belongs to the target that is nearest within the tolerance."""
    # lazy: slow to import
    from scipy.optimize import linear_sum_assignment

    targets, laid = exercise.hidden, list(tracks)
    away = np.array([[math.dist(one[1:3], target[2:4]) for target in targets] for one in contacts])
    away = away.reshape(len(contacts), len(targets))
    # A pair beyond the tolerance costs more than all others together, so that as many as possible are within it.
    cost = np.where(away <= exercise.tolerance, away, 1e6)
    pairs = [(int(i), int(j)) for i, j in zip(*linear_sum_assignment(cost)) if cost[i, j] < 1e6]
    matches = {i: Match(contacts[i], targets[j]) for i, j in pairs}
    rest = [i for i in range(len(contacts)) if i not in matches]
    again = [i for i in rest if away[i].min(initial=math.inf) <= exercise.tolerance]
    seen = {j for _, j in pairs}
    return Marks(
        [match for match in matches.values() if match.target.wanted],
        [target for j, target in enumerate(targets) if target.wanted and j not in seen],
        [match for match in matches.values() if not match.target.wanted],
        [Match(contacts[i], targets[int(away[i].argmin())]) for i in again],
        [contacts[i] for i in rest if i not in again],
        _coverage(exercise.area, laid) if laid else math.nan,
        sum(track.seconds for track in laid),
    )


def describe_marks(exercise: Exercise, marks: Marks) -> list[str]:
    """Lines that tell the student."""
    wanted = len(marks.found) + len(marks.missed)
    lines = [
        f"{exercise.title}: {len(marks.found)} of {wanted} found, {len(marks.missed)} missed, "
        f"{len(marks.false)} false, {len(marks.others)} of other things, {len(marks.repeated)} repeated"
    ]
    for match in (*marks.found, *marks.others):
        height = match.found.height - match.target.height
        tall = "" if math.isnan(height) else f", height {height:+.2f} m of {match.target.height:.2f} m"
        lines.append(f"  {match.found.name}: {match.target.name}, {match.away:.2f} m away{tall}")
    lines += [f"  {match.found.name}: {match.target.name} again" for match in marks.repeated]
    lines += [f"  {one.name}: nothing lies at {one.x:.1f}, {one.y:.1f}" for one in marks.false]
    lines += [f"  missed: {one.name} at {one.x:.1f}, {one.y:.1f}, {one.height:.2f} m high" for one in marks.missed]
    if marks.found:
        heights = [each.found.height - each.target.height for each in marks.found if not math.isnan(each.found.height)]
        tall = f", of heights {_rms(heights):.2f} m over {len(heights)}" if heights else ""
        lines.append(f"rms error of positions {_rms([each.away for each in marks.found]):.2f} m{tall}")
    if not math.isnan(marks.coverage):
        minutes = marks.seconds / 60.0
        late = f", {minutes - exercise.minutes:.1f} over" if minutes > exercise.minutes else ""
        covered = f"{100.0 * marks.coverage:.1f} % of the area covered"
        lines.append(f"{covered}, in {minutes:.1f} of {exercise.minutes:g} minutes{late}")
    return lines


def read_contacts_of(exercise: Exercise, path: Path) -> list[Found]:
    """Read contacts by the suffix of a file, of the viewer or of another program: CSV or GeoJSON."""
    try:
        text = read_text(path, largest=LARGEST)
        if path.suffix.lower() == CSV:
            rows: list[dict[Any, Any]] = list(csv.DictReader(io.StringIO(text)))
        elif path.suffix.lower() in (GEOJSON, ".json"):
            rows = [_properties(feature) for feature in json.loads(text)["features"]]
        else:
            raise FileFault("is no list of contacts by its suffix", f"give {CSV} or {GEOJSON}")
        return [_found(exercise, number, row) for number, row in enumerate(rows, start=1)]
    except (FileFault, OSError) as fault:
        raise SceneError(f"{path.name}: {fault}") from None
    except (ValueError, LookupError, TypeError, AttributeError, csv.Error, RecursionError) as error:
        wrong = str(error) if isinstance(error, _PlaceError) else "is not a list of contacts"
        raise SceneError(f"{path.name}: {wrong}; give columns longitude and latitude, or x and y") from None


def read_track(exercise: Exercise, name: str) -> Track:
    """Read where a record of the exercise was made."""
    record, place = read_record(name), exercise.scene.georeference
    x, y = (record[f"platform_{axis}"].values.astype(np.float64) for axis in "xy")
    if "platform_longitude" in record and place is not None and place.crs:
        x, y = from_degrees(place, record["platform_longitude"].values, record["platform_latitude"].values)
    times = record["ping_time"].values
    reach = float(record["slant_range"].values[-1])
    return Track(x, y, float(np.nanmedian(record["platform_altitude"].values)), reach, float(times[-1] - times[0]))


class _PlaceError(ValueError):
    pass


def _properties(feature: dict[str, Any]) -> dict[str, Any]:
    point = (feature.get("geometry") or {}).get("coordinates") or ()
    return dict(zip(("longitude", "latitude"), point)) | dict(feature["properties"])


def _found(exercise: Exercise, number: int, row: dict[Any, Any]) -> Found:
    """Contact of one row; its place on Earth counts where there is one."""
    given = {str(key).strip().lower(): value for key, value in row.items()}
    known = {
        name: next((given[key] for key in keys if given.get(key) not in (None, "")), None)
        for name, keys in NAMES.items()
    }
    numbers = {name: math.nan if value is None else float(value) for name, value in known.items() if name != "name"}
    x, y, place = numbers["x"], numbers["y"], exercise.scene.georeference
    if math.isfinite(numbers["longitude"]) and math.isfinite(numbers["latitude"]) and place is not None and place.crs:
        east, north = from_degrees(place, *(np.array([numbers[name]]) for name in ("longitude", "latitude")))
        x, y = float(east[0]), float(north[0])
    if not (math.isfinite(x) and math.isfinite(y)):
        raise _PlaceError(f"contact {number} has no place")
    return Found(str(known["name"] or f"contact {number}"), x, y, numbers["height"])


def _coverage(corners: Floats, tracks: Iterable[Track]) -> float:
    """Share of an area that the swaths of tracks cover."""
    low = corners.min(axis=0)
    columns, rows = (math.ceil(side / CELL) for side in corners.max(axis=0) - low)
    x, y = np.meshgrid(low[0] + CELL * (np.arange(columns) + 0.5), low[1] + CELL * (np.arange(rows) + 0.5))
    within = lie_within(corners, np.stack([x.ravel(), y.ravel()], axis=1)).reshape(rows, columns)
    seen = np.zeros((rows, columns), bool)
    for track in tracks:
        along = np.concatenate([[0.0], np.hypot(np.diff(track.x), np.diff(track.y)).cumsum()])
        moves = np.concatenate([[True], np.diff(along) > 0.0])
        steps = np.arange(0.0, along[-1], 0.5 * CELL)
        east, north = (np.interp(steps, along[moves], column[moves]) for column in (track.x, track.y))
        if steps.size < 2:
            continue
        course = np.arctan2(np.gradient(north), np.gradient(east))[:, None]
        reach = math.sqrt(max(track.slant_range**2 - track.altitude**2, 0.0))
        across = np.arange(-reach, reach, 0.5 * CELL)
        column = np.floor((east[:, None] - np.sin(course) * across - low[0]) / CELL).astype(np.int64)
        row = np.floor((north[:, None] + np.cos(course) * across - low[1]) / CELL).astype(np.int64)
        inside = (column >= 0) & (column < columns) & (row >= 0) & (row < rows)
        seen[row[inside], column[inside]] = True
    return float((seen & within).sum() / within.sum())


def _rms(values: Sequence[float]) -> float:
    return math.sqrt(sum(value**2 for value in values) / len(values))
