"""Plan of a simulation: one entry per choice, with its reason, error and cost."""

from dataclasses import dataclass, field
from typing import Any

from insonify.cards import make_card, quote_text
from insonify.packing.packed_scene import Model
from insonify.tracers.base import find_tracer
from insonify.tracers.plane_counts import Goal


@dataclass(frozen=True)
class PlanEntry:
    """One choice of a plan."""

    subject: str  # subject of the choice, by which another choice is forced: "planes", "bending", "targets", ..
    choice: str  # choice in words
    reason: str  # reason with numbers
    modelled: bool = True  # whether the effect is modelled or left out
    error: float = 0.0  # error due to this choice, measured on a few pings, as a share of the record
    # Seconds per ping that it adds on this machine, both sides on one thread; for an effect left out, that it
    # would add.
    cost: float = field(default=0.0, compare=False)
    # Choices that can be forced; none if there is no choice. Other numbers than those listed are accepted.
    options: tuple[str, ...] = ()
    forced: bool = False  # whether the user forced it


@dataclass(frozen=True)
class Plan:
    """Model with which a scene is simulated."""

    model: Model  # tracer, settings and effects
    entries: tuple[PlanEntry, ...] = ()  # all choices
    error: float = 0.0  # measured error, as a share of the record
    left_out: float = 0.0  # the same but for that of planes, which each ping estimates itself
    goal: Goal | None = None  # error of its planes with which the tracing of a ping ends; None for the same planes
    work: float = 0.0  # work of a ping, by which models are compared: a count, the same on every machine
    cost: float = field(default=0.0, compare=False)  # seconds per ping on this machine, both sides on one thread

    @property
    def near_error(self) -> float:
        """Measured error over all bins from the first return: the tolerance holds there as well."""
        return self.error

    @property
    def method(self) -> str:
        """Name of the tracer."""
        return self.model.method

    @property
    def settings(self) -> dict[str, Any]:
        """Arguments of the tracer."""
        return find_tracer(self.method).settings(self.model)

    @property
    def label_settings(self) -> dict[str, Any]:
        """Planes and rays by which bins are labelled, which the sweep does for every tracer."""
        return {name: number for name, number in self.settings.items() if name in ("planes", "across", "rays")}

    @property
    def planes(self) -> int:
        """Number of planes across the beam; 1 where the method has none."""
        return self.model.planes

    def entry(self, subject: str) -> PlanEntry | None:
        """Return the entry about a subject, if there is one."""
        return next((entry for entry in self.entries if entry.subject == subject), None)

    def describe_excess(self, tolerance: float) -> str:
        """Return a sentence about an error beyond a tolerance."""
        most = max(self.entries, key=lambda entry: entry.error)
        return (
            f"the estimated error of the record is {percent(self.error)}, more than the tolerance of "
            f"{percent(tolerance)}, most of it from '{most.choice}'; raise the tolerance or choose a simpler scene"
        )

    def lines(self) -> list[str]:
        """Return one line per choice: first what is modelled, then what is left out."""
        return [
            f"{'' if entry.modelled else 'left out: '}{entry.choice}: {entry.reason}"
            for modelled in (True, False)
            for entry in self.entries
            if entry.modelled is modelled
        ]

    def _repr_html_(self) -> str:
        """Describe the plan in a notebook."""
        facts = [("method", self.method), ("estimated error", percent(self.error))]
        return make_card("Plan", facts, quote_text("\n".join(self.lines())))


def percent(error: float) -> str:
    """Write an error in percent."""
    return f"{float(f'{100.0 * error:.2g}'):g} %"


def counted(number: int, noun: str) -> str:
    """Write a number of things: "1 plane", "2 planes"."""
    return f"{number} {noun}{'s' * (number != 1)}"
