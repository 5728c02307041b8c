"""What goes wrong in a window, and what it takes: faults, gaps of the main thread, memory."""

from __future__ import annotations

import gc
import os
import sys
import threading
import time
import traceback
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
from PySide6.QtCore import QObject, Qt, QTimer, qInstallMessageHandler
from PySide6.QtGui import QOpenGLContext
from PySide6.QtWidgets import QApplication
from vtkmodules.vtkCommonCore import vtkOutputWindow, vtkStringOutputWindow

TICK = 5  # ms
LIMIT = 250.0  # ms, above which gaps are counted
LONG = 0.15  # s, a gap whose cause is looked for
HARMLESS = ("This plugin does not support propagateSizeHints", "QXcbConnection: XCB error")


class Faults:
    """Gathers exceptions of every thread and messages of Qt and VTK, those of OpenGL among them."""

    def __init__(self) -> None:
        self.found: Counter[str] = Counter()
        self.doing = "starting"
        self._vtk = vtkStringOutputWindow()
        vtkOutputWindow.SetInstance(self._vtk)
        sys.excepthook = lambda _, error, __: self._take(error)
        sys.unraisablehook = lambda hook: self._take(hook.exc_value)
        threading.excepthook = lambda hook: self._take(hook.exc_value)
        qInstallMessageHandler(self._take_message)

    def add(self, told: str) -> None:
        """Note a fault during the present action."""
        self.found[f"while: {self.doing}\n{told}"] += 1

    def watch_drawing(self, renderer: Any) -> None:
        """Look for an error of OpenGL after each drawing."""
        renderer.AddObserver("EndEvent", self._look)

    def close(self) -> None:
        """Add what VTK has said."""
        qInstallMessageHandler(None)
        assert vtkOutputWindow.GetInstance() is self._vtk
        if told := self._vtk.GetOutput():
            self.add(f"VTK: {told[:4000]}")

    def _look(self, *_: Any) -> None:
        context = QOpenGLContext.currentContext()
        if context is not None and (error := context.functions().glGetError()):
            self.add(f"OpenGL error {error:#x}")

    def _take(self, error: BaseException | None) -> None:
        self.add("".join(traceback.format_exception(error)) if error else "an exception without a value")

    def _take_message(self, kind: Any, _: Any, message: str) -> None:
        if not message.startswith(HARMLESS):
            self.add(f"Qt {kind.name}: {message}")


class Gaps(QObject):
    """Time between turns of the main loop without the 3-D drawing, and where the long ones come from."""

    def __init__(self) -> None:
        super().__init__()
        self.gaps: list[float] = []
        self.causes: Counter[str] = Counter()
        self._last, self._drawing, self._drawn = time.perf_counter(), 0.0, 0.0
        self._main, self._ending = threading.main_thread().ident, threading.Event()
        self._seen = ""
        timer = QTimer(self)
        timer.setTimerType(Qt.TimerType.PreciseTimer)
        timer.timeout.connect(self._turn)
        timer.start(TICK)
        self._sampler = threading.Thread(target=self._sample, name="sampler", daemon=True)
        self._sampler.start()

    def leave_out_drawing(self, renderer: Any) -> None:
        """Do not count the time between the start and the end of a drawing."""
        renderer.AddObserver("StartEvent", lambda *_: setattr(self, "_drawing", time.perf_counter()))
        renderer.AddObserver("EndEvent", self._drew)

    def close(self) -> None:
        """End the sampling thread."""
        self._ending.set()
        self._sampler.join()

    def in_words(self) -> str:
        """The gaps as one sentence."""
        found = 1e3 * np.array(self.gaps)
        usual, late, over = np.median(found), np.quantile(found, 0.99), np.sum(found > LIMIT)
        return f"gaps p50 {usual:.1f}, p99 {late:.1f}, greatest {found.max():.0f} ms; {over} over {LIMIT:g} ms"

    def _drew(self, *_: Any) -> None:
        self._drawn += time.perf_counter() - self._drawing

    def _turn(self) -> None:
        now = time.perf_counter()
        gap = max(now - self._last - self._drawn, 0.0)
        self.gaps.append(gap)
        if gap > LONG:
            self.causes[f"{1e3 * gap:5.0f} ms: {self._seen or 'not in Python'}"] += 1
        self._last, self._drawn, self._seen = time.perf_counter(), 0.0, ""

    def _sample(self) -> None:
        while not self._ending.wait(0.02):
            if time.perf_counter() - self._last > 0.6 * LONG:
                frames = traceback.extract_stack(sys._current_frames()[self._main])
                ours = [f"{Path(frame.filename).name}:{frame.lineno} {frame.name}" for frame in frames]
                self._seen = " < ".join(ours[:-6:-1])


def resident() -> float:
    """Resident memory of this process, in megabytes."""
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / 1e6


def holdings() -> str:
    """Memory, widgets, threads and objects at this moment, in words."""
    widgets, threads, objects = len(QApplication.allWidgets()), threading.active_count(), len(gc.get_objects())
    return f"{resident():5.0f} MB, {widgets} widgets, {threads} threads, {objects} objects"


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
