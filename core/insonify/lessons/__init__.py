"""Lessons: what to move in a scene step by step, what to look for, and a question with its answer."""

from __future__ import annotations

from insonify.files import bundled_lessons
from insonify.lessons.conditions import Condition, parse_condition
from insonify.lessons.lesson import Lesson, Step, load_lesson, load_lessons, parse_lesson
from insonify.lessons.states import AUTOMATIC, SIDES, WINDOW_FIELDS, LessonState, check_lesson, split_move, states_of

__all__ = [
    "AUTOMATIC",
    "SIDES",
    "WINDOW_FIELDS",
    "Condition",
    "Lesson",
    "LessonState",
    "Step",
    "bundled_lessons",
    "check_lesson",
    "load_lesson",
    "load_lessons",
    "parse_condition",
    "parse_lesson",
    "split_move",
    "states_of",
]
