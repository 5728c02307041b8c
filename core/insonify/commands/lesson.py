"""``insonify lesson``: list the lessons of the viewer, or check lessons."""

import argparse
from typing import Any

from insonify.commands.options import say


def register(subparsers: Any) -> None:
    """Add ``lesson``."""
    parser = subparsers.add_parser(
        "lesson",
        description="List the lessons that the viewer teaches, or check lessons of your own. "
        "Example: insonify lesson check my-lesson.md",
    )
    parser.set_defaults(run=run_list)
    actions = parser.add_subparsers(metavar="ACTION")
    check = actions.add_parser(
        "check",
        help="check that lessons can be done",
        description="Check that scenes and fields of lessons exist, that values lie in their bounds, and that "
        "the condition of every step is false before its move and true after it; then that simulated records agree "
        "with the questions. "
        "Example: insonify lesson check my-lesson.md",
    )
    check.add_argument(
        "lessons", nargs="*", metavar="FILE", help="a Markdown file or a bundled lesson (default: all bundled lessons)"
    )
    check.set_defaults(run=run_check)


def run_list(arguments: argparse.Namespace) -> None:
    """Print the bundled lessons in their order, with course, minutes and title."""
    from insonify.lessons.courses import group_lessons  # lazy: no other command needs lessons
    from insonify.lessons.lesson import load_lessons  # lazy: no other command needs lessons

    groups = group_lessons(load_lessons())
    width = max((len(lesson.name) for _, lessons in groups for lesson in lessons), default=0)
    wide = max((len(course.title) for course, _ in groups), default=0)
    for course, lessons in groups:
        for lesson in lessons:
            say(f"{lesson.name:<{width}}  {course.title:<{wide}}  {lesson.minutes:>2} min  {lesson.title}")


def run_check(arguments: argparse.Namespace) -> None:
    """Check lessons; the first fault ends the check with an error."""
    from insonify.files import bundled_lessons  # lazy: as above
    from insonify.lessons.checks import check_lesson, check_records  # lazy: as above
    from insonify.lessons.lesson import load_lesson  # lazy: as above

    for name in arguments.lessons or bundled_lessons():
        lesson = load_lesson(name)
        check_lesson(lesson)
        steps = len(lesson.steps)
        asked, checked = sum(step.ask is not None for step in lesson.steps), check_records(lesson)
        questions = f"; {asked} question{'s' * (asked > 1)}, {checked} checked by simulation" if asked else ""
        say(f"{lesson.name}: {steps} step{'s' * (steps > 1)}, each can be done and is noticed{questions}")
