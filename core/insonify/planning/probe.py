"""Probe of a scene: a few pings traced by several models; their differences are the errors of the coarser ones."""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from contextlib import suppress
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from insonify.acoustics.flat_bed import ERROR_ALTITUDES, compute_flat_bed_curves, find_first_bin
from insonify.arrays import Booleans, Floats, Singles
from insonify.kernels.common.types import Poses, SceneArrays
from insonify.packing.packed_scene import SURFACE_ECHO, Model, PackedScene
from insonify.parallel import in_parallel
from insonify.planning.probe_pings import ProbePings, spread_over_track
from insonify.scene import SceneError
from insonify.tow.poses import find_pings_in_bed, make_poses, refuse_sonar_in_bed, take_poses
from insonify.tracers.base import find_tracer, prepare_tracer
from insonify.tracers.plane_counts import TracedPings, errors_over_bed
from insonify.tracers.sweep import trace_measured

FEW = 12  # pings at least on which models are compared
LITTLE = 1e6  # work of some milliseconds, which more pings than these may take together
MOST = 1e8  # work of half a second, up to which finer and finer models are traced to judge coarser ones
WORK_OF_A_THREAD = 1e5  # of the pings of a call, beside which what the call itself takes is little
SEARCHED, FOUND = 48, 2  # pings over the track that are searched, and the most of them that are added
MOST_TREND = 0.5  # of a bias that falls with the first power
MEASURED = 16  # pings on which the errors of planes are measured
FEW_PLANES, MANY_PLANES = 4, 16  # by which they are
LEAST_POWER, MOST_POWER = 0.5, 2.0  # of planes at random, and of a smooth bed
TRUST_MARGIN = 1.25  # of errors over what planes estimate, for pings unlike those measured
LEAST_TRUST = 0.5
USUAL = 0.75  # share of the pings that are within the tolerance by the planes that all of them begin with
LOUD = 3.0  # times the mean energy of those searched
_LOADED: set[tuple[str, bool, bool]] = set()  # kernels of waves that this process has called: method, bent, paths


def trace_model(packed: PackedScene, model: Model, poses: Poses) -> Singles:
    """Trace pings of a scene by a model on one thread, (n, 2, bins)."""
    tracer, settings = prepare_tracer(packed, model), find_tracer(model.method).settings(model)
    found: Singles = packed.ground_tiles(model.every, tracer.bins_beyond).map(
        lambda tile, some: tracer.trace(tile, some, threads=1, **settings), packed.reduce(model), poses
    )
    return found


def work_of(packed: PackedScene, model: Model) -> float:
    """Work of a ping by a model, both sides: a count, the same on every machine."""
    if model not in packed.works:
        packed.works[model] = find_tracer(model.method).work(packed.scene, packed.arrays, model)
    return packed.works[model]


class PlaneLaw(NamedTuple):
    """Error of pings by the number of planes across the beam."""

    error: float  # of `FEW_PLANES`
    power: float  # of the number of planes with which it falls
    trust: float  # errors over what planes estimate, by a margin
    estimated: tuple[float, ...]  # of pings over the track by `FEW_PLANES`, by their planes

    def of(self, planes: int) -> float:
        """Error of a number of planes."""
        return self.error * (FEW_PLANES / planes) ** self.power

    def enough(self, counts: Sequence[int], tolerance: float) -> int:
        """Return the fewest planes with which most measured pings are within a tolerance; the most if none are."""
        usual = self.trust * float(np.quantile(self.estimated, USUAL))
        within = (count for count in counts if usual * (FEW_PLANES / count) ** self.power <= tolerance)
        return next(within, counts[-1])


