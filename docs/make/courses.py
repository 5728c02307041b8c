"""Write the pages of courses: an overview with plans, a page of each course, and the answers for teachers."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache, partial

from insonify.lessons.conditions import parse_expression
from insonify.lessons.courses import Course, group_lessons
from insonify.lessons.lesson import Lesson, Step, load_lessons
from insonify.lessons.quantities import QUANTITIES
from insonify.lessons.questions import Ask
from insonify.lessons.states import LessonState, states_of
from insonify.lessons.wording import fill_in

HEAD = """# Teach a course

The courses of [lessons](lessons.md), a plan for a semester and one for two hours. Each course has a page with its
questions; the right answers, and the misconceptions behind the wrong ones, stand [on a page for
teachers](../courses/answers.md). Every number in a lesson is computed from its scene. After a lesson, *Save page…*
writes answers and records as a page to hand in, PDF or Markdown, which serves as the worksheet.

| course | level | lessons | minutes | assumes |
|---|---|---|---|---|
"""

# Title of each week of a semester, its lessons, and what is done beyond them.
WEEKS = (
    ("What a record shows", "first-return pipe-on-bed", "Read altitude and swath from a record of your own scene."),
    ("Shadows and heights", "target-height range-and-resolution", "Measure three targets of the scene `targets`."),
    ("Beams", "aperture two-way-beam", "Find a data sheet of a side-scan sonar: is its width one-way or two-way?"),
    ("Pulse, frequency, gain", "pulse-and-chirp frequency-and-absorption time-varied-gain vertical-beam",
     "Choose frequency and pulse for a range of 200 m."),
    ("The sonar equation", "sonar-equation noise", "Work out `insonify budget raw-record` by hand."),
    ("Sound speed and refraction", "sound-speed thermocline figure-3 ghosts",
     "Lay the shadow zone of a cast of your own."),
    ("The tow and other sounds", "towing other-sounds fish-and-plumes bottom-tracking",
     "List what repeats, what slants, what drifts."),
    ("Angles and sediments", "ground-range incidence angular-response sediments",
     "Compare two sediments at one incidence."),
    ("Texture and speckle", "incidence-and-ripples speckle classification figure-6 models",
     "Make a bed that passes for a recording."),
    ("Targets", "pipe-span detection wreck-or-rock figure-2 figure-4 figure-5",
     "Describe a contact so that another finds it."),
    ("Surveys", "survey-lines mosaics", "Plan lines for a square kilometre and 3 pings on a metre."),
    ("A recording, and the test", "read-a-recording end-test other-ocean",
     "Hand in the pages of all three, and the contacts of an exercise."),
)  # fmt: skip
# Minutes of a demonstration, its lessons, and what is shown.
DEMO = (
    (15, "first-return", "What the dark band is; raise and lower the sonar."),
    (20, "pipe-on-bed target-height", "Let the class guess the height of the block before you measure it."),
    (15, "figure-2", "Light beside sonar: the same shadow, another echo."),
    (20, "figure-4 two-way-beam", "Two spheres become one."),
    (10, "", "Pause: questions of the class on the default scene."),
    (20, "thermocline ghosts", "Bent sound in the panel of rays; echoes by the surface."),
    (20, "wreck-or-rock", "A vote: wreck or rock? Then turn the hull."),
)
PLANS = """
## A semester of 12 weeks

Two hours a week: one with the lessons of the week, one for the exercise and its discussion. {unplanned}
The courses end with a [survey exercise](exercise.md): survey hidden targets, hand in contacts, be marked.

| week | subject | lessons | minutes | exercise |
|---|---|---|---|---|
{weeks}

## A demonstration of two hours

