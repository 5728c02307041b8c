"""Record of a simulation traced block by block: as many pings at a time as take some time and memory."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from insonify.kernels.common.types import Poses
from insonify.scene import Scene
from insonify.tow.poses import take_poses
from insonify.tracers.labels import RecordLabels

BLOCK_TIME = 0.25  # s, predicted for a block
BLOCK_BYTES = 16e6  # of a block; a stream that is written holds three
ECHO_BYTES, LABEL_BYTES = 4, 64  # of one bin with all copies

Echoes = NDArray[np.float32]
Columns = dict[str, NDArray[Any]]


class Traceable(Protocol):
    """What is traced: a `Simulation`, whose methods these are."""

    @property
    def scene(self) -> Scene:
        """Its declaration."""

    def poses(self, pings: NDArray[np.int64]) -> Poses:
        """Poses of the sonar at pings."""

    def labels(self, poses: Poses) -> RecordLabels:
        """Labels of pings."""

    def record(self, pings: NDArray[np.int64], poses: Poses, out: Echoes | None = None) -> Echoes:
        """Intensity of pings."""

    def pings_within(self, seconds: float) -> int:
        """Pings that take about so long."""


class TracedBlock(NamedTuple):
    """Successive pings of a record."""

    pings: NDArray[np.int64]  # (n,) their numbers
    poses: Poses  # their poses
    columns: Columns  # ``intensity``, and labels by their names if asked for


def trace_blocks(
    simulation: Traceable, truth: bool = False, block: int | None = None, pings: range | None = None
) -> Iterator[TracedBlock]:
    """Trace the record of a simulation block by block."""
    size = _block_size(simulation, truth, streamed=True) if block is None else block
    wanted = range(simulation.scene.track.pings) if pings is None else pings
    for first in range(wanted.start, wanted.stop, size):
        some = np.arange(first, min(first + size, wanted.stop), dtype=np.int64)
        poses = simulation.poses(some)
        yield TracedBlock(some, poses, _trace_columns(simulation, some, poses, truth))


def trace_whole(
    simulation: Traceable,
    pings: NDArray[np.int64],
    poses: Poses,
    truth: bool = False,
    progress: Callable[[int, int], None] | None = None,
) -> Columns:
    """Trace the whole record of a simulation, block by block into arrays of its length."""
    size = _block_size(simulation, truth, streamed=False)
    columns: Columns = {}
    for first in range(0, pings.size, size):
        part = slice(first, first + size)
        columns = _enter_block(columns, simulation, pings, poses, part, truth)
        if progress is not None:
            progress(min(part.stop, pings.size), pings.size)
    return columns


def _block_size(simulation: Traceable, truth: bool, *, streamed: bool) -> int:
    """Return the number of pings to trace at a time, by time and by the memory that a block takes."""
    bytes_a_ping = 2 * simulation.scene.sonar.bins * (ECHO_BYTES + LABEL_BYTES * truth)
    fitting = int(BLOCK_BYTES / bytes_a_ping) if streamed or truth else simulation.scene.track.pings
    return max(1, min(fitting, simulation.pings_within(BLOCK_TIME)))


def _enter_block(
    whole: Columns, simulation: Traceable, pings: NDArray[np.int64], poses: Poses, part: slice, truth: bool
) -> Columns:
    """Simulate some of the pings and enter them in the columns of a record, which their first block makes."""
    some = take_poses(poses, part)
    if part.start == 0 and part.stop >= pings.size:
        return _trace_columns(simulation, pings, some, truth)
    out = whole["intensity"][part] if whole else None
    for name, column in _trace_columns(simulation, pings[part], some, truth, out).items():
        if name not in whole:
            whole[name] = np.empty((pings.size, *column.shape[1:]), column.dtype)
        if column is not out:
            whole[name][part] = column
    return whole


def _trace_columns(
    simulation: Traceable, pings: NDArray[np.int64], poses: Poses, truth: bool, out: Echoes | None = None
) -> Columns:
    """Intensity of some pings, and their labels if asked for, (n, 2, bins) each."""
    labels = simulation.labels(poses)._asdict() if truth else {}
    return {"intensity": simulation.record(pings, poses, out)} | labels
