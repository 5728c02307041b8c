"""Write the teacher's page: courses and lessons, questions, right answers, and the misconceptions behind wrong ones."""

from __future__ import annotations

from insonify.lessons.conditions import parse_expression
from insonify.lessons.courses import Course, group_lessons
from insonify.lessons.lesson import Lesson, Step, load_lessons
from insonify.lessons.quantities import QUANTITIES
from insonify.lessons.questions import Ask
from insonify.lessons.states import LessonState, states_of

HEAD = """# Teach a course

What each course of [lessons](lessons.md) asks, the right answers, and the misconceptions behind the wrong ones that the
viewer knows. Numbers are those of the scene as the lesson opens it; an answer is judged on the student's own scene.
After a lesson, *Save page…* writes answers and records as a page to hand in, which serves as the worksheet.

| course | level | lessons | minutes | assumes |
|---|---|---|---|---|
"""

TOPICS = """## Topics

Each topic with its lesson, its questions, and what the right answer is checked by: a closed form of the student's
scene; its value as measured in the simulated record (`insonify lesson check`); a condition on that record, which tests
what is to be seen there and not always the number that is asked for; or, for a choice, the reasons alone.

| topic | lesson | question | checked by |
|---|---|---|---|
"""


def page() -> str:
    """Return the page."""
    groups = [(course, lessons) for course, lessons in group_lessons(load_lessons()) if course.name]
    rows = [
        f"| [{course.title}](#{course.title.lower().replace(' ', '-')}) | {course.level} | {len(lessons)} | "
        f"{sum(each.minutes for each in lessons)} | {course.assumes} |"
        for course, lessons in groups
    ]
    return HEAD + "\n".join(rows) + f"\n\n{_topics(groups)}\n" + "\n".join(_course(*each) for each in groups)


def _topics(groups: list[tuple[Course, list[Lesson]]]) -> str:
    """Return the table of topics with the lesson, the question and the check of each."""
    rows = [TOPICS]
    for course, lessons in groups:
        for topic in course.topics:
            steps = [(lesson, step) for lesson in lessons for step in lesson.steps if step.topic == topic]
            for number, (lesson, step) in enumerate(steps):
                question = " ".join(step.question.split())
                rows.append(f"| {'' if number else topic} | `{lesson.name}` | {question} | {_check(step)} |\n")
    return "".join(rows)


def _check(step: Step) -> str:
    """Name what the right answer is checked by."""
    ask = step.ask
    if ask is None:
        return "nothing: shown on demand"
    calls = [name for name, each in QUANTITIES.items() if each.measure and f"{name}(" in ask.value]
    return " and ".join(
        words
        for words, holds in (
            ("closed form", bool(ask.value)),
            ("measured in the simulated record", bool(calls)),
            ("a condition on the simulated record", bool(ask.holds)),
            ("reason for each wrong choice", bool(ask.choices) and not ask.holds),
        )
        if holds
    )


def _course(course: Course, lessons: list[Lesson]) -> str:
    return f"## {course.title}\n\n{course.aims}\n\n" + "\n".join(map(_lesson, lessons))


def _lesson(lesson: Lesson) -> str:
    steps = [_step(*each) for each in states_of(lesson)]
    return (
        f"### {lesson.title}\n\nLesson `{lesson.name}`, scene `{lesson.scene}`, {lesson.minutes} minutes.\n\n"
        + "\n".join(steps)
    )


def _step(step: Step, start: LessonState, end: LessonState) -> str:
    asked = [] if step.ask is None else _answers(step.ask, start, end)
    checked = " A condition on the simulated record is checked." if step.ask is not None and step.ask.holds else ""
    question = f"**{step.title}.** {' '.join(step.question.split())}{checked}\n"
    return "\n".join([question, *(f"- {line}" for line in asked), *([""] if asked else [])])


def _answers(ask: Ask, start: LessonState, end: LessonState) -> list[str]:
    """Return the right answer, then each wrong one with the misconception behind it."""
    if ask.choices:
        right = [f"right: {each.text}" for each in ask.choices if each.right]
        return right + [f"wrong: {each.text}. {each.because}" for each in ask.choices if not each.right]
    reader = end.reader(start)
    numbers = [parse_expression(each.value).number(reader) for each in (ask, *ask.mistakes)]
    shown = ["of a record" if number is None else ask.in_unit(number) for number in numbers]
    return [
        f"right: {shown[0]}, within {100 * ask.tolerance:g} %",
        *(f"wrong: {number}. {mistake.because}" for number, mistake in zip(shown[1:], ask.mistakes)),
    ]
