"""Keeps the plan's panel up to date, does what is forced there, and tells what that changed."""

from __future__ import annotations

import statistics
from typing import TYPE_CHECKING

from insonify_viewer.panels.plan.comparison import Heard, difference, in_words, subject_of
from insonify_viewer.session import Session

if TYPE_CHECKING:
    from insonify.simulation import Simulation
    from insonify_viewer.record import Record
    from insonify_viewer.simulator import Answer
    from insonify_viewer.views.main_window import MainWindow

MOVED = 64  # pings that a running tow goes on before the record is heard anew


class PlanPanel:
    """Shows the plan by which the record on screen was traced.

    Parameters
    ----------
    session : Session
        Whose way to model its scene is changed.
    window : MainWindow
        Who holds the panel.
    """

    def __init__(self, session: Session, window: MainWindow) -> None:
        self._session, self._window = session, window
        self._shown: Simulation | None = None
        self._seconds: list[float] = []
        self._heard: Heard | None = None
        view = window.plan
        view.forced.connect(lambda subject, choice: session.model(session.modelling.forcing(subject, choice)))
        view.tolerated.connect(lambda share: session.model(session.modelling.tolerating(share)))
        view.left_to_plan.connect(lambda: session.model(session.modelling.automatic))

    def take(self, answer: Answer, record: Record, *, complete: bool) -> None:
        """Follow an answer at full accuracy that the record has taken over; ``complete`` if it was the last."""
        if answer.simulation is not self._shown:
            self._shown, self._seconds = answer.simulation, []
            self._window.plan.show_plan(answer.simulation.plan, self._session.modelling)
            self._window.plan.show_change("", "")
        self._seconds.append(answer.seconds / len(answer.pings))
        if complete and self._is_new(record):
            self._compare(record)

    def show_again(self) -> None:
        """Let the panel fall back to what holds."""
        if self._shown is not None:
            self._window.plan.show_plan(self._shown.plan, self._session.modelling)

    def _is_new(self, record: Record) -> bool:
        """Whether the record is of something else than the one last heard, or has left it behind."""
        last, session = self._heard, self._session
        same = last is not None and (last.scene, last.modelling) == (session.scene, session.modelling)
        return not same or last is None or abs(int(record.ping.max()) - int(last.ping.max())) >= MOVED

    def _compare(self, record: Record) -> None:
        """Tell what another way to model the same scene changed."""
        before = self._heard
        # The median leaves out the block during which a kernel was compiled.
        seconds = statistics.median(self._seconds)
        self._window.plan.show_measured(seconds)
        after = self._heard = Heard.of(record, self._session.scene, self._session.modelling, seconds)
        if before is None or before.scene != after.scene or before.modelling == after.modelling:
            return
        words = in_words(difference(before, after), after.seconds / before.seconds)
        subject = subject_of(before.modelling, after.modelling)
        self._window.plan.show_change(subject, words)
        choice = dict(after.modelling.forced).get(subject, "automatic") if subject else ""
        self._window.say(f"{subject} {choice}: {words}" if subject else words)
