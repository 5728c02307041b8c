"""Sound-speed casts: properties of the water by depth, cleaned from the rows that an instrument wrote.

A format is one module here that holds a `FileFormat`.
"""

from dataclasses import dataclass

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from insonify.arrays import Booleans, Floats, Integers
from insonify.io.file_access import FileFault
from insonify.io.formats import FormatRegistry

__all__ = ["CASTS", "Cast", "read_cast"]

ENCODING = "latin-1"  # accepts any byte
BIN = 0.5  # m of depth over which rows are averaged
# Values outside come from sensors in air or broken sensors.
PLAUSIBLE = {
    "depth": (0.0, 12000.0), "sound_speed": (1300.0, 1700.0), "temperature": (-3.0, 45.0), "salinity": (0.0, 45.0)
}  # fmt: skip
UNITS = {"depth": "m", "sound_speed": "m/s", "temperature": "°C", "salinity": ""}
DEEPEST_SOAK = 30.0  # m, above which an instrument may wait until its sensors have settled
# A wait lasts longer than the descent takes for SLOWER times its metres and WAIT m more, and than LEAST_WAIT s.
SLOWER, WAIT, LEAST_WAIT = 4.0, 3.0, 10.0
DESCENT = 0.5  # share of the range of depths that a descent covers at least
# A spike differs at least so much from the rows before and behind it, and by depth so much for each SPIKE_OVER metres
# between them, in more than ten rows' usual steps. Water that differs so from what is above and below has more rows.
SPIKE = {"depth": 5.0, "sound_speed": 3.0, "temperature": 1.0, "salinity": 2.5}
SPIKE_OVER, SPIKE_OVER_NOISE, AT_END = 1.5, 10.0, 10.0  # m, usual steps, times more for the first and last row
BESIDE, QUIET = 3, 10  # rows on each side of a spike, and those that measure the noise

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
    remarks: tuple[str, ...] = ()  # which rows of the file are left out, and why


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
    columns, used, remarks = _choose_columns(columns)
    rows, causes = _choose_rows(columns, used)
    # Means over bins of depth, which remove noise and repeated or unsorted depths. Depths are averaged like the other
    # columns, which keeps gradients and the place of sparse rows.
    _, step = np.unique(np.floor(columns["depth"][rows] / BIN), return_inverse=True)
    means = {name: np.bincount(step, weights=columns[name][rows]) / np.bincount(step) for name in used}
    count = columns["depth"].size
    if means["depth"].size < 2:
        cause = f" ({'; '.join(causes)})" if causes else ""
        remedy = "correct those rows, or name the units of its columns" if causes else "give two or more"
        raise FileFault(f"holds {means['depth'].size} usable depths of {count} rows{cause}", remedy)
    if causes:
        top = f"the cast begins at {means['depth'][0]:.3g} m"
        remarks = *remarks, f"{count - rows.size} of {count} rows are left out: {'; '.join(causes)}; {top}"
    speed, temperature, salinity = (means.get(name) for name in ("sound_speed", "temperature", "salinity"))
    return Cast(means["depth"], speed, temperature, salinity, remarks)


def _choose_columns(columns: Columns) -> tuple[Columns, tuple[str, ...], tuple[str, ...]]:
    """Columns with depths downwards, the names of those that make up the cast, and remarks."""
    if "depth" not in columns or not np.isfinite(columns["depth"]).any():
        raise FileFault("has no depth", "name a column depth (m)")
    remarks, depth = [], columns["depth"]
    if np.nanmin(depth) < -2.0 and np.nanmean(depth < 0.0) > 0.9:
        columns = columns | {"depth": -depth}
        remarks.append("its depths are negative and count downwards")
    choices = [names for names in (("sound_speed",), ("temperature", "salinity")) if columns.keys() >= {*names}]
    # A sensor that fails in most rows takes no part.
    sound = {names: int(np.all([_plausible(name, columns[name]) for name in names], axis=0).sum()) for names in choices}
    best = max(sound.values(), default=0)
    if not any(np.isfinite(columns[name]).any() for names in choices for name in names):
        raise FileFault(
            "has neither the speed of sound nor temperature and salinity", "name a column sound_speed (m/s)"
        )
    kept = [names for names in choices if 2 * sound[names] >= best]
    remarks += [
        f"{' and '.join(names).replace('_', ' ')} {'are' if len(names) > 1 else 'is'} left out: "
        f"{sound[names]} of {depth.size} rows have possible values"
        for names in choices
        if names not in kept and any(np.isfinite(columns[name]).any() for name in names)
    ]
    return columns, ("depth", *(name for names in kept for name in names)), tuple(remarks)


def _plausible(name: str, column: Floats) -> Booleans:
    low, high = PLAUSIBLE[name]
    return (column >= low) & (column <= high)  # False for NaN


