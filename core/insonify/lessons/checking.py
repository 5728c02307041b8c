"""Check of a lesson: its scene and fields exist, and every step can be done and is noticed when it is done."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from insonify.errors import SceneError
from insonify.lessons.lesson import Lesson, Step
from insonify.lessons.states import LessonState, start_state


def check_lesson(lesson: Lesson) -> None:
    """Check that every step of a lesson can be done, one after the other."""
    for step, start, end in states_of(lesson):
        with _named(lesson, step):
            _check_step(step, start, end)


def states_of(lesson: Lesson) -> Iterator[tuple[Step, LessonState, LessonState]]:
    """Yield every step of a lesson with the states in which it begins and ends, if each is done as it says."""
    with _named(lesson):
        end = start_state(lesson.scene, lesson.set)
    for step in lesson.steps:
        with _named(lesson, step):
            start = start_state(step.scene, step.set) if step.scene else end.moved(step.set)
            end = start.moved(step.move)
        yield step, start, end


def _check_step(step: Step, start: LessonState, end: LessonState) -> None:
    """Check that the condition of a step is false before its move and true after it."""
    condition = step.condition
    for path in step.fields:
        if start.value(path) is None and end.value(path) is None:
            raise SceneError(f"{path}: is no number, text or truth value of this scene; name one, such as sonar.range")
    if condition.holds(start.value):
        raise SceneError(f"done: {step.done!r} is true before the move; ask for a change")
    if not condition.holds(end.value):
        raise SceneError(f"done: {step.done!r} is not true after the move {step.move}; mend one of the two")


@contextmanager
def _named(lesson: Lesson, step: Step | None = None) -> Iterator[None]:
    where = f"lesson {lesson.name}" + ("" if step is None else f", step {step.title!r}")
    try:
        yield
    except SceneError as error:
        raise SceneError(f"{where}: {error}") from None
