"""Conditions of lessons: what they mean, what they refuse, and that nothing of them runs as code."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from insonify.errors import SceneError
from insonify.lessons.conditions import Reader, parse_condition, parse_expression

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
def test_conditions_mean_what_they_say(text: str, expected: bool) -> None:
    assert parse_condition(text).holds(VALUES.get) is expected


def doubled(name: str, arguments: tuple[float, ...]) -> float | None:
    return {"slant_range": sum(arguments), "altitude": 7.0}.get(name)


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
def test_expressions_call_quantities_and_read_values_before_the_move(text: str, expected: float | None) -> None:
    before = Reader({"sonar.range": 20.0}.get)
    assert parse_expression(text).number(Reader(VALUES.get, doubled, before)) == expected
    assert parse_condition(f"{text} == 1 or 1 == 1").holds(Reader(VALUES.get, doubled, before)) is (
        expected is not None
    )


@pytest.mark.parametrize(
    ("text", "told"),
    [
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
    ],
)
def test_a_fault_of_an_expression_is_one_sentence(text: str, told: str) -> None:
    with pytest.raises(SceneError) as caught:
        parse_expression(text)
    assert told in str(caught.value)


def test_the_fields_are_told_once_each() -> None:
    condition = parse_condition("sonar.range > 1 and (sonar.bins < 3 or sonar.range < true)")
    assert condition.fields == ("sonar.range", "sonar.bins")


@pytest.mark.parametrize(
    ("text", "told"),
    [
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
    ],
)
def test_a_fault_is_one_sentence(text: str, told: str) -> None:
    with pytest.raises(SceneError, match="condition") as caught:
        parse_condition(text)
    assert told in str(caught.value)
    assert "\n" not in str(caught.value)


@given(st.text(alphabet="ab.1 0()<>=!+-*/'\"andortu_e", max_size=60))
def test_any_text_is_a_condition_or_a_fault(text: str) -> None:
    try:
        condition = parse_condition(text)
    except SceneError:
        return
    assert condition.holds({"a": 1.0, "b": "a"}.get) in (True, False)
