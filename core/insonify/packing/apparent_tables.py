"""Tables of apparent positions in a scene's layered water, kept from call to call."""

import math
from typing import NamedTuple

import numpy as np

from insonify.array_cache import keep_arrays
from insonify.arrays import Booleans, Floats, Singles
from insonify.kernels.common.types import Poses, SceneArrays
from insonify.kernels.geometry.solids import highest_place
from insonify.kernels.refraction.apparent_positions import ApparentTables, no_apparent_tables
from insonify.kernels.refraction.apparent_tables import fill_apparent_table, is_single_valued
from insonify.kernels.targets.apparent_targets import SECANT
from insonify.parallel import in_parallel

SONAR_STEP = 0.25  # m, between heights of the sonar that have tables
ROW_STEP, COLUMN_STEP = 0.25, 1.0  # m
MOST_PLACES = 1 << 19  # of one table, 8 MB; larger scenes are traced by rays


class _Extent(NamedTuple):
    """Extent of a table: its rows, its columns, and the water's surface and reference speed."""

    first_row: int
    rows: int
    columns: int
    surface: float  # height above which no ray may go, m
    reference: float  # m/s


def make_apparent_tables(arrays: SceneArrays, poses: Poses) -> tuple[ApparentTables, Booleans]:
    """Tabulate apparent positions for the heights of some pings."""
    if not arrays.water.bent or poses.z.size == 0:
        return no_apparent_tables(), np.zeros(poses.z.size, np.bool_)
    if arrays.water.station.size > 1:
        return no_apparent_tables(), np.ones(poses.z.size, np.bool_)
    height, speed = _extend_below_bed(arrays)
    stretch = max(float(speed[height >= arrays.bed.low].max()) / arrays.water.reference, 1.0)
    # From the lowest bed to the highest body, and out to the record's range.
    first = math.floor((arrays.bed.low - SECANT) / ROW_STEP)
    last = math.ceil(min(highest_place(arrays) + SECANT, arrays.water.surface) / ROW_STEP)
    columns = math.ceil(arrays.bins * arrays.bin_length * stretch / COLUMN_STEP) + 2
    extent = _Extent(first, max(last - first, 1) + 1, columns, arrays.water.surface, arrays.water.reference)
    if extent.rows * extent.columns > MOST_PLACES:
        return no_apparent_tables(), np.ones(poses.z.size, np.bool_)
    below = np.floor(poses.z / SONAR_STEP).astype(np.int64)
    numbers = range(int(below.min()), int(below.max()) + 2)
    key = height.tobytes(), speed.tobytes(), extent
    made = in_parallel(lambda first, last: [_table(*key, k) for k in numbers[first:last]], len(numbers), least=1)
    tables = [table for share in made for table in share]
    bending = ApparentTables(
        bent=True,
        tables=np.stack([table for table, _ in tables]),
        sonar_low=numbers[0] * SONAR_STEP,
        sonar_step=SONAR_STEP,
        low=extent.first_row * ROW_STEP,
        row_step=ROW_STEP,
        column_step=COLUMN_STEP,
        stretch=stretch,
    )
    folds = np.array([not single for _, single in tables])
    return bending, folds[below - numbers[0]] | folds[below + 1 - numbers[0]]


def _extend_below_bed(arrays: SceneArrays) -> tuple[Floats, Floats]:
    """Nodes of the water, extended below the lowest bed with the gradient that holds there."""
    # No sound goes there, but a ray that turns up again from there appears to come from below the bed, which hides it.
    water, low = arrays.water, arrays.bed.low
    above = water.height > low
    height = np.concatenate([[low], water.height[above]])
    speed = np.concatenate([np.interp([low], water.height, water.speed[0]), water.speed[0, above]])
    if height.size < 2:
        return height, speed
    deep = arrays.bins * arrays.bin_length
    rate = (speed[1] - speed[0]) / (height[1] - height[0])
    deepest = speed[0] - min(rate, 0.0) * deep  # where sound slows downwards rays do not come back
    return np.concatenate([[low - deep], height]), np.concatenate([[deepest], speed])


@keep_arrays
def _table(height: bytes, speed: bytes, extent: _Extent, k: int) -> tuple[Singles, bool]:
    """Table of the sonar at step k of height, and whether every place of it is reached by one ray alone."""
    nodes = np.frombuffer(height), np.frombuffer(speed)
    table = np.zeros((extent.rows, extent.columns, 4), np.float32)
    z, low = k * SONAR_STEP, extent.first_row * ROW_STEP
    whole = fill_apparent_table(*nodes, extent.reference, z, low, ROW_STEP, COLUMN_STEP, extent.surface, table)
    reach, high = (extent.columns - 1) * COLUMN_STEP, low + (extent.rows - 1) * ROW_STEP
    return table, bool(whole and is_single_valued(*nodes, z, low, high, reach, extent.surface))
