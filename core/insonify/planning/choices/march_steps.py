"""Choice of the step of the march."""

from __future__ import annotations

import math
from collections.abc import Iterator

from insonify.packing.packed_scene import Model
from insonify.planning.choices.base import FINENESS, Case, Choice, Number, percent
from insonify.planning.plan_entries import PlanEntry


class Step(Number):
    """Steps of the march, with rays as dense."""

    subject, field, stage, rank, whole = "step", "step", FINENESS, 3, False
    low, high = 1e-6, 1e4
    offered = ("0.02", "0.05", "0.1", "0.2", "0.5", "1", "2")

    def settings(self, case: Case, model: Model) -> tuple[float, ...]:
        """Return steps of a cell, its half, a quarter and so on."""
        if model.method != "march":
            return (0.0,)
        wish, spacing = self.wish(case), case.packed.arrays.bed.spacing
        return tuple(spacing / 2**n for n in range(7)) if wish is None else (wish,)

    def pair(self, case: Case, model: Model, step: float) -> tuple[Model, Model]:
        """March of a step, and that of half the step and twice the rays by which it is judged."""
        plain = Model("march", bent=case.bent, bounces=model.bounces, targets=case.targets, ways=case.paths)
        return plain._replace(step=step, rays=model.rays), plain._replace(step=0.5 * step, rays=2 * model.rays)

    def measured_step(self, case: Case, model: Model) -> float:
        """Step that is measured: a model's, doubled until the probe affords to judge it, no longer than the range."""
        step, longest = model.step, case.scene.sonar.range
        while 2.0 * step <= longest and not case.probe.affords(self.pair(case, model, step)[1]):
            step *= 2.0
        return step

    def error(self, case: Case, model: Model, cautious: bool = True) -> float:
        """Error measured from half the step; a shorter one's falls on with the power, of 0 to 1, with which it fell.

        The power is 0 where the number of rays alone keeps the error from falling.
        """
        if model.method != "march":
            return 0.0
        step = self.measured_step(case, model)
        error = case.probe.difference(*self.pair(case, model, step), cautious=cautious)
        if step == model.step or error == 0.0:
            return error
        before = case.probe.difference(*self.pair(case, model, 2.0 * step), cautious=cautious)
        return float(error * (model.step / step) ** min(max(math.log2(max(before / error, 1.0)), 0.0), 1.0))

    def entries(self, case: Case, model: Model, error: float) -> Iterator[PlanEntry]:
        """Entry of the step."""
        if model.method == "march":
            step = self.measured_step(case, model)
            reason = f"on {case.pings(self.pair(case, model, step)[1])} steps of {step:.3g} m are "
            reason += f"{percent(case.probe.difference(*self.pair(case, model, step)))} from half the step and twice"
            reason += " the rays"
            reason += f", so {model.step:.3g} m about {percent(error)}" if step > model.step else ""
            reason = f"{model.rays} rays per side; {reason}; the march can step over anything thinner than a step"
            yield self.entry(case, f"steps of {model.step:.3g} m", reason, error=error, options=self.offered)


CHOICES: tuple[Choice, ...] = (Step(),)
