"""Lessons: reading, the check of each, the command, conditions, of which nothing runs as code, and questions."""

import math
import re
from collections import Counter
from datetime import datetime, timedelta
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from hypothesis import given
from hypothesis import strategies as st

from commands import refused
from insonify.cli import main
from insonify.errors import SceneError
from insonify.files import bundled_lessons
from insonify.lessons.checks import check_lesson, check_records
from insonify.lessons.conditions import Reader, parse_condition, parse_expression
from insonify.lessons.courses import group_lessons, load_courses
from insonify.lessons.lesson import load_lesson, load_lessons, parse_lesson
from insonify.lessons.quantities import QUANTITIES
from insonify.lessons.questions import Ask, Grade, judge, order_choices, read_number
from insonify.lessons.states import LessonState, states_of
from insonify.lessons.wording import BLANK, TEXTS, fill_in, write_out
from insonify.lessons.worksheet import Answer, Worksheet
from insonify.scene import Scene, edit, load_scene
from insonify.simulation import simulate

LESSON = """+++
title = "Width"
scene = "figure-4a"
order = 5
set = { "track.altitude" = 8.0 }
+++

What a beam is.

## Widen the beam

Take a *fan*.

```toml
move = { "sonar.beam.kind" = "fan", "sonar.beam.width" = 6.0 }
done = "sonar.beam.width >= 5"
```

Look for: merged echoes,
on two lines.

Question: Why?

Answer: Because.
"""


def test_the_parts_of_a_lesson_and_the_states_that_follow_its_moves():
    lesson = parse_lesson(LESSON, "width")
    assert (lesson.name, lesson.title, lesson.scene, lesson.order) == ("width", "Width", "figure-4a", 5)
    assert (lesson.set, lesson.introduction) == ({"track.altitude": 8.0}, "What a beam is.")
    (step,) = lesson.steps
    assert (step.title, step.text) == ("Widen the beam", "Take a *fan*.")
    assert step.look_for == "merged echoes,\non two lines."
    assert (step.question, step.answer) == ("Why?", "Because.")
    assert step.fields == ("sonar.beam.kind", "sonar.beam.width")
    ((_, start, end),) = states_of(lesson)
    known = ("track.altitude", 8.0), ("sonar.beam.width", None)
    assert [(path, start.value(path)) for path, _ in known] == [*known]
    known = ("sonar.beam.width", 6.0), ("plan.tolerance", 0.03), ("plan.method", "auto"), ("point.side", None)
    assert [(path, end.value(path)) for path, _ in known] == [*known]


FAULTS = {
    "has no front matter": ("+++\ntitle", "title"),
    "its TOML is not valid": ('title = "Width"', "title = "),
    "order: is missing": ("order = 5\n", ""),
    "colour: unknown key": ("order = 5", 'order = 5\ncolour = "red"'),
    "order: 'five' is not a whole number": ("order = 5", 'order = "five"'),
    "course: 'second-look' does not exist; choose one of first-look": ("order", 'course = "second-look"\norder'),
    "topic: 'fog' is not of the course": ('done = "sonar.beam.width', 'topic = "fog"\ndone = "sonar.beam.width'),
    "display side='front' is not a valid value; write for example both": ("set", 'display = { side = "front" }\nset'),
    "has no step": ("## Widen the beam", "Widen the beam"),
    "has 0 blocks of TOML": ("```toml", "```text"),
    "done: is missing": ('done = "sonar.beam.width >= 5"\n', ""),
    "has no paragraph 'Answer": ("Answer: Because.", ""),
    "has no text about what to move": ("Take a *fan*.", ""),
    "scene: 'figure-9' does not come with insonify": ('"figure-4a"', '"figure-9"'),
    "track.altitude: -1.0 is out of bounds": ("8.0", "-1.0"),
    "sonar.beam.width: -6.0 is out of bounds": ("6.0", "-6.0"),
    "sonar.beam.widht: unknown key": ('"sonar.beam.width" = 6.0', '"sonar.beam.widht" = 6.0'),
    "sonar.beam.lenght: is not a number": ("sonar.beam.width >= 5", "sonar.beam.lenght >= 5"),
    "sonar.beam: is not a number": ("sonar.beam.width >= 5", "sonar.beam >= 5"),
    "is true before the move": ("sonar.beam.width >= 5", "sonar.range > 1 or sonar.beam.width >= 5"),
    "is not true after the move": ("6.0", "4.0"),
    "contains no comparison": ("sonar.beam.width >= 5", "sonar.beam.width"),
    "plan.tolerance: 2.0 is out of bounds": ('"sonar.beam.width" = 6.0', '"plan.tolerance" = 2.0'),
    "model: 'plains' is not a choice": ('"sonar.beam.width" = 6.0', '"plan.plains" = "8"'),
    "point.side: 'left' is not a side": ('"sonar.beam.width" = 6.0', '"point.side" = "left"'),
    "point.slant_range: 60.0 is outside": ('"sonar.beam.width" = 6.0', '"point.slant_range" = 60.0'),
    "point.colour: is not known": ('"sonar.beam.width" = 6.0', '"point.colour" = 1'),
}