class Probe:
    """A few pings of a scene, each traced at most once by any model."""

    def __init__(self, packed: PackedScene, pings: ProbePings) -> None:
        self._packed = packed
        ordered, self._is_across = pings.interleaved()
        self._poses = make_poses(packed.scene, packed.ground, ordered)
        clear = ~find_pings_in_bed(packed.ground, self._poses)
        if not clear.any():
            refuse_sonar_in_bed(packed.scene, packed.ground, ordered, self._poses)
        # Pings from below the bed are refused when they are simulated.
        self._poses, self._is_across = take_poses(self._poses, clear), self._is_across[clear]
        self._near = find_first_bin(1.0, packed.arrays, self._poses)
        self._beyond = find_first_bin(ERROR_ALTITUDES, packed.arrays, self._poses) - self._near
        self._scale = scale_to_flat_bed(packed.arrays, self._poses, self._near)
        # Pings, in an order in which few are spread like all, from the first return, over the flat-bed curve.
        self._traced: dict[Model, Singles] = {}
        self._timed: dict[tuple[str, bool], float] = {}  # seconds per work
        self._differences: dict[tuple[Any, ...], float] = {}
        self._laws: dict[Model, PlaneLaw] = {}

    def leave_out_collisions(self, model: Model) -> None:
        """Leave out pings in which the sonar is inside a target: they are refused when they are simulated."""
        try:
            self._trace(model, self._is_across.size)
        except SceneError:
            kept = []
            for ping in range(self._is_across.size):
                with suppress(SceneError):
                    trace_model(self._packed, model, take_poses(self._poses, slice(ping, ping + 1)))
                    kept.append(ping)
            if not kept:
                raise
            self._poses, self._is_across = take_poses(self._poses, np.array(kept)), self._is_across[kept]
            self._scale = self._scale[kept]

    def work(self, model: Model) -> float:
        """Return the work of a ping by a model."""
        return work_of(self._packed, model)

    def count(self, model: Model) -> int:
        """Return the number of pings on which a model is compared with a coarser one."""
        return min(self._is_across.size, max(FEW, int(LITTLE / self.work(model))))

    def affords(self, model: Model) -> bool:
        """Whether a model may be traced to judge a coarser one; errors of more work are predicted from its order."""
        return self.count(model) * self.work(model) <= MOST

    def difference(
        self,
        coarse: Model,
        fine: Model,
        *,
        before: Model | None = None,
        nearer: float = 0.0,
        cautious: bool = False,
        of: tuple[int, ...] = (),
    ) -> float:
        """Error of a model against a finer one, of some pings or all: the greater of those over track and targets.

        With the model before both in their order it includes what still finer ones add to the difference.
        """
        coarse, fine, before = _without_surface_echo(coarse, fine, before or coarse)
        if coarse == fine:
            return 0.0
        key = coarse, fine, before, nearer, cautious, of
        if key not in self._differences:
            count = self.count(max(coarse, fine, key=self.work))
            records = [self._trace(model, count, of) for model in (before, coarse, fine)]
            across, errors = self._is_across[list(of) or slice(count)], [0.0]
            for group in (across, ~across):
                some = [record[group] for record in records]
                rest = 1.0 - min(max(_trend(*(record[:, :, self._beyond :] for record in some)), 0.0), MOST_TREND)
                missed, whole = (np.square(part).sum(axis=1, dtype=np.float64) for part in (some[1] - some[2], some[2]))
                errors.append(_error(missed[:, self._beyond :], whole[:, self._beyond :], cautious) / rest)
                if nearer > 0.0:
                    errors.append(nearer * _error(missed, whole, cautious) / rest)
            self._differences[key] = max(errors)
        return self._differences[key]

    def measure_planes(self, model: Model) -> PlaneLaw:
        """Errors of a swept model by the number of its planes, from few planes of the same pings and from many."""
        model = _without_surface_echo(model)[0]
        if model not in self._laws:
            count = min(self._is_across.size, MEASURED)
            poses, across = take_poses(self._poses, slice(count)), self._is_across[:count]
            few, many = (self._measure(model._replace(planes=planes), poses) for planes in (FEW_PLANES, MANY_PLANES))
            one, other = (each.echoes[:, :, self._near :] * self._scale[:count] for each in (few, many))
            squares = [np.square(part, dtype=np.float64).sum(axis=1) for part in (one - other, other)]
            found = [_ratio(*(each[:, first:].sum(axis=1) for each in squares)) for first in (0, self._beyond)]
            estimated = (errors_over_bed(each.squares.sum(axis=1)) for each in (few, many))
            errors = np.stack([np.maximum(*found), *estimated])
            self._laws[model] = _fit_law(errors, [group for group in (~across, across) if group.any()])
        return self._laws[model]

    def _measure(self, model: Model, poses: Poses) -> TracedPings:
        """Trace pings by a swept model with the errors of their planes."""
        settings = find_tracer(model.method).settings(model)
        tiles, arrays = self._packed.ground_tiles(model.every, 0), self._packed.reduce(model)
        return TracedPings(*tiles.map(lambda tile, some: trace_measured(tile, some, **settings), arrays, poses))

    def loudest(self, model: Model, most: int) -> tuple[int, ...]:
        """Return the pings of the greatest energy over the level-bed curve by a model."""
        record = self._trace(_without_surface_echo(model)[0], self.count(model))[:, :, self._beyond :]
        energy = np.square(record, dtype=np.float64).sum(axis=(1, 2))
        return tuple(np.argsort(-energy, kind="stable")[:most].tolist())

    def seconds(self, model: Model) -> float:
        """Seconds of a ping by a model, one thread: by its work, from the first of its kind that was timed."""
        kind = model.method, model.bent
        if kind not in self._timed:
            alike = [other for other in self._traced if (other.method, other.bent) == kind and self.affords(other)]
            timed = model if self.affords(model) or not alike else max(alike, key=self.work)
            # Of a ping over the track, of which few meet targets. A call for one ping takes as long besides the ping
            # itself as one for many.
            pings = np.flatnonzero(~self._is_across)[: max(int(LITTLE / self.work(timed)), 2)]
            one, many = (self._time(self._packed, timed, pings[:count]) for count in (1, pings.size))
            seconds = (many - one) / (pings.size - 1) if pings.size > 1 and many > one else many / pings.size
            self._timed[kind] = seconds / self.work(timed)
        return self._timed[kind] * self.work(model)

    def seconds_of_first(self, packed: PackedScene, model: Model) -> float:
        """Seconds of the first ping by a model of another scene with the same track."""
        kernels = (model.method, model.bent, bool(model.ways))
        if kernels not in _LOADED:  # the first call takes longer, for it loads them
            self._time(packed, model, [0])
            _LOADED.add(kernels)
        return self._time(packed, model, [0])

    def _time(self, packed: PackedScene, model: Model, pings: ArrayLike) -> float:
        """Processor time that some of the pings take, in seconds."""
        poses, began = take_poses(self._poses, np.asarray(pings)), time.thread_time()
        trace_model(packed, model, poses)
        return time.thread_time() - began

    def _trace(self, model: Model, count: int, of: tuple[int, ...] = ()) -> Singles:
        """Trace a number of the pings, or some of them, unless they are traced already."""
        pings = np.array(of or range(min(count, self._is_across.size)))
        if model in self._traced and self._traced[model].shape[0] > pings.max():
            return self._traced[model][pings]

        def block(first: int, last: int) -> Singles:
            return trace_model(self._packed, model, take_poses(self._poses, pings[first:last]))

        parts = in_parallel(block, pings.size, least=max(1, int(WORK_OF_A_THREAD / self.work(model))))
        made = np.asarray(np.concatenate(parts)[:, :, self._near :] * self._scale[pings])
        if not of:
            self._traced[model] = made
        return made


