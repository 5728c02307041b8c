"""Choices of the effects that are modelled: refraction, bounces, targets and paths by the sea surface."""

import math
from collections.abc import Iterator

from insonify.packing.packed_scene import SURFACE_ECHO, Model
from insonify.planning.choices.base import FEWEST_RAYS, NEGLIGIBLE, Case, Choice
from insonify.planning.plan_entries import PlanEntry, percent
from insonify.scene.water.surfaces import WAYS
from insonify.tracers.base import AUTO, find_tracer


class Bending(Choice):
    """Refraction of sound."""

    subject, field, rank = "bending", "bent", 5

    def settings(self, case: Case, model: Model) -> tuple[bool, ...]:
        """Straight rays, refracted ones or both; straight ones where the sound speed is the same everywhere."""
        wish = self.wish(case)
        if not case.packed.arrays.water.bent or (wish is None and case.straight_bound < NEGLIGIBLE):
            return (False,)
        return (False, True) if wish is None else (wish,)

    def error(self, case: Case, model: Model, cautious: bool = True) -> float:
        """Error of straight rays: the same pings by few planes, without paths by the surface."""
        if model.bent:
            return 0.0
        if case.straight_bound < NEGLIGIBLE:
            return case.straight_bound
        method = case.choose_tracer(Model(bent=True))
        bent = Model(method, case.few_planes, FEWEST_RAYS, bent=True, targets=case.targets)
        straight = bent._replace(bent=False, rays=0 if "planes" in find_tracer(method).fineness else FEWEST_RAYS)
        return case.probe.difference(straight, bent, cautious=cautious)

    def require(self, case: Case, model: Model) -> None:
        """Raise an error if refraction is combined with an effect computed along straight rays only."""
        if model.bent:
            case.check_refraction()

    def entries(self, case: Case, model: Model, error: float) -> Iterator[PlanEntry]:
        """Entry of refraction; none in water of constant sound speed."""
        if not case.packed.arrays.water.bent:
            return
        missed = self.error(case, model._replace(bent=False), cautious=False)
        by = find_tracer(model.method).refraction
        reason = f"straight rays are {percent(missed)} from refracted ones"
        reason = f"{reason} at most" if missed < NEGLIGIBLE else f"on {case.pings(model)} {reason}"
        reason = f"{by}; {reason}" if model.bent else reason
        yield self.switched(case, model, "refraction", reason, False, True, error)


class Bounces(Choice):
    """Specular reflection and transmission after the first echo."""

    subject, field, rank = "bounces", "bounces", 9

    def settings(self, case: Case, model: Model) -> tuple[int, ...]:
        """None, as many as the scene declares, or both; none over a level bed without targets."""
        declared, wish = case.scene.sonar.bounces, self.wish(case)
        if declared == 0 or (case.scene.seabed.relief.level and not case.scene.targets):
            return (0,)
        if wish is not None:
            return (declared if wish else 0,)
        return (0, declared) if case.requested == AUTO or find_tracer(case.requested).follows_bounces else (declared,)

    def error(self, case: Case, model: Model, cautious: bool = True) -> float:
        """Share of the later echoes in the same pings by single rays."""
        declared = case.scene.sonar.bounces
        if self.settings(case, model) == (0,) or model.bounces == declared:
            return 0.0
        plain = Model(case.choose_tracer(Model(bounces=declared)), rays=FEWEST_RAYS, targets=case.targets)
        return case.probe.difference(plain, plain._replace(bounces=declared), cautious=cautious)

    def entries(self, case: Case, model: Model, error: float) -> Iterator[PlanEntry]:
        """Entry of the bounces that a scene declares."""
        declared = case.scene.sonar.bounces
        if declared == 0:
            return
        reason = "specular reflection and transmission after the first echo"
        if self.settings(case, model) == (0,) and self.wish(case) is None:
            reason = "later echoes add nothing on a level bed without targets"
        elif model.bounces == 0:
            reason = f"on {case.pings(model)} later echoes are {percent(error)} of the record"
        yield self.switched(case, model, f"{declared} bounces", reason, 0, declared, error)