def test_a_file_is_checked(tmp_path, capsys):
    file = tmp_path / "width.md"
    file.write_text(LESSON, encoding="utf-8")
    assert main(["lesson", "check", str(file)]) in (None, 0)
    assert capsys.readouterr().out == "width: 1 step, each can be done and is noticed\n"
    unreachable = LESSON.replace("done = ", 'scene = "figure-1"\nset = { "sonar.rnage" = 3.0 }\ndone = ')
    with pytest.raises(SceneError, match=r"step 'Widen the beam': sonar.rnage: unknown key; did you mean 'range'"):
        check_lesson(parse_lesson(unreachable, "width"))


def test_every_bundled_lesson_is_listed_belongs_to_a_course_takes_some_minutes_and_asks_first(capsys):
    bundled, groups = load_lessons(), group_lessons(load_lessons())
    orders = [lesson.order for lesson in bundled]
    assert orders == sorted({*orders}), "each has its own place"
    main(["lesson"])
    assert [line.split()[0] for line in capsys.readouterr().out.splitlines()] == [lesson.name for lesson in bundled]
    assert [course.name for course, _ in groups] == [course.name for course in load_courses()]
    assert [lesson for _, lessons in groups for lesson in lessons] == list(bundled), "by course and by place"
    assert all(lesson.minutes >= 5 for lesson in bundled)
    assert all(step.ask is not None for lesson in bundled for step in lesson.steps)
    assert all(course.level and course.aims and course.assumes for course in load_courses())
    for course, lessons in groups:
        assert set(course.topics) == {step.topic for each in lessons for step in each.steps} - {""}
    # Lessons of no course come last.
    own = parse_lesson(LESSON, "width")
    course, lessons = group_lessons((own, *bundled))[-1]
    assert (course.title, lessons) == ("Other lessons", [own])


# Numbers that need no scene: those of formulas, of names, and exponents; every other number of a text is computed.
CONSTANT = re.compile(
    r"\*[^*]*\*|`[^`]*`|\b(relief|target|[Ff]igure|Models?|Foote) \d+( to \d+)?|\d+ log|2[²³⁰-⁹]+|√\(?\d|−3 dB|/ 2\b"
    r"|\(2 [A-Z·]|1 / [√(nNc]"
)


def texts_of(lesson):
    """Every text of a lesson, with where it stands."""
    yield "title", lesson.title
    yield "introduction", lesson.introduction
    for step in lesson.steps:
        yield from ((step.title, getattr(step, name)) for name in ("title", *TEXTS))
        yield from ((step.title, text) for each in step.ask.choices for text in (each.text, each.because))
        yield from ((step.title, each.because) for each in step.ask.mistakes)


@pytest.mark.parametrize("name", bundled_lessons())
def test_every_number_of_a_text_is_computed_from_the_scene(name):
    lesson = load_lesson(name)
    for where, text in texts_of(lesson):
        assert not re.search(r"\d", CONSTANT.sub("", BLANK.sub("n", text))), (where, text)
        assert all(parse_expression(blank[1]).names for blank in BLANK.finditer(text)), (where, text)
    for _, text in texts_of(fill_in(lesson)):
        assert "{" not in text


