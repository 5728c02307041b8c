"""Recorded navigation: position and attitude of the sonar by time."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from insonify.io.formats import FormatRegistry
from insonify.io.georeference import Georeference

# Unit and greatest size of a number; a larger one is in another unit. Headings may count on, turn after turn.
LIMITS = {
    "time": ("s", 1e12),
    "x": ("m", 1e8),
    "y": ("m", 1e8),
    "depth": ("m", 2e4),
    "altitude": ("m", 2e4),
    "heading": ("°", 1e6),
    "pitch": ("°", 90.0),
    "roll": ("°", 180.0),
    "longitude": ("°", 360.0),
    "latitude": ("°", 90.0),
}
ALIASES = {"lon": "longitude", "long": "longitude", "lng": "longitude", "lat": "latitude"}
COLUMNS = tuple(name for name in LIMITS if name != "time")
Column = NDArray[np.float64]
Columns = dict[str, Column]
NAVIGATION: FormatRegistry[Columns] = FormatRegistry(
    "a recorded navigation",
    "insonify.io.navigation",
    "insonify.navigation_formats",
    "track.motion.path: {path!r} {fault}; {remedy}",
)
PREFIXES = ("platform_", "ping_")  # of the same names in a record


@dataclass(frozen=True, eq=False)
class RecordedNavigation:
    """Position and attitude of the sonar over time; a file may have only some of them."""

    time: Column  # (n,) seconds since the first row, increasing; at least two rows
    # Any of x, y, depth, altitude in metres, heading, pitch, roll in degrees; as a record has them.
    columns: Mapping[str, Column]
    place: Georeference | None = None  # where x and y lie on Earth; None if they are those of the scene


def find_columns(names: list[str]) -> dict[str, int]:
    """Places of the columns of navigation among the names in a file."""
    bare = [name.strip().strip('"').lower() for name in names]
    for prefix in PREFIXES:
        bare = [name.removeprefix(prefix) for name in bare]
    bare = [ALIASES.get(name, name) for name in bare]
    return {name: bare.index(name) for name in LIMITS if name in bare}


def check_columns(path: str, found: Mapping[str, Column]) -> None:
    """Refuse numbers between which nothing can be interpolated."""
    time = found["time"]
    if time.size < 2:
        raise NAVIGATION.refusal(path, f"holds {time.size} row{'s' * (time.size != 1)}", "give at least two")
    for name, column in found.items():
        if column.size != time.size:
            raise NAVIGATION.refusal(
                path, f"has {column.size} of {name} for {time.size} times", "give one for each time"
            )
        if not np.isfinite(column).all():
            row = int(np.flatnonzero(~np.isfinite(column))[0]) + 1
            raise NAVIGATION.refusal(path, f"has no number for {name} in row {row}", "leave the row out or fill it in")
        unit, most = LIMITS[name]
        if (size := np.abs(column)).max() > most:
            row = int(size.argmax())
            fault = f"has {name} {column[row]:g} {unit} in row {row + 1}"
            raise NAVIGATION.refusal(path, fault, f"give it in {unit}, from {-most:g} to {most:g}")
    unsorted = np.flatnonzero(np.diff(time) <= 0.0)
    if unsorted.size:
        raise NAVIGATION.refusal(
            path, f"goes back in time at row {int(unsorted[0]) + 2}", "sort its rows by time, each time once"
        )
