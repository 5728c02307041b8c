"""What a plan says: one entry a choice, with its reason, its error and its cost."""

from __future__ import annotations

import shutil
import textwrap
from dataclasses import dataclass, field
from typing import Any

WIDEST, NARROWEST = 120, 60  # characters of a table
ERROR, COST = 8, 10  # characters of its two last columns


@dataclass(frozen=True)
class PlanEntry:
    """One choice.

    Attributes
    ----------
    subject : str
        What it is about, and the name by which another choice is forced: "planes", "bending", "targets", ...
    choice : str
        What was chosen, in words.
    reason : str
        Why, with numbers.
    modelled : bool
        Whether it is modelled; if not, it is left out.
    error : float
        Share of the record by which this choice misses, as predicted.
    cost : float
        Seconds per ping, both sides on one thread, that it adds; of what is left out, what it would add.
    options : tuple of str
        What it can be forced to; none if there is no choice. Where they are numbers, others will do too.
    forced : bool
        Whether it was forced.
    """

    subject: str
    choice: str
    reason: str
    modelled: bool = True
    error: float = 0.0
    cost: float = 0.0
    options: tuple[str, ...] = ()
    forced: bool = False


@dataclass(frozen=True)
class Plan:
    """How a scene is simulated.

    Attributes
    ----------
    method : str
        Tracer: sweep, march or rays.
    settings : dict
        What it is called with.
    bent : bool
        Whether sound follows the water; if not, it is taken to go straight at the sonar's speed.
    every : int
        Of the relief's nodes along each axis, every so many are kept.
    bounces : int
        Mirror-like bounces followed.
    ways : frozenset of str
        Ways by the sea surface that are heard, by their names in the scene.
    targets : tuple of int
        Targets that are modelled, by their places in the scene.
    block : int
        Pings that are simulated at a time.
    entries : tuple of Entry
        Every choice.
    error : float
        Predicted error beyond 1.4 times the altitude, as a share of the record.
    cost : float
        Predicted seconds per ping, both sides on one thread.
    """

    method: str
    settings: dict[str, Any] = field(default_factory=dict)
    bent: bool = False
    every: int = 1
    bounces: int = 0
    ways: frozenset[str] = frozenset()
    targets: tuple[int, ...] = ()
    block: int = 64
    entries: tuple[PlanEntry, ...] = ()
    error: float = 0.0
    cost: float = 0.0

    @property
    def planes(self) -> int:
        """Planes across the beam; 1 where the method has none."""
        return int(self.settings.get("planes", 1))

    def entry(self, subject: str) -> PlanEntry | None:
        """Return the entry about a subject, if there is one."""
        return next((entry for entry in self.entries if entry.subject == subject), None)

    def lines(self) -> list[str]:
        """Return one line a choice: what is modelled, then what is left out."""
        return [
            f"{'' if entry.modelled else 'left out: '}{entry.choice}: {entry.reason}"
            for modelled in (True, False)
            for entry in self.entries
            if entry.modelled is modelled
        ]

    def table(self, width: int | None = None) -> str:
        """Return all entries as a table of plain text.

        Parameters
        ----------
        width : int, optional
            Characters of a line; those of the terminal when left out.
        """
        wide = min(max(width or shutil.get_terminal_size().columns, NARROWEST), WIDEST)
        rows: list[str] = []
        for title, modelled in (("Modelled", True), ("Left out", False)):
            entries = [entry for entry in self.entries if entry.modelled is modelled]
            if not entries:
                continue
            rows.append(f"{title:<{wide - ERROR - COST}}{'error':>{ERROR}}{'cost':>{COST}}")
            for entry in entries:
                rows += _row(entry, wide)
            rows.append("")
        rows.append(f"{'All together':<{wide - ERROR - COST}}{_share(self.error):>{ERROR}}{_time(self.cost):>{COST}}")
        rows += textwrap.wrap("per ping, both sides, one thread", wide, initial_indent="  ")
        return "\n".join(rows)


def _row(entry: PlanEntry, wide: int) -> list[str]:
    """Lines of one entry: choice, error and cost, and the reason beneath."""
    name = f"  {entry.choice}{' (forced)' if entry.forced else ''}"
    head = f"{name:<{wide - ERROR - COST}}{_share(entry.error):>{ERROR}}{_time(entry.cost):>{COST}}"
    return [head, *textwrap.wrap(entry.reason, wide, initial_indent="    ", subsequent_indent="    ")]


def _share(error: float) -> str:
    return "-" if error <= 0.0 else f"{100.0 * error:.2g} %"


def _time(seconds: float) -> str:
    return "-" if seconds <= 0.0 else f"{1e6 * seconds:.3g} µs"
