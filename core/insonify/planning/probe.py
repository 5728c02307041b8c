"""Probe of a scene: a few pings traced by several models; their differences are the errors of the coarser ones."""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from insonify.acoustics.flat_bed import ERROR_ALTITUDES, compute_flat_bed_curves, find_first_bin
from insonify.arrays import Booleans, Floats, Singles
from insonify.kernels.common.types import Poses, SceneArrays
from insonify.packing.apparent_tables import make_apparent_tables
from insonify.packing.containment import refuse_sonar_in_target
from insonify.packing.packed_scene import Model, PackedScene
from insonify.parallel import count_threads, in_parallel
from insonify.planning.probe_pings import ProbePings, spread_over_track
from insonify.scene import SceneError
from insonify.tow.poses import find_pings_in_bed, make_poses, refuse_sonar_in_bed, take_poses
from insonify.tracers.azimuth_fan import lay_planes
from insonify.tracers.base import find_tracer, prepare_tracer
from insonify.tracers.plane_counts import Trust, empty_squares, errors_over_bed
from insonify.tracers.sweep import Sweep, trace_measured
from insonify.tracers.target_planes import find_pings_met

MEASURED, FEWEST, SHARE_OF_TRACK = 16, 4, 16  # pings measured: one in sixteen of the track, within bounds
MOST = 1e8  # work of half a second, up to which finer and finer models are traced to judge coarser ones
WORK_OF_A_THREAD = 2e5  # of the pings of a call, beside which what the call itself takes is little
SECONDS_OF_WORK = 7e-9  # where nothing was timed
SEARCHED, FOUND = 48, 2  # pings over the track that are searched, and the most of them that are added
MOST_TREND = 0.5  # of a bias that falls with the first power
ENOUGH_PINGS = 8  # that tell how far what planes estimate is trusted
LEAST_POWER, MOST_POWER = 0.5, 2.0  # of planes at random, and of a smooth bed
TRUST_MARGIN = 1.25  # of errors over what planes estimate, for pings unlike those measured
USUAL = 0.75  # share of the pings that are within the tolerance by the planes that all of them begin with
LOUD = 3.0  # times the mean energy of those searched
_LOADED: set[tuple[str, bool, bool]] = set()  # kernels of waves that this process has called: method, bent, paths


def trace_model(packed: PackedScene, model: Model, poses: Poses) -> Singles:
    """Trace pings of a scene by a model on one thread, (n, 2, bins)."""
    tracer, settings = prepare_tracer(packed, model), find_tracer(model.method).settings(model)
    found: Singles = packed.ground_tiles(model.every, tracer.bins_beyond).map(
        lambda tile, some: tracer.trace(tile, some, threads=1, **settings), packed.modelled_arrays(model), poses
    )
    return found


def trace_planes(packed: PackedScene, model: Model, poses: Poses) -> tuple[Singles, Floats]:
    """Trace pings by a swept model on one thread, with the squares of the errors of their planes."""
    settings = find_tracer(model.method).settings(model) | {"threads": 1}
    tiles, arrays = packed.ground_tiles(model.every, 0), packed.modelled_arrays(model)
    echoes, squares, *_ = tiles.map(lambda tile, some: trace_measured(tile, some, **settings), arrays, poses)
    return echoes, squares


def work_of(packed: PackedScene, model: Model) -> float:
    """Work of a ping by a model, both sides: a count, the same on every machine."""
    if model not in packed.works:
        packed.works[model] = find_tracer(model.method).work(packed.scene, packed.arrays, model)
    return packed.works[model]


class PlaneLaw(NamedTuple):
    """Error of pings by the number of planes across the beam."""

    few: int  # planes by which it is measured
    many: int  # and by the difference to which
    error: float  # of the few
    power: float  # of the number of planes with which it falls
    trust: Trust  # by a margin
    estimated: tuple[float, ...]  # errors of pings over the track by the few, as their planes are trusted

    def of(self, planes: int) -> float:
        """Error of a number of planes."""
        return self.error * (self.few / planes) ** self.power

    def usual(self, planes: int) -> float:
        """Estimated error of a number of planes within which most measured pings are."""
        return float(np.quantile(self.estimated, USUAL)) * (self.few / planes) ** self.power


