"""Casts as instruments log them: a heading, a line with the names of the columns, a row for each sample.

Files of Valeport (Swift and MIDAS), of AML Oceanographic and of the Castaway have this form.
"""

from __future__ import annotations

import re

import numpy as np
from numpy.typing import NDArray

from insonify.io.file_access import FileFault, read_text
from insonify.io.formats import FileFormat
from insonify.io.sound_speed_casts.cast import ENCODING, Columns
from insonify.io.sound_speed_casts.seabird import depth_of_pressure
from insonify.io.sound_speed_casts.text import NAMES, find_columns, number_or_nan

PREFIX = "Columns="  # of AML, before the names
PRESSURE = r"pressure|pres|prs"  # dbar
CLOCK = re.compile(r"(\d{1,2}):(\d{2}):(\d{2}(?:\.\d+)?)\s*$")
DAY = 86400.0  # s
REMEDY = "export it as CSV with the columns depth and sound_speed"
OWN_NAMES = {
    **NAMES,
    "temperature": NAMES["temperature"] + "|tempct",
    "time": r"time|date ?/ ?time",
    "pressure": PRESSURE,
}


def read_log(path: str) -> Columns:
    """Read the columns of a logged cast; depth is derived from pressure where the file lacks it."""
    lines = read_text(path, ENCODING).splitlines()
    heads = ((number, find_columns(_cells(line.removeprefix(PREFIX)), OWN_NAMES)) for number, line in enumerate(lines))
    number, places = next(((number, places) for number, places in heads if _suffices(places)), (0, {}))
    if not places:
        raise FileFault("has no line that names the columns of depth or pressure, and of sound speed", REMEDY)
    numbers = {name: place for place, name in enumerate(places)}
    rows = (_row(line, places) for line in lines[number + 1 :])
    table = np.array([row for row in rows if np.isfinite(row).all()]).reshape(-1, len(places))
    if not table.size:
        raise FileFault("has no row of numbers under the names of its columns", REMEDY)
    found = {name: table[:, place] for name, place in numbers.items()}
    if "time" in found:
        found["time"] = np.unwrap(found["time"], period=DAY)
    pressure = found.pop("pressure", None)
    if "depth" not in found and pressure is not None:
        found["depth"] = depth_of_pressure(pressure)
    return found


def _cells(line: str) -> list[str]:
    return [cell.strip() for cell in line.split("\t" if "\t" in line else ",")]


def _suffices(places: dict[str, int]) -> bool:
    return bool(places.keys() & {"depth", "pressure"} and places.keys() & {"sound_speed", "temperature"})


def _row(line: str, places: dict[str, int]) -> NDArray[np.float64]:
    """Return the numbers of a row in the order of the columns, NaN for cells that are none."""
    cells = _cells(line)
    used = (cells[place] if place < len(cells) else "" for place in places.values())
    return np.array([_seconds(cell) if name == "time" else number_or_nan(cell) for name, cell in zip(places, used)])


def _seconds(cell: str) -> float:
    """Time of day, from a time with or without a date before it."""
    found = CLOCK.search(cell)
    if found is None:
        return number_or_nan(cell)
    hours, minutes, seconds = (float(part) for part in found.groups())
    return 3600.0 * hours + 60.0 * minutes + seconds


LOG = FileFormat("log of Valeport or AML", (".vp2", ".000", ".aml"), read_log, remedy=REMEDY)
