"""Descriptions of editable fields, without widgets: a number on a slider, a choice among names, a file."""

from __future__ import annotations

from dataclasses import dataclass

from insonify_viewer.state.quantities import format_quantity


@dataclass(frozen=True)
class NumberField:
    """A number with a slider, or without one if the field declares no slider range."""

    path: str  # dotted path of the field, as ``insonify.scene.edit`` takes it
    label: str  # texts to show
    tooltip: str
    unit: str
    indent: int  # nesting depth within the section
    value: float  # value that applies, also if the scene leaves the field open
    slider: tuple[float, float] | None  # (float, float) ends of the slider
    log: bool  # whether the slider is logarithmic
    integer: bool  # whether the number is an integer
    idle: str = ""  # why the number has no effect at present; empty if it has
    rare: bool = False  # whether few people change it, so that it is folded away
    name: str = ""  # full name, understood without the rows around it; empty if that is the label
    # (float or None, float or None) smallest and largest value that the scene accepts; None where there is no
    # bound.
    bounds: tuple[float | None, float | None] = (None, None)

    @property
    def about(self) -> str:
        """Tooltip with the unit and the range of the number."""
        return f"{self.tooltip} ({self.unit or 'no unit'}; {self._range()})"

    def _range(self) -> str:
        """Values that the scene accepts, or the ends of the slider where it accepts more."""
        low, high = (None if bound is None else format_quantity(bound, self.unit) for bound in self.bounds)
        if low is not None and high is not None:
            return f"{low} to {high}"
        if self.slider is not None:
            first, last = (format_quantity(end, self.unit) for end in self.slider)
            return f"slider from {first} to {last}"
        return f"from {low}" if low is not None else f"up to {high}" if high is not None else "any number"


@dataclass(frozen=True)
class ChoiceField:
    """A choice among names; `NumberField` explains the attributes."""

    path: str
    label: str
    tooltip: str
    indent: int
    value: str | int
    options: tuple[str | int, ...]  # values to choose from
    rare: bool = False
    name: str = ""
    meanings: tuple[str, ...] = ()  # what each of them is, in a sentence; empty where their names say it

    @property
    def about(self) -> str:
        """Tooltip with the meaning of the value."""
        meaning = self.meanings[self.options.index(self.value)] if self.meanings else ""
        return f"{self.tooltip}; {self.value}: {meaning}" if meaning else self.tooltip


@dataclass(frozen=True)
class FileField:
    """A file; `NumberField` explains the attributes."""

    path: str
    label: str
    tooltip: str
    indent: int
    value: str
    rare: bool = False
    name: str = ""


Parameter = NumberField | ChoiceField | FileField
