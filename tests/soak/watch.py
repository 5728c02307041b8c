"""What goes wrong in a window, and what it takes: faults, gaps of the main thread, memory."""

import faulthandler
import re
import sys
import tempfile
import threading
import time
import traceback
import warnings
from array import array
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any, TextIO

import numpy as np
import psutil
from numpy.typing import NDArray
from PySide6.QtCore import QObject, Qt, QTimer, qInstallMessageHandler
from PySide6.QtGui import QOpenGLContext
from PySide6.QtWidgets import QApplication
from vtkmodules.vtkCommonCore import vtkOutputWindow, vtkStringOutputWindow

from insonify.errors import FileWarning, PlanWarning, SceneError

TICK = 5  # ms
DEPTH = 7  # functions of a stack that are told
LIMIT = 250.0  # ms, above which gaps are counted
FROZEN = 5.0  # s beside waiting for a processor: a drawing that is a fault however slow the graphics are
LONG = 0.15  # s, a gap whose cause is looked for
SCHEDULED = Path("/proc/thread-self/schedstat")  # nanoseconds that a thread ran and waited to run
HARMLESS = ("This plugin does not support propagateSizeHints", "QXcbConnection: XCB error")


class Faults:
    """Gathers exceptions and warnings of every thread, and messages of Qt and VTK, those of OpenGL among them."""

    def __init__(self) -> None:
        self.found: Counter[str] = Counter()
        self.doing = "starting"
        self._vtk = vtkStringOutputWindow()
        sys.excepthook = lambda _, error, __: self._take(error)
        sys.unraisablehook = lambda hook: self._take(hook.exc_value)
        threading.excepthook = lambda hook: self._take(hook.exc_value)
        warnings.showwarning = self._take_warning
        qInstallMessageHandler(self._take_message)

    def add(self, told: str) -> None:
        """Note a fault during the present action."""
        fault = f"while: {self.doing}\n{told}"
        if fault not in self.found:  # told at once, in case the process does not live to tell it
            say(f"--- {fault}")
        self.found[fault] += 1

    def watch_drawing(self, renderer: Any) -> None:
        """Look for an error of OpenGL after each drawing, and gather what VTK says."""
        vtkOutputWindow.SetInstance(self._vtk)  # in place of PyVista's
        renderer.AddObserver("EndEvent", self._look)

    def close(self) -> None:
        """Add what VTK has said."""
        qInstallMessageHandler(None)
        sys.excepthook, sys.unraisablehook = sys.__excepthook__, sys.__unraisablehook__
        if told := self._vtk.GetOutput():
            self.add(f"VTK: {told[:4000]}")

    def _look(self, *_: Any) -> None:
        context = QOpenGLContext.currentContext()
        if context is not None and (error := context.functions().glGetError()):
            self.add(f"OpenGL error {error:#x}")

    def _take(self, error: BaseException | None) -> None:
        if not isinstance(error, SceneError):  # of a file that was damaged while the window shows it: told as it is
            self.add("".join(traceback.format_exception(error)) if error else "an exception without a value")

    def _take_warning(self, warning: Warning | str, category: type[Warning], *_: Any) -> None:
        if not issubclass(category, (FileWarning, PlanWarning)):
            self.add(f"{warning!r}\n{''.join(traceback.format_stack()[:-1])}")

    def _take_message(self, kind: Any, _: Any, message: str) -> None:
        if not message.startswith(HARMLESS):
            self.add(f"Qt {kind.name}: {message}")


