"""A lesson and its steps."""

from __future__ import annotations

from typing import Any

from pydantic import Field

from insonify.lessons.conditions import Condition, parse_condition
from insonify.scene.base import Declaration


class LessonHead(Declaration):
    """Front matter of a lesson: its title, the scene that it starts from, and its place in the list."""

    title: str = Field(min_length=1)
    scene: str = Field(min_length=1)
    order: int
    set: dict[str, Any] = Field(default={})


class StepHead(Declaration):
    """The machine-readable part of a step: the move that it asks for, and how that is noticed."""

    done: str = Field(min_length=1)
    move: dict[str, Any] = Field(min_length=1)
    scene: str = ""
    set: dict[str, Any] = Field(default={})


class Step(StepHead):
    """One step of a lesson."""

    title: str
    text: str
    look_for: str
    question: str
    answer: str

    @property
    def condition(self) -> Condition:
        """The condition, parsed."""
        return parse_condition(self.done)

    @property
    def fields(self) -> tuple[str, ...]:
        """Dotted paths that the step speaks of: those that it moves, then others of its condition."""
        return tuple(dict.fromkeys((*self.move, *self.condition.fields)))


class Lesson(LessonHead):
    """A lesson."""

    name: str
    introduction: str
    steps: tuple[Step, ...]
