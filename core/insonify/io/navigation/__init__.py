"""Recorded navigation: a format is one module here that holds a `FileFormat`."""

from __future__ import annotations

import numpy as np

from insonify.io.navigation.recorded import COLUMNS, NAVIGATION, RecordedNavigation, check_columns

__all__ = ["COLUMNS", "NAVIGATION", "RecordedNavigation", "read_navigation"]


def read_navigation(path: str) -> RecordedNavigation:
    """Read recorded navigation.

    Parameters
    ----------
    path : str
        A file of one of the formats of `NAVIGATION`: CSV with a header of column names, or a record as
        ``insonify render`` writes it (.nc). Names may be those of a record (``ping_time``, ``platform_x``) or the bare
        ones; other columns are ignored.

    Returns
    -------
    RecordedNavigation

    Raises
    ------
    SceneError
        One sentence with what is wrong with the file and the remedy.
    """
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
    check_columns(path, found)
    time = found.pop("time")
    return RecordedNavigation(time - time[0], found)
