"""Sound-speed casts: properties of the water by depth, cleaned from the rows that an instrument wrote.

A format is one module here that holds a `FileFormat`.
"""

from dataclasses import dataclass

import numpy as np

from insonify.arrays import Floats
from insonify.io.file_access import FileFault
from insonify.io.formats import FormatRegistry

__all__ = ["CASTS", "Cast", "read_cast"]

ENCODING = "latin-1"  # accepts any byte
BIN = 0.5  # m of depth over which rows are averaged
# Values outside come from sensors in air or broken sensors.
PLAUSIBLE = {"depth": (0.0, 12000.0), "temperature": (-3.0, 45.0), "salinity": (0.0, 45.0)}
DEEPEST_SOAK = 30.0  # m, above which an instrument may wait until its sensors have settled
PAUSE = 10.0  # times the median duration of a bin of depth that counts as waiting
DESCENT = 0.5  # share of the range of depths that a descent covers at least

# Columns of a file by name: depth (m) and any of time (s), sound_speed (m/s), temperature (°C), salinity (practical).
# NaN where a row has no value.
Columns = dict[str, Floats]


@dataclass(frozen=True, eq=False)
class Cast:
    """A measured cast with sound speed, or temperature and salinity, or all three."""

    depth: Floats  # (n,) metres, increasing; at least two
    sound_speed: Floats | None  # (n,) m/s
    temperature: Floats | None  # (n,) °C, ITS-90
    salinity: Floats | None  # (n,) practical salinity


CASTS: FormatRegistry[Columns] = FormatRegistry(
    "a measured cast",
    "insonify.io.sound_speed_casts",
    "insonify.sound_speed_cast_formats",
    "water.path: {path!r} {fault}; {remedy}",
)


def read_cast(path: str) -> Cast:
    """Read a measured cast."""
    with CASTS.guarded(path):
        return clean_cast(CASTS.read(path))


def clean_cast(columns: Columns) -> Cast:
    """Make a cast of the columns of a file."""
    used = _used(columns)
    fine = np.ones(columns["depth"].shape, dtype=bool)
    for name in used:
        low, high = PLAUSIBLE.get(name, (-np.inf, np.inf))
        fine &= np.isfinite(columns[name]) & (columns[name] >= low) & (columns[name] <= high)
    rows = np.flatnonzero(fine)
    if rows.size:
        time = columns["time"][rows] if "time" in columns else None
        rows = rows[_way_down(columns["depth"][rows], time)]
    # Means over bins of depth, which remove noise and repeated or unsorted depths. Depths are averaged like the other
    # columns, which keeps gradients and the place of sparse rows.
    _, step = np.unique(np.floor(columns["depth"][rows] / BIN), return_inverse=True)
    means = {name: np.bincount(step, weights=columns[name][rows]) / np.bincount(step) for name in used}
    if means["depth"].size < 2:
        raise FileFault(
            f"holds {means['depth'].size} usable depths of {columns['depth'].size} rows", "give two or more"
        )
    return Cast(means["depth"], *(means.get(name) for name in ("sound_speed", "temperature", "salinity")))


def _used(columns: Columns) -> tuple[str, ...]:
    """Names of the columns that make up the cast."""
    known = {name for name, column in columns.items() if np.isfinite(column).any()}
    if "depth" not in known:
        raise FileFault("has no depth", "name a column depth (m)")
    whole = ("sound_speed", *(("temperature", "salinity") if {"temperature", "salinity"} <= known else ()))
    used = tuple(name for name in whole if name in known)
    if not used:
        raise FileFault(
            "has neither the speed of sound nor temperature and salinity", "name a column sound_speed (m/s)"
        )
    return ("depth", *used)


def _way_down(depth: Floats, time: Floats | None) -> slice:
    """Rows of the descent: from its last start to the deepest row; all rows if there is none."""
    deepest = int(depth.argmax())
    # The last of the shallowest rows: rows before it belong to an ascent.
    start = deepest - int(depth[deepest::-1].argmin())
    if depth[deepest] - depth[start] < DESCENT * (depth.max() - depth.min()) or deepest == start:
        return slice(None)
    if time is not None:
        start += _after_soak(depth[start : deepest + 1], time[start : deepest + 1])
    return slice(start, deepest + 1)


def _after_soak(depth: Floats, time: Floats) -> int:
    """Row at which the descent continues after the last soak near the surface; 0 if there is none."""
    # An instrument soaks below the surface until its pump runs, and is often raised again before the descent.
    levels = np.arange(depth[0], depth[-1], BIN)
    if levels.size < 2:
        return 0
    reached = np.searchsorted(np.maximum.accumulate(depth), levels)
    taken = np.diff(time[reached])
    waits = np.flatnonzero((taken > PAUSE * np.median(taken)) & (levels[1:] < min(DEEPEST_SOAK, 0.5 * depth[-1])))
    if waits.size == 0:
        return 0
    first, last = int(reached[waits[-1]]) + 1, int(reached[waits[-1] + 1]) + 1
    return first + int(depth[first:last].argmin())
