"""Recorded navigation: a format is one module here that holds a `FileFormat`."""

from __future__ import annotations

import numpy as np

from insonify.io.georeference import from_degrees, local_georeference
from insonify.io.navigation.recorded import COLUMNS, NAVIGATION, RecordedNavigation, check_columns

__all__ = ["COLUMNS", "NAVIGATION", "RecordedNavigation", "read_navigation"]


def read_navigation(path: str) -> RecordedNavigation:
    """Read recorded navigation."""
    found = NAVIGATION.read(path)
    # A recording without a pitch sensor holds a column without numbers.
    found = {
        name: column
        for name, column in found.items()
        if name == "time" or not np.isnan(column).all() or column.size == 0
    }
    if "time" not in found:
        raise NAVIGATION.refusal(path, "has no column time", "name the column of seconds time")
    if len(found) < 2:
        raise NAVIGATION.refusal(path, "says nothing of the fish", f"name a column one of {', '.join(COLUMNS)}")
    if ("x" in found) != ("y" in found):
        raise NAVIGATION.refusal(path, "has only one of x and y", "give both or neither")
    if ("longitude" in found) != ("latitude" in found):
        raise NAVIGATION.refusal(path, "has only one of longitude and latitude", "give both or neither")
    check_columns(path, found)
    time = found.pop("time")
    longitude, latitude = found.pop("longitude", None), found.pop("latitude", None)
    if "x" in found or longitude is None or latitude is None:
        return RecordedNavigation(time - time[0], found)
    place = local_georeference(float(longitude[0]), float(latitude[0]))
    found["x"], found["y"] = from_degrees(place, longitude, latitude)
    return RecordedNavigation(time - time[0], found, place)
