"""Measurement of one chart on a thread of its own, for a minute or so, unless it is stopped."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from insonify.scene import Scene, SceneError
from insonify_viewer.panels.chart.chart_details import ChartPicture, draw_chart

if TYPE_CHECKING:
    from insonify.accuracy.charts.kinds.accuracy import AccuracyChart

Progress = Callable[[float], None]


class _StoppedError(Exception):
    """The measurement was stopped."""


class Measurement:
    """A chart being measured.

    Parameters
    ----------
    scene : Scene
        Scene to measure.
    call_later : callable
        Calls (receive, result) on the main thread.
    progressed : callable
        Receives the share done.
    drawn : callable
        Receives the `ChartPicture`.
    failed : callable
        Receives one sentence, empty if the measurement was stopped.
    measure : callable, optional
        Makes the chart of (scene, progress); the core's unless a test replaces it.
    """

    def __init__(
        self,
        scene: Scene,
        call_later: Callable[[Callable[[Any], None], Any], None],
        *,
        progressed: Progress,
        drawn: Callable[[ChartPicture], None],
        failed: Callable[[str], None],
        measure: Callable[[Scene, Progress], AccuracyChart] | None = None,
    ) -> None:
        self._scene, self._measure = scene, measure or _measured
        self._call_later, self._progressed, self._drawn, self._failed = call_later, progressed, drawn, failed
        self._stopping = False
        self._thread = threading.Thread(target=self._work, name="insonify chart", daemon=True)

    def start(self) -> None:
        """Start the thread."""
        self._thread.start()

    def stop(self) -> None:
        """Stop at the next report of progress."""
        self._stopping = True

    def close(self) -> None:
        """Stop, and wait for the thread."""
        self.stop()
        self._thread.join()

    def _work(self) -> None:
        try:
            self._call_later(self._drawn, draw_chart(self._measure(self._scene, self._report)))
        except _StoppedError:
            self._call_later(self._failed, "")
        except SceneError as error:
            self._call_later(self._failed, str(error))
        except Exception as error:  # an exception that ends the thread would leave the window waiting
            self._call_later(self._failed, f"this scene cannot be charted ({type(error).__name__}: {error})")

    def _report(self, share: float) -> None:
        if self._stopping:
            raise _StoppedError
        self._call_later(self._progressed, share)


def _measured(scene: Scene, progress: Progress) -> AccuracyChart:
    # lazy: the window opens before Numba and Matplotlib are loaded
    from insonify.accuracy.charts.kinds.accuracy import measure_chart

    return measure_chart(scene, progress=progress)