@pytest.mark.parametrize(
    ("text", "written"),
    [
        ("{altitude()} m", "10 m"),
        ("{sonar.frequency / 1000:1} kHz, {sonar.beam.kind}", "400.0 kHz, fan"),
        ("{water.sound_speed} {water.sound_speed / 7} {-sqrt(2):3}", "1500 214 −1.414"),
        ("{sonar.frequency} Hz", "400,000 Hz"),
        ("{before(altitude())}", "7"),
        ("{absent}", None),
        ("{sonar.beam}", None),
        ("{altitude() > 3}", None),
        ("{altitude(}", None),
    ],
)
def test_a_blank_is_a_field_as_it_is_or_a_value_to_three_digits(text, written):
    state = LessonState(load_scene("default"))
    before = LessonState(edit(state.scene, {"track.altitude": 7.0}))
    if written is None:
        with pytest.raises(SceneError, match=r"correct|join|missing|comparison"):
            write_out(text, state.reader(before))
    else:
        assert write_out(text, state.reader(before)) == written


EARTH = {"water.sound_speed": 1500.0, "water.absorption.coefficient": 38.0, "water.surface.gravity": 9.81}


@pytest.mark.parametrize("run", ["", "2026-03-01T09:30", "2026-03-02T11:00"])
def test_every_run_draws_another_ocean_in_which_remembered_answers_fail(run):
    lesson = load_lesson("other-ocean")
    drawn, other = fill_in(lesson, run), fill_in(lesson, run + "'")
    assert {path: drawn.set[path] for path in lesson.draw} != {path: other.set[path] for path in lesson.draw}
    assert all(least <= drawn.set[path] <= greatest for path, (least, greatest) in lesson.draw.items())
    assert fill_in(lesson, run) == drawn
    check_lesson(drawn)
    remembered = states_of(drawn.model_copy(update={"set": drawn.set | EARTH}))
    for (step, start, end), (_, before, after) in zip(states_of(drawn), remembered):
        answer = parse_expression(step.ask.value).number(after.reader(before))
        right = parse_expression(step.ask.value).number(end.reader(start))
        assert judge(step.ask, right, end.reader(start)).grade is Grade.RIGHT
        assert judge(step.ask, answer, end.reader(start)).grade is not Grade.RIGHT, step.title


def shadow_of_block(scene: Scene) -> tuple[float, float]:
    """Slant ranges at which the shadow of the first target begins and ends, from the intensities alone."""
    record = simulate(scene)
    ping = round(scene.targets[0].position[0] / scene.track.speed * scene.sonar.ping_rate)
    intensity = record.intensity.isel(ping_time=ping).sel(channel="starboard").to_numpy()
    edges = np.arange(scene.sonar.bins + 1) * scene.sonar.range / scene.sonar.bins
    # The longest stretch without an echo behind the first return.
    dark = np.flatnonzero(np.diff(np.concatenate([[1], (intensity > 0.0).astype(int), [1]])))
    starts, ends = dark[::2], dark[1::2]
    behind = edges[starts] > scene.altitude
    longest = np.argmax(np.where(behind, ends - starts, 0))
    return float(edges[starts[longest]]), float(edges[ends[longest]])


def test_the_height_of_the_block_follows_from_its_shadow():
    """h = A L / (R + L) holds on the record of every step with the block to the size of two bins."""
    _, first, _ = next(states_of(load_lesson("target-height")))
    ends = [end.scene for _, _, end in states_of(load_lesson("target-height"))]
    lengths = []
    for scene in (first.scene, *(scene for scene in ends if scene.targets[0].kind == "box")):
        begin, end = shadow_of_block(scene)
        height = scene.altitude * (end - begin) / end
        bin_length = scene.sonar.range / scene.sonar.bins
        assert height == pytest.approx(scene.targets[0].size[2], abs=2.0 * bin_length * scene.altitude / end)
        lengths.append((begin, end - begin))
    # The figures that question and answer give.
    _, one, other, last = lengths
    assert one == pytest.approx((22.47, 5.62), abs=0.05)
    assert other == pytest.approx((21.2, 14.1), abs=0.05)
    assert last == pytest.approx((21.4, 5.3), abs=0.06)