With the [lecture](view.md#lecture) view (F11) on a projector: the class guesses, one student moves the slider.

| minutes | lessons | what is shown |
|---|---|---|
{demo}

"""
ANSWERS = """# Answers for teachers

The right answers of all lessons, and the misconceptions behind the wrong ones that the viewer knows. Numbers follow
from the scene as the lesson opens it; an answer is judged on the student's own scene. The lesson `other-ocean` draws
other numbers in every run: here is one draw.

"""

TOPICS = """## Topics

Each topic with its lesson, its questions, and the check of the right answer. It is a closed form of the student's
scene; its value as measured in the simulated record (`insonify lesson check`); or a condition on that record. A choice
may have its reasons alone.

| topic | lesson | question | checked by |
|---|---|---|---|
"""


def pages() -> dict[str, Callable[[], str]]:
    """Return what writes each page, by its path below ``docs``."""
    makers: dict[str, Callable[[], str]] = {"howto/courses.md": _overview, "courses/answers.md": _answers_page}
    return makers | {f"courses/{course.name}.md": partial(_course, course, lessons) for course, lessons in _groups()}


@cache
def _groups() -> list[tuple[Course, list[Lesson]]]:
    """Return the courses with their lessons, the texts written out."""
    groups = group_lessons([fill_in(lesson) for lesson in load_lessons()])
    return [(course, lessons) for course, lessons in groups if course.name]


def _overview() -> str:
    """Return the page of all courses."""
    groups = _groups()
    rows = [
        f"| [{course.title}](../courses/{course.name}.md) | {course.level} | {len(lessons)} | "
        f"{sum(each.minutes for each in lessons)} | {course.assumes} |"
        for course, lessons in groups
    ]
    return HEAD + "\n".join(rows) + "\n" + _plans(groups) + _topics(groups)


def _plans(groups: list[tuple[Course, list[Lesson]]]) -> str:
    """Return the plans of a semester and of a demonstration."""
    minutes = {lesson.name: lesson.minutes for _, lessons in groups for lesson in lessons}
    courses = {lesson.name: course.title for course, lessons in groups for lesson in lessons}

    def shown(names: str) -> str:
        return ", ".join(f"`{name}`" for name in names.split())

    weeks = [
        f"| {number} | {title} | {shown(names)} | {sum(minutes[name] for name in names.split())} | {exercise} |"
        for number, (title, names, exercise) in enumerate(WEEKS, 1)
    ]
    demo = [f"| {length} | {shown(names)} | {what} |" for length, names, what in DEMO]
    left = sorted(
        {courses[name] for name in minutes.keys() - {each for _, names, _ in WEEKS for each in names.split()}}
    )
    unplanned = f"What it leaves out, of {' and '.join(left)}, is for those who want more." if left else ""
    return PLANS.format(unplanned=unplanned, weeks="\n".join(weeks), demo="\n".join(demo))


def _course(course: Course, lessons: list[Lesson]) -> str:
    """Return the page of a course: what each lesson asks."""
    parts = [f"# {course.title}\n\n{course.aims} Assumed: {course.assumes[:1].lower()}{course.assumes[1:]}\n"]
    for lesson in lessons:
        parts.append(
            f"## {lesson.title}\n\nLesson `{lesson.name}`, scene `{lesson.scene}`, {lesson.minutes} minutes.\n"
        )
        parts += [f"- **{step.title}.** {' '.join(step.question.split())}" for step in lesson.steps]
        parts.append("")
    return "\n".join(parts).rstrip() + "\n"


def _opening(lesson: Lesson) -> str:
    return f"Lesson `{lesson.name}`, scene `{lesson.scene}`, {lesson.minutes} minutes."


def _answers_page() -> str:
    """Return the page of all answers."""
    return ANSWERS + "\n".join(
        f"## {course.title}\n\n" + "\n".join(map(_lesson, lessons)) for course, lessons in _groups()
    )


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
    calls = ask.measured or [name for name, each in QUANTITIES.items() if each.measure and f"{name}(" in ask.value]
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


def _lesson(lesson: Lesson) -> str:
    steps = [_step(*each) for each in states_of(lesson)]
    return f"### {lesson.title}\n\n{_opening(lesson)}\n\n" + "\n".join(steps)


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
