"""Simulator thread between the window and the core: the newest request is prepared and traced."""

import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from psygnal import Signal

from insonify.arrays import Booleans, Floats, Integers, Singles
from insonify.compiler.progress import Compilation, watch_compilation
from insonify.scene import Scene, SceneError, edit, load_scene
from insonify_viewer.core_types import LevelBed, PackedScene, Simulation
from insonify_viewer.errors import describe_error
from insonify_viewer.state.history import Modelling
from insonify_viewer.work.executor import Executor, Lane, Progress, Receive, Work
from insonify_viewer.work.ping_request import PingRequest, SimulatedScene, TracedPings, find_altitude, is_same_ground
from insonify_viewer.work.waiting import Waiting

BLOCK_TIME = 0.04  # s, predicted for a block of pings: it is shown, and a newer request takes over
COARSE_TIME = 0.08  # s, to trace the pings of a first picture while a slider moves; those between are interpolated
MAX_STRIDE = 16
FIRST_COARSE = 4  # pings of a coarse picture from which the time of the others is estimated
LONGEST = 0.3  # s, after which a coarse picture that a newer request waits for is shown as far as it is traced
THINNINGS = (4, 2)  # times the spacing; the first that resolves the waves of the relief is taken
MOST_NODES = 2**22  # of ground that is made at once, some 100 MB while it is made; beyond, tiles take less
MARGIN = 1.3  # times the range, about the pings: for the pulse, rough motion and refracted rays