VALUES = {
    "sonar.beam.width": 5.0,
    "sonar.beam.kind": "fan",
    "sonar.range": 50.0,
    "sonar.bins": 1000,
    "targets.0.gap": 1.5,
    "two_way": True,
}


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("sonar.beam.width >= 5", True),
        ("sonar.beam.width > 5", False),
        ("sonar.beam.width != 5", False),
        ("sonar.beam.kind == 'fan'", True),
        ('sonar.beam.kind != "fan"', False),
        ("targets.0.gap < 1.6 and targets.0.gap > 1.4", True),
        ("sonar.range / sonar.bins <= 0.05", True),
        ("sonar.range / sonar.bins < 0.05", False),
        ("2 + 3 * 4 == 14", True),
        ("(2 + 3) * 4 == 20", True),
        ("10 - 4 - 3 == 3", True),
        ("8 / 4 / 2 == 1", True),
        ("-sonar.range < -4.9e1", True),
        ("1e3 == sonar.bins", True),
        ("not sonar.range > 60", True),
        ("not (sonar.range > 60 or sonar.bins == 1000)", False),
        ("two_way == true and not two_way == false", True),
        # "and" binds closer than "or".
        ("1 == 1 or 1 == 2 and 1 == 2", True),
        ("(1 == 1 or 1 == 2) and 1 == 2", False),
        # A field that does not decide may be absent.
        ("sonar.range == 50 or absent > 1", True),
        ("sonar.range > 50 and absent > 1", False),
        # What has no value or cannot be compared does not hold.
        ("absent > 1", False),
        ("absent == absent", False),
        ("not absent > 1", False),
        ("sonar.beam.kind > 1", False),
        ("two_way == 1", False),
        ("1 / 0 > 1", False),
        ("two_way + 1 > 0", False),
    ],
)
def test_conditions_mean_what_they_say(text, expected):
    assert parse_condition(text).holds(VALUES.get) is expected


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("altitude()", 7.0),
        ("2 * slant_range(3, altitude() - 1) + 1", 19.0),
        ("before(sonar.range)", 20.0),
        ("sonar.range / before(sonar.range + 5)", 2.0),
        ("before(before(sonar.range))", None),  # a scene has one past
        ("swath()", None),
        ("sqrt(absent)", None),
        ("sonar.beam.kind", None),
        ("sonar.range / 0", None),
    ],
)
def test_expressions_call_quantities_and_read_values_before_the_move(text, expected):
    before = Reader({"sonar.range": 20.0}.get)
    reader = Reader(VALUES.get, lambda name, given: {"slant_range": sum(given), "altitude": 7.0}.get(name), before)
    assert parse_expression(text).number(reader) == expected
    assert parse_condition(f"{text} == 1 or 1 == 1").holds(reader) is (expected is not None)


def test_the_fields_are_told_once_each():
    condition = parse_condition("sonar.range > 1 and (sonar.bins < 3 or sonar.range < true)")
    assert condition.fields == ("sonar.range", "sonar.bins")


FAULTY_EXPRESSIONS = [
    ("altitude(", "a value is missing"),
    ("altitude(1)", "altitude has 1 values; it takes 0"),
    ("slant_range(1)", "slant_range has 1 values; it takes 2"),
    ("before()", "before has 0 values; it takes 1"),
    ("eval(1)", "is not expected here"),
    ("sqrt(1", "not closed"),
    ("sqrt(" * 1000, "characters"),
    ("sqrt(" * 150, "nested"),
    ("sonar.range > 1", "is a comparison where a number is needed"),
    ("1, 2", "is not expected here"),
]
FAULTY_CONDITIONS = [
    ("", "a value is missing"),
    ("sonar.range", "contains no comparison"),
    ("sonar.range >", "a value is missing"),
    ("sonar.range > 1 sonar.bins", "is not expected here"),
    ("1 < sonar.range < 3", "is not expected here"),
    ("(sonar.range > 1", "not closed"),
    ("sonar.range = 1", "'=' is not understood"),
    ("sonar.range > 1;", "';' is not understood"),
    ("and > 1", "a value is missing"),
    ("__import__('os') == 1", "is not expected here"),
    ("sonar.range > [1]", "is not understood"),
    ("(" * 1000, "nested"),
    ("x > 1 and " * 200, "characters"),
]


@pytest.mark.parametrize(
    ("parse", "text", "told"),
    [(parse_expression, *each) for each in FAULTY_EXPRESSIONS]
    + [(parse_condition, *each) for each in FAULTY_CONDITIONS],
)
def test_a_fault_is_one_sentence(parse, text, told):
    with pytest.raises(SceneError, match="condition") as caught:
        parse(text)
    assert told in str(caught.value)
    assert "\n" not in str(caught.value)


@given(st.text(alphabet="ab.1 0()<>=!+-*/'\"andortu_e", max_size=60))
def test_any_text_is_a_condition_or_a_fault(text):
    try:
        condition = parse_condition(text)
    except SceneError:
        return
    assert condition.holds({"a": 1.0, "b": "a"}.get) in (True, False)


