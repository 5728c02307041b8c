"""Readers of recorded tows: where the fish was, and how it lay in the water."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from insonify.errors import SceneError

__all__ = ["COLUMNS", "RecordedTow", "read_tow"]

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
}
COLUMNS = tuple(name for name in LIMITS if name != "time")
PREFIXES = ("platform_", "ping_")  # of the same names in a record
Column = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class RecordedTow:
    """What a file knows of a tow.

    Attributes
    ----------
    time : (n,) float64
        Seconds since the first row, increasing; at least two rows.
    columns : mapping of str to (n,) float64
        Any of x, y, depth, altitude in metres, heading, pitch, roll in degrees; as a record has them.
    """

    time: Column
    columns: Mapping[str, Column]


def read_tow(path: str) -> RecordedTow:
    """Read a recorded tow.

    Parameters
    ----------
    path : str
        CSV with a header of column names, or a record as ``insonify render`` writes it (.nc); names may be those of a
        record (``ping_time``, ``platform_x``) or the bare ones, and other columns do not matter.

    Returns
    -------
    RecordedTow

    Raises
    ------
    SceneError
        One sentence with what is wrong with the file and the remedy.
    """
    if not Path(path).is_file():
        raise _refusal(path, "does not exist", "give the path of a recorded tow")
    suffix = Path(path).suffix.lower()
    if suffix not in (".csv", ".nc"):
        raise _refusal(path, "is not a format known here", "give a file that ends in .csv or .nc")
    found = _from_record(path) if suffix == ".nc" else _from_text(path)
    # A recording that was never told its pitch holds a column without numbers.
    found = {
        name: column
        for name, column in found.items()
        if name == "time" or not np.isnan(column).all() or column.size == 0
    }
    if "time" not in found:
        raise _refusal(path, "has no column time", "name the column of seconds time")
    if len(found) < 2:
        raise _refusal(path, "says nothing of the fish", f"name a column one of {', '.join(COLUMNS)}")
    if ("x" in found) != ("y" in found):
        raise _refusal(path, "has only one of x and y", "give both or neither")
    _check(path, found)
    time = found.pop("time")
    return RecordedTow(time - time[0], found)


def _from_text(path: str) -> dict[str, Column]:
    """Read the columns of a CSV file that are known here."""
    try:
        with Path(path).open(encoding="utf-8-sig") as file:
            places = _known(file.readline().split(","))
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", UserWarning)  # a file without rows is refused below
                table = np.loadtxt(file, delimiter=",", usecols=tuple(places.values()), ndmin=2) if places else None
    except (OSError, ValueError) as error:
        reason = str(error).splitlines()[0].rstrip(".;")
        raise _refusal(path, f"cannot be read ({reason})", "give one number in every column of every row") from None
    if table is None:
        return {}
    return dict(zip(places, np.ascontiguousarray(table.reshape(-1, len(places)).T)))


def _from_record(path: str) -> dict[str, Column]:
    """Read the columns of a record."""
    import netCDF4

    try:
        with netCDF4.Dataset(path) as file:
            names = [str(name) for name in file.variables]
            places = _known(names)
            return {name: _plain(file.variables[names[place]]) for name, place in places.items()}
    except (OSError, ValueError, TypeError) as error:
        raise _refusal(path, f"cannot be read ({error})", "give a record as insonify render writes it") from None


def _plain(variable: Any) -> Column:
    return np.ma.filled(np.ma.asarray(variable[:], dtype=np.float64), np.nan).ravel()


def _known(names: list[str]) -> dict[str, int]:
    """Places of the columns that are known here."""
    bare = [name.strip().strip('"').lower() for name in names]
    for prefix in PREFIXES:
        bare = [name.removeprefix(prefix) for name in bare]
    return {name: bare.index(name) for name in LIMITS if name in bare}


def _check(path: str, found: Mapping[str, Column]) -> None:
    """Refuse numbers between which nothing can be interpolated."""
    time = found["time"]
    if time.size < 2:
        raise _refusal(path, f"holds {time.size} row{'s' * (time.size != 1)}", "give at least two")
    for name, column in found.items():
        if column.size != time.size:
            raise _refusal(path, f"has {column.size} of {name} for {time.size} times", "give one for each time")
        if not np.isfinite(column).all():
            row = int(np.flatnonzero(~np.isfinite(column))[0]) + 1
            raise _refusal(path, f"has no number for {name} in row {row}", "leave the row out or fill it in")
        unit, most = LIMITS[name]
        if (size := np.abs(column)).max() > most:
            row = int(size.argmax())
            fault = f"has {name} {column[row]:g} {unit} in row {row + 1}"
            raise _refusal(path, fault, f"give it in {unit}, from {-most:g} to {most:g}")
    unsorted = np.flatnonzero(np.diff(time) <= 0.0)
    if unsorted.size:
        raise _refusal(
            path, f"goes back in time at row {int(unsorted[0]) + 2}", "sort its rows by time, each time once"
        )


def _refusal(path: str, fault: str, remedy: str) -> SceneError:
    return SceneError(f"track.motion.path: {path!r} {fault}; {remedy}")
