"""Uses the window at random: ``python -m soak MINUTES SEED``, with ``tests`` on the path and a screen."""

import os
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np
from PySide6.QtCore import QSettings, QTimer

from insonify.compiler.processes import compiled_elsewhere
from insonify.scene import load_scene
from insonify_viewer.application import has_opengl, main_thread_collection, make_application
from insonify_viewer.viewer import Viewer
from soak.actions import Steps, draw_actions
from soak.dialogs import Answers
from soak.watch import Faults, Gaps, holdings, left_threads, resident, say

MINUTE = 60.0  # s, between two lines of what is held
PATIENCE = 120.0  # s, for the worker to end after the window has closed
SETTLED, LAST = 5, 5  # minutes until memory has settled, and those at the end over which its median is taken
GROWTH = 150.0  # MB, that the window may hold more at the end than when it had settled


class Person:
    """Acts on the window until the time is over, then closes it."""

    def __init__(self, viewer: Viewer, seconds: float, seed: int, faults: Faults, gaps: Gaps) -> None:
        self._viewer, self._seconds, self._faults, self._gaps = viewer, seconds, faults, gaps
        self._random = np.random.default_rng(seed)
        self._drawn = draw_actions(self._random)
        self._steps: Steps = iter(())
        self._begun = 0.0
        self._held: list[float] = []  # MB, after each minute
        self.actions, self.closing = 0, 0.0
        self._timer = QTimer(singleShot=True)
        self._timer.timeout.connect(self._act)
        self._timer.start(100)

    def _act(self) -> None:
        if not self._begun and not self._start():
            return
        used = time.monotonic() - self._begun
        while used >= MINUTE * (len(self._held) + 1):
            self._held.append(resident())
            say(f"{len(self._held):3} min: {holdings()}, {self.actions} actions; {self._gaps.in_words()}")
        if used >= self._seconds:
            self._close()
            return
        self._timer.start(int(self._next_step()))

    @property
    def growth(self) -> float:
        """Megabytes by which the window has grown since it had settled; 0 before twice that time."""
        if len(self._held) < SETTLED + LAST:
            return 0.0
        return float(np.median(self._held[-LAST:])) - self._held[SETTLED - 1]

    def _start(self) -> bool:
        """Wait for the first picture, unless the window says that there will be none."""
        if self._viewer.failure:
            self._faults.add(self._viewer.failure)
            self._close()
            return False
        if not self._viewer.complete:
            self._timer.start(100)
            return False
        renderer = self._viewer.seabed.view.canvas.plotter.renderer
        self._gaps.leave_out_drawing(renderer, self._faults)
        self._faults.watch_drawing(renderer)
        self._gaps.clear()
        self._begun = time.monotonic()
        say(f"  0 min: {holdings()}")
        return True

    def _next_step(self) -> float:
        """Take a step of the action under way, or begin another; return the milliseconds to wait after it."""
        try:
            return next(self._steps)
        except StopIteration:
            do = next(self._drawn)
            self.actions += 1
            self._faults.doing = f"{do.__name__} in {self._viewer.session.scene.title!r}, action {self.actions}"
            self._steps = do(self._viewer, self._random)
        except Exception:
            self._steps = iter(())
            sys.excepthook(*sys.exc_info())
        return 5.0

    def _close(self) -> None:
        self._faults.doing = "closing"
        begun = time.perf_counter()
        self._viewer.window.close()
        self.closing = time.perf_counter() - begun


def soak(seconds: float, seed: int) -> int:
    """Use the window for a time; print figures, and return the number of kinds of faults."""
    with tempfile.TemporaryDirectory() as folder:
        # Settings and states of windows are the person's own elsewhere.
        QSettings.setPath(QSettings.Format.IniFormat, QSettings.Scope.UserScope, folder)
        os.environ["XDG_STATE_HOME"] = folder
        application: Any = make_application()
        faults, gaps = Faults(), Gaps()
        with main_thread_collection(), compiled_elsewhere():
            Answers(np.random.default_rng([seed, 1]), Path(folder))
            viewer = Viewer(load_scene("default"), accelerated=has_opengl())
            viewer.window.show()
            QTimer.singleShot(0, viewer.start)
            person = Person(viewer, seconds, seed, faults, gaps)
            application.exec()
            say(
                f"seed {seed}: {person.actions} actions, {gaps.in_words()}; grown by {person.growth:.0f} MB, "
                f"closed in {person.closing:.2f} s"
            )
            if person.growth > GROWTH:
                faults.add(f"the window has grown by more than {GROWTH:g} MB")
            gaps.close()
        for stack in left_threads(PATIENCE):
            faults.add(f"a thread is left: {stack}")
        faults.close()
        for cause, _ in sorted(gaps.causes.items(), reverse=True)[:25]:
            say(f"  {cause}")
        for told, count in faults.found.items():
            say(f"{count} × {told.splitlines()[0]}")
        return len(faults.found)


if __name__ == "__main__":
    sys.exit(soak(60.0 * float(sys.argv[1]), int(sys.argv[2])) > 0)