CHOICES = [{"text": "Longer", "right": True}, {"text": "Shorter", "because": "Sound comes in flatter."}]
NUMBER = {
    "value": "shadow_length(21, targets.0.size.2)",
    "unit": "m",
    "tolerance": 0.05,
    "mistakes": [{"value": "2 * before(shadow_length(21, targets.0.size.2))", "because": "A − h counts."}],
}
ASKING = """+++
title = "Height"
scene = "pipe-on-bed"
order = 5

[set]
targets = [{ kind = "box", position = [20.0, -20.5], size = [6.0, 1.0, 2.0], material = "concrete" }]
+++

## Lower the sonar

Lower it.

```toml
move = { "track.altitude" = 5.0 }
done = "track.altitude <= 5.5"

[ask]
value = "shadow_length(21, targets.0.size.2)"
unit = "m"
holds = "dark_share(22, 30) > before(dark_share(22, 30))"

[[ask.mistakes]]
value = "before(shadow_length(21, targets.0.size.2))"
because = \"\"\"
The sound comes
in flatter.
\"\"\"
```

Look for: a longer shadow.

Question: How long?

Answer: L = h · R / (A − h).
"""


def block(altitude: float) -> LessonState:
    """State of the lesson on a block's shadow, at an altitude."""
    _, start, _ = next(states_of(load_lesson("target-height")))
    return LessonState(edit(start.scene, {"track.altitude": altitude}))


@pytest.mark.parametrize(
    ("asked", "answer", "grade", "words"),
    [
        (NUMBER, 14.1, Grade.RIGHT, "Right: 14.1 m."),
        (NUMBER, 14.8, Grade.RIGHT, "Right: 14.1 m."),
        (NUMBER, 15.5, Grade.CLOSE, "Close: it is 14.1 m. Yours is 9.6 % too large."),
        (NUMBER, 13.0, Grade.CLOSE, "Close: it is 14.1 m. Yours is 8.1 % too small."),
        (NUMBER, 11.2, Grade.WRONG, "Not quite. Answer: 14.1 m. A − h counts."),
        (NUMBER, 3.0, Grade.WRONG, "Not quite. Answer: 14.1 m."),
        (NUMBER, None, Grade.UNKNOWN, "Answer: 14.1 m."),
        ({"choices": CHOICES}, 0, Grade.RIGHT, "Right: Longer."),
        ({"choices": CHOICES}, 1, Grade.WRONG, "Not quite. Answer: Longer. Sound comes in flatter."),
        ({"choices": CHOICES}, None, Grade.UNKNOWN, "Answer: Longer."),
    ],
)
def test_an_answer_is_right_close_or_a_known_mistake(asked, answer, grade, words):
    verdict = judge(Ask.model_validate(asked), answer, block(5.0).reader(block(10.0)))
    assert (verdict.grade, verdict.words) == (grade, words)


def test_choices_stand_in_an_order_of_the_run_that_does_not_tell_the_right_one():
    asked = [(step.question, step.ask) for lesson in load_lessons() for step in lesson.steps if step.ask.choices]
    runs = [Worksheet(load_lesson("ghosts"), datetime(2026, 3, 2, 9, 0, 0, number)).run for number in range(60)]
    first = dict.fromkeys(runs, 0)  # right answers that stand first
    for question, ask in asked:
        right = next(place for place, choice in enumerate(ask.choices) if choice.right)
        stands = Counter()
        for run in runs:
            order = order_choices(question, ask, run)
            assert order == order_choices(question, ask, run), "stable within a run"
            assert sorted(order) == list(range(len(ask.choices))), "a place is that of the file"
            stands[order.index(right)] += 1
            first[run] += order[0] == right
        even = len(runs) / len(ask.choices)
        assert all(abs(stands[place] - even) < 5.0 * math.sqrt(even) for place in range(len(ask.choices)))
    expected = sum(1.0 / len(ask.choices) for _, ask in asked)
    assert all(abs(count - expected) < 5.0 * math.sqrt(expected) for count in first.values())
    assert len(set(first.values())) > 1


def test_a_number_follows_the_scene_of_the_student():
    ask = Ask.model_validate(NUMBER)
    for altitude in (4.0, 5.0, 8.0):
        length = math.hypot(21.0, altitude - 2.0) * 2.0 / (altitude - 2.0)
        assert judge(ask, length, block(altitude).reader(block(10.0))).grade is Grade.RIGHT
    assert judge(ask, 1.0, LessonState(load_scene("pipe-on-bed")).reader()) is None, "a pipe has no size"


