"""Courses: the order in which lessons are taught, with level, aims and what each assumes."""

import tomllib
from collections.abc import Sequence
from functools import cache

from pydantic import Field

from insonify.files import resources
from insonify.lessons.lesson import Lesson
from insonify.scene.base import Declaration


class Course(Declaration):
    """A course of lessons."""

    name: str
    title: str = Field(min_length=1)
    level: str = ""
    aims: str = ""
    assumes: str = ""
    topics: tuple[str, ...] = ()  # each with a step that is about it


OTHER = Course(name="", title="Other lessons")  # lessons that belong to no course


@cache
def load_courses() -> tuple[Course, ...]:
    """Read the courses that come with the package, in their order."""
    text = (resources() / "lessons" / "courses.toml").read_text(encoding="utf-8")
    return tuple(map(Course.model_validate, tomllib.loads(text)["courses"]))


def group_lessons(lessons: Sequence[Lesson]) -> list[tuple[Course, list[Lesson]]]:
    """Group lessons by course, in the order of the courses; those of no course come last."""
    groups = [(course, [each for each in lessons if each.course == course.name]) for course in (*load_courses(), OTHER)]
    return [(course, members) for course, members in groups if members]
