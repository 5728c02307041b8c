"""Recorded navigation: position and attitude of the sonar by time.

A format is one module here that holds a `FileFormat`.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from insonify.arrays import Floats
from insonify.io.file_access import FileFault
from insonify.io.formats import FormatRegistry
from insonify.io.georeference import Georeference, from_degrees, local_georeference

__all__ = ["NAVIGATION", "RecordedNavigation", "read_navigation"]

# Unit and greatest size of a number; a larger one is in another unit. Headings may exceed 360°.
LIMITS = {
    "time": ("s", 1e12),
    "x": ("m", 1e8),
    "y": ("m", 1e8),
    "depth": ("m", 2e4),
    "altitude": ("m", 2e4),
    "heading": ("°", 1e6),
    "compass": ("°", 1e6),
    "pitch": ("°", 90.0),
    "roll": ("°", 180.0),
    "longitude": ("°", 360.0),
    "latitude": ("°", 90.0),
}
FASTEST = 50.0  # m/s, above which a track is doubtful
STILL, STILL_EXTENT = 0.05, 5.0  # m/s and m, within which a track stands still, beside the noise of its fixes
Columns = dict[str, Floats]
NAVIGATION: FormatRegistry[Columns] = FormatRegistry(
    "a recorded navigation",
    "insonify.io.navigation",
    "insonify.navigation_formats",
    "track.motion.path: {path!r} {fault}; {remedy}",
)


@dataclass(frozen=True, eq=False)
class RecordedNavigation:
    """Position and attitude of the sonar over time; a file may have only some of them."""

    time: Floats  # (n,) seconds since the first row, increasing; at least two rows
    # Any of x, y, depth, altitude in metres, heading, pitch, roll in degrees; as a record has them.
    columns: Mapping[str, Floats]
    place: Georeference | None = None  # where x and y lie on Earth; None if they are those of the scene
    remarks: tuple[str, ...] = ()  # what was changed or is doubtful


def read_navigation(path: str) -> RecordedNavigation:
    """Read recorded navigation."""
    with NAVIGATION.guarded(path):
        found = NAVIGATION.read(path)
        # A recording without a pitch sensor has a column without numbers.
        blank = [name for name, each in found.items() if each.size and np.isnan(each).all()]
        found = {name: each for name, each in found.items() if name == "time" or name not in blank}
        if "time" not in found:
            raise FileFault("has no column time", "name the column of seconds time")
        if len(found) < 2:
            raise FileFault("has no column of position or attitude", f"give any of {', '.join([*LIMITS][1:])}")
        for one, other in (("x", "y"), ("longitude", "latitude")):
            if (one in found) != (other in found):
                raise FileFault(f"has only one of {one} and {other}", "give both or neither")
        if "heading" in found and "compass" in found:
            raise FileFault("has both heading and compass", "give one of them")
        found, remarks = _with_increasing_times(found)
        _check_columns(found)
        if "compass" in found:  # degrees clockwise from north
            found["heading"] = 90.0 - np.degrees(np.unwrap(np.radians(found.pop("compass"))))
        time = found.pop("time")
        time = time - time[0]
        longitude, latitude, place = found.pop("longitude", None), found.pop("latitude", None), None
        if "x" not in found and longitude is not None and latitude is not None:
            place = local_georeference(float(longitude[0]), float(latitude[0]))
            found["x"], found["y"] = from_degrees(place, longitude, latitude)
        return RecordedNavigation(time, found, place, (*remarks, *_doubts(time, found)))


def _with_increasing_times(found: Columns) -> tuple[Columns, list[str]]:
    """Columns without rows that repeat others or lack a fix, with the rows of one tick of a clock spread over it."""
    remarks: list[str] = []
    time = found["time"]
    uneven = any(column.size != time.size for column in found.values())
    if uneven or time.size < 2 or not np.isfinite(time).all():
        return found, remarks  # `_check_columns` names the fault
    if (np.diff(time) <= 0.0).all() and time[0] > time[-1]:
        found, time = {name: column[::-1] for name, column in found.items()}, time[::-1]
        remarks.append("its rows go from the last to the first and are reversed")
    table = np.stack([*found.values()])
    keep = np.append(True, (table[:, 1:] != table[:, :-1]).any(axis=0))
    if "longitude" in found:
        lost = (found["longitude"] == 0.0) & (found["latitude"] == 0.0)
        if lost.any() and not lost.all():
            remarks.append(f"{int(lost.sum())} of {time.size} rows have no fix (0°, 0°) and are left out")
            keep &= ~lost
    found = {name: column[keep] for name, column in found.items()}
    ticks, first, counts = np.unique(found["time"], return_index=True, return_counts=True)
    if (counts > 1).any() and ticks.size > 1 and (np.diff(found["time"]) >= 0.0).all():
        apart = np.diff(ticks)
        tick = np.minimum(np.append(apart, apart[-1]), np.median(apart))  # a gap is no tick
        within = np.arange(found["time"].size) - np.repeat(first, counts)
        found["time"] = found["time"] + within * np.repeat(tick / counts, counts)
        remarks.append(f"its clock has one time for several rows, which are spread over the tick: {(counts - 1).sum()}")
    return found, remarks


def _doubts(time: Floats, found: Columns) -> Iterator[str]:
    """Describe tracks that stand still, are too fast, or whose headings count as a compass does."""
    if "x" not in found:
        return
    x, y = found["x"], found["y"]
    extent = float(np.hypot(np.ptp(x), np.ptp(y)))
    if extent <= min(STILL * time[-1], STILL_EXTENT):
        lack = "" if "heading" in found else ", and its course is no heading"
        yield f"it stands still: its positions lie within {extent:.3g} m in {time[-1]:.4g} s{lack}"
        return
    steps = np.hypot(np.diff(x), np.diff(y))
    speeds = steps / np.diff(time)
    if speeds.max() > FASTEST:
        row = int(speeds.argmax())
        yield (
            f"it goes {steps[row]:.4g} m in {np.diff(time)[row]:.3g} s from row {row + 1} to row {row + 2}, "
            f"{speeds[row]:.3g} m/s: is that a wrong fix, or are its times not in seconds?"
        )
    if "heading" in found:
        # Means of cosines between heading and course, by distance.
        course, heading = np.arctan2(np.diff(y), np.diff(x)), np.radians(found["heading"][1:])
        ahead, by_compass = (
            np.average(np.cos(each - course), weights=steps) for each in (heading, np.pi / 2 - heading)
        )
        if by_compass > 0.9 and ahead < 0.5:
            yield "its heading fits its course only if it counts clockwise from north; then name the column compass"


def _check_columns(found: Mapping[str, Floats]) -> None:
    """Raise FileFault for columns that cannot be interpolated: gaps, unknown units, unsorted times."""
    time = found["time"]
    if time.size < 2:
        raise FileFault(f"holds {time.size} row{'s' * (time.size != 1)}", "give at least two")
    for name, column in found.items():
        if column.size != time.size:
            raise FileFault(f"has {column.size} of {name} for {time.size} times", "give one for each time")
        if not np.isfinite(column).all():
            row = int(np.flatnonzero(~np.isfinite(column))[0]) + 1
            raise FileFault(f"has no number for {name} in row {row}", "leave the row out or fill it in")
        unit, most = LIMITS[name]
        if (size := np.abs(column)).max() > most:
            row = int(size.argmax())
            fault = f"has {name} {column[row]:g} {unit} in row {row + 1}"
            raise FileFault(fault, f"give it in {unit}, from {-most:g} to {most:g}")
    unsorted = np.flatnonzero(np.diff(time) <= 0.0)
    if unsorted.size:
        raise FileFault(f"goes back in time at row {int(unsorted[0]) + 2}", "sort its rows by time, each time once")
