"""How a scene is modelled: the tolerance of its plan, and the choices that are forced."""

from __future__ import annotations

from dataclasses import dataclass, replace

USUAL = 0.03  # share of the record
# While a slider moves, one plane or few rays stand for the beam, which is 17 % of the record wrong for a fan of 1°.
# Finer methods would add nothing to that.
OF_FINENESS = ("method", "planes", "rays", "step")


@dataclass(frozen=True)
class Modelling:
    """The tolerance of a plan, and its forced choices."""

    tolerance: float = USUAL  # greatest error beyond 1.4 altitudes, as a share of the record
    # Subject and choice of the plan's entries that are forced; each subject at most once.
    forced: tuple[tuple[str, str], ...] = ()

    def forcing(self, subject: str, choice: str | None) -> Modelling:
        """Return a copy in which the choice of a subject is forced, or with None left to the plan again."""
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
        """The coarse modelling that replaces it while a slider moves."""
        kept = tuple(pair for pair in self.forced if pair[0] not in OF_FINENESS)
        return replace(self, forced=(*kept, ("planes", "1"), ("rays", "1000")))
