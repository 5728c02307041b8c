"""A lesson under way: its step, and whether that was done; without widgets."""

from __future__ import annotations

from insonify.lessons import Lesson, LessonState, Step, states_of


class Course:
    """A lesson under way."""

    def __init__(self, lesson: Lesson) -> None:
        self.lesson, self.index = lesson, 0
        self._states = tuple(states_of(lesson))
        self._done: set[int] = set()

    @property
    def step(self) -> Step:
        """The present step."""
        return self.lesson.steps[self.index]

    @property
    def start(self) -> LessonState:
        """The state in which the present step begins."""
        return self._states[self.index][1]

    @property
    def base(self) -> str:
        """Name of the bundled scene that the present step is about."""
        own = [step.scene for step in self.lesson.steps[: self.index + 1] if step.scene]
        return own[-1] if own else self.lesson.scene

    @property
    def done(self) -> bool:
        """Whether the present step was done."""
        return self.index in self._done

    @property
    def last(self) -> bool:
        """Whether the present step is the last."""
        return self.index + 1 == len(self.lesson.steps)

    @property
    def finished(self) -> bool:
        """Whether every step was done."""
        return len(self._done) == len(self.lesson.steps)

    def notice(self, state: LessonState) -> bool:
        """Note the present step as done if its condition holds; return whether it does for the first time."""
        if self.done or not self.step.condition.holds(state.value):
            return False
        self._done.add(self.index)
        return True

    def go_to(self, index: int) -> None:
        """Go to a step, which is to be done anew, with those that follow it."""
        self.index = index
        self._done = {number for number in self._done if number < index}
