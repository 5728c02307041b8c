"""Questions of lessons: their declaration, the verdict on an answer, quantities, and the page to hand in."""

import math
from datetime import datetime, timedelta
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr

from commands import refused
from insonify.errors import SceneError
from insonify.files import bundled_lessons
from insonify.lessons.checks import check_lesson, check_records
from insonify.lessons.lesson import load_lesson, load_lessons, parse_lesson
from insonify.lessons.quantities import QUANTITIES
from insonify.lessons.questions import Ask, Grade, judge, read_number
from insonify.lessons.states import LessonState, states_of
from insonify.lessons.worksheet import Answer, Worksheet
from insonify.scene import edit, load_scene

CHOICES = [
    {"text": "Longer", "right": True},
    {"text": "Shorter", "because": "Sound comes in flatter."},
]
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
    ("answer", "grade", "told"),
    [
        (14.1, Grade.RIGHT, "Right: 14.1 m."),
        (14.8, Grade.RIGHT, "14.1 m"),
        (15.5, Grade.CLOSE, "Close: it is 14.1 m. Yours is 9.6 % too large."),
        (13.0, Grade.CLOSE, "too small"),
        (11.2, Grade.WRONG, "A − h counts."),
        (3.0, Grade.WRONG, "Not quite: it is 14.1 m."),
        (None, Grade.UNKNOWN, "It is 14.1 m."),
    ],
)
def test_a_number_is_right_close_or_a_known_mistake(answer: float | None, grade: Grade, told: str) -> None:
    verdict = judge(Ask.model_validate(NUMBER), answer, block(5.0).reader(block(10.0)))
    assert verdict.grade is grade
    assert told in verdict.words


def test_a_number_follows_the_scene_of_the_student() -> None:
    ask = Ask.model_validate(NUMBER)
    for altitude in (4.0, 5.0, 8.0):
        length = math.hypot(21.0, altitude - 2.0) * 2.0 / (altitude - 2.0)
        verdict = judge(ask, length, block(altitude).reader(block(10.0)))
        assert verdict.grade is Grade.RIGHT
    assert judge(ask, 1.0, LessonState(load_scene("pipe-on-bed")).reader()) is None, "a pipe has no size"


def test_a_wrong_choice_tells_its_misconception() -> None:
    ask = Ask.model_validate({"choices": CHOICES})
    reader = block(5.0).reader()
    verdicts = [judge(ask, answer, reader) for answer in (0, 1, None)]
    assert [verdict.words for verdict in verdicts] == [
        "Right: Longer.",
        "Not quite: it is Longer. Sound comes in flatter.",
        "It is Longer.",
    ]


@pytest.mark.parametrize(
    ("text", "number"),
    [("14", 14.0), (" 14,1 m", 14.1), ("−3.5e-1", -0.35), (".5", 0.5), ("about 3", None), ("", None), ("-", None)],
)
def test_a_number_is_read_with_point_comma_and_unit(text: str, number: float | None) -> None:
    assert read_number(text) == number


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ({}, "give choices, or value and unit"),
        ({"choices": CHOICES, "value": "1"}, "give choices, or value and unit"),
        ({"choices": CHOICES[:1]}, "give two to four"),
        ({"choices": CHOICES[1:] * 2}, "exactly one right choice"),
        ({"choices": [CHOICES[0], CHOICES[0]]}, "exactly one right choice"),
        ({"choices": [CHOICES[0], {"text": "Shorter"}]}, "name the misconception"),
        ({"choices": CHOICES, "unit": "m"}, "belong to a number"),
        ({"value": "1 +"}, "a value is missing"),
        ({"value": "1", "tolerance": 0.5}, "tolerance"),
        ({"value": "1", "holds": "1"}, "contains no comparison"),
    ],
)
def test_a_fault_of_a_question_names_the_remedy(given: dict[str, Any], told: str) -> None:
    with pytest.raises(ValueError, match=r".") as caught:
        Ask.model_validate(given)
    assert told in str(caught.value)


def test_quantities_agree_with_what_is_written_of_them() -> None:
    scene = edit(
        load_scene("default"),
        {"sonar.beam": {"kind": "array", "length": 0.2}, "water.sound_speed": 1500.0, "sonar.frequency": 100e3},
    )
    wavelength = 0.015
    expected = {
        "altitude": 10.0,
        "sound_speed": 1500.0,
        "wavelength": wavelength,
        "bin_length": 0.05,
        "ping_spacing": 0.2,
        "fastest_ping_rate": 15.0,
        "first_return": 10.0,
        "swath": 2.0 * math.sqrt(50.0**2 - 10.0**2),
        "beam_width": math.degrees(0.886 * wavelength / 0.2),
        "near_field": 0.2**2 / wavelength,
        "across_resolution": 0.075,
    }
    for name, value in expected.items():
        assert QUANTITIES[name].compute(scene) == pytest.approx(value), name
    given = {
        ("slant_range", 30.0, 2.0): math.hypot(30.0, 8.0),
        ("ground_range", 26.0): 24.0,
        ("shadow_end", 30.0, 2.0): 1.25 * math.hypot(30.0, 8.0),
        ("along_resolution", 1.0): 0.2,
        ("along_resolution", 40.0): 40.0 * 0.886 * wavelength / 0.2,
        ("pings_on", 1.0, 1.0): 6.0,
        ("sin", 30.0): 0.5,
        ("cos", 60.0): 0.5,
        ("tan", 45.0): 1.0,
        ("arccos", 0.5): 60.0,
        ("sqrt", 9.0): 3.0,
        ("log10", 1000.0): 3.0,
    }
    for (name, *arguments), value in given.items():
        assert QUANTITIES[name].compute(scene, *arguments) == pytest.approx(value), name


