"""Fields as a person edits them: a number on a slider, a choice among names, a file. No widgets."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Number:
    """A number with a slider, or without one where the field declares no useful range.

    Attributes
    ----------
    path : str
        Dotted path of the field, as ``insonify.scene.edit`` takes it.
    label, tooltip, unit : str
        What is printed.
    indent : int
        Depth below the section.
    value : float
        Value that applies, also where the scene leaves it open.
    slider : (float, float) or None
        Ends of the slider.
    log : bool
        Whether the slider moves in equal ratios.
    integer : bool
        Whether only whole numbers fit.
    idle : str
        Why it changes nothing at present, empty if it does.
    """

    path: str
    label: str
    tooltip: str
    unit: str
    indent: int
    value: float
    slider: tuple[float, float] | None
    log: bool
    integer: bool
    idle: str = ""


@dataclass(frozen=True)
class Choice:
    """One of several names; see `Number` for what the fields mean."""

    path: str
    label: str
    tooltip: str
    indent: int
    value: str | int
    options: tuple[str | int, ...]


@dataclass(frozen=True)
class File:
    """The name of a file; see `Number` for what the fields mean."""

    path: str
    label: str
    tooltip: str
    indent: int
    value: str


Parameter = Number | Choice | File