class Simulator:
    """Traces the pings of the newest request on a thread of its own."""

    # A new request replaces one that waits. A request under way runs to the end of its block, so that a slider that
    # moves all the time still shows pings; the rest of it must be requested again.

    answered = Signal(object)  # `TracedPings`
    laid = Signal(int, object)  # number of a request, and its scene on a new bed
    refused = Signal(int, object)  # number of a request, and a `Failure`

    def __init__(
        self,
        prepare: Callable[..., Simulation] | None = None,
        pack: Callable[[Scene], PackedScene] | None = None,
    ) -> None:
        self.executor = Executor()  # threads of what else works beside the window
        self._prepare = prepare or _prepare
        self._pack = pack or (None if prepare else _pack)
        # Draws amplitudes, altitudes and reach of `TracedPings` for the window, on the thread that has traced them.
        self.draw: Callable[[Singles, Floats, Floats | None], Any] = lambda *_: None
        self._activity = Waiting()
        self._compilation: Compilation | None = None
        self._watching = ExitStack()
        self._watching.enter_context(watch_compilation(partial(setattr, self, "_compilation")))
        self.lane = Lane("simulator", self.executor.call_later)
        self.cost = 1e-4  # s, of a coarse ping
        self._coarse = -1  # number of the last coarse answer that was sent to the main thread
        self._last: dict[bool, tuple[Scene, Modelling, Simulation, LevelBed]] = {}
        self._traced_as: Callable[[Simulation], Simulation] | None = None

    @property
    def activity(self) -> Waiting:
        """What the worker does besides tracing pings, first of all compiling kernels."""
        reported = self._compilation
        if reported is None:
            return self._activity
        compilation = reported.by_now
        return Waiting(compilation.sentence, compilation.done)

    def ask(self, request: PingRequest) -> None:
        """Trace these pings next, instead of a request that still waits."""
        self.lane.put("pings", lambda: self._serve(request), lambda _: None, rank=2)

    def show_first(self, scene: Scene, receive: Callable[[Any], None]) -> None:
        """Make pictures ready to be drawn; answer with the record that comes with the package if it is the scene's."""
        self.send(lambda: self._example(scene), receive)

    def trace_as(self, change: Callable[[Simulation], Simulation] | None) -> None:
        """Change every simulation that is prepared from now on, or none: another track, or more in the water."""
        if change is not self._traced_as:
            self._traced_as = change
            self._last.clear()

    def prepare(self, scene: Scene, modelling: Modelling, receive: Callable[[Any], None]) -> None:
        """Prepare a scene without tracing it, and pass its `Simulation` or a `SceneError` to the main thread."""
        self.send(lambda: self._prepared(scene, modelling, fine=True)[0], receive)

    def simulate_beside(self, scene: Scene, modelling: Modelling) -> SimulatedScene:
        """Prepare another scene on the calling thread, to be traced there."""
        # lazy: loaded on the worker; the window opens before Numba is loaded
        from insonify.display.normalisation import LevelBed

        simulation = self._prepare(scene, tolerance=modelling.tolerance, forced=dict(modelling.forced))
        return SimulatedScene(simulation, LevelBed(simulation))

    def send(self, work: Work, receive: Receive) -> None:
        """Run work on the simulator's thread, before any request, and pass its result to the main thread."""
        # An exception is passed on as a `SceneError`.
        self.lane.put(object(), lambda: result_of(work), receive, rank=0)

    def send_patiently(self, key: str, work: Work, receive: Receive) -> None:
        """Run work like `send` once no request came for a moment; it replaces work of its key that still waits."""
        self.lane.put(key, lambda: result_of(work), receive, rank=3, patient=True)

    def trace_beside(self, scene: Scene, modelling: Modelling, pings: Integers) -> Singles:
        """Trace pings of another scene on the calling thread alone, beside the worker."""
        # lazy: loaded beside the worker; the window opens before Numba is loaded
        from insonify.display.normalisation import LevelBed
        from insonify.parallel import limited_threads

        with limited_threads(1):
            simulation = self._prepare(scene, tolerance=modelling.tolerance, forced={})
            return LevelBed(simulation).amplitudes(pings)

    def prepare_all(self, files: Sequence[Path], report: Progress) -> None:
        """Trace two pings of each scene of some files, so that the kernels that they need are compiled."""
        for number, file in enumerate(files):
            report(number / len(files))
            with suppress(SceneError):
                self.trace_beside(load_scene(file), Modelling(), np.arange(2))

    def close(self, patience: float | None = None) -> None:
        """End all threads, and wait for each at most for a time in seconds: it may be compiling."""
        self._watching.close()
        self.lane.close(patience)
        self.executor.close(patience)

    def _serve(self, request: PingRequest) -> None:
        refuse = partial(self.refused.emit, request.number)
        try:
            for answer in self.trace(request):
                if not answer.fine:
                    self._coarse = answer.number
                self._send(answer)
                if self.lane.is_interrupted_by("pings"):
                    return
        except Exception as error:  # an exception that ends the thread would freeze the picture silently
            self.executor.call_later(refuse, describe_error(error, "the simulation of this scene"))

    def _example(self, scene: Scene) -> None:
        # lazy: loaded on the worker; the window opens before Numba is loaded
        from insonify.display.example import UNPLANNED, read_example
        from insonify.display.normalisation import LevelBed
        from insonify.display.picture import compile_picture

        compile_picture()
        amplitude = read_example(scene) if self._pack is not None else None
        if amplitude is None:
            return
        simulation = self._prepare(scene, plan=UNPLANNED, **self._packed(scene, 0, None, tell=False))
        pings, level = np.arange(len(amplitude)), LevelBed(simulation)
        drawn, altitude = np.ones(len(pings), bool), find_altitude(simulation, pings)
        answer = TracedPings(0, False, pings, amplitude, level, simulation, 0.0, drawn, altitude, example=True)
        self._send(answer)
        level.normalise(amplitude[:1], pings[:1])  # compiles what the cursor needs, before all that tracing needs

    def trace(self, request: PingRequest) -> Iterator[TracedPings]:
        """Trace the pings of a request, part by part; the first picture of a moving slider is refined."""
        modelling = request.modelling if request.fine else request.modelling.coarse
        known = self._last.get(True)
        scene = request.scene if request.fine else thin_new_ground(request.scene, known and known[0])
        pings, beneath, begun = request.pings, None if scene is request.scene else request.pings, time.perf_counter()
        simulation, level = self._prepared(scene, modelling, fine=request.fine, number=request.number, beneath=beneath)
        if request.fine:
            simulation.expect(pings)  # a slider that moves next traces them all together
        if not request.fine:
            reach = _reach(simulation)
            for amplitude, between, seconds in self._refine(level, pings, time.perf_counter() - begun):
                block = pings[: len(amplitude)]
                altitude = find_altitude(simulation, block)
                yield TracedPings(
                    request.number, False, block, amplitude, level, simulation, seconds, between, altitude, reach
                )
            return
        size = simulation.pings_within(BLOCK_TIME)
        for start in range(0, len(pings), size):
            begun, block = time.perf_counter(), pings[start : start + size]
            amplitude, error = level.trace(block)
            seconds, between = time.perf_counter() - begun, np.zeros(len(block), bool)
            altitude = find_altitude(simulation, block)
            traced = TracedPings(request.number, True, block, amplitude, level, simulation, seconds, between, altitude)
            yield replace(traced, error=error)

    def _refine(self, level: LevelBed, pings: Integers, passed: float) -> Iterator[tuple[Singles, Booleans, float]]:
        """Yield amplitudes of pings, which are interpolated, and the seconds it took: at first every few, then all."""
        # Of pings that take long something newer may wait for, only the first come.
        stride, begun = self._stride(len(pings), passed), time.perf_counter()
        traced = self._trace_coarsely(level, pings[::stride])
        seconds = time.perf_counter() - begun
        self.cost = seconds / len(traced)
        amplitude = np.repeat(traced, stride, axis=0)[: len(pings)]
        between = np.arange(len(amplitude)) % stride > 0
        while True:
            interpolate_pings(amplitude, between)
            yield amplitude.copy(), between.copy(), seconds
            rest = np.flatnonzero(between)[: max(1, int(BLOCK_TIME / self.cost))]
            if not rest.size:
                return
            begun = time.perf_counter()
            amplitude[rest] = level.amplitudes(pings[rest])
            between[rest], seconds = False, time.perf_counter() - begun

    def _trace_coarsely(self, level: LevelBed, pings: Integers) -> Singles:
        """Amplitudes of the first pings: of all, unless it takes long and something newer waits."""
        parts: list[Singles] = []
        done, size, begun = 0, FIRST_COARSE, time.perf_counter()
        while done < len(pings):
            parts.append(level.amplitudes(pings[done : done + size]))
            done += len(parts[-1])
            passed = time.perf_counter() - begun
            if passed > LONGEST and self.lane.is_interrupted_by("pings"):
                break
            # Of what takes little time there is one more part; one that takes long is looked after.
            size = max(1, int(LONGEST * done / passed))
        return np.concatenate(parts)

    def _stride(self, pings: int, passed: float) -> int:
        """Stride over pings by which a coarse trace of them takes about `COARSE_TIME`, or half of what has passed."""
        # A picture for which ground was made comes late in any case, and hardly later with more of its pings.
        stride, allowed = 1, max(COARSE_TIME, 0.5 * passed)
        while stride < MAX_STRIDE and pings * self.cost > allowed * stride:
            stride *= 2
        return stride

    def _prepared(
        self, scene: Scene, modelling: Modelling, *, fine: bool, number: int = 0, beneath: Integers | None = None
    ) -> tuple[Simulation, LevelBed]:
        """Prepare a scene, of its ground no more than lies beneath some pings, if they are given."""
        # The last simulation is used again if the scene is the same.
        # lazy: loaded on the worker; the window opens before Numba is loaded
        from insonify.display.normalisation import LevelBed

        last = self._last.get(fine)
        if last is None or last[:2] != (scene, modelling) or beneath is not None:
            # While a slider moves nothing is measured: the last plan is kept where the scene allows it.
            known = self._last.get(True)
            kept: dict[str, Any] = {} if fine or known is None else {"plan": known[2].plan}
            with self._doing("building the bed"):
                kept |= self._packed(scene, number, beneath, tell=fine)
            with self._doing("choosing the fastest method within the tolerance"):
                # A preview has one plane for all of its beam: those across targets take longer than all others.
                forced = dict(modelling.forced) | ({} if fine else {"target_planes": "0"})
                simulation = self._prepare(scene, tolerance=modelling.tolerance, forced=forced, **kept)
                simulation = simulation if self._traced_as is None else self._traced_as(simulation)
                last = self._last[fine] = (scene, modelling, simulation, LevelBed(simulation))
        return last[2:]

    def _packed(self, scene: Scene, number: int, beneath: Integers | None, *, tell: bool) -> dict[str, PackedScene]:
        """Build the bed of a scene and announce it, so that it is shown while kernels are compiled."""
        if self._pack is None:
            return {}
        packed = self._pack(scene) if beneath is None else pack_beneath(scene, beneath)
        known = self._last.get(True)
        if tell and (known is None or not is_same_ground(known[2].ground, packed.ground)):
            self.executor.call_later(partial(self.laid.emit, number), packed)
        return {"packed": packed}

    @contextmanager
    def _doing(self, what: str) -> Iterator[None]:
        """Note the worker's activity until the block ends."""
        self._activity = Waiting(what)
        try:
            yield
        finally:
            self._activity = Waiting()

    def _send(self, answer: TracedPings) -> None:
        """Draw pings, and pass them to the main thread."""
        drawn = self.draw(answer.amplitude, answer.altitude, answer.reach)
        self.executor.call_later(self._deliver, replace(answer, drawn=drawn))

    def _deliver(self, answer: TracedPings) -> None:
        """Pass an answer on, unless it is a coarse picture and that of a later edit waits behind it."""
        if answer.fine or answer.number >= self._coarse:
            self.answered.emit(answer)


