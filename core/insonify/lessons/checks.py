"""Check that every step of a lesson can be done, and that simulated records agree with its questions."""

from __future__ import annotations

from itertools import combinations
from typing import Any

from insonify.arrays import Dataset
from insonify.errors import SceneError
from insonify.lessons.conditions import Reader, parse_condition, parse_expression
from insonify.lessons.courses import OTHER, load_courses
from insonify.lessons.lesson import Lesson, Step
from insonify.lessons.quantities import QUANTITIES
from insonify.lessons.questions import Ask
from insonify.lessons.states import AUTOMATIC, USUAL_TOLERANCE, LessonState, named, states_of
from insonify.lessons.wording import fill_in


def check_lesson(lesson: Lesson) -> None:
    """Check that every step of a lesson can be done, one after the other, and its questions answered."""
    topics = {course.name: course.topics for course in (*load_courses(), OTHER)}
    lesson = fill_in(lesson)
    with named(lesson):
        if lesson.course not in topics:
            known = ", ".join(filter(None, topics))
            raise SceneError(f"course: {lesson.course!r} does not exist; choose one of {known}")
    for step, start, end in states_of(lesson):
        with named(lesson, step):
            if step.topic not in ("", *topics[lesson.course]):
                known = ", ".join(topics[lesson.course])
                raise SceneError(f"topic: {step.topic!r} is not of the course {lesson.course!r}; choose one of {known}")
            _check_step(step, start, end)
            if step.ask is not None and step.ask.value:
                _check_number(step.ask, end.reader(start))


def check_records(lesson: Lesson) -> int:
    """Check questions of a lesson against simulated records; return how many were compared."""
    checked, lesson = 0, fill_in(lesson)
    records: dict[Any, Dataset] = {}
    for step, start, end in states_of(lesson):
        with named(lesson, step):
            if step.ask is not None:
                checked += _check_record(step.ask, _Simulated(start, records), _Simulated(end, records))
    return checked


def _check_step(step: Step, start: LessonState, end: LessonState) -> None:
    """Check that the condition of a step is false before its move and true after it."""
    condition = step.condition
    for path in step.fields:
        if start.value(path) is None and end.value(path) is None:
            raise SceneError(
                f"{path}: is not a number, text or truth value of this scene; name one, such as sonar.range"
            )
    if condition.holds(start.value):
        raise SceneError(f"done: {step.done!r} is true before the move; ask for a change")
    if not condition.holds(end.value):
        raise SceneError(f"done: {step.done!r} is not true after the move {step.move}; correct one of them")


def _check_number(ask: Ask, reader: Reader) -> None:
    """Check that the number has a value, and that no mistake passes for it or for another mistake."""
    values = [(text, _number(text, reader)) for text in (ask.value, *(each.value for each in ask.mistakes))]
    for (one, a), (other, b) in combinations(values, 2):
        if abs(a - b) <= ask.tolerance * (abs(a) + abs(b)):
            raise SceneError(
                f"ask: {one} = {a:.4g} and {other} = {b:.4g} agree within the tolerance of {100 * ask.tolerance:g} %; "
                "lower it or leave one out"
            )


def _number(text: str, reader: Reader) -> float:
    value = parse_expression(text).number(reader)
    if value is None or value == 0.0:
        raise SceneError(f"ask: {text} is {'0' if value == 0.0 else 'not a number'} in this scene; ask for another")
    return value


class _Simulated:
    """A state whose quantities are measured in its simulated record where they can be."""

    def __init__(self, state: LessonState, records: dict[Any, Dataset]) -> None:
        self.state, self._records = state, records
        self.measured = False  # whether any was

    def reader(self, before: _Simulated | None = None) -> Reader:
        """Return what questions read."""
        return Reader(self.state.value, self._quantity, None if before is None else before.reader())

    def _quantity(self, name: str, arguments: tuple[float, ...]) -> float | None:
        measure = QUANTITIES[name].measure
        if measure is None:
            return self.state.quantity(name, arguments)
        self.measured = True
        key = self.state.scene, *sorted(self.state.window.items())  # a step often begins where the last one ended
        if key not in self._records:
            self._records[key] = _simulate(self.state)
        return measure(self.state.scene, self._records[key], *arguments)


def _simulate(state: LessonState) -> Dataset:
    """Simulate the scene of a state with the choices of its plan."""
    # lazy: loads Numba
    from insonify.simulation import simulate

    plan: dict[str, Any] = {path[5:]: value for path, value in state.window.items() if path.startswith("plan.")}
    tolerance = plan.pop("tolerance", USUAL_TOLERANCE)
    forced = {subject: choice for subject, choice in plan.items() if choice != AUTOMATIC}
    return simulate(state.scene, tolerance=tolerance, forced=forced)


def _check_record(ask: Ask, before: _Simulated, after: _Simulated) -> bool:
    """Check one question against the records before and after its move; return whether a record was measured."""
    reader = after.reader(before)
    for text in filter(None, (ask.value, ask.value and ask.measured)):
        expected = parse_expression(ask.value).number(after.state.reader(before.state))
        found = parse_expression(text).number(reader)
        if expected is None or found is None or abs(found - expected) > ask.tolerance * abs(expected):
            shown = _shown(found) if text == ask.value else f"{text} is {_shown(found)}"
            raise SceneError(
                f"ask: {ask.value} is {_shown(expected)}, but {shown} in the simulated record; correct the "
                "expression or widen the tolerance"
            )
    if ask.holds and not parse_condition(ask.holds).holds(reader):
        raise SceneError(f"ask: {ask.holds!r} does not hold in the simulated record; correct it or the right answer")
    return before.measured or after.measured


def _shown(value: float | None) -> str:
    return "nothing" if value is None else f"{value:.4g}"
