"""Predicted errors of a scene's modelling choices."""

from __future__ import annotations

import math
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from insonify.acoustics.beam_patterns import is_patterned
from insonify.acoustics.straightness import estimate_refraction
from insonify.planning import fitted_laws
from insonify.planning.bed_errors import BedEcho, predict_bed_echo
from insonify.planning.candidates import Candidate
from insonify.planning.multipath_errors import MultipathErrors
from insonify.planning.plane_count import (
    PlaneErrors,
    TargetDemand,
    interpolate_over_counts,
    predict_ray_error,
    predict_target_demand,
)
from insonify.planning.relevance import bound_echo_advance, find_multipaths_in_reach, find_targets_in_reach
from insonify.planning.scene_summary import SceneSummary
from insonify.scene import Scene
from insonify.scene.surfaces import WAYS

Field = NDArray[np.float64]


class PredictedErrors:
    """Predicted errors of a scene's modelling choices, as shares of the record beyond 1.4 altitudes.

    Parameters
    ----------
    scene : Scene
    view : SceneSummary
        Lengths of the scene.
    silent : frozenset of str
        Multipaths by the sea surface that the user leaves out.

    Raises
    ------
    SceneError
        If a file that the scene names cannot be read.
    """

    def __init__(self, scene: Scene, view: SceneSummary, silent: frozenset[str] = frozenset()) -> None:
        self._scene, self._view, self._silent = scene, view, silent
        self.bending = estimate_refraction(scene)
        self.targets = find_targets_in_reach(scene)
        self.far_targets = tuple(k for k in range(len(scene.targets)) if k not in self.targets)
        self.ways = find_multipaths_in_reach(scene)
        self._planes: dict[frozenset[str], PlaneErrors] = {}
        self._thinned: dict[tuple[int, frozenset[str]], Field] = {}

    @cached_property
    def echo(self) -> BedEcho:
        """Spectrum of the bed's echo."""
        return predict_bed_echo(self._view, self._scene.seabed, self._scene.track.heading)

    @cached_property
    def heard(self) -> frozenset[str]:
        """Multipaths by the sea surface whose echoes may arrive within the range."""
        scene = self._scene
        late = {way: first for way, first in self.ways.items() if first > scene.sonar.range}
        sooner = bound_echo_advance(scene, self.echo.rms_height) if late else {}
        heard = (way for way in self.ways if way not in late or late[way] - sooner[way] <= scene.sonar.range)
        return frozenset(heard) - self._silent

    @cached_property
    def ghosts(self) -> MultipathErrors:
        """Levels and errors of the multipaths that arrive within the range, without the surface's own echo."""
        ways = [way for way in WAYS if way in self.heard and way != "surface_echo"]
        return MultipathErrors(self._scene, self._view, ways, self.echo.steepness if ways else 0.0)

    @cached_property
    def demand(self) -> TargetDemand:
        """Error of a single plane across the targets in reach."""
        if not self._scene.sonar.beam.has_width or not self.targets:
            return TargetDemand(0.0)
        return predict_target_demand(self._scene, self._view, self.targets, self.echo.square)

    def planes(self, ways: frozenset[str]) -> PlaneErrors:
        """Errors by number of planes where the given multipaths are modelled."""
        if ways not in self._planes:
            bed = np.zeros(len(fitted_laws.COUNTS))
            if self._scene.sonar.beam.has_width:
                bed = self.echo.of_planes()
                if self._louder(ways):
                    bed = np.hypot(self.ghosts.direct * bed, self.ghosts.of_planes())
            if self._scene.receiver.speckle.interferes:
                bed[0] = 1.0  # each scatterer has its own place within the beam
            most = fitted_laws.MOST_OF_PATTERNS if is_patterned(self._scene) else fitted_laws.MOST_PLANES
            self._planes[ways] = PlaneErrors(bed, self.demand, most)
        return self._planes[ways]

    def _louder(self, ways: frozenset[str]) -> bool:
        """Tell whether echoes of bed or targets arrive by any of the given multipaths."""
        return bool((ways & self.heard) - {"surface_echo"})

    @cached_property
    def straight(self) -> float:
        """Error of straight rays in water that refracts sound."""
        if self.bending.most == 0.0:
            return 0.0
        error = self.echo.of_shift(self.bending)
        if self._scene.targets:
            error = math.hypot(error, min(self.bending.shift / self._view.bin_length, 1.0))
        return min(error, 1.0)

    def thinned(self, every: int, ways: frozenset[str]) -> Field:
        """Error of keeping every n-th node of the relief, for each plane count in ``fitted_laws.COUNTS``."""
        if (every, ways) not in self._thinned:
            error = self.echo.of_thinning(every)
            if every > 1 and self.targets:
                # Targets rest on the thinned bed, whose height errors displace their echoes.
                error = np.hypot(error, fitted_laws.TARGETS_LOST * self.echo.height_lost(every) / self._view.bin_length)
            if every > 1 and self._louder(ways):
                error = np.hypot(error, self.ghosts.of_cells(every * self._view.spacing, self.echo.height_lost(every)))
            self._thinned[every, ways] = error
        return self._thinned[every, ways]

    @cached_property
    def bounced(self) -> float:
        """Error of leaving out echoes after the first one; 0 for a level bed without targets."""
        scene = self._scene
        if scene.seabed.relief.level and not scene.targets:
            return 0.0
        material = scene.seabed.material
        of = [*material.materials, *(target.material for target in scene.targets)]
        return min(fitted_laws.BOUNCED * max(one.reflectivity.reflection for one in of) ** 2, 1.0)

    def tracer(self, draft: Candidate) -> float:
        """Error of the tracer itself with any number of planes, or of single rays by their number."""
        if draft.method == "rays":
            return predict_ray_error(self._scene, draft.rays)
        if draft.method == "march":
            return fitted_laws.MARCH * (draft.step / self._view.spacing) ** fitted_laws.MARCH_ORDER
        return fitted_laws.SWEEP_TARGETS if draft.targets else fitted_laws.SWEEP

    def left_out(self, draft: Candidate) -> dict[str, float]:
        """Errors of the effects that a candidate leaves out, by subject."""
        return {
            "bending": 0.0 if draft.bent else self.straight,
            "spacing": interpolate_over_counts(self.thinned(draft.every, draft.ways), draft.planes),
            "ways": self._unheard(draft.ways),
            "bounces": self.bounced if draft.bounces < self._scene.sonar.bounces else 0.0,
        }

    def _unheard(self, ways: frozenset[str]) -> float:
        """Error of leaving out all multipaths but the given ones."""
        missed = self.heard - ways - {"surface_echo"}
        return min(sum(self.ghosts.shares[way] for way in missed), 1.0) if missed else 0.0

    def wary(self, draft: Candidate) -> float:
        """Error of a candidate, with margins for the spread between scenes."""
        margins = {"spacing": fitted_laws.MARGIN_OF_NODES, "ways": fitted_laws.MARGIN_OF_WAYS}
        parts = [margins.get(subject, fitted_laws.MARGIN) * error for subject, error in self.left_out(draft).items()]
        if draft.method == "sweep":
            parts.append(self.planes(draft.ways).wary(draft.planes) if draft.planes in fitted_laws.COUNTS else 0.0)
        return math.hypot(*parts)