@pytest.mark.parametrize(
    ("text", "number"),
    [("14", 14.0), (" 14,1 m", 14.1), ("−3.5e-1", -0.35), (".5", 0.5), ("about 3", None), ("", None), ("-", None)],
)
def test_a_number_is_read_with_point_comma_and_unit(text, number):
    assert read_number(text) == number


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ({}, "give choices, or value and unit"),
        ({"choices": CHOICES, "value": "1"}, "give choices, or value and unit"),
        ({"choices": CHOICES[:1]}, "give two to four"),
        ({"choices": CHOICES[1:] * 2}, "exactly one right choice"),
        ({"choices": [CHOICES[0], CHOICES[0]]}, "exactly one right choice"),
        ({"choices": [*CHOICES, CHOICES[1]]}, "two choices of the same text"),
        ({"choices": [CHOICES[0], {"text": "Shorter"}]}, "name the misconception"),
        ({"choices": CHOICES, "unit": "m"}, "belong to a number"),
        ({"choices": CHOICES, "measured": "altitude()"}, "belong to a number"),
        ({"value": "1 +"}, "a value is missing"),
        ({"value": "1", "tolerance": 0.5}, "tolerance"),
        ({"value": "1", "holds": "1"}, "contains no comparison"),
    ],
)
def test_a_fault_of_a_question_names_the_remedy(given, told):
    with pytest.raises(ValueError, match=re.escape(told)):
        Ask.model_validate(given)


def test_quantities_agree_with_what_is_written_of_them_and_with_a_record():
    beam = {"sonar.beam": {"kind": "array", "length": 0.2}, "sonar.frequency": 100e3}
    scene, wavelength = edit(load_scene("default"), {"water.sound_speed": 1500.0} | beam), 0.015
    expected = {
        ("altitude",): 10.0,
        ("sound_speed",): 1500.0,
        ("wavelength",): wavelength,
        ("bin_length",): 0.05,
        ("ping_spacing",): 0.2,
        ("fastest_ping_rate",): 15.0,
        ("first_return",): 10.0,
        ("swath",): 2.0 * math.sqrt(50.0**2 - 10.0**2),
        ("beam_width",): math.degrees(0.886 * wavelength / 0.2),
        ("near_field",): 0.2**2 / wavelength,
        ("across_resolution",): 0.075,
        ("slant_range", 30.0, 2.0): math.hypot(30.0, 8.0),
        ("ground_range", 26.0): 24.0,
        ("shadow_end", 30.0, 2.0): 1.25 * math.hypot(30.0, 8.0),
        ("along_resolution", 1.0): 0.2,
        ("recorded_width",): math.degrees(0.638 * wavelength / 0.2),
        ("along_resolution", 40.0): 40.0 * 0.638 * wavelength / 0.2,
        ("pings_on", 1.0, 1.0): 6.0,
        ("sin", 30.0): 0.5,
        ("cos", 60.0): 0.5,
        ("tan", 45.0): 1.0,
        ("arccos", 0.5): 60.0,
        ("sqrt", 9.0): 3.0,
        ("log10", 1000.0): 3.0,
        ("power", 2.0, 8.0): 256.0,
        ("radians", 180.0): math.pi,
        ("single_step", 4182600.0): 0.25,
        # The logarithm of an exponential variable has the variance π²/6, of many looks 1/n.
        ("looks_spread", 1.0): 10.0 / math.log(10.0) * math.pi / math.sqrt(6.0),
        ("looks_spread", 25.0): 0.877,
        # TEOS-10, and for fresh water Marczak, J. Acoust. Soc. Am. 102 (1997): 1450.05 m/s at 10.7 °C.
        ("sea_speed", 10.0, 35.0, 0.0): 1489.789,
        ("sea_temperature", 1450.05, 0.0): 10.70,
        ("sea_temperature", 1450.0, 35.0): 0.2129,
        ("backscatter", 30.0): 10.0 * math.log10(scene.seabed.material.reflectivity_at(100e3).diffuse / math.pi * 0.25),
    }
    found = {(name, *arguments): QUANTITIES[name].compute(scene, *arguments) for name, *arguments in expected}
    assert found == pytest.approx(expected, rel=2e-3)
    scene = edit(load_scene("default"), {"sonar.bins": 50, "sonar.range": 50.0})
    intensity = np.full((2, 4, 50), 1e-6)
    intensity[..., :10] = intensity[..., 45:] = 0.0
    intensity[..., 20:25] = 1e-12
    record = xr.Dataset({"intensity": (("channel", "ping_time", "range_sample"), intensity)})
    expected = {
        ("first_return",): 10.0,
        ("last_return",): 45.0,
        ("level", 30.0, 40.0): -60.0,
        ("dark_share", 15.0, 25.0): 0.5,
        ("contrast", 30.0, 40.0): 0.0,
    }
    found = {(name, *arguments): QUANTITIES[name].measure(scene, record, *arguments) for name, *arguments in expected}
    assert found == pytest.approx(expected, abs=1e-9)


