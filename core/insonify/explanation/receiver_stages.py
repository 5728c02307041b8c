"""The record of one ping after each stage of the receiver, in the receiver's order."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.kernels.common.types import Poses, SceneArrays
from insonify.receiver import Reception, Traced, record_echoes
from insonify.simulation import Simulation
from insonify.tracers import sweep

Record = NDArray[np.float32]

# Fields of the receiver that each stage brings in, in the order in which it acts on an echo.
STAGES: tuple[tuple[str, tuple[str, ...]], ...] = (
    ("source level", ("source",)),
    ("water column", ("reverberation", "volumes")),
    ("speckle", ("speckle", "divided_by_shape", "coherent", "samples")),
    ("crosstalk", ("crosstalk",)),
    ("fluctuation", ("fluctuation",)),
    ("noise", ("noise",)),
    ("other waves", ("disturbances",)),
    ("time-varied gain", ("gain",)),
    ("recorder", ("recording",)),
)


class ReceiverStage(NamedTuple):
    """The record of one ping once a stage of the receiver acts."""

    name: str  # empty for the echo of the pulse alone
    record: Record  # (2, bins) linear intensity


def record_by_stages(simulation: Simulation, ping: int) -> list[ReceiverStage]:
    """Record one ping stage by stage."""
    whole, bare = simulation.reception, _without_stages(simulation.reception)
    trace, stages, present = _Tracing(simulation, ping), [], bare
    stages.append(ReceiverStage("", trace.record(bare)))
    for name, fields in STAGES:
        wanted = {field: getattr(whole, field) for field in fields}
        if all(_same(getattr(bare, field), value) for field, value in wanted.items()):
            continue
        present = replace(present, **wanted)
        stages.append(ReceiverStage(name, trace.record(present)))
    return stages


def _without_stages(reception: Reception) -> Reception:
    """Receiver that does nothing but follow the pulse."""
    nothing: dict[str, Any] = dict.fromkeys(
        ("fluctuation", "speckle", "divided_by_shape", "volumes", "disturbances", "recording")
    )
    return replace(
        reception,
        **nothing,
        reverberation=np.zeros_like(reception.reverberation),
        coherent=False,
        samples=1,
        crosstalk=0.0,
        source=1.0,
        noise=0.0,
        gain=np.ones_like(reception.gain),
    )


def _same(one: Any, other: Any) -> bool:
    if isinstance(one, np.ndarray) and isinstance(other, np.ndarray):
        return np.array_equal(one, other)
    return bool(one is other or (isinstance(one, (int, float)) and one == other))


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
