"""Entries of a plan that inform about the scene and leave no choice."""

import math
from collections.abc import Iterator

from insonify.packing.packed_scene import Model
from insonify.planning.choices.base import Case, Choice
from insonify.planning.plan_entries import PlanEntry
from insonify.tracers.base import find_tracer


class Remark(Choice):
    """An entry without a choice."""

    field = "method"
    offered = ()

    def settings(self, case: Case, model: Model) -> tuple[str, ...]:
        """Return the tracer as it is chosen."""
        return (model.method,)


class Precision(Remark):
    """Numerical precision of the tracer."""

    subject, rank = "precision", 10

    def entries(self, case: Case, model: Model, error: float) -> Iterator[PlanEntry]:
        """Entry of the precision."""
        rounding = find_tracer(model.method).rounding
        if rounding > 0.0:
            reason = "heights and strengths are rounded to 7 digits, times and sums to 16"
            yield self.entry(case, "7 and 16 digits", reason, error=rounding)
        else:
            yield self.entry(case, "16 digits", "rays are rounded to 16 digits")


class Speckle(Remark):
    """Coherent speckle."""

    subject, rank = "speckle", 11

    def entries(self, case: Case, model: Model, error: float) -> Iterator[PlanEntry]:
        """Entry of coherent speckle, if the scene has it."""
        if case.scene.receiver.speckle.interferes:
            reason = "coherent speckle sums all scatterers in the beam, which takes most of the time"
            yield self.entry(case, "scatterers", reason, cost=case.seconds_of_waves(model))


class Motion(Remark):
    """Motion of the fish."""

    subject, rank = "motion", 12

    def entries(self, case: Case, model: Model, error: float) -> Iterator[PlanEntry]:
        """Entry of the motions, if the track has any."""
        if case.scene.track.kinds:
            reason = "each ping has its own position and heading; the sonar does not move during a ping"
            yield self.entry(case, ", ".join(case.scene.track.kinds), reason)


class Pings(Remark):
    """Distance between pings."""

    subject, rank = "pings", 13

    def entries(self, case: Case, model: Model, error: float) -> Iterator[PlanEntry]:
        """Entry of pings farther apart than the beam is wide at the nearest bed."""
        scene = case.scene
        apart = scene.track.speed / scene.sonar.ping_rate
        if not scene.sonar.beam.has_width:
            reason = f"{apart:.3g} m apart; a knife-edge beam misses anything between two pings"
            yield self.entry(case, "pings", reason)
            return
        # At shorter range the beam is narrower than the distance between pings; nothing lies nearer than the bed.
        covered = apart / (2.0 * math.sin(case.packed.arrays.half_width))
        if covered > scene.altitude:
            nearer = f"up to {covered:.3g} m" if covered < scene.sonar.range else "at every range"
            reason = f"{apart:.3g} m apart, wider than the beam {nearer}, where a narrow target can be missed"
            yield self.entry(case, "pings", reason)


CHOICES: tuple[Choice, ...] = (Precision(), Speckle(), Motion(), Pings())
