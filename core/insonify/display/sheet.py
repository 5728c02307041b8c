"""Sheet of a record: amplitudes in display columns, collected block by block in the memory of one sheet."""

import math
from collections.abc import Callable, Iterable, Iterator
from typing import NamedTuple

import numpy as np

from insonify.arrays import Dataset, Floats, Integers, Singles
from insonify.display.display_options import DisplayOptions, side_factors
from insonify.display.normalisation import MedianCurve, estimate_median_curve, normalise
from insonify.display.picture import average_columns, compute_column_edges, mirror_channels
from insonify.display.range_axis import RangeAxis, choose_kind, make_range_axis
from insonify.io.record_schema import read_echoes, split_record
from insonify.io.records.bottom_track import complete_altitude, find_altitude
from insonify.scene import SceneError
from insonify.simulation import Simulation
from insonify.tow.poses import platform_columns

Relative = Callable[[Singles, Integers], Singles]
MOST_ROWS = 4096
SHEET_WIDTHS = {"both": 1200, "port": 900, "starboard": 900}  # columns of a sheet
HEIGHTS = (420, 1800)  # least and greatest number of rows of a sheet


class RecordSheet(NamedTuple):
    """Amplitudes of a record in rows and columns of display."""

    # (rows, columns) amplitudes relative to a curve; newest ping on top, port mirrored about nadir.
    amplitude: Singles
    reach: float  # range of the outer edge of a side, in metres
    along: float  # along-track length, in metres
    pings: int  # number of pings
    altitude: Floats  # (pings,) above the bed, in metres


class SheetPings(NamedTuple):
    """Data of successive pings that a picture shows."""

    intensity: Singles  # (n, 2, bins) linear, port first
    x: Floats  # (n,) position of the sonar, in metres
    y: Floats
    altitude: Floats  # (n,) above the bed beneath, in metres, as `find_altitude` completes it
    bin_length: float  # slant range of a bin, in metres


def trace_sheet_pings(simulation: Simulation) -> Iterator[SheetPings]:
    """Trace the record of a simulation block by block and yield the data that a picture shows."""
    sonar = simulation.scene.sonar
    bin_length = sonar.range / sonar.bins
    for block in simulation.record_blocks():
        x, y, _, altitude, *_ = platform_columns(block.poses, simulation.ground)
        intensity = block.columns["intensity"]
        known = complete_altitude(altitude, np.moveaxis(intensity, 1, 0), bin_length)
        yield SheetPings(intensity, x, y, known, bin_length)


def gather_sheet(
    blocks: Iterable[SheetPings], relative: Relative, pings: int, look: DisplayOptions, lowest: float | None = None
) -> RecordSheet:
    """Collect blocks of a record in a sheet, as wide as the lowest ping receives: of the first block if not given."""
    columns = SHEET_WIDTHS[look.side]
    together = _pings_a_row(pings)
    rows = np.zeros((math.ceil(pings / together), columns), dtype=np.float32)
    counts = np.zeros((len(rows), 1), dtype=np.float32)
    done, axis, per_side = 0, None, columns // 2 if look.side == "both" else columns
    track = [np.empty((3, 0))]  # x, y and altitude of successive pings
    for block in blocks:
        axis = axis or _axis(block, float(block.altitude.min()) if lowest is None else lowest, look)
        numbers = np.arange(done, done + len(block.intensity))
        row = (numbers // together)[::-1]  # the oldest ping is in the last one
        starts = np.flatnonzero(np.diff(row, prepend=row[0] + 1))
        places = len(rows) - 1 - row[starts]
        amplitude = relative(block.intensity, numbers)
        factors = side_factors(look, amplitude.shape[-1])
        edges = compute_column_edges(np.nan_to_num(block.altitude), axis, per_side)
        newest_first = mirror_channels(amplitude if factors is None else amplitude * factors, edges, look.side)
        rows[places] += np.add.reduceat(newest_first, starts, axis=0)
        counts[places, 0] += np.diff(starts, append=numbers.size)
        track.append(np.stack([block.x, block.y, block.altitude]))
        done += numbers.size
    rows /= np.maximum(counts, 1.0)
    x, y, altitude = np.concatenate(track, axis=1)
    along = float(np.hypot(np.diff(x), np.diff(y)).sum()) * (done / max(done - 1, 1))
    reach = axis.reach if axis is not None else 0.0
    across = 2.0 * reach if look.side == "both" else reach
    height = int(np.clip(columns * along / across if across > 0.0 else 0, *HEIGHTS))
    sheet = resample_rows(rows, height)
    return RecordSheet(sheet if look.newest_on_top else sheet[::-1], reach, along, done, altitude)


def gather_record_sheet(record: Dataset, look: DisplayOptions) -> RecordSheet:
    """Make a sheet of a whole record relative to its own median at every range, block by block."""
    pings, altitude, bin_length = record.sizes["ping_time"], find_altitude(record), _bin_length(record)
    x, y = record["platform_x"].values, record["platform_y"].values
    curve = find_median_curve(record, altitude)
    blocks = (
        SheetPings(read_echoes(record, some), x[some], y[some], altitude[some], bin_length)
        for some in split_record(record, _pings_a_row(pings))  # a row is added up in one block
    )

    def relative(echoes: Singles, some: Integers) -> Singles:
        return normalise(echoes, curve.at(np.nan_to_num(altitude[some]))[:, None])

    return gather_sheet(blocks, relative, pings, look, float(altitude.min()))


def _pings_a_row(pings: int) -> int:
    return math.ceil(pings / MOST_ROWS)


def find_median_curve(record: Dataset, altitude: Floats | None = None) -> MedianCurve:
    """Estimate the median curve of a record; its altitude is found by `find_altitude` if not given."""
    known = find_altitude(record) if altitude is None else altitude
    return estimate_median_curve(record.variables["intensity"], np.nan_to_num(known), _bin_length(record))


def compute_median_curve(record: Dataset) -> Floats:
    """Compute the median curve of every ping of a record, (pings, 1, bins), see `find_median_curve`."""
    return find_median_curve(record).at(fill_altitude(record))[:, None]


def resample_rows(rows: Singles, height: int) -> Singles:
    """Resample rows to a number of rows, by their mean where there are more."""
    edges = np.broadcast_to(np.linspace(0.0, len(rows), height + 1), (rows.shape[1], height + 1))
    return average_columns(np.ascontiguousarray(rows.T), edges).T


def _axis(block: SheetPings, lowest: float, look: DisplayOptions) -> RangeAxis:
    """Distance across the picture, to the farthest that a ping at the lowest altitude receives."""
    kind = choose_kind(ground_range=look.ground_range, water_column=look.water_column)
    bins = block.intensity.shape[-1]
    axis = make_range_axis(kind, bins, block.bin_length, lowest)
    if axis is not None:
        return axis
    option, end = "--ground-range" if look.ground_range else "water column", bins * block.bin_length
    if not math.isfinite(lowest):
        raise SceneError(f"{option}: the record has no altitude and shows no first echo of the bed; leave it out")
    raise SceneError(
        f"{option}: the record ends at a slant range of {end:g} m, before the bed {lowest:g} m beneath; leave it out"
    )


def fill_altitude(block: Dataset) -> Floats:
    """Altitudes of pings by `find_altitude`, in metres; 0 where the record shows no bed."""
    return np.nan_to_num(find_altitude(block))


def _bin_length(block: Dataset) -> float:
    """Return the recorded slant range of a bin; its first centre lies at half of it."""
    return 2.0 * float(block["slant_range"].values[0])
