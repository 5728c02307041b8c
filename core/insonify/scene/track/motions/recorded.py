"""A recorded tow."""

from dataclasses import replace

import numpy as np

from insonify.files import kept_until_changed
from insonify.io.file_access import warn_of_file
from insonify.io.navigation import RecordedNavigation, read_navigation
from insonify.scene.base import FilePath, parameter
from insonify.scene.track.motions import SingleMotion


class Recorded(SingleMotion, kind="recorded", rank=80):
    """Motion recorded in a file; quantities that the file lacks keep their declared values."""

    tilts = True
    path: FilePath = parameter(
        description="CSV with a column time (s) and any of x, y, depth, altitude (m), compass (or heading from east), "
        "pitch, roll, longitude, latitude (°); a record (.nc), a recording (.xtf, .jsf) or a track (.gpx)",
        min_length=1,
    )

    def recording(self) -> tuple[str, RecordedNavigation]:
        """Read the file, and return it with its path."""
        return self.path, _read_with_course(self.path)


@kept_until_changed(maxsize=4)
def _read_with_course(path: str) -> RecordedNavigation:
    tow = read_navigation(path)
    warn_of_file(path, tow.remarks)
    if "x" not in tow.columns or "heading" in tow.columns:
        return tow
    # A file without a heading has the course from successive positions.
    east, north = (np.gradient(tow.columns[name], tow.time) for name in ("x", "y"))
    moving = (east != 0.0) | (north != 0.0)
    # At rest the fish keeps its last course; before the first move it has the first one.
    last = np.maximum.accumulate(np.where(moving, np.arange(moving.size), int(moving.argmax())))
    heading = np.degrees(np.arctan2(north, east))[last]
    return replace(tow, columns={**tow.columns, "heading": heading})
