"""Choices of a plan that a user can force, and their bounds."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import NamedTuple

from insonify.scene import SceneError
from insonify.scene.surfaces import WAYS

METHODS = ("auto", "sweep", "march", "rays")
SWITCH = ("on", "off")


class _Number(NamedTuple):
    """Number that a user can force: its bounds, whether it is an integer, and values to offer."""

    low: float
    high: float
    whole: bool
    offered: tuple[str, ...]


NUMBERS = {
    "planes": _Number(1, 512, True, ("2", "4", "8", "16", "32", "64")),
    "rays": _Number(1, 1 << 22, True, ("1000", "4000", "16000", "64000")),
    "step": _Number(1e-6, 1e4, False, ("0.02", "0.05", "0.1", "0.2", "0.5")),
    "spacing": _Number(1, 64, True, ("1", "2", "4", "8")),
}
SWITCHES = ("bending", "bounces", "targets", "far_targets", *WAYS)
SUBJECTS = ("method", *NUMBERS, *SWITCHES)


class Overrides:
    """Choices that a user forces on a plan, checked against their bounds.

    Parameters
    ----------
    choices : mapping of str to str
        Choices by subject. A choice on a subject for which the scene has no alternatives has no effect.

    Raises
    ------
    SceneError
        If a subject or a choice is not known.
    """

    def __init__(self, choices: Mapping[str, str]) -> None:
        for subject, choice in choices.items():
            _check(subject, choice)
        self._choices = dict(choices)

    def __contains__(self, subject: str) -> bool:
        return subject in self._choices

    def method(self) -> str:
        """Return the forced method, or "auto"."""
        return self._choices.get("method", "auto")

    def number(self, subject: str) -> float | None:
        """Return the forced number of a subject, None where it is not forced."""
        return float(self._choices[subject]) if subject in self._choices else None

    def switch(self, subject: str) -> bool | None:
        """Return the forced state of a switch, None where it is not forced."""
        return self._choices[subject] == "on" if subject in self._choices else None


def _check(subject: str, choice: str) -> None:
    if subject not in SUBJECTS:
        raise SceneError(f"model: {subject!r} is no choice of a plan; choose one of {', '.join(SUBJECTS)}")
    if subject in NUMBERS:
        _check_number(subject, choice)
        return
    known = METHODS if subject == "method" else SWITCH
    if choice not in known:
        raise SceneError(f"{_name(subject)}: {choice!r} is not known; choose one of {', '.join(known)}")


def _check_number(subject: str, choice: str) -> None:
    bounds = NUMBERS[subject]
    try:
        number = float(choice)
    except ValueError:
        number = math.nan
    if not bounds.low <= number <= bounds.high or (bounds.whole and number != int(number)):
        whole = "a whole number" if bounds.whole else "a number"
        raise SceneError(
            f"{_name(subject)}: {choice!r} will not do; give {whole} from {bounds.low:g} to {bounds.high:g}"
        )


def _name(subject: str) -> str:
    return subject if subject == "method" else f"model {subject}"