def _choose_rows(columns: Columns, used: tuple[str, ...]) -> tuple[Integers, list[str]]:
    """Rows of the descent with possible values, and why each of the others is left out."""
    depth, causes = columns["depth"], list[str]()
    rows = np.flatnonzero(np.all([np.isfinite(columns[name]) for name in used], axis=0))
    if rows.size < depth.size:
        causes.append(f"{depth.size - rows.size} without a number or flagged as bad")
    for name in used:
        possible = _plausible(name, columns[name][rows])
        fault = "a depth outside the water" if name == "depth" else f"an impossible {name.replace('_', ' ')}"
        rows = _without(rows, ~possible, fault, name, columns, causes)
    rows = _without(rows, find_spikes("depth", depth[rows], None), "a spike of depth", "depth", columns, causes)
    if rows.size:
        time = columns.get("time", np.full(depth.shape, np.nan))[rows]
        known = np.isfinite(time)
        cut, wait = _way_down(depth[rows], np.interp(rows, rows[known], time[known]) if known.any() else None)
        below = rows[cut]
        before, after = int((rows < below[0]).sum()), int((rows > below[-1]).sum())
        causes += [f"{before} before the descent{wait}"] if before else []
        causes += [f"{after} of the way up"] if after else []
        rows = below
    for name in used[1:]:
        order = np.argsort(depth[rows], kind="stable")
        spikes = np.zeros(rows.size, dtype=bool)
        spikes[order] = find_spikes(name, columns[name][rows][order], depth[rows][order])
        rows = _without(rows, spikes, f"a spike of {name.replace('_', ' ')}", name, columns, causes)
    return rows, causes


def _without(rows: Integers, bad: Booleans, fault: str, name: str, columns: Columns, causes: list[str]) -> Integers:
    """Rows that are not bad; adds the number of the others and the first of them to the causes."""
    if bad.any():
        first = rows[bad][0]
        where = "" if name == "depth" else f" at {columns['depth'][first]:.4g} m"
        value = f"{columns[name][first]:.6g} {UNITS[name]}".rstrip()
        causes.append(f"{int(bad.sum())} with {fault} ({value}{where})")
    return rows[~bad]


def find_spikes(name: str, values: Floats, depth: Floats | None) -> Booleans:
    """Find values far above, or far below, both the median of the rows before and the median of the rows behind."""
    if values.size < 2 * BESIDE:
        return np.zeros(values.size, dtype=bool)
    around = sliding_window_view(np.pad(values, BESIDE, constant_values=np.nan), 2 * BESIDE + 1)
    steps = np.abs(np.diff(values, prepend=values[0]))
    noise = np.median(
        sliding_window_view(np.pad(steps, QUIET, mode="reflect" if steps.size > QUIET else "edge"), 2 * QUIET + 1),
        axis=1,
    )
    least = np.full(values.size, SPIKE[name])
    if depth is not None:
        places = np.pad(depth, 2, mode="edge")
        least *= np.maximum(np.maximum(depth - places[:-4], places[4:] - depth) / SPIKE_OVER, 1.0)
    before, behind = np.empty_like(values), np.empty_like(values)
    before[1:], behind[:-1] = np.nanmedian(around[1:, :BESIDE], axis=1), np.nanmedian(around[:-1, -BESIDE:], axis=1)
    # The first and the last row have neighbours on one side, and water may have a steep gradient there.
    before[0], behind[-1] = behind[0], before[-1]
    least[[0, -1]] *= AT_END if depth is not None else np.inf
    away = np.maximum(values - np.maximum(before, behind), np.minimum(before, behind) - values)
    return away > np.maximum(least, SPIKE_OVER_NOISE * noise)


def _way_down(depth: Floats, time: Floats | None) -> tuple[slice, str]:
    """Rows of the descent, all if there is none, and in words the wait behind which they begin."""
    deepest = int(depth.argmax())
    # The last of the shallowest rows: rows before it belong to an ascent.
    start = deepest - int(depth[deepest::-1].argmin())
    if depth[deepest] - depth[start] < DESCENT * (depth.max() - depth.min()) or deepest == start:
        return slice(None), ""
    wait = ""
    if time is not None:
        soaked, wait = _after_soak(depth[start : deepest + 1], time[start : deepest + 1])
        start += soaked
    return slice(start, deepest + 1), wait


def _after_soak(depth: Floats, time: Floats) -> tuple[int, str]:
    """Row at which the descent continues after the last soak near the surface, 0 if there is none, and the soak."""
    # An instrument soaks below the surface until its pump runs, and is often raised again before the descent.
    deepest = np.maximum.accumulate(depth)
    reached = np.unique(np.searchsorted(deepest, np.arange(depth[0], depth[-1], BIN)))
    if reached.size < 3:
        return 0, ""
    # By metre between rows, which may lie farther apart than a bin.
    taken, metres = np.diff(time[reached]), np.diff(deepest[reached])
    slow = taken > np.maximum(np.median(taken / metres) * (SLOWER * metres + WAIT), LEAST_WAIT)
    waits = np.flatnonzero(slow & (deepest[reached[:-1]] < min(DEEPEST_SOAK, 0.5 * depth[-1])))
    if waits.size == 0:
        return 0, ""
    last = waits[-1]
    first, end = int(reached[last]) + 1, int(reached[last + 1]) + 1
    wait = f" and up to the end of a wait of {taken[last]:.3g} s at {deepest[reached[last]]:.3g} m"
    return first + int(depth[first:end].argmin()), wait