class Targets(Choice):
    """Targets within reach of the track."""

    subject, field, rank = "targets", "targets", 6
    within = True

    def settings(self, case: Case, model: Model) -> tuple[tuple[int, ...], ...]:
        """Those within reach unless forced otherwise; geometry decides."""
        wish = self.wish(case)
        modelled = self.within if wish is None else wish
        return (tuple(sorted((*model.targets, *(self._of(case) if modelled else ())))),)

    def _of(self, case: Case) -> tuple[int, ...]:
        return tuple(k for k in range(len(case.scene.targets)) if (k in case.near) == self.within)

    def entries(self, case: Case, model: Model, error: float) -> Iterator[PlanEntry]:
        """Entry of the targets within reach, or of those out of reach."""
        of = self._of(case)
        if not of:
            return
        modelled = set(of) <= set(model.targets)
        reason = "left out by the user"
        if not self.within:
            reason = "too far from the track for any ping"
        elif modelled:
            triangles = int(case.packed.arrays.mesh.target.size)
            reason = "within reach of the track" + (f", with {triangles:,} triangles" if triangles else "")
        off = tuple(k for k in model.targets if k not in of)
        on = tuple(sorted((*off, *of)))
        choice = f"{len(of)} target{'s' * (len(of) > 1)}{'' if self.within else ' out of reach'}"
        yield self.switched(case, model, choice, reason, off, on, error)


class FarTargets(Targets):
    """Targets out of reach of the track."""

    subject, rank, within = "far_targets", 7, False


class SurfacePath(Choice):
    """One path by the sea surface."""

    field, rank = "ways", 8

    def __init__(self, way: str) -> None:
        self.subject = way  # type: ignore[misc]

    def settings(self, case: Case, model: Model) -> tuple[frozenset[str], ...]:
        """Without it, with it or both; without it if no echo arrives within the range."""
        wish, off = self.wish(case), model.ways - {self.subject}
        if self.subject not in case.paths:
            return (off,)
        if self.subject == SURFACE_ECHO and wish is None:
            return (off | {self.subject},)  # it takes no time
        return (off, off | {self.subject}) if wish is None else (off | {self.subject},)

    def error(self, case: Case, model: Model, cautious: bool = True) -> float:
        """Share of its echoes in the record, in the same pings by the least planes."""
        if self.subject in model.ways or self.subject not in case.paths:
            return 0.0
        whole = Model(planes=case.least_planes, targets=case.targets, ways=case.paths)
        without = whole._replace(ways=case.paths - {self.subject})
        share = case.probe.difference(without, whole, cautious=cautious)
        return share * math.sqrt(len(case.paths - model.ways))  # energies add up, errors are summed by squares

    def kept(self, case: Case, model: Model, last: Model) -> frozenset[str]:
        """Return the model's other paths, with this one if another model has it and the scene admits it."""
        values = self.settings(case, model)
        return values[0] if len(values) == 1 or self.subject not in last.ways else values[1]

    def entries(self, case: Case, model: Model, error: float) -> Iterator[PlanEntry]:
        """Entry of the path, if the scene has it."""
        if self.subject not in case.first_echoes:
            return
        surface, on = case.scene.water.surface, model.ways | {self.subject}
        reason = "from image sources above the surface; objects higher than the sonar do not block the path"
        if self.subject in model.ways and surface.rms_height > 0.0:
            slope = math.degrees(math.sqrt(surface.slope_variance))
            reason = (
                f"from image sources above the surface; waves of {surface.rms_height:.2g} m rms and slopes of "
                f"{slope:.2g}° rms spread the echo in range"
            )
        elif self.subject not in model.ways:
            first, reach = case.first_echoes[self.subject], case.scene.sonar.range
            reason = f"its first echo arrives at {first:.3g} m, beyond the range of {reach:g} m"
            if self.subject in case.forced:
                reason = "left out by the user"
            elif self.subject in case.audible:
                reason = f"on {case.pings(model)} {percent(error)} of the record"
        choice = f"{surface.kind} sea, {self.subject.replace('_', '-')}"
        yield self.switched(case, model, choice, reason, model.ways - {self.subject}, on, error)


# Effects that may err too little to matter beside others.
SMALL_EFFECTS: tuple[Choice, ...] = (Bending(), *(SurfacePath(way) for way in WAYS))
CHOICES: tuple[Choice, ...] = (Bounces(), Targets(), FarTargets(), *SMALL_EFFECTS)
