"""Probe of a scene: a few pings traced by several models, whose differences are the errors of the coarser ones."""

from __future__ import annotations

import math
import time
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.acoustics.error_range import ERROR_ALTITUDES, find_first_bin
from insonify.acoustics.flat_bed import compute_flat_bed_curves
from insonify.kernels.common.types import Poses, SceneArrays
from insonify.packing.navigation import make_poses, take_poses
from insonify.planning.models import Model, PackedScene
from insonify.planning.probe_pings import ProbePings
from insonify.scene import edit

Record = NDArray[np.float32]


class Traced(NamedTuple):
    """Probe pings as a model traces them."""

    record: Record  # (pings, 2, bins from the first return), over the flat-bed curve
    seconds: float  # of a ping, both sides, one thread


class Probe:
    """A few pings of a scene, each traced at most once by any model.

    Parameters
    ----------
    packed : PackedScene
        The scene.
    pings : ProbePings
        Its pings.
    """

    def __init__(self, packed: PackedScene, pings: ProbePings) -> None:
        if packed.scene.receiver.speckle.interferes:
            # Errors are those of the mean energy; interfering waves differ at random.
            packed = replace(packed, scene=edit(packed.scene, {"receiver.speckle": "none"}))
        self.pings = pings
        self._packed = packed
        self._poses = make_poses(packed.scene, packed.ground, pings.all)
        arrays = packed.arrays
        first = find_first_bin(1.0, arrays, self._poses)
        self._near, self._beyond = first, find_first_bin(ERROR_ALTITUDES, arrays, self._poses) - first
        curve = compute_flat_bed_curves(arrays, self._poses)[:, :, first:]
        self._scale = np.divide(1.0, curve, out=np.zeros_like(curve), where=curve > 0.0)
        self._traced: dict[Model, Traced] = {}
        self._warm: set[tuple[str, bool, bool]] = set()

    @property
    def count(self) -> int:
        """Number of pings."""
        return self.pings.all.size

    def difference(self, coarse: Model, fine: Model, *, nearer: float = 0.0) -> float:
        """Error of a model against a finer one: the greater of that over the track and that across targets.

        Parameters
        ----------
        coarse, fine : Model
        nearer : float
            Weight of the error over all bins from the first return; 0 for bins beyond 1.4 altitudes alone.
        """
        one, other = self._trace(coarse).record, self._trace(fine).record
        split = self.pings.spread.size
        groups = [part for part in (slice(0, split), slice(split, None)) if one[part].size]
        errors = [_relative(one[part, :, self._beyond :], other[part, :, self._beyond :]) for part in groups]
        if nearer > 0.0:
            errors += [nearer * _relative(one[part], other[part]) for part in groups]
        return max(errors, default=0.0)

    def seconds(self, model: Model) -> float:
        """Seconds of a ping by a model, in proportion to its work from the most similar model traced."""
        if all(other.method != model.method for other in self._traced):
            self._trace(model._replace(planes=1))
        work = self._packed.work(model)

        def unlike(other: Model) -> tuple[int, float]:
            fields = sum(a != b for a, b in zip(model, other)) - (model.planes != other.planes)
            return fields, abs(math.log(self._packed.work(other) / work))

        nearest = min(self._traced, key=unlike)
        return self._traced[nearest].seconds * work / self._packed.work(nearest)

    def _trace(self, model: Model) -> Traced:
        if model not in self._traced:
            self._traced[model] = self._made(model)
        return self._traced[model]

    def _made(self, model: Model) -> Traced:
        """Trace the probe pings."""
        reduced = self._packed.reduced(model)

        def on_tile(tile: SceneArrays, poses: Poses) -> tuple[Record]:
            return (reduced.tracer.trace(tile, poses, threads=1, **model.settings),)

        kernels = (model.method, model.bent, bool(model.ways))
        if kernels not in self._warm:  # the first call loads the kernels
            reduced.tiles.map(on_tile, reduced.arrays, take_poses(self._poses, slice(0, 1)))
            self._warm.add(kernels)
        began = time.perf_counter()
        record = reduced.tiles.map(on_tile, reduced.arrays, self._poses)[0]
        seconds = (time.perf_counter() - began) / self.count
        return Traced((record[:, :, self._near :] * self._scale).astype(np.float32), seconds)


def _relative(one: Record, other: Record) -> float:
    """Norm of a difference over that of the reference."""
    missed = float(np.linalg.norm((one - other).astype(np.float64)))
    whole = float(np.linalg.norm(other.astype(np.float64)))
    return missed / whole if whole > 0.0 else float(missed > 0.0)
