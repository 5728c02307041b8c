"""Questions that a step asks first: choices or a number, and the verdict on an answer."""

import hashlib
import re
from dataclasses import dataclass
from enum import Enum
from typing import Annotated, Self

from pydantic import AfterValidator, Field, model_validator

from insonify.lessons.conditions import Reader, parse_condition, parse_expression
from insonify.scene.base import Declaration

NEARLY = 3.0  # tolerances within which a number is close
UNKNOWN = "I don't know"
_NUMBER = re.compile(r"\s*([-+−]?(?:\d+[.,]?\d*|[.,]\d+)(?:[eE][-+]?\d+)?)")

Words = Annotated[str, AfterValidator(lambda text: " ".join(text.split()))]  # may be written on several lines
ExpressionText = Annotated[Words, AfterValidator(lambda text: text and parse_expression(text).text)]
ConditionText = Annotated[Words, AfterValidator(lambda text: text and parse_condition(text).text)]


class Choice(Declaration):
    """One of the answers to choose from; a wrong one names the misconception behind it."""

    text: Words = Field(min_length=1, max_length=200)
    right: bool = False
    because: Words = Field(default="", max_length=500)


class Mistake(Declaration):
    """A number that follows from a misconception."""

    value: ExpressionText = Field(min_length=1)
    because: Words = Field(min_length=1, max_length=500)


class Ask(Declaration):
    """What a step asks before it shows what to look for: choices, or a number with its unit and tolerance."""

    choices: tuple[Choice, ...] = Field(default=(), max_length=4)
    value: ExpressionText = ""
    unit: str = ""
    tolerance: float = Field(default=0.05, gt=0.0, le=0.3)
    mistakes: tuple[Mistake, ...] = ()
    measured: ExpressionText = ""  # the number as the record shows it
    holds: ConditionText = ""

    @model_validator(mode="after")
    def _asks_for_one_thing(self) -> Self:
        if bool(self.choices) == bool(self.value):
            raise ValueError("asks for choices and for a number, or for neither; give choices, or value and unit")
        if self.choices and sum(choice.right for choice in self.choices) != 1:
            raise ValueError("needs exactly one right choice among two to four; mark it by right = true")
        if self.choices and len(self.choices) < 2:
            raise ValueError("has one choice; give two to four")
        if len({choice.text for choice in self.choices}) < len(self.choices):
            raise ValueError("has two choices of the same text; word them differently")
        for choice in self.choices:
            if not (choice.right or choice.because):
                raise ValueError(f"choice {choice.text!r} is wrong without a reason; name the misconception by because")
        if self.choices and (self.mistakes or self.unit or self.measured):
            raise ValueError("gives a unit, mistakes or what is measured beside choices; they belong to a number")
        return self

    def in_unit(self, number: float) -> str:
        """Write a number to three digits, with the unit."""
        return f"{float(f'{number:.3g}'):g} {self.unit}".strip()


class Grade(Enum):
    """How good an answer is."""

    RIGHT = "right"
    CLOSE = "close"
    WRONG = "wrong"
    UNKNOWN = "not known"


@dataclass(frozen=True)
class Verdict:
    """How good an answer is, the right one, and the reason."""

    grade: Grade
    right: str  # the right answer, with its unit
    because: Words = ""  # the misconception, or how far off a number is

    @property
    def words(self) -> str:
        """One or two sentences."""
        start = {
            Grade.RIGHT: f"Right: {self.right}.",
            Grade.CLOSE: f"Close: it is {self.right}.",
            Grade.WRONG: f"Not quite. Answer: {self.right}.",
            Grade.UNKNOWN: f"Answer: {self.right}.",
        }[self.grade]
        return f"{start} {self.because}".strip()


def order_choices(question: str, ask: Ask, run: str) -> list[int]:
    """Places of the choices in the order of the screen: the same within a run, unlike that of other runs."""

    def order(place: int) -> bytes:
        return hashlib.sha256("\0".join([run, question, ask.choices[place].text]).encode()).digest()

    return sorted(range(len(ask.choices)), key=order)


def read_number(text: str) -> float | None:
    """Return the number at the start of a text, with a point or a comma; None if there is none."""
    match = _NUMBER.match(text)
    return float(match[1].replace(",", ".").replace("−", "-")) if match else None


def judge(ask: Ask, answer: int | float | None, reader: Reader) -> Verdict | None:
    """Judge the place of a choice, a number, or None for "I don't know"; None if the scene lacks the right number."""
    if not ask.choices:
        return _judge_number(ask, answer, reader)
    right = next(choice for choice in ask.choices if choice.right)
    if answer is None:
        return Verdict(Grade.UNKNOWN, right.text)
    chosen = ask.choices[int(answer)]
    return Verdict(Grade.RIGHT if chosen.right else Grade.WRONG, right.text, chosen.because)


def _judge_number(ask: Ask, answer: float | None, reader: Reader) -> Verdict | None:
    expected = parse_expression(ask.value).number(reader)
    if expected is None:
        return None
    right = ask.in_unit(expected)
    if answer is None:
        return Verdict(Grade.UNKNOWN, right)
    if _agrees(answer, expected, ask.tolerance):
        return Verdict(Grade.RIGHT, right)
    for mistake in ask.mistakes:
        mistaken = parse_expression(mistake.value).number(reader)
        if mistaken is not None and _agrees(answer, mistaken, ask.tolerance):
            return Verdict(Grade.WRONG, right, mistake.because)
    if _agrees(answer, expected, NEARLY * ask.tolerance):
        off = 100.0 * abs(answer / expected - 1.0)
        return Verdict(Grade.CLOSE, right, f"Yours is {off:.2g} % too {'large' if answer > expected else 'small'}.")
    return Verdict(Grade.WRONG, right)


def _agrees(answer: float, expected: float, tolerance: float) -> bool:
    return abs(answer - expected) <= tolerance * abs(expected)
