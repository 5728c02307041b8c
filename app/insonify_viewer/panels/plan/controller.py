"""Shows the plan of the record on screen, forces its choices, and measures what that changes."""

import statistics
from typing import NamedTuple

from insonify_viewer.core_types import Plan
from insonify_viewer.panels.panel import Panel, Place, Workbench
from insonify_viewer.panels.plan.view import PlanView
from insonify_viewer.record.comparison.record_difference import RecordDifference, RecordSnapshot, compare_records
from insonify_viewer.record.record import Record, RecordGrowth
from insonify_viewer.state.history import Modelling

MOVED = 64  # pings by which a running tow moves on before the record is copied again


class PlanPanel(Panel):
    """Shows the plan by which the record on screen was traced."""

    name = "plan"
    title = "Plan"
    place = Place.SIDE
    rank = 20

    def __init__(self, workbench: Workbench) -> None:
        self._session, self._say = workbench.session, workbench.say
        self._plan: Plan | None = None
        self._seconds: list[float] = []
        self._snapshot: ModelledRecord | None = None
        self.view = view = PlanView()
        session = workbench.session
        view.forced.connect(lambda subject, choice: session.model(session.modelling.forcing(subject, choice)))
        view.tolerated.connect(lambda share: session.model(session.modelling.tolerating(share)))
        view.automatic.clicked.connect(lambda: session.model(session.modelling.automatic))
        view.chart.clicked.connect(lambda: workbench.open_panel("chart"))

    def plan_made(self, plan: Plan) -> None:
        """Show another plan."""
        self._plan, self._seconds = plan, []
        self.view.show_plan(plan, self._session.modelling)
        self.view.show_change("", "")

    def fields_lit(self, paths: tuple[str, ...]) -> None:
        """Light the tolerance, or choices of the plan."""
        self.view.light({path.removeprefix("plan.") for path in paths if path.startswith("plan.")})

    def scene_refused(self) -> None:
        """Show the plan that is still valid."""
        if self._plan is not None:
            self.view.show_plan(self._plan, self._session.modelling)

    def record_grown(self, growth: RecordGrowth) -> None:
        """Time the pings; compare the record once all of it is traced by the plan."""
        if growth.current:
            self._seconds.append(growth.answer.seconds / len(growth.answer.pings))
            if growth.complete and self._is_new(growth.record):
                self._compare(growth.record)

    def _is_new(self, record: Record) -> bool:
        """Whether the record shows another scene, another modelling or other pings than the snapshot."""
        last, session = self._snapshot, self._session
        same = last is not None and (last.record.scene, last.modelling) == (session.scene, session.modelling)
        return not same or last is None or abs(int(record.ping.max()) - int(last.record.ping.max())) >= MOVED

    def _compare(self, record: Record) -> None:
        """State what another modelling of the same scene changes."""
        before = self._snapshot
        # The median leaves out the block during which a kernel was compiled.
        seconds = statistics.median(self._seconds)
        self.view.show_measured(seconds)
        session = self._session
        copied = RecordSnapshot.of(record, session.scene)
        after = self._snapshot = ModelledRecord(copied, session.modelling, seconds)
        if before is None or before.record.scene != copied.scene or before.modelling == after.modelling:
            return
        words = difference_in_words(compare_records(before.record, copied), after.seconds / before.seconds)
        subject = changed_subject(before.modelling, after.modelling)
        self.view.show_change(subject, words)
        choice = dict(after.modelling.forced).get(subject, "automatic") if subject else ""
        self._say(f"{subject} {choice}: {words}" if subject else words)


class ModelledRecord(NamedTuple):
    """Copy of a record under one modelling."""

    record: RecordSnapshot  # the copy
    modelling: Modelling  # the modelling
    seconds: float  # time to trace a ping


def changed_subject(before: Modelling, after: Modelling) -> str:
    """Subject by which two modellings differ; empty if there are several, or none."""
    subjects = {subject for subject, _ in {*before.forced} ^ {*after.forced}}
    return subjects.pop() if len(subjects) == 1 and before.tolerance == after.tolerance else ""


def difference_in_words(difference: RecordDifference | None, times: float) -> str:
    """Write a difference and a ratio of times: "changes the record by 0.4 %, takes 1.8 × the time"."""
    record = "" if difference is None else f"{difference.in_words()}, "
    return f"{record}takes {times:.2g} × the time"