class Gaps(QObject):
    """Time between turns of the main loop without the 3-D drawing, and where the long ones come from."""

    def __init__(self, tick: int = TICK) -> None:
        super().__init__()
        self.clear()
        self._last, self._ending = _now(), threading.Event()
        self._begun, self._drawn = self._last, np.zeros(3)
        self._seen = ""
        self._timer = QTimer(self)
        self._timer.setTimerType(Qt.TimerType.PreciseTimer)
        self._timer.timeout.connect(self._turn)
        self._timer.start(tick)
        self._sampler = threading.Thread(target=self._sample, name="sampler", daemon=True)
        self._sampler.start()

    def leave_out_drawing(self, renderer: Any, faults: Faults) -> None:
        """Do not count the time between the start and the end of a drawing, unless it freezes the window."""
        renderer.AddObserver("StartEvent", self.begin_drawing)
        renderer.AddObserver("EndEvent", lambda *_: self._drew(faults))

    def begin_drawing(self, *_: Any) -> None:
        """Leave out what follows, up to the end of the drawing."""
        self._begun = _now()

    def end_drawing(self, *_: Any) -> NDArray[np.float64]:
        """Return the seconds of the drawing, which are left out: by the clock, of processor time and waiting for it."""
        drawn = _now() - self._begun
        self._drawn += drawn
        return drawn

    def close(self) -> None:
        """End the gaps and the sampling thread."""
        self._timer.stop()
        self._ending.set()
        self._sampler.join()

    def in_words(self) -> str:
        """The gaps as one sentence."""
        found, busy = 1e3 * np.array(self.gaps), 1e3 * np.array(self.busy)
        return f"gaps {_spread(found)}; of processor time {_spread(busy)}"

    def _drew(self, faults: Faults) -> None:
        drawn = self.end_drawing()
        if drawn[0] - drawn[2] > FROZEN:
            faults.add("a drawing of {:.0f} s, {:.0f} of processor time, {:.0f} waiting for it".format(*drawn))

    def _turn(self) -> None:
        gap, busy, _ = np.maximum(_now() - self._last - self._drawn, 0.0)
        self.gaps.append(gap)
        self.busy.append(busy)
        if gap > LONG:
            told = f"{1e3 * gap:5.0f} ms, {1e3 * busy:4.0f} of processor time: {self._seen or 'not in Python'}"
            self.causes[told] += 1
        self._last, self._drawn, self._seen = _now(), np.zeros(3), ""

    def clear(self) -> None:
        """Forget all gaps so far."""
        # Seconds of each turn by the clock, and of processor time: a million an hour, as objects as large as a leak.
        self.gaps, self.busy = array("d"), array("d")
        self.causes: Counter[str] = Counter()

    def _sample(self) -> None:
        """Note where the threads are while a gap lasts: the main thread, and those that may hold the interpreter."""
        own = threading.get_ident()
        with tempfile.TemporaryFile("w+") as file:
            while not self._ending.wait(0.02):
                if time.perf_counter() - self._last[0] > 0.6 * LONG:
                    names = {thread.ident: thread.name for thread in threading.enumerate()}
                    found = [(names.get(ident, "?"), place) for ident, place in _places(file) if ident != own]
                    # Threads that wait for work are left out.
                    busy = [each for each in found if "wait_for" not in each[1] and not each[1].startswith("thread.py")]
                    self._seen = "; ".join(f"{name}: {place}" for name, place in reversed(busy))


def _now() -> NDArray[np.float64]:
    """Time of day, of the processor in this thread, and of waiting for one, in s: on a busy machine they part."""
    waited = 1e-9 * int(SCHEDULED.read_text().split()[1]) if SCHEDULED.exists() else 0.0
    return np.array([time.perf_counter(), time.thread_time(), waited])


def _spread(found: NDArray[np.float64]) -> str:
    """Describe times in milliseconds."""
    over = np.sum(found > LIMIT)
    return f"p99 {np.quantile(found, 0.99):.1f}, greatest {found.max():.0f} ms, {over} over {LIMIT:g} ms"


def _places(file: TextIO) -> Iterator[tuple[int, str]]:
    """Every thread by its number, and the innermost functions of its stack, in words.

    The stacks are written by C. A frame as an object would outlive its function, and with it a painter among its
    variables, which this thread would then end instead of the main one.
    """
    file.seek(0)
    file.truncate()
    faulthandler.dump_traceback(file)
    file.seek(0)
    for told in re.split(r"^(?:Current t|T)hread ", file.read(), flags=re.MULTILINE)[1:]:
        calls = re.findall(r'^  File "(.*)", line (\d+) in (.*)$', told, flags=re.MULTILINE)[:DEPTH]
        yield int(told.split()[0], 16), " < ".join(f"{Path(path).name}:{line} {name}" for path, line, name in calls)


def say(line: str) -> None:
    sys.stdout.write(f"{line}\n")
    sys.stdout.flush()


def resident() -> float:
    """Resident memory of this process, in megabytes."""
    return psutil.Process().memory_info().rss / 1e6


def holdings() -> str:
    """Memory, widgets, threads and blocks of Python's own memory at this moment, in words."""
    widgets, threads, blocks = len(QApplication.allWidgets()), threading.active_count(), sys.getallocatedblocks()
    return f"{resident():5.0f} MB, {widgets} widgets, {threads} threads, {blocks} blocks"


def left_threads(patience: float) -> list[str]:
    """Stacks of the viewer's threads that have not ended within a time in seconds."""
    deadline = time.monotonic() + patience
    left: list[threading.Thread] = []
    while time.monotonic() < deadline:
        left = [thread for thread in threading.enumerate() if thread.name.startswith("insonify")]
        if not left:
            return []
        time.sleep(0.05)
    frames = sys._current_frames()
    return [f"{thread.name}:\n{''.join(traceback.format_stack(frames[thread.ident]))}" for thread in left]
