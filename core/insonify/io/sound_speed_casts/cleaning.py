"""Clean a cast: from rows as the instrument wrote them to the way down, at increasing depths."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from insonify.io.sound_speed_casts.cast import CASTS, Cast, Columns, Values

BIN = 0.5  # m of depth that are averaged
# Beyond these a sensor was in air, or is broken.
PLAUSIBLE = {"depth": (0.0, 12000.0), "temperature": (-3.0, 45.0), "salinity": (0.0, 45.0)}
MOST_SOAK = 30.0  # m, depth down to which an instrument may be kept waiting until its sensors have settled
PAUSE = 10.0  # times as long as half a metre usually takes
DESCENT = 0.5  # share of the depths that a way down has to cover to be one


def clean_cast(path: str, columns: Columns) -> Cast:
    """Make a cast of the columns of a file.

    Parameters
    ----------
    path : str
        Of the file, for what is said of it.
    columns : dict of str to (n,) float64
        In the order measured.

    Returns
    -------
    Cast

    Raises
    ------
    SceneError
        If less than a profile is left.
    """
    used = _used(path, columns)
    rows = np.flatnonzero(_plausible({name: columns[name] for name in used}))
    if rows.size:
        time = columns["time"][rows] if "time" in columns else None
        rows = rows[_way_down(columns["depth"][rows], time)]
    depth = columns["depth"][rows]
    means = {name: _binned(depth, columns[name][rows]) for name in used}
    if means["depth"].size < 2:
        raise CASTS.refusal(
            path, f"holds {means['depth'].size} usable depths of {columns['depth'].size} rows", "give two or more"
        )
    return Cast(means["depth"], *(means.get(name) for name in ("sound_speed", "temperature", "salinity")))


def _used(path: str, columns: Columns) -> tuple[str, ...]:
    """Columns that make up the water."""
    known = {name for name, column in columns.items() if np.isfinite(column).any()}
    if "depth" not in known:
        raise CASTS.refusal(path, "tells no depth", "name a column depth (m)")
    whole = ("sound_speed", *(("temperature", "salinity") if {"temperature", "salinity"} <= known else ()))
    used = tuple(name for name in whole if name in known)
    if not used:
        raise CASTS.refusal(
            path, "tells neither the speed of sound nor temperature and salinity", "name a column sound_speed (m/s)"
        )
    return ("depth", *used)


def _plausible(columns: Columns) -> NDArray[np.bool_]:
    """Rows in which every number is there and could be of water."""
    fine = np.ones(columns["depth"].shape, dtype=bool)
    for name, column in columns.items():
        low, high = PLAUSIBLE.get(name, (-np.inf, np.inf))
        fine &= np.isfinite(column) & (column >= low) & (column <= high)
    return fine


def _way_down(depth: Values, time: Values | None) -> slice:
    """Rows from the last start of the descent to the deepest; all of them if there is no such way."""
    deepest = int(depth.argmax())
    # The last of the shallowest rows: what comes before went up.
    start = deepest - int(depth[deepest::-1].argmin())
    if depth[deepest] - depth[start] < DESCENT * (depth.max() - depth.min()) or deepest == start:
        return slice(None)
    if time is not None:
        start += _after_soak(depth[start : deepest + 1], time[start : deepest + 1])
    return slice(start, deepest + 1)


def _after_soak(depth: Values, time: Values) -> int:
    """Row at which the descent goes on after the last wait near the surface; 0 if it never waits.

    An instrument waits below the surface until its pump runs, and is often raised again before it goes down.
    """
    levels = np.arange(depth[0], depth[-1], BIN)
    reached = np.searchsorted(np.maximum.accumulate(depth), levels)
    taken = np.diff(time[reached])
    waits = np.flatnonzero((taken > PAUSE * np.median(taken)) & (levels[1:] < min(MOST_SOAK, 0.5 * depth[-1])))
    if waits.size == 0:
        return 0
    first, last = int(reached[waits[-1]]) + 1, int(reached[waits[-1] + 1]) + 1
    return first + int(depth[first:last].argmin())


def _binned(depth: Values, column: Values) -> Values:
    """Means over equal steps of depth that hold anything; noise, repeated and unsorted depths end here.

    Depths are averaged like all else, so that a gradient stays what it is and sparse rows stay where they are.
    """
    _, step = np.unique(np.floor(depth / BIN), return_inverse=True)
    return np.bincount(step, weights=column) / np.bincount(step)
