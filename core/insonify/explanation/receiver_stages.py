"""The record of one ping after each stage of the receiver, in the receiver's order."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.kernels.common.types import Poses, SceneArrays
from insonify.receiver import Reception, Traced, record_echoes
from insonify.simulation import Simulation
from insonify.tracers import sweep

Record = NDArray[np.float32]


class ReceiverStage(NamedTuple):
    """The record of one ping after a stage of the receiver."""

    name: str  # empty for the echo of the pulse alone
    detail: str
    record: Record  # (2, bins) linear intensity


def record_by_stages(simulation: Simulation, ping: int) -> list[ReceiverStage]:
    """Record one ping with none of the receiver's stages, with the first, with the first two, and so on."""
    reception, trace = simulation.reception, _Tracing(simulation, ping)
    records = [ReceiverStage("", "", trace.record(replace(reception, stages=())))]
    for count, stage in enumerate(reception.stages, 1):
        record = trace.record(replace(reception, stages=reception.stages[:count]))
        records.append(ReceiverStage(stage.name, stage.detail, record))
    return records


class _Tracing:
    """Traces of one ping, each made once."""

    def __init__(self, simulation: Simulation, ping: int) -> None:
        self._simulation = simulation
        self._pings = np.array([ping], dtype=np.int64)
        self._poses = simulation.poses(self._pings)
        self._kept: dict[tuple[int, bool, bool], Traced] = {}

    def record(self, reception: Reception) -> Record:
        """Record of the ping by a receiver, (2, bins)."""
        arrays, shapes = self._simulation.reduced, reception.divided_by_shape
        traced = self._trace(arrays, reception)
        divided = None if shapes is None else self._trace(arrays._replace(reflectivity=shapes), reception)
        out = np.empty((1, 2, arrays.bins), np.float32)
        return record_echoes(reception, traced, self._pings, divided, out)[0]

    def _trace(self, arrays: SceneArrays, reception: Reception) -> Traced:
        waves = bool(reception.sums_waves and reception.coherent)
        key = id(arrays.reflectivity), reception.coherent, waves
        if key not in self._kept:
            self._kept[key] = self._traced(arrays, reception, waves)
        return self._kept[key].copy()

    def _traced(self, arrays: SceneArrays, reception: Reception, waves: bool) -> Traced:
        simulation = self._simulation
        tracer, settings = simulation.tracer, simulation.plan.settings
        trace = (tracer.trace_waves if waves else None) or tracer.trace
        if simulation.reception.coherent and not reception.coherent:
            trace = sweep.trace  # the mean energy of the scatterers

        def trace_tile(tile: SceneArrays, some: Poses) -> tuple[Traced]:
            return (trace(tile, some, **settings),)

        return simulation.tiles.map(trace_tile, arrays, self._poses)[0]