def _without_surface_echo(*models: Model) -> tuple[Model, ...]:
    """Models without the echo of the sea surface itself if all have it: alike in all, it may outweigh the bed."""
    if not all(SURFACE_ECHO in model.ways for model in models):
        return models
    return tuple(model._replace(ways=model.ways - {SURFACE_ECHO}) for model in models)


def _fit_law(errors: Floats, groups: list[Booleans]) -> PlaneLaw:
    """Law of errors, (3, pings): of few planes as found, and as few and many planes estimate them."""
    found, few, many = (
        [math.sqrt(float(np.square(np.minimum(each[group], 1.0)).mean())) for group in groups] for each in errors
    )
    fall = math.log(few[0] / many[0]) / math.log(MANY_PLANES / FEW_PLANES) if many[0] > 0.0 else MOST_POWER
    trust = max(one / other if other > 0.0 else 0.0 for one, other in zip(found, few))
    fall, trust = min(max(fall, LEAST_POWER), MOST_POWER), max(TRUST_MARGIN * trust, LEAST_TRUST)
    return PlaneLaw(found[0], fall, trust, tuple(np.minimum(errors[1][groups[0]], 1.0).tolist()))


def scale_to_flat_bed(arrays: SceneArrays, poses: Poses, first: int) -> Singles:
    """Return the factors by which a record is divided by its flat-bed curve, from a bin on; 0 where that is none."""
    curve = compute_flat_bed_curves(arrays, poses)[:, :, first:]
    echoes = curve > np.finfo(np.float32).tiny
    return np.divide(1.0, curve, out=np.zeros_like(curve), where=echoes).astype(np.float32)


