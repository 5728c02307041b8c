"""Worker thread between the window and the core; requests are numbered, and the newest wins."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QObject, Qt, Signal

from insonify.compiler.progress import Compilation, watch_compilation
from insonify.scene import Scene, SceneError
from insonify_viewer.errors.failure import describe_error
from insonify_viewer.record.comparison.kept_record import SimulatedScene, find_altitude
from insonify_viewer.state.modelling import Modelling
from insonify_viewer.work.coarse_ground import pack_beneath, thin_new_ground
from insonify_viewer.work.laid_scene import is_same_ground
from insonify_viewer.work.ping_request import PingRequest, TracedPings
from insonify_viewer.work.thread_priority import yield_to_window
from insonify_viewer.work.waiting import Activity

if TYPE_CHECKING:
    from insonify.display.normalisation import LevelBed
    from insonify.packing.packed_scene import PackedScene
    from insonify.simulation import Simulation

BLOCK_TIME = 0.04  # s, predicted for a block of pings: it is shown, and a newer request takes over
COARSE_TIME = 0.01  # s, time to trace all pings on screen while a slider moves
MAX_STRIDE = 16
FIRST_COARSE = 4  # pings of a coarse picture by which the time of the others is told
LONGEST = 0.3  # s, after which a coarse picture that a newer request waits for is shown as far as it is traced
QUIET, PATIENCE = 0.1, 0.7  # s without requests before a patient errand, and its longest wait


class Simulator(QObject):
    """Traces the pings of the newest request on a thread of its own.

    A new request replaces one that waits. A request under way runs to the end of its block, so that a slider that moves
    all the time still shows pings; the rest of it must be requested again.
    """

    answered = Signal(object)
    laid = Signal(int, object)  # number of a request, and its scene on a new bed
    refused = Signal(int, object)  # number of a request, and a `Failure`
    _called_back = Signal(object, object)

    def __init__(
        self,
        prepare: Callable[..., Simulation] | None = None,
        pack: Callable[[Scene], PackedScene] | None = None,
        parent: QObject | None = None,
    ) -> None:
        super().__init__(parent)
        self._prepare = prepare or _prepare
        self._pack = pack or (None if prepare else _pack)
        self._activity = Activity()
        self._compilation: Compilation | None = None
        self._watching = ExitStack()
        self._watching.enter_context(watch_compilation(partial(setattr, self, "_compilation")))
        self._waiting: PingRequest | None = None
        self._errands: list[_Errand] = []
        self._patient: _Errand | None = None
        self._latest_start = 0.0
        self._closing = False
        self._cost = 1e-4  # s, of a coarse ping
        self._coarse = -1  # number of the last coarse answer that was sent to the main thread
        self._changed = threading.Condition()
        self._last: dict[bool, tuple[Scene, Modelling, Simulation, LevelBed]] = {}
        self._called_back.connect(self._call_back, Qt.ConnectionType.QueuedConnection)
        self._thread = threading.Thread(target=self._work, name="insonify simulator", daemon=True)
        self._thread.start()

    @property
    def activity(self) -> Activity:
        """What the worker does besides tracing pings, first of all compiling kernels."""
        reported = self._compilation
        if reported is None:
            return self._activity
        compilation = reported.by_now
        return Activity(compilation.sentence, compilation.done)

    def ask(self, request: PingRequest) -> None:
        """Trace these pings next, instead of a request that still waits."""
        with self._changed:
            self._waiting = request
            self._changed.notify()

    def prepare(self, scene: Scene, modelling: Modelling, receive: Callable[[Any], None]) -> None:
        """Prepare a scene without tracing it, and pass its `Simulation` or a `SceneError` to the main thread."""
        self.send(lambda: self._prepared(scene, modelling, fine=True)[0], receive)

    def simulate_beside(self, scene: Scene, modelling: Modelling) -> SimulatedScene:
        """Prepare another scene on the calling thread, to be traced there."""
        # lazy: loaded on the worker; the window opens before Numba is loaded
        from insonify.display.normalisation import LevelBed

        simulation = self._prepare(scene, tolerance=modelling.tolerance, forced=dict(modelling.forced))
        return SimulatedScene(simulation, LevelBed(simulation))

    def send(self, errand: Callable[[], Any], receive: Callable[[Any], None]) -> None:
        """Run an errand on the worker, before any request, and pass its result to the main thread.

        An exception of the errand is passed on as a `SceneError`.
        """
        with self._changed:
            self._errands.append((errand, receive))
            self._changed.notify()

    def send_patiently(self, errand: Callable[[], Any], receive: Callable[[Any], None]) -> None:
        """Run an errand once no request came for a moment; it replaces a patient errand that still waits."""
        with self._changed:
            if self._patient is None:
                self._latest_start = time.perf_counter() + PATIENCE
            self._patient = (errand, receive)
            self._changed.notify()

    def trace_beside(self, scene: Scene, modelling: Modelling, pings: NDArray[np.int64]) -> NDArray[np.float32]:
        """Trace pings of another scene on the calling thread alone, beside the worker."""
        # lazy: loaded beside the worker; the window opens before Numba is loaded
        from insonify.display.normalisation import LevelBed
        from insonify.parallel import limited_threads

        with limited_threads(1):
            simulation = self._prepare(scene, tolerance=modelling.tolerance, forced={})
            return LevelBed(simulation).amplitudes(pings)

    def call_later(self, receive: Callable[[Any], None], result: Any) -> None:
        """Pass a result from any thread to the main thread; it is dropped once the viewer closes."""
        # A thread that compiles outlives the window, and Qt's half of this object when the interpreter ends.
        with suppress(RuntimeError):
            self._called_back.emit(receive, result)

    def close(self, patience: float | None = None) -> None:
        """Stop the worker and wait for it, at most for a time in seconds: it may be compiling."""
        with self._changed:
            self._closing = True
            self._changed.notify()
        self._watching.close()
        self._thread.join(patience)

    def _work(self) -> None:
        yield_to_window()
        while not self._closing:
            with self._changed:
                self._changed.wait_for(lambda: self._patient or self._is_wanted())
                # A patient errand gives precedence to the next move of a slider.
                self._changed.wait_for(self._is_wanted, timeout=QUIET)
                errands, self._errands = self._errands, []
                request, self._waiting = self._waiting, None
                if self._patient and (request is None or time.perf_counter() > self._latest_start):
                    errands, self._patient = [*errands, self._patient], None
            for errand, receive in errands:
                self.call_later(receive, _result(errand))
            if request is not None and not self._closing:
                self._serve(request)

    def _is_wanted(self) -> bool:
        return bool(self._waiting or self._errands or self._closing)

    def _serve(self, request: PingRequest) -> None:
        refuse = partial(self.refused.emit, request.number)
        try:
            for answer in self._trace(request):
                if not answer.fine:
                    self._coarse = answer.number
                self.call_later(self._deliver, answer)
                if self._waiting is not None or self._closing:
                    return
        except Exception as error:  # an exception that ends the thread would freeze the picture silently
            self.call_later(refuse, describe_error(error, "the simulation of this scene"))

    def _trace(self, request: PingRequest) -> Iterator[TracedPings]:
        modelling = request.modelling if request.fine else request.modelling.coarse
        known = self._last.get(True)
        scene = request.scene if request.fine else thin_new_ground(request.scene, known and known[0])
        pings, beneath, begun = request.pings, None if scene is request.scene else request.pings, time.perf_counter()
        simulation, level = self._prepared(scene, modelling, fine=request.fine, number=request.number, beneath=beneath)
        if request.fine:
            simulation.expect(pings)  # a slider that moves next traces them all together
        stride = 1 if request.fine else self._stride(len(pings), time.perf_counter() - begun)
        size = simulation.pings_within(BLOCK_TIME)
        start = 0
        while start < len(pings):
            begun = time.perf_counter()
            if request.fine:
                traced = level.amplitudes(pings[start : start + size])
            else:
                traced = self._trace_coarsely(level, pings[start::stride])
            seconds = time.perf_counter() - begun
            if not request.fine:
                self._cost = seconds / len(traced)
            block = pings[start : start + stride * len(traced)]
            start += len(block)
            amplitude = traced if stride == 1 else np.repeat(traced, stride, axis=0)[: len(block)]
            reach = None if request.fine else _reach(simulation)
            yield TracedPings(
                request.number,
                request.fine,
                block,
                amplitude,
                level,
                simulation,
                seconds,
                stride,
                find_altitude(simulation, block),
                reach,
            )

    def _trace_coarsely(self, level: LevelBed, pings: NDArray[np.int64]) -> NDArray[np.float32]:
        """Amplitudes of the first pings: of all, unless it takes long and something newer waits."""
        parts: list[NDArray[np.float32]] = []
        done, size, begun = 0, FIRST_COARSE, time.perf_counter()
        while done < len(pings):
            parts.append(level.amplitudes(pings[done : done + size]))
            done += len(parts[-1])
            passed = time.perf_counter() - begun
            if passed > LONGEST and (self._waiting is not None or self._closing):
                break
            # Of what takes little time there is one more part; one that takes long is looked after.
            size = max(1, int(LONGEST * done / passed))
        return np.concatenate(parts)

    def _stride(self, pings: int, passed: float) -> int:
        """Stride over the pings by which a coarse trace of them takes about `COARSE_TIME`, or half of what has passed.

        A picture for which ground was made comes late in any case, and hardly later with more of its pings.
        """
        stride, allowed = 1, max(COARSE_TIME, 0.5 * passed)
        while stride < MAX_STRIDE and pings * self._cost > allowed * stride:
            stride *= 2
        return stride

    def _prepared(
        self,
        scene: Scene,
        modelling: Modelling,
        *,
        fine: bool,
        number: int = 0,
        beneath: NDArray[np.int64] | None = None,
    ) -> tuple[Simulation, LevelBed]:
        """Prepare a scene, of its ground no more than lies beneath some pings, if they are given.

        The last simulation is used again if the scene is the same.
        """
        # lazy: loaded on the worker; the window opens before Numba is loaded
        from insonify.display.normalisation import LevelBed

        last = self._last.get(fine)
        if last is None or last[:2] != (scene, modelling) or beneath is not None:
            # While a slider moves nothing is measured: the last plan serves as far as the scene admits it.
            known = self._last.get(True)
            kept: dict[str, Any] = {} if fine or known is None else {"plan": known[2].plan}
            with self._doing("building the bed"):
                kept |= self._packed(scene, number, beneath, tell=fine)
            with self._doing("choosing the methods by a few pings"):
                simulation = self._prepare(scene, tolerance=modelling.tolerance, forced=dict(modelling.forced), **kept)
                last = self._last[fine] = (scene, modelling, simulation, LevelBed(simulation))
        return last[2:]

    def _packed(
        self, scene: Scene, number: int, beneath: NDArray[np.int64] | None, *, tell: bool
    ) -> dict[str, PackedScene]:
        """Build the bed of a scene and tell of it, so that it is shown while kernels are compiled."""
        if self._pack is None:
            return {}
        packed = self._pack(scene) if beneath is None else pack_beneath(scene, beneath)
        known = self._last.get(True)
        if tell and (known is None or not is_same_ground(known[2].ground, packed.ground)):
            self.call_later(partial(self.laid.emit, number), packed)
        return {"packed": packed}

    @contextmanager
    def _doing(self, what: str) -> Iterator[None]:
        """Tell what the worker does meanwhile."""
        self._activity = Activity(what)
        try:
            yield
        finally:
            self._activity = Activity()

    def _deliver(self, answer: TracedPings) -> None:
        """Pass an answer on, unless it is a coarse picture and that of a later edit waits behind it."""
        if answer.fine or answer.number >= self._coarse:
            self.answered.emit(answer)

    def _call_back(self, receive: Callable[[Any], None], result: Any) -> None:
        if not self._closing:  # a result may still be queued when the window closes
            receive(result)


_Errand = tuple[Callable[[], Any], Callable[[Any], None]]


def _pack(scene: Scene) -> PackedScene:
    # lazy: loaded on the worker; the window opens before Numba is loaded
    from insonify.packing.packed_scene import pack

    return pack(scene)


def _prepare(scene: Scene, **how: Any) -> Simulation:
    # lazy: loaded on the worker; the window opens before Numba is loaded
    from insonify.simulation import prepare

    return prepare(scene, **how)


def _reach(simulation: Simulation) -> NDArray[np.float64] | None:
    """Count the pings that the beam covers, by range bin; None if averaging would also blur speckle or noise."""
    # lazy: loaded on the worker; the window opens before Numba is loaded
    from insonify.acoustics.resolution_cell import bin_centres, coherence_angle

    scene, arrays = simulation.scene, simulation.arrays
    if arrays.half_width <= 0.0 or not scene.receiver.steady:
        return None
    step = scene.track.speed / scene.sonar.ping_rate
    return coherence_angle(arrays) * bin_centres(arrays) / step


def _result(errand: Callable[[], Any]) -> Any:
    try:
        return errand()
    except SceneError as error:
        return error
    except Exception as error:
        refusal = SceneError(f"this cannot be shown ({type(error).__name__}: {error}); open another scene")
        refusal.__cause__ = error
        return refusal