def test_a_question_is_checked_against_simulated_records_and_may_be_left_out():
    lesson = parse_lesson(ASKING, "height")
    assert lesson.steps[0].ask.mistakes[0].because == "The sound comes in flatter."
    check_lesson(lesson)
    assert check_records(lesson) == 1
    text = ASKING[: ASKING.index("[ask]")] + ASKING[ASKING.index("```\n\nLook") :]
    lesson = parse_lesson(text, "height")
    assert lesson.steps[0].ask is None
    check_lesson(lesson)
    assert check_records(lesson) == 0
    with pytest.raises(SceneError, match="has no paragraph 'Question"):
        parse_lesson(text.replace("Question:", "Asked:"), "height")


CONTRADICTIONS = [
    ('"shadow_length(21', '"shadow_length(25', "in the simulated record"),
    ('unit = "m"\nholds', 'unit = "m"\nmeasured = "first_return()"\nholds', "but first_return() is 5 in"),
    ("> before(dark", "< before(dark", "does not hold in the simulated record"),
    ('value = "before(', 'value = "2.5 * before(', "agree within the tolerance"),
    ('targets.0.size.2)"\nunit', 'targets.0.radius)"\nunit', "is not a number in this scene"),
    ('"shadow_length(21, targets.0.size.2)"\nunit', '"level(20, 30)"\nunit', "is not a number in this scene"),
    ("[ask]", "[ask]\nchoice = 1", "ask.choice: unknown key"),
]


@pytest.mark.parametrize(
    ("text", "old", "new", "told"),
    [(LESSON, *change, told) for told, change in FAULTS.items()] + [(ASKING, *each) for each in CONTRADICTIONS],
)
def test_a_fault_is_one_sentence_that_names_lesson_and_remedy(text, old, new, told, tmp_path, capsys):
    assert old in text
    file = tmp_path / "width.md"
    file.write_text(text.replace(old, new, 1), encoding="utf-8", newline="")
    complaint = refused(capsys, "lesson", "check", str(file))
    assert "lesson width" in complaint
    assert told in complaint
    assert "; " in complaint
    assert text is LESSON or "step 'Lower the sonar'" in complaint


@pytest.mark.parametrize("name", bundled_lessons())
def test_every_bundled_lesson_can_be_done_and_records_agree_with_its_questions(name, request):
    if not name.startswith("breaks-"):  # which speak of plans
        request.getfixturevalue("fixed_model")
    lesson = load_lesson(name)
    check_lesson(lesson)
    check_records(lesson)


def test_the_page_to_hand_in():
    lesson = parse_lesson(ASKING, "height")
    began = datetime(2026, 3, 1, 9, 30)
    sheet = Worksheet(lesson, began, ended=began + timedelta(minutes=7))
    assert sheet.summary == "1 question: 1 not answered."
    verdict = judge(Ask.model_validate(NUMBER), 11.2, block(5.0).reader(block(10.0)))
    sheet.answers[0] = Answer("11.2", verdict, (("track.altitude", 5.0),))
    lines = sheet.to_markdown({0: Path("height-1.png")}).splitlines()
    assert lines[:5] == ["# Height", "", "Name:", "", "2026-03-01 09:30, 7 min. 1 question: 1 wrong."]
    assert {
        "## 1. Lower the sonar",
        "How long?",
        "- **Answer**: 11.2",
        "- **Verdict**: Not quite. Answer: 14.1 m. A − h counts.",
        "- `track.altitude` = 5",
        "![Record after step 1](height-1.png)",
        "**Why**: L = h · R / (A − h).",
    } <= {*lines}
    assert sheet.results() == ["Lower the sonar: wrong"]
