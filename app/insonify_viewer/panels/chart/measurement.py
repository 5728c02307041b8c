"""Measures a chart on a thread of its own, for a minute or so, unless it is stopped."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, Signal

from insonify.scene import Scene, SceneError
from insonify_viewer.panels.chart.chart_details import picture

if TYPE_CHECKING:
    from insonify.accuracy.charts.kinds.accuracy import AccuracyChart

Progress = Callable[[float], None]


class _StoppedError(Exception):
    """The person has had enough."""


class Measurement(QObject):
    """One chart being measured.

    Parameters
    ----------
    scene : Scene
        Of what.
    measure : callable, optional
        Makes the chart of (scene, progress); the core's, unless a test stands in for it.
    parent : QObject, optional
        Owner.
    """

    progressed = Signal(float)  # share done
    drawn = Signal(object)  # Pictured
    failed = Signal(str)  # one sentence, empty if it was stopped

    def __init__(
        self,
        scene: Scene,
        measure: Callable[[Scene, Progress], AccuracyChart] | None = None,
        parent: QObject | None = None,
    ) -> None:
        super().__init__(parent)
        self._scene, self._measure = scene, measure or _measured
        self._stopping = False
        self._thread = threading.Thread(target=self._work, name="insonify chart", daemon=True)

    def start(self) -> None:
        """Begin; whoever listens has to be connected by now."""
        self._thread.start()

    def stop(self) -> None:
        """Stop at the next report of progress."""
        self._stopping = True

    def close(self) -> None:
        """Stop, and wait for it."""
        self.stop()
        self._thread.join()

    def _work(self) -> None:
        try:
            self.drawn.emit(picture(self._measure(self._scene, self._report)))
        except _StoppedError:
            self.failed.emit("")
        except SceneError as error:
            self.failed.emit(str(error))
        except Exception as error:  # a thread that dies would leave the window waiting without a word
            self.failed.emit(f"this scene cannot be charted ({type(error).__name__}: {error})")

    def _report(self, share: float) -> None:
        if self._stopping:
            raise _StoppedError
        self.progressed.emit(share)


def _measured(scene: Scene, progress: Progress) -> AccuracyChart:
    # lazy: the window is there before Numba and Matplotlib are
    from insonify.accuracy.charts.kinds.accuracy import measure_chart

    return measure_chart(scene, progress=progress)
