"""Time and error of every method on one scene, as measured."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from insonify.accuracy.charts.method_settings import EMBREE_OWN, SWEEPS, Record, SettingKey
from insonify.accuracy.charts.reference import Reference
from insonify.accuracy.charts.style import format_percent, format_time
from insonify.acoustics.flat_bed import compute_flat_bed_curves
from insonify.display.normalisation import extend_to_water_column, normalise
from insonify.kernels.common.types import Poses, SceneArrays
from insonify.statistics.displacement import Displacement
from insonify.statistics.record_errors import RecordErrors

COMPARED_ERROR = 0.02  # error at which the times of methods are compared
TINY = 1e-9  # errors below it count as this


@dataclass(frozen=True)
class AccuracyRow:
    """Time and error of one method with one setting."""

    method: str  # name of the method
    setting: str  # setting as text
    size: float  # the setting as a number: step in metres, rays per side, or planes
    targets: bool  # whether the scene holds its targets
    microseconds: float  # median time per ping, both sides, on one thread
    spread: float  # half the distance between the quartiles of the times, as a share of the median
    errors: RecordErrors  # errors against the reference, as shares of the record
    displacement: Displacement  # displacement of shadows and echoes, in metres

    @property
    def key(self) -> SettingKey:
        """Method, setting and targets, which together identify the row."""
        return SettingKey(self.method, self.setting, self.targets)

    @property
    def label(self) -> str:
        """Setting without the unit that its method implies."""
        return self.setting.removesuffix("s").removesuffix(" plane").removesuffix(" ray")


class TracedScene(NamedTuple):
    """Arrays, poses and references of a scene with its targets or without them."""

    arrays: SceneArrays  # scene as kernels read it
    poses: Poses  # poses of the n pings that are compared
    reference: Reference  # record by exact rays
    triangles: Reference | None = None  # record by exact rays over a scene of triangles

    def reference_of(self, method: str) -> Reference:
        """Return the reference against which a method's errors are computed."""
        return self.triangles if method == EMBREE_OWN and self.triangles is not None else self.reference


@dataclass(frozen=True)
class AccuracyMeasurement:
    """Time and error of every method on one scene."""

    title: str  # title of the scene
    rows: tuple[AccuracyRow, ...]  # all methods and settings
    pings: int  # number of pings that were compared
    machine: str  # processor and versions of the measurement
    # Scene with its targets (``True``) and without; a scene that has none has only ``False``.
    scenes: Mapping[bool, TracedScene] = field(repr=False)
    records: Mapping[SettingKey, Record] = field(repr=False)  # record of every row
    notes: tuple[str, ...] = ()  # methods that were left out, and why

    def rows_of(self, targets: bool) -> list[AccuracyRow]:
        """Rows of the scene with its targets, or without."""
        return [row for row in self.rows if row.targets == targets]

    def find_front(self, targets: bool) -> list[AccuracyRow]:
        """Pareto front, fastest first: rows whose error is less than that of all faster rows.

        Less by more than the last doubling of the rays changed the reference; a smaller difference is not resolved.
        """
        front: list[AccuracyRow] = []
        resolved = self.scenes[targets].reference.moved
        rows = (row for row in self.rows_of(targets) if row.method != EMBREE_OWN)
        for row in sorted(rows, key=lambda row: (row.microseconds, row.errors.beyond)):
            if not front or row.errors.beyond < front[-1].errors.beyond - resolved:
                front.append(row)
        return front

    def time_to_error(self, method: str, error: float, targets: bool) -> float:
        """Microseconds per ping after which a method's error falls to a bound.

        Between two settings the error is a power of the time. NaN where no setting reaches the bound, or where the
        reference does not resolve it.
        """
        if error < self.scenes[targets].reference.floor:
            return math.nan
        before: AccuracyRow | None = None
        rows = [row for row in self.rows_of(targets) if row.method == method]
        for row in sorted(rows, key=lambda row: row.microseconds):
            if row.errors.beyond <= error:
                if before is None:
                    return row.microseconds
                fall = math.log(before.errors.beyond / max(row.errors.beyond, TINY))
                share = math.log(before.errors.beyond / error) / fall
                return before.microseconds * (row.microseconds / before.microseconds) ** share
            before = row
        return math.nan

    def fastest_sweep(self, error: float, targets: bool) -> tuple[str, float]:
        """Find the division of segments by which the sweep reaches an error first: method and microseconds per ping.

        NaN where none reaches it, or where the reference does not resolve it.
        """
        times = {method: self.time_to_error(method, error, targets) for method in SWEEPS}
        return min(times.items(), key=lambda item: math.inf if math.isnan(item[1]) else item[1])

    def describe_speedup(self, targets: bool) -> str:
        """State how much faster the sweep reaches an error than exact rays; empty where either does not reach it.

        The sweep divides segments as far as serves it best at that error, as a plan lets it.
        """
        method, sweep = self.fastest_sweep(COMPARED_ERROR, targets)
        exact = self.time_to_error("rays", COMPARED_ERROR, targets)
        if not exact / sweep > 0.0:
            return ""
        times = f"{exact / sweep:,.0f}" if exact > 10.0 * sweep else f"{exact / sweep:.2g}"
        division = method.removeprefix("sweep").removeprefix(", ")
        how = f"the sweep ({division})" if division else "the sweep"
        bound = format_percent(COMPARED_ERROR)
        return f"{bound} in {format_time(sweep)} by {how}, in {format_time(exact)} by exact rays: × {times}"

    def summarise(self) -> tuple[str, ...]:
        """State how much faster the sweep is, and which methods were left out."""
        which = {False: "without targets: ", True: "with targets: "} if len(self.scenes) > 1 else {}
        speedups = {targets: self.describe_speedup(targets) for targets in sorted(self.scenes)}
        return (*(which.get(targets, "") + line for targets, line in speedups.items() if line), *self.notes)

    def normalise_row(self, row: AccuracyRow) -> tuple[Record, Record]:
        """Amplitudes of a row's record and of its reference, relative to a level Lambert bed."""
        scene = self.scenes[row.targets]
        curves = compute_flat_bed_curves(scene.arrays, scene.poses)[:, 0]
        curve = np.array([extend_to_water_column(one) for one in curves])[:, None, :]
        return normalise(self.records[row.key], curve), normalise(scene.reference_of(row.method).record, curve)