def _pack(scene: Scene) -> PackedScene:
    # lazy: loaded on the worker; the window opens before Numba is loaded
    from insonify.packing.packed_scene import pack

    return pack(scene)


def _prepare(scene: Scene, **how: Any) -> Simulation:
    # lazy: loaded on the worker; the window opens before Numba is loaded
    from insonify.simulation import prepare

    return prepare(scene, **how)


def interpolate_pings(amplitude: Singles, between: Booleans) -> None:
    """Interpolate some rows of amplitudes between the nearest others, or repeat the last of these, in place."""
    rows, known = np.flatnonzero(between), np.flatnonzero(~between)
    if rows.size:
        after = np.searchsorted(known, rows)
        one, other = known[after - 1], known[np.minimum(after, known.size - 1)]
        share = (rows - one) / np.maximum(other - one, 1)
        share = share.astype(np.float32)[:, None, None]
        amplitude[rows] = amplitude[one] + share * (amplitude[other] - amplitude[one])


def _reach(simulation: Simulation) -> Floats | None:
    """Count the pings that the beam covers, by range bin; None if averaging would also blur speckle or noise."""
    # lazy: loaded on the worker; the window opens before Numba is loaded
    from insonify.acoustics.resolution_cell import bin_centres, coherence_angle

    scene, arrays = simulation.scene, simulation.arrays
    if arrays.half_width <= 0.0 or not scene.receiver.steady:
        return None
    step = scene.track.speed / scene.sonar.ping_rate
    return coherence_angle(arrays) * bin_centres(arrays) / step


