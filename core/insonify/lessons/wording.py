"""Texts of a lesson with numbers computed from its scene: ``{altitude()} m``, with decimals ``{altitude():2} m``."""

import hashlib
import re
from typing import Any

from insonify.errors import SceneError
from insonify.lessons.conditions import Reader, parse_expression
from insonify.lessons.lesson import Lesson, Step
from insonify.lessons.questions import Ask
from insonify.lessons.states import named, states_of

BLANK = re.compile(r"\{([^{}]*?)(?::(\d))?\}")  # an expression, and its decimals
TEXTS = ("text", "look_for", "question", "answer")  # of a step; they read its state after the move


def fill_in(lesson: Lesson, run: str = "") -> Lesson:
    """Return a lesson with the values that a run draws, and with its texts written out."""
    lesson = lesson.model_copy(update={"set": lesson.set | _draws(lesson, run)})
    states = list(states_of(lesson))
    with named(lesson):
        introduction = write_out(lesson.introduction, states[0][1].reader())
    steps = tuple(_written(lesson, step, end.reader(start)) for step, start, end in states)
    return lesson.model_copy(update={"introduction": introduction, "steps": steps})


def write_out(text: str, reader: Reader) -> str:
    """Return a text with the values of its expressions: a field as it is, others to three digits if not to decimals."""

    def value(blank: re.Match[str]) -> str:
        expression = parse_expression(blank[1])
        found = expression.value(reader)
        if found is None or isinstance(found, bool):
            raise SceneError(f"text: {blank[0]} has no value in this scene; correct the expression")
        if isinstance(found, str):
            return found.replace("_", " ")
        digits = 6 if expression.names == (expression.text,) else 3  # of a field as it is, and of what is computed
        number = f"{found:.{blank[2]}f}" if blank[2] else f"{float(f'{found:.{digits}g}'):.12f}".rstrip("0").rstrip(".")
        whole, point, decimals = number.partition(".")
        return ((f"{int(whole):,}" if len(whole) > 4 else whole) + point + decimals).replace("-", "−")

    return BLANK.sub(value, text)


def _written(lesson: Lesson, step: Step, reader: Reader) -> Step:
    """Return a step with its texts written out."""
    with named(lesson, step):
        texts: dict[str, Any] = {name: write_out(getattr(step, name), reader) for name in TEXTS}
        return step.model_copy(update=texts | {"ask": step.ask and _asked(step.ask, reader)})


def _asked(ask: Ask, reader: Reader) -> Ask:
    """Return a question with the texts of its choices and mistakes written out."""
    choices = tuple(
        each.model_copy(update={"text": write_out(each.text, reader), "because": write_out(each.because, reader)})
        for each in ask.choices
    )
    mistakes = tuple(each.model_copy(update={"because": write_out(each.because, reader)}) for each in ask.mistakes)
    return ask.model_copy(update={"choices": choices, "mistakes": mistakes})


def _draws(lesson: Lesson, run: str) -> dict[str, float]:
    """Values of the fields that a lesson draws, to three digits; the same within a run."""
    drawn = {}
    for path, (least, greatest) in lesson.draw.items():
        digest = hashlib.sha256("\0".join([run, lesson.name, path]).encode()).digest()
        share = int.from_bytes(digest[:8], "big") / 2**64
        drawn[path] = float(f"{least + share * (greatest - least):.3g}")
    return drawn
