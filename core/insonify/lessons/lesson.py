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
    """One step of a lesson.

    Attributes
    ----------
    title : str
        Heading.
    text : str
        What to move, in Markdown.
    look_for, question, answer : str
        In Markdown.
    done : str
        The condition that notices that the step was done.
    move : dict of str to object
        One way to do it: values by dotted path, of the scene or of the window.
    scene : str
        Bundled scene that the step opens first; empty where it goes on with the one before.
    set : dict of str to object
        Values of that scene to change.
    """

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
    """A lesson.

    Attributes
    ----------
    name : str
        Of its file, without the suffix.
    title : str
        Heading.
    scene : str
        Bundled scene that it starts from.
    set : dict of str to object
        Values of that scene to change at the start, by dotted path.
    order : int
        Its place in the list.
    introduction : str
        In Markdown.
    steps : tuple of Step
        At least one.
    """

    name: str
    introduction: str
    steps: tuple[Step, ...]