def result_of(work: Work) -> Any:
    """Return the result of work, or why there is none as a `SceneError`."""
    try:
        return work()
    except SceneError as error:
        return error
    except Exception as error:
        refusal = SceneError(f"this cannot be shown ({type(error).__name__}: {error}); open another scene")
        refusal.__cause__ = error
        return refusal


def thin_new_ground(scene: Scene, known: Scene | None) -> Scene:
    """Put an endless bed that is new on fewer nodes; the bed of the known scene stays as it is."""
    # Endless ground shares all but its finest waves with the same ground at a multiple of the spacing, and the time
    # that a window takes falls with the square of it.
    if not scene.seabed.endless or (known is not None and _ground_of(scene) == _ground_of(known)):
        return scene
    for times in THINNINGS:
        try:
            return edit(scene, {"seabed.spacing": times * scene.seabed.spacing})
        except SceneError:  # waves of the relief are too short for it
            continue
    return scene


def pack_beneath(scene: Scene, pings: Integers) -> PackedScene:
    """Pack a scene over endless ground, limited to what some pings reach."""
    # lazy: loaded on the worker; the window opens before Numba is loaded
    from insonify.packing.packed_scene import pack
    from insonify.terrain import build_excerpt
    from insonify.tow.line import tow_line_at

    line, margin = tow_line_at(scene, pings), MARGIN * scene.sonar.range
    low, high = (line.x.min() - margin, line.y.min() - margin), (line.x.max() + margin, line.y.max() + margin)
    sides = np.subtract(high, low) / scene.seabed.spacing
    return pack(scene, build_excerpt(scene, low, high) if sides.prod() <= MOST_NODES else None)


def _ground_of(scene: Scene) -> tuple[object, ...]:
    """Return what decides the tiles beneath the pings of a scene."""
    return scene.seabed, scene.seed, scene.pits, scene.track.start, scene.track.heading