def test_quantities_are_measured_in_a_record() -> None:
    scene = edit(load_scene("default"), {"sonar.bins": 50, "sonar.range": 50.0})
    intensity = np.full((2, 4, 50), 1e-6)
    intensity[..., :10] = intensity[..., 45:] = 0.0
    intensity[..., 20:25] = 1e-12
    record = xr.Dataset({"intensity": (("channel", "ping_time", "range_sample"), intensity)})
    measured = {
        ("first_return",): 10.0,
        ("last_return",): 45.0,
        ("level", 30.0, 40.0): -60.0,
        ("dark_share", 15.0, 25.0): 0.5,
        ("contrast", 30.0, 40.0): 0.0,
    }
    for (name, *arguments), value in measured.items():
        assert QUANTITIES[name].measure(scene, record, *arguments) == pytest.approx(value, abs=1e-9), name


def test_a_question_is_checked_against_simulated_records() -> None:
    lesson = parse_lesson(ASKING, "height")
    assert lesson.steps[0].ask.mistakes[0].because == "The sound comes in flatter."
    check_lesson(lesson)
    assert check_records(lesson) == 1


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ('"shadow_length(21', '"shadow_length(25', "in the simulated record"),
        ("> before(dark", "< before(dark", "does not hold in the simulated record"),
        ('value = "before(', 'value = "2.5 * before(', "agree within the tolerance"),
        ('targets.0.size.2)"\nunit', 'targets.0.radius)"\nunit', "is not a number in this scene"),
        ('"shadow_length(21, targets.0.size.2)"\nunit', '"level(20, 30)"\nunit', "is not a number in this scene"),
        ("[ask]", "[ask]\nchoice = 1", "ask.choice: unknown key"),
    ],
)
def test_a_question_that_the_scene_contradicts_is_found(
    old: str, new: str, told: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert old in ASKING
    file = tmp_path / "height.md"
    file.write_text(ASKING.replace(old, new, 1), encoding="utf-8", newline="")
    complaint = refused(capsys, "lesson", "check", str(file))
    assert "step 'Lower the sonar'" in complaint
    assert told in complaint


@pytest.mark.parametrize("name", bundled_lessons())
def test_records_agree_with_every_bundled_question(name: str, request: pytest.FixtureRequest) -> None:
    if not name.startswith("breaks-"):  # which speak of plans
        request.getfixturevalue("fixed_model")
    check_records(load_lesson(name))


def test_every_step_of_the_bundled_lessons_asks_first() -> None:
    assert all(step.ask is not None for lesson in load_lessons() for step in lesson.steps)


def test_the_page_to_hand_in() -> None:
    lesson = parse_lesson(ASKING, "height")
    began = datetime(2026, 3, 1, 9, 30)
    sheet = Worksheet(lesson, began, ended=began + timedelta(minutes=7))
    assert sheet.summary == "1 question: 1 not answered."
    verdict = judge(Ask.model_validate(NUMBER), 11.2, block(5.0).reader(block(10.0)))
    sheet.answers[0] = Answer("11.2", verdict, (("track.altitude", 5.0),))
    page = sheet.to_markdown({0: Path("height-1.png")})
    assert page.splitlines()[:5] == ["# Height", "", "Name:", "", "2026-03-01 09:30, 7 min. 1 question: 1 wrong."]
    for line in (
        "## 1. Lower the sonar",
        "How long?",
        "- **Answer**: 11.2",
        "- **Verdict**: Not quite: it is 14.1 m. A − h counts.",
        "- `track.altitude` = 5",
        "![Record after step 1](height-1.png)",
        "**Why**: L = h · R / (A − h).",
    ):
        assert line in page.splitlines()
    assert sheet.results() == ["Lower the sonar: wrong"]


def test_a_lesson_without_questions_in_advance_still_loads() -> None:
    text = ASKING[: ASKING.index("[ask]")] + ASKING[ASKING.index("```\n\nLook") :]
    lesson = parse_lesson(text, "height")
    assert lesson.steps[0].ask is None
    check_lesson(lesson)
    assert check_records(lesson) == 0
    with pytest.raises(SceneError, match="has no paragraph 'Question"):
        parse_lesson(text.replace("Question:", "Asked:"), "height")
