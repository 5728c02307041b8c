"""Navigation in text files of comma-separated values."""

from __future__ import annotations

from datetime import UTC, datetime

import numpy as np

from insonify.io.file_access import FileFault, read_text
from insonify.io.formats import FileFormat
from insonify.io.navigation.recorded import Columns, find_columns

REMEDY = "give one number in every column of every row"


def read_csv(path: str) -> Columns:
    """Read the columns of navigation in a CSV file."""
    lines = read_text(path).splitlines()
    places = find_columns(lines[0].split(",")) if lines else {}
    if not places:
        return {}
    try:
        table = np.loadtxt(
            lines[1:],
            delimiter=",",
            usecols=tuple(places.values()),
            ndmin=2,
            converters={places["time"]: _seconds} if "time" in places else None,
        )
    except ValueError as error:
        told = str(error).splitlines()[0].rstrip(".;")
        raise FileFault(f"cannot be read ({told})", REMEDY) from None
    return dict(zip(places, np.ascontiguousarray(table.reshape(-1, len(places)).T)))


def _seconds(text: str) -> float:
    """Read a time: a number of seconds, or ISO 8601, of UTC unless it says its zone."""
    try:
        return float(text)
    except ValueError:
        time = datetime.fromisoformat(text.strip().strip('"'))
        return (time if time.tzinfo else time.replace(tzinfo=UTC)).timestamp()


CSV = FileFormat("comma-separated values", (".csv",), read_csv, remedy=REMEDY)
