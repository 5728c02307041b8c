"""A lesson under way: its steps, what was done, and the answers."""

from datetime import datetime
from typing import NamedTuple

from insonify.errors import SceneError
from insonify.lessons.lesson import Lesson, Step
from insonify.lessons.questions import Verdict, judge
from insonify.lessons.states import LessonState, states_of
from insonify.lessons.wording import fill_in
from insonify.lessons.worksheet import Answer, Worksheet


class Given(NamedTuple):
    """An answer of a student, before it is judged."""

    text: str
    number: float | None  # a number, or the place of a choice
    # States before and after the move of the step, if the move was still to come.
    prediction: tuple[LessonState, LessonState] | None


class Progress:
    """A lesson under way."""

    def __init__(self, lesson: Lesson) -> None:
        began = datetime.now()
        self.lesson, self.index = fill_in(lesson, began.isoformat()), 0
        self._states = tuple(states_of(self.lesson))
        self._done: set[int] = set()
        self._given: dict[int, Given] = {}
        self.worksheet = Worksheet(self.lesson, began)

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

    @property
    def given(self) -> Given | None:
        """The answer to the question of the present step."""
        return self._given.get(self.index)

    def answer(self, text: str, number: float | None, state: LessonState) -> None:
        """Keep an answer; one given before the move is judged on the student's scene with the move of the step."""
        prediction = None
        if not self.done:
            try:
                prediction = state, state.moved(self.step.move)
            except SceneError:  # her other edits do not allow the move, so her own move is judged
                prediction = None
        self._given[self.index] = Given(text, number, prediction)

    @property
    def explained(self) -> bool:
        """Whether the present step may show what to look for: it was done, and its question answered."""
        return self.done and self.given is not None

    def verdict(self, state: LessonState) -> Verdict | None:
        """Judge the answer to the present step, and write it into the worksheet; None without one."""
        given, ask = self.given, self.step.ask
        if given is None or ask is None:
            return None
        before, after = given.prediction or (self.start, state)
        verdict = judge(ask, given.number, after.reader(before))
        if verdict is not None:
            settings = tuple((path, value) for path in self.step.fields if (value := state.value(path)) is not None)
            self.worksheet.answers[self.index] = Answer(given.text, verdict, settings)
        return verdict

    def go_to(self, index: int) -> None:
        """Go to a step, which is to be done anew, with those that follow it."""
        self.index = index
        self._done = {number for number in self._done if number < index}
