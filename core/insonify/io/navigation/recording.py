"""Navigation in a side-scan recording."""

from __future__ import annotations

import numpy as np

from insonify.io.formats import FileFormat
from insonify.io.navigation.recorded import LIMITS, Columns
from insonify.io.records import read_record

ON_EARTH = {"x": "longitude", "y": "latitude"}  # what a recording with a place has instead


def read_recording(path: str) -> Columns:
    """Read the columns of navigation of a recording; of several pings at one tick of its clock, the first."""
    record = read_record(path)
    names = {name: f"ping_{name}" if name == "time" else f"platform_{name}" for name in LIMITS}
    skipped = set(ON_EARTH if "platform_longitude" in record else ON_EARTH.values())
    columns = {
        name: record[stored].values.astype(np.float64)
        for name, stored in names.items()
        if stored in record.variables and name not in skipped
    }
    ticks = np.append(True, np.diff(columns["time"]) > 0.0)
    return {name: column[ticks] for name, column in columns.items()}


RECORDING = FileFormat("side-scan recording", (".xtf", ".jsf"), read_recording, remedy="export it again")
