"""Predicted errors of everything that a plan may choose, for one scene."""

from __future__ import annotations

import math
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from insonify.plan import laws
from insonify.plan.across import Planes, among_counts, error_of_rays, target_demand
from insonify.plan.bed_errors import Echo, echo_of
from insonify.plan.drafts import Draft
from insonify.plan.reach import targets_in_reach, ways_in_reach
from insonify.plan.view import View
from insonify.scene import Scene
from insonify.scene.materials import Material
from insonify.scene.reliefs import Flat
from insonify.scene.sonar import Knife
from insonify.sound.beams import is_patterned
from insonify.sound.straightness import bending_of

Field = NDArray[np.float64]


class Errors:
    """Errors by choice, as shares of the record beyond 1.4 altitudes.

    Parameters
    ----------
    scene : Scene
    view : View
        Its lengths.

    Raises
    ------
    SceneError
        If a file that the scene names cannot be read.
    """

    def __init__(self, scene: Scene, view: View) -> None:
        self._scene, self._view = scene, view
        self.bending = bending_of(scene)
        self.targets = targets_in_reach(scene)
        self.far_targets = tuple(k for k in range(len(scene.targets)) if k not in self.targets)
        self.ways = ways_in_reach(scene)
        self._thinned = {1: np.zeros(len(laws.COUNTS))}

    @cached_property
    def echo(self) -> Echo:
        """Spectrum of the bed's echo."""
        return echo_of(self._view, self._scene.seabed, self._scene.track.heading)

    @cached_property
    def planes(self) -> Planes:
        """Errors of planes."""
        if isinstance(self._scene.sonar.beam, Knife):
            return Planes(np.zeros(len(laws.COUNTS)), 0.0)
        bed = self.echo.of_planes()
        most = laws.MOST_OF_PATTERNS if is_patterned(self._scene) else laws.MOST_PLANES
        return Planes(bed, target_demand(self._scene, self._view, self.targets), most)

    @cached_property
    def straight(self) -> float:
        """Error of sound taken to go straight."""
        if self.bending.most == 0.0:
            return 0.0
        error = self.echo.of_shift(self.bending)
        if self._scene.targets:
            error = math.hypot(error, min(self.bending.shift / self._view.bin_length, 1.0))
        return min(error, 1.0)

    def thinned(self, every: int) -> Field:
        """Error of a bed of every so many nodes, by each of ``laws.COUNTS`` planes."""
        if every not in self._thinned:
            self._thinned[every] = self.echo.of_thinning(every)
        return self._thinned[every]

    @cached_property
    def bounced(self) -> float:
        """Error of leaving out what goes on after the first echo; none where nothing is there to be met again."""
        scene = self._scene
        if isinstance(scene.seabed.relief, Flat) and not scene.targets:
            return 0.0
        material = scene.seabed.material
        of = [*((material,) if isinstance(material, Material) else material.of), *(t.material for t in scene.targets)]
        return min(laws.BOUNCED * max(one.reflectivity.reflection for one in of) ** 2, 1.0)

    def tracer(self, draft: Draft) -> float:
        """Error of the tracer itself, however many planes it has; of single rays by their number."""
        if draft.method == "rays":
            return error_of_rays(self._scene, draft.rays)
        if draft.method == "march":
            return laws.MARCH * (draft.step / self._view.spacing) ** laws.MARCH_ORDER
        return laws.SWEEP_TARGETS if draft.targets else laws.SWEEP

    def left_out(self, draft: Draft) -> dict[str, float]:
        """Error of what a draft leaves out, by subject."""
        return {
            "bending": 0.0 if draft.bent else self.straight,
            "spacing": among_counts(self.thinned(draft.every), draft.planes),
            "bounces": self.bounced if draft.bounces < self._scene.sonar.bounces else 0.0,
        }

    def wary(self, draft: Draft) -> float:
        """Error of all that a draft chooses, with the margin by which a scene may differ from the others."""
        parts = [
            (laws.MARGIN_OF_NODES if subject == "spacing" else laws.MARGIN) * error
            for subject, error in self.left_out(draft).items()
        ]
        if draft.method == "sweep":
            parts.append(self.planes.wary(draft.planes) if draft.planes in laws.COUNTS else 0.0)
        return math.hypot(*parts)
