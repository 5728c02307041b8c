"""Casts as text: sound-speed profiles of echo sounders, and tables."""

from __future__ import annotations

import re
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from insonify.io.file_access import read_text
from insonify.io.formats import FileFormat
from insonify.io.sound_speed_casts.cast import CASTS, ENCODING, Columns, Values

BYTE_ORDER_MARK = "\u00ef\u00bb\u00bf"  # read as Latin-1
SPEEDS = (1300.0, 1700.0)
# Names of columns in a header, in lower case and without units.
NAMES = {
    "time": r"time|seconds",
    "depth": r"depth|dep|z",
    "sound_speed": r"sound[ _]?(speed|velocity)|speed|velocity|sv|svp|c",
    "temperature": r"temperature|temp|t",
    "salinity": r"(practical )?salinity|sal|psal|s",
}


def read_profile(path: str) -> Columns:
    """Read depth and speed of sound from ``.asvp``, ``.svp``, ``.vel`` and ``.calc`` files.

    Lines that are not all numbers are headings.
    """
    text = read_text(path, ENCODING)
    sections = len(re.findall(r"^\s*section\b", text, flags=re.MULTILINE | re.IGNORECASE))
    if sections > 1:
        raise CASTS.refusal(path, f"holds {sections} casts", "keep one of its sections")
    rows = [row for row in map(_numbers, text.splitlines()) if row.size >= 2 and np.isfinite(row).all()]
    if not rows:
        raise CASTS.refusal(path, "holds no rows of depth and sound speed", "give two numbers in every line")
    depth, speed = np.array([row[:2] for row in rows]).T
    return {"depth": depth, "sound_speed": speed}


def read_table(path: str) -> Columns:
    """Read a table with a header of column names, or one whose columns are recognised by their values."""
    whole = read_text(path, ENCODING).removeprefix(BYTE_ORDER_MARK).splitlines()
    lines = [line for line in whole if line.strip(" ,;\t") and line[0] not in "#%"]
    rows = [_numbers(line) for line in lines]
    names = find_columns(_cells(lines[0]), NAMES) if lines and np.isnan(rows[0]).all() else None
    rows = rows[names is not None :]
    width = max((row.size for row in rows), default=0)
    if width < 2:
        raise CASTS.refusal(path, "holds no table", "give columns depth and sound_speed with a line for each depth")
    table = np.array([np.pad(row, (0, width - row.size), constant_values=np.nan) for row in rows])
    if names is None:
        return _by_values(path, table)
    return {name: table[:, place] for name, place in names.items() if place < width}


def _cells(line: str) -> list[str]:
    separator = next((mark for mark in ",;\t" if mark in line), None)
    return [cell.strip().strip('"') for cell in line.split(separator)]


def _numbers(line: str) -> Values:
    """Return the numbers of a line, NaN for cells that are none."""
    return np.array([number_or_nan(cell) for cell in _cells(line)])


def find_columns(cells: list[str], names: Mapping[str, str]) -> dict[str, int]:
    """Find the columns that the cells of a header name."""
    bare = [re.sub(r"[\[(;].*", "", cell).strip().lower() for cell in cells]
    places = {
        name: next((place for place, cell in enumerate(bare) if re.fullmatch(pattern, cell)), -1)
        for name, pattern in names.items()
    }
    return {name: place for name, place in places.items() if place >= 0}


def number_or_nan(cell: str) -> float:
    """Return the number in a cell, NaN if it holds none."""
    try:
        return float(cell)
    except ValueError:
        return float("nan")


def _by_values(path: str, table: Values) -> Columns:
    """Find the columns of depth and sound speed in a table without a header."""
    remedy = "put a line with the names of the columns first, depth and sound_speed among them"
    whole = [place for place in range(table.shape[1]) if np.isfinite(table[:, place]).all()]
    speeds = [place for place in whole if _is_speed(table[:, place])]
    depths = [place for place in whole if place not in speeds and _is_depth(table[:, place])]
    if len(speeds) != 1 or len(depths) != 1:
        what = "depth" if len(speeds) == 1 else "sound speed"
        count = len(depths) if len(speeds) == 1 else len(speeds)
        raise CASTS.refusal(path, f"has {count or 'no'} columns that look like {what}", remedy)
    return {"depth": table[:, depths[0]], "sound_speed": table[:, speeds[0]]}


def _is_speed(column: NDArray[np.float64]) -> bool:
    return bool(((column >= SPEEDS[0]) & (column <= SPEEDS[1])).all())


def _is_depth(column: NDArray[np.float64]) -> bool:
    """Whether a column increases in most rows, over nearly its whole range."""
    steps = np.diff(column)
    return bool(column.min() >= -1.0 and steps.sum() >= 0.9 * np.ptp(column) > 0.0 and (steps > 0.0).mean() > 0.5)


PROFILE = FileFormat("sound-speed profile of an echo sounder", (".asvp", ".svp", ".vel", ".calc"), read_profile)
TABLE = FileFormat("table", (".csv",), read_table)
