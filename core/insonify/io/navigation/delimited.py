"""Navigation in text files of comma-separated values."""

from __future__ import annotations

import warnings
from pathlib import Path

import numpy as np

from insonify.io.formats import FileFormat
from insonify.io.navigation.recorded import NAVIGATION, Columns, find_columns


def read_csv(path: str) -> Columns:
    """Read the columns of navigation in a CSV file."""
    try:
        with Path(path).open(encoding="utf-8-sig") as file:
            places = find_columns(file.readline().split(","))
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", UserWarning)  # a file without rows is refused below
                table = np.loadtxt(file, delimiter=",", usecols=tuple(places.values()), ndmin=2) if places else None
    except (OSError, ValueError) as error:
        reason = str(error).splitlines()[0].rstrip(".;")
        raise NAVIGATION.refusal(
            path, f"cannot be read ({reason})", "give one number in every column of every row"
        ) from None
    if table is None:
        return {}
    return dict(zip(places, np.ascontiguousarray(table.reshape(-1, len(places)).T)))


CSV = FileFormat("comma-separated values", (".csv",), read_csv)
