"""Entries of a plan that inform about the scene and leave no choice."""

import math
from collections.abc import Iterator

from insonify.packing.packed_scene import Model
from insonify.planning.choices.base import Case, Choice
from insonify.planning.plan_entries import PlanEntry
from insonify.tracers.base import find_tracer


class Remarks(Choice):
    """Entries without a choice: numerical precision, coherent speckle, motion of the fish and distance of pings."""

    subject, field, rank, offered = "remarks", "method", 10, ()

    def settings(self, case: Case, model: Model) -> tuple[str, ...]:
        """Return the tracer as it is chosen."""
        return (model.method,)

    def entries(self, case: Case, model: Model, error: float) -> Iterator[PlanEntry]:
        """Entry of the precision, and those of speckle, motion and pings if they concern the scene."""
        scene = case.scene
        rounding = find_tracer(model.method).rounding
        if rounding > 0.0:
            reason = "heights and strengths are rounded to 7 digits, times and sums to 16"
            yield PlanEntry("precision", "7 and 16 digits", reason, error=rounding)
        else:
            yield PlanEntry("precision", "16 digits", "rays are rounded to 16 digits")
        if scene.receiver.speckle.interferes:
            reason = "coherent speckle sums all scatterers in the beam, which takes most of the time"
            yield PlanEntry("speckle", "scatterers", reason, cost=case.seconds_of_waves(model))
        if scene.track.kinds:
            reason = "each ping has its own position and heading; the sonar does not move during a ping"
            yield PlanEntry("motion", ", ".join(scene.track.kinds), reason)
        apart = scene.track.speed / scene.sonar.ping_rate
        if not scene.sonar.beam.has_width:
            reason = f"{apart:.3g} m apart; a knife-edge beam misses anything between two pings"
            yield PlanEntry("pings", "pings", reason)
            return
        # At shorter range the beam is narrower than the distance between pings; nothing lies nearer than the bed.
        covered = apart / (2.0 * math.sin(case.packed.arrays.half_width))
        if covered > scene.altitude:
            nearer = f"up to {covered:.3g} m" if covered < scene.sonar.range else "at every range"
            reason = f"{apart:.3g} m apart, wider than the beam {nearer}, where a narrow target can be missed"
            yield PlanEntry("pings", "pings", reason)


CHOICES: tuple[Choice, ...] = (Remarks(),)