class Probe:
    """A few pings of a scene, each traced at most once by any model."""

    def __init__(self, packed: PackedScene, pings: ProbePings, targets: tuple[int, ...] = ()) -> None:
        self._packed = packed
        ordered, across = pings.interleaved()
        size = max(min(packed.scene.track.pings // SHARE_OF_TRACK, MEASURED), FEWEST)
        ordered, across = ordered[:size], across[:size]
        poses = make_poses(packed.scene, packed.ground, ordered)
        clear = ~find_pings_in_bed(packed.ground, poses)
        if not clear.any():
            refuse_sonar_in_bed(packed.scene, packed.ground, ordered, poses)
        # Pings from below the bed or inside a target are refused when they are simulated.
        clear[clear] = _find_clear_of_targets(packed.modelled_arrays(Model(targets=targets)), take_poses(poses, clear))
        self._poses, self._is_across = take_poses(poses, clear), across[clear]
        self._near = find_first_bin(1.0, packed.arrays, self._poses)
        self._beyond = find_first_bin(ERROR_ALTITUDES, packed.arrays, self._poses) - self._near
        self._scale = scale_to_flat_bed(packed.arrays, self._poses, self._near)
        # Pings, in an order in which few are spread like all, from the first return, over the flat-bed curve.
        self._traced: dict[tuple[Model, tuple[int, ...]], Singles] = {}
        self._squares: dict[tuple[Model, tuple[int, ...]], Floats] = {}
        self._rates: dict[tuple[str, bool], float] = {}  # seconds per work
        self._differences: dict[tuple[Any, ...], float] = {}
        self._laws: dict[tuple[Model, Model], PlaneLaw] = {}

    @property
    def size(self) -> int:
        """Number of its pings."""
        return self._is_across.size

    def affords(self, model: Model) -> bool:
        """Whether a model may be traced to judge a coarser one; errors of more work are predicted from its order."""
        return self.size * work_of(self._packed, model) <= MOST

    def trace(self, models: Sequence[Model], of: tuple[int, ...] = ()) -> None:
        """Trace the pings, or some of them, by models that they are not traced by yet: all in one call of threads."""
        pings, threads = np.array(of or range(self.size)), count_threads()
        models = [model for model in dict.fromkeys(models) if (model, of) not in self._traced]
        works = [work_of(self._packed, model) * pings.size for model in models]
        share = max(sum(works) / (4 * threads), WORK_OF_A_THREAD) if threads > 1 else math.inf
        tasks = [
            (model, part)
            for work, model in sorted(zip(works, models), key=lambda pair: pair[0])
            for part in np.array_split(pings, min(max(round(work / share), 1), pings.size))
        ]
        shares = in_parallel(
            lambda first, last: [self._trace(*task) for task in tasks[first:last]], len(tasks), least=1
        )
        parts = [found for share in shares for found in share]
        for model in models:
            own = [found for (other, _), found in zip(tasks, parts) if other is model]
            echoes = np.concatenate([echoes for echoes, _ in own])[:, :, self._near :] * self._scale[pings]
            self._traced[model, of] = echoes
            if model.planes > 1:
                self._squares[model, of] = np.concatenate([squares for _, squares in own])

    def _trace(self, model: Model, pings: ArrayLike) -> tuple[Singles, Floats]:
        """Trace pings by a model on one thread, timed; return the squares of the errors of planes too if swept."""
        poses, began = take_poses(self._poses, np.asarray(pings)), time.thread_time()
        if model.planes > 1 and isinstance(find_tracer(model.method), Sweep):
            found = trace_planes(self._packed, model, poses)
        else:
            found = trace_model(self._packed, model, poses), empty_squares(0)
        kind, work = (model.method, model.bent), work_of(self._packed, model) * max(poses.x.size, 1)
        self._rates[kind] = min(self._rates.get(kind, math.inf), (time.thread_time() - began) / work)
        return found

    def rate(self, model: Model) -> float:
        """Seconds of a unit of work by a model's method, as the least of those timed."""
        return self._rates.get((model.method, model.bent), SECONDS_OF_WORK)

    def difference(
        self,
        coarse: Model,
        fine: Model,
        *,
        before: Model | None = None,
        nearer: float = 0.0,
        of: tuple[int, ...] = (),
    ) -> float:
        """Error of a model against a finer one, of all pings or some: the greater of those over track and targets.

        Of all pings it includes its standard error; with the model before both in their order, also what still finer
        ones add to the difference.
        """
        before = before or coarse
        if coarse == fine:
            return 0.0
        key = coarse, fine, before, nearer, of
        if key not in self._differences:
            self.trace((before, coarse, fine), of)
            across, errors = self._is_across[list(of) or slice(None)], [0.0]
            for group in (across, ~across):
                some = [self._traced[model, of][group] for model in (before, coarse, fine)]
                rest = 1.0 - min(max(_trend(*(record[:, :, self._beyond :] for record in some)), 0.0), MOST_TREND)
                missed, whole = (np.square(part).sum(axis=1, dtype=np.float64) for part in (some[1] - some[2], some[2]))
                some_missed, some_whole = (squares[:, self._beyond :] for squares in (missed, whole))
                errors.append(_error(some_missed, some_whole, is_bound=not of) / rest)
                errors.append(nearer * _error(missed, whole) / rest)
            self._differences[key] = max(errors)
        return self._differences[key]

    def law(self, few: Model, many: Model, pings: int) -> PlaneLaw:
        """Errors by the number of planes, from few planes of the first pings and from many of the same."""
        if (few, many) not in self._laws:
            count = min(pings, self.size)
            (one, estimated), (other, finer) = (self._first(count, model) for model in (few, many))
            squares = [np.square(part, dtype=np.float64).sum(axis=1) for part in (one - other, other)]
            found = [_ratio(*(each[:, first:].sum(axis=1) for each in squares)) for first in (0, self._beyond)]
            errors = [np.maximum(*found), *(errors_over_bed(each.sum(axis=1)) for each in (estimated, finer))]
            arrays, poses = self._packed.modelled_arrays(few), take_poses(self._poses, slice(count))
            met = find_pings_met(arrays, poses, lay_planes(arrays, poses, few.planes, few.across))
            self._laws[few, many] = _fit_law(few.planes, many.planes, np.stack(errors), met, self._is_across[:count])
        return self._laws[few, many]

    def _first(self, count: int, model: Model) -> tuple[Singles, Floats]:
        """Echoes of the first pings by a model over the flat-bed curve, and the squares that its planes estimate."""
        of = () if (model, ()) in self._traced or count == self.size else tuple(range(count))
        self.trace([model], of)
        return self._traced[model, of][:count], self._squares[model, of][:count]

    def folds(self, model: Model) -> bool:
        """Whether several eigenrays or none reach some places from some of the pings."""
        return bool(make_apparent_tables(self._packed.modelled_arrays(model), self._poses)[1].any())

    def loudest(self, model: Model, most: int) -> tuple[int, ...]:
        """Return the pings of the greatest energy over the level-bed curve by a model."""
        self.trace([model])
        energy = np.square(self._traced[model, ()][:, :, self._beyond :], dtype=np.float64).sum(axis=(1, 2))
        return tuple(np.argsort(-energy, kind="stable")[:most].tolist())

    def seconds_of_first(self, packed: PackedScene, model: Model) -> float:
        """Seconds of the first ping by a model of another scene with the same track."""
        kernels, poses = (model.method, model.bent, bool(model.ways)), take_poses(self._poses, slice(0, 1))
        if kernels not in _LOADED:  # the first call takes longer, for it loads them
            trace_model(packed, model, poses)
            _LOADED.add(kernels)
        began = time.thread_time()
        trace_model(packed, model, poses)
        return time.thread_time() - began


def _find_clear_of_targets(arrays: SceneArrays, poses: Poses) -> Booleans:
    """Whether the sonar is outside of all targets at each ping; it is an error if it is inside at all pings."""
    clear, fault = np.ones(poses.x.size, np.bool_), None
    try:
        refuse_sonar_in_target(arrays, poses)
    except SceneError:
        for ping in range(clear.size):
            try:
                refuse_sonar_in_target(arrays, take_poses(poses, slice(ping, ping + 1)))
            except SceneError as error:
                clear[ping], fault = False, error
    if fault is not None and not clear.any():
        raise fault
    return clear


def _fit_law(few: int, many: int, errors: Floats, is_met: Booleans, is_across: Booleans) -> PlaneLaw:
    """Law of errors, (3, pings): of few planes as found, and as few and many planes estimate them."""
    errors, fall = np.minimum(errors, 1.0), MOST_POWER  # an unknown one is infinite
    found, estimated, _ = errors
    usual = ~is_across if not is_across.all() else is_across
    of_few, of_many = (_root_mean_square(each[usual]) for each in errors[1:])
    if of_many > 0.0:
        fall = math.log(of_few / of_many) / math.log(many / few) if of_few > 0.0 else LEAST_POWER
    alone = _trust(found[~is_met], estimated[~is_met], is_across[~is_met])
    met = _trust(found[is_met], estimated[is_met], is_across[is_met])
    crossing, told = int(is_met.sum()), is_met & (estimated > 0.0)
    if told.any() and crossing < ENOUGH_PINGS:
        # Targets are less alike than the bed: of few pings the worst counts.
        worst = float((found[told] / estimated[told]).max())
        met = max(met, (1.0 + 1.0 / math.sqrt(crossing)) * worst)
    # Where no ping of a kind is measured, those of the other kind have to do.
    trust = Trust(alone or met, met or alone)
    by_planes = np.where(is_met, trust.met, trust.alone) * estimated
    error, fall = _root_mean_square(found[usual]), min(max(fall, LEAST_POWER), MOST_POWER)
    return PlaneLaw(few, many, error, fall, trust, tuple(by_planes[usual].tolist()))


def _trust(found: Floats, estimated: Floats, is_across: Booleans) -> float:
    """Errors found over those estimated, the greater of those over the track and across targets; 0 without pings.

    Few pings may err little by chance: n of them give no reason to trust in less than 1/√n.
    """
    ratios = [0.0]
    for group in (is_across, ~is_across):
        if group.any() and estimated[group].any():
            ratios.append(_root_mean_square(found[group]) / _root_mean_square(estimated[group]))
    return max(TRUST_MARGIN * max(ratios), 1.0 / math.sqrt(found.size)) if found.size else 0.0


def _root_mean_square(errors: Floats) -> float:
    return math.sqrt(float(np.square(errors).mean()))


def scale_to_flat_bed(arrays: SceneArrays, poses: Poses, first: int) -> Singles:
    """Return the factors by which a record is divided by its flat-bed curve, from a bin on; 0 where that is none."""
    curve = compute_flat_bed_curves(arrays, poses)[:, :, first:]
    echoes = curve > np.finfo(np.float32).tiny
    return np.divide(1.0, curve, out=np.zeros_like(curve), where=echoes).astype(np.float32)


def _error(missed: Floats, whole: Floats, is_bound: bool = True) -> float:
    """Error of a group of pings from squares, (n, bins) each; with its standard error if it is to be a bound."""
    squares = missed.sum(axis=1), whole.sum(axis=1)
    return float(_ratio(missed.sum(), whole.sum())) + is_bound * _standard_error(*squares)


def _trend(coarser: Singles, coarse: Singles, fine: Singles) -> float:
    """Share of its last change by which a record goes on to change: the ratio of the vectors of both changes.

    Random changes are at right angles and give 0; changes by a bias that falls with the first power give a half.
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
    relief, has_lobes = packed.scene.seabed.relief, packed.arrays.limits.shininess > 0.0
    if relief.level or not (has_lobes or relief.measured):  # alike everywhere, and without glints
        return pings
    searched = spread_over_track(packed.scene, SEARCHED)
    poses = make_poses(packed.scene, packed.ground, searched)
    first = find_first_bin(ERROR_ALTITUDES, packed.arrays, poses)
    record = trace_model(packed, Model(), poses)[:, :, first:] * scale_to_flat_bed(packed.arrays, poses, first)
    energy = np.square(record, dtype=np.float64).sum(axis=(1, 2))
    loudest = np.argsort(-energy, kind="stable")[:FOUND]
    loud = loudest[energy[loudest] > LOUD * energy.mean()]
    return pings._replace(spread=np.union1d(pings.spread, searched[loud]), loud=searched[loud])
