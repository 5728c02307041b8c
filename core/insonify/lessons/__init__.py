"""Lessons: a question to answer first, what to move in a scene, what to look for, and why."""

from insonify.files import bundled_lessons
from insonify.lessons.checks import check_lesson, check_records
from insonify.lessons.conditions import Condition, Expression, Reader, parse_condition, parse_expression
from insonify.lessons.courses import Course, group_lessons, load_courses
from insonify.lessons.lesson import Lesson, Step, load_lesson, load_lessons, parse_lesson
from insonify.lessons.quantities import QUANTITIES, SIDES
from insonify.lessons.questions import UNKNOWN, Ask, Choice, Grade, Verdict, judge, read_number
from insonify.lessons.states import AUTOMATIC, WINDOW_FIELDS, LessonState, split_move, states_of, subject_of
from insonify.lessons.worksheet import Answer, Worksheet

__all__ = [
    "AUTOMATIC",
    "QUANTITIES",
    "SIDES",
    "UNKNOWN",
    "WINDOW_FIELDS",
    "Answer",
    "Ask",
    "Choice",
    "Condition",
    "Course",
    "Expression",
    "Grade",
    "Lesson",
    "LessonState",
    "Reader",
    "Step",
    "Verdict",
    "Worksheet",
    "bundled_lessons",
    "check_lesson",
    "check_records",
    "group_lessons",
    "judge",
    "load_courses",
    "load_lesson",
    "load_lessons",
    "parse_condition",
    "parse_expression",
    "parse_lesson",
    "read_number",
    "split_move",
    "states_of",
    "subject_of",
]
