"""How a scene is to be modelled: what a plan may miss, and the choices that are not left to it."""

from __future__ import annotations

from dataclasses import dataclass, replace

USUAL = 0.03  # share of the record
# While a slider moves, the beam's own detail along the track is left out, by which a fan of 1° misses 17 % of the
# record, and so is what a finer method would find.
COARSE = 0.2
OF_FINENESS = ("method", "planes", "rays", "step")


@dataclass(frozen=True)
class Modelling:
    """What a plan is asked for.

    Attributes
    ----------
    tolerance : float
        Greatest error beyond 1.4 altitudes, as a share of the record.
    forced : tuple of (str, str)
        Choices that are forced, by the subjects of the plan's entries, each at most once.
    """

    tolerance: float = USUAL
    forced: tuple[tuple[str, str], ...] = ()

    def forcing(self, subject: str, choice: str | None) -> Modelling:
        """Return a copy in which a choice is forced, or left to the plan again."""
        others = tuple(pair for pair in self.forced if pair[0] != subject)
        return replace(self, forced=others if choice is None else (*others, (subject, choice)))

    def tolerating(self, tolerance: float) -> Modelling:
        """Return a copy with another tolerance."""
        return replace(self, tolerance=tolerance)

    @property
    def automatic(self) -> Modelling:
        """A copy in which every choice is left to the plan."""
        return replace(self, forced=())

    @property
    def coarse(self) -> Modelling:
        """What stands for it while a slider moves."""
        kept = tuple(pair for pair in self.forced if pair[0] not in OF_FINENESS)
        return Modelling(max(self.tolerance, COARSE), (*kept, ("planes", "1")))