def _error(missed: Floats, whole: Floats, cautious: bool) -> float:
    """Error of a group of pings from squares, (n, bins) each; a cautious one with its standard error."""
    squares = missed.sum(axis=1), whole.sum(axis=1)
    return float(_ratio(missed.sum(), whole.sum())) + (_standard_error(*squares) if cautious else 0.0)


def _trend(coarser: Singles, coarse: Singles, fine: Singles) -> float:
    """Share of its last change by which a record goes on to change: the ratio of the vectors of both changes.

    Changes at random are at right angles and give 0; those of a bias that falls with the first power, a half.
    This is the vector form of Aitken's process (Wynn 1962).
    """
    before, last = coarser - coarse, coarse - fine
    square = float(np.square(before).sum(dtype=np.float64))
    return float((before * last).sum(dtype=np.float64)) / square if square > 0.0 else 0.0


def _ratio(missed: Floats, whole: Floats) -> Floats:
    """Root of the ratio of energies; 1 where the finer model returns nothing and the coarser one something."""
    echoes = whole > 0.0
    return np.sqrt(np.where(echoes, missed / np.where(echoes, whole, 1.0), missed > 0.0))


def _standard_error(missed: Floats, whole: Floats) -> float:
    """Return the jackknife's standard error of the ratio of sums: from the ratios without each ping (Efron 1982)."""
    if missed.size < 2:
        return 0.0
    without = _ratio(np.maximum(missed.sum() - missed, 0.0), np.maximum(whole.sum() - whole, 0.0))
    return math.sqrt((missed.size - 1) * float(without.var()))


def add_loud_pings(packed: PackedScene, pings: ProbePings) -> ProbePings:
    """Add those pings over the track that are much louder than others, by one plane over the bed alone."""
    if packed.scene.seabed.relief.level:
        return pings
    searched = spread_over_track(packed.scene, SEARCHED)
    poses = make_poses(packed.scene, packed.ground, searched)
    first = find_first_bin(ERROR_ALTITUDES, packed.arrays, poses)
    record = trace_model(packed, Model(), poses)[:, :, first:] * scale_to_flat_bed(packed.arrays, poses, first)
    energy = np.square(record, dtype=np.float64).sum(axis=(1, 2))
    loudest = np.argsort(-energy, kind="stable")[:FOUND]
    loud = loudest[energy[loudest] > LOUD * energy.mean()]
    return pings._replace(spread=np.union1d(pings.spread, searched[loud]))
