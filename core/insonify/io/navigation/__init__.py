"""Recorded navigation: position and attitude of the sonar by time.

A format is one module here that holds a `FileFormat`.
"""

from collections.abc import Mapping
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
        _check_columns(found)
        if "compass" in found:  # degrees clockwise from north
            found["heading"] = 90.0 - np.degrees(np.unwrap(np.radians(found.pop("compass"))))
        time = found.pop("time")
        longitude, latitude = found.pop("longitude", None), found.pop("latitude", None)
        if "x" in found or longitude is None or latitude is None:
            return RecordedNavigation(time - time[0], found)
        place = local_georeference(float(longitude[0]), float(latitude[0]))
        found["x"], found["y"] = from_degrees(place, longitude, latitude)
        return RecordedNavigation(time - time[0], found, place)


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
