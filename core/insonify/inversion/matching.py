"""Match of a simulated record to a recorded one: simulate, measure, and correct the parameters of the bed."""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from insonify.inversion.bed_parameters import USUAL_SPEED, BedParameters, PowerLaw, set_bed, variance_of_looks
from insonify.inversion.footprint import footprint_of
from insonify.inversion.recorded_sonar import RecordedSonar
from insonify.inversion.roughness_fit import PowerLawFit, RoughnessFit, fit_roughness
from insonify.inversion.segment_spectra import SegmentSpectra, SoundedBed, measure_segment_spectra, sound_bed
from insonify.scene import Scene
from insonify.scene.edit import edit
from insonify.simulation import simulate

Pairs = tuple[tuple[float, float], ...]
# Slant ranges in altitudes between which levels are compared: mirror lobes do not reach as far, and slopes of the bed,
# which change the level by cot θ times the slope, have little effect.
FROM, TO = 1.5, 2.2
GAIN_KNOTS = 24  # of a table of gains
MOST_GAIN = 190.0  # dB, of a gain or the level of a beam
# Share of the difference by which each simulation corrects the parameters: first those of an even bed, then once more
# if patches of material are added; the last steps average over simulations.
FIRST_STEPS, STEPS = (1.0, 1.0), (1.0, 1.0 / 2.0, 1.0 / 3.0, 1.0 / 4.0)
MOST_SIMULATIONS = 2 * len(FIRST_STEPS) + len(STEPS) + 1  # the last one is compared with the record
SPECKLE_STEP = 0.5  # the same for speckle, which comes in steps of whole looks
LARGEST_STEP = 2.0  # of a logarithm of a level
EXPONENTS = (0.1, 3.0)
SIGNIFICANT, PATCHIER = 20.0, 3.0  # gain of log likelihood that patches must bring, also over that of an even bed
UNDETERMINED = 0.7  # standard error of ln A from which there is no relief that rises above the speckle
FIRST_DIFFUSE = 0.19  # of medium sand, of the first candidate
MOST_PINGS = 1024  # of a simulation
EVERY_NODE = {"spacing": "1"}  # nodes left out would make the relief smoother


@dataclass(frozen=True)
class Candidate:
    """Bed, speckle, gains and vertical beam of a scene to try."""

    bed: BedParameters
    gains: Pairs | None  # time-varied gain, where that of the sonar is unknown
    # Vertical beam, where that of the sonar is unknown and its altitude changes enough to show it.
    vertical: Pairs | None

    def set_on(self, scene: Scene) -> Scene:
        """Give the bed, the speckle, the gains and the vertical beam to a scene."""
        changes: dict[str, Any] = {}
        if self.gains is not None:
            changes["receiver.tvg"] = {"kind": "table", "by": "bin", "gains": [list(pair) for pair in self.gains]}
        if self.vertical is not None:
            levels = [list(pair) for pair in self.vertical]
            changes["sonar.vertical"] = {"kind": "table", "tilt": 0.0, "levels": levels}
        return edit(set_bed(scene, self.bed), changes)


class Matching:
    """Search for the bed with a simulated record of the same fit and level as a recorded one."""

    def __init__(
        self,
        scene: Scene,
        sonar: RecordedSonar,
        recorded: SoundedBed,
        spectra: SegmentSpectra,
        progress: Callable[[float], None],
    ) -> None:
        self._progress, self._left = progress, MOST_SIMULATIONS
        self._scene, self._sonar, self._recorded, self._spectra = scene, sonar, recorded, spectra
        self._footprint = footprint_of(scene, speed_of_sound(scene))
        self._number = 0  # of simulations

    def match(self) -> tuple[Candidate, RoughnessFit]:
        """Return the bed that matches, and the fit of the record itself."""
        fit = fit_roughness(self._spectra, self._footprint)
        candidate, simulated = self._refine(self._first(fit), fit, FIRST_STEPS)
        patchy = fit_roughness(self._spectra, self._footprint, patches=True, near=fit)
        if patchy.patches is not None and self._has_patches(fit.cost - patchy.cost, simulated):
            bed = replace(candidate.bed, patches=PowerLaw(*patchy.patches[:2]))
            candidate, fit = replace(candidate, bed=bed), patchy
            candidate, _ = self._refine(candidate, fit, FIRST_STEPS)
        self._left = len(STEPS) + 1
        return self._refine(candidate, fit, STEPS)[0], fit

    def _first(self, fit: RoughnessFit) -> Candidate:
        """First candidate: the record's own fit."""
        relief = None
        if fit.relief.log_level_error < UNDETERMINED:
            relief = PowerLaw(fit.relief.log_level, float(np.clip(fit.relief.exponent, *EXPONENTS)))
        speckle = min(fit.speckle, variance_of_looks(1))
        unknown = not self._sonar.simulated
        shows = unknown and bool(self._recorded.level.by_angle.any())
        even: Pairs = ((0.0, 0.0),)
        bed = BedParameters(relief, None, speckle, FIRST_DIFFUSE, mirrors=not unknown)
        return Candidate(bed, even if unknown else None, even if shows else None)

    def _refine(
        self, candidate: Candidate, target: RoughnessFit, steps: tuple[float, ...]
    ) -> tuple[Candidate, SegmentSpectra]:
        """Correct a candidate by simulations with seeds of their own; return also the last one's spectra."""
        for step in steps:
            self._number += 1
            self._progress(1.0 - self._left / MOST_SIMULATIONS)
            self._left -= 1
            simulated = self._simulate(candidate, self._number)
            spectra = measure_segment_spectra(simulated)
            found = fit_roughness(spectra, self._footprint, patches=target.patches is not None, near=target)
            candidate = self._leveled(candidate, simulated, step)
            candidate = replace(candidate, bed=_correct(candidate.bed, target, found, step))
        return candidate, spectra

    def _simulate(self, candidate: Candidate, number: int) -> SoundedBed:
        """Simulate a candidate with the seed of that number, over a whole period of its bed where the track allows."""
        scene = edit(candidate.set_on(self._scene), {"seed": self._scene.seed + number})
        if self._sonar.navigation is None:
            advance = scene.track.speed / scene.sonar.ping_rate
            whole = math.ceil(getattr(scene.seabed.relief, "period", 0.0) / advance)
            scene = edit(scene, {"track.pings": min(max(scene.track.pings, whole), max(scene.track.pings, MOST_PINGS))})
        record = simulate(scene, forced=EVERY_NODE)
        as_recorded = not self._sonar.simulated and self._sonar.navigation is not None
        altitude = self._sonar.altitude if as_recorded else record["platform_altitude"].values
        return sound_bed(record, altitude, separate=not self._sonar.simulated)

    def _leveled(self, candidate: Candidate, simulated: SoundedBed, step: float) -> Candidate:
        """Candidate at the record's level: by its material where gains are known, else by gains and vertical beam."""
        if candidate.gains is None:
            return replace(candidate, bed=candidate.bed.scaled(step * level_difference(self._recorded, simulated)))
        vertical = candidate.vertical
        if vertical is not None:
            vertical = correct_beam(vertical, self._recorded, simulated, self._scene.sonar.beam.passes)
        gains = correct_gains(candidate.gains, self._recorded, simulated)
        return replace(candidate, gains=gains, vertical=vertical)

    def _has_patches(self, gain: float, simulated: SegmentSpectra) -> bool:
        """Whether patches of material improve the fit far more than they improve the fit of an even bed."""
        if gain < SIGNIFICANT:
            return False
        even = fit_roughness(simulated, self._footprint)
        patchy = fit_roughness(simulated, self._footprint, patches=True, near=even)
        return gain > PATCHIER * (even.cost - patchy.cost)


def speed_of_sound(scene: Scene) -> float:
    """Sound speed of the water at the sonar, in m/s."""
    return float(scene.water.only_speed or USUAL_SPEED)


def _correct(bed: BedParameters, target: RoughnessFit, found: RoughnessFit, step: float) -> BedParameters:
    """Correct parameters by a share of the difference between the target and the fit of their own record."""
    patches = bed.patches
    if patches is not None and target.patches is not None and found.patches is not None:
        patches = _moved(patches, target.patches, found.patches, step)
    return replace(
        bed,
        relief=None if bed.relief is None else _moved(bed.relief, target.relief, found.relief, step),
        patches=patches,
        speckle=max(bed.speckle + SPECKLE_STEP * (target.speckle - found.speckle), 0.0),
    )


def _moved(law: PowerLaw, target: PowerLawFit, found: PowerLawFit, step: float) -> PowerLaw:
    """Power law moved by a share of a difference, within bounds."""
    change = float(np.clip(target.log_level - found.log_level, -LARGEST_STEP, LARGEST_STEP))
    exponent = law.exponent + step * (target.exponent - found.exponent)
    return PowerLaw(law.log_level + step * change, float(np.clip(exponent, *EXPONENTS)))


def level_difference(recorded: SoundedBed, simulated: SoundedBed) -> float:
    """Level of a recorded bed over a simulated one, in dB: the median from 1.5 to 2.2 altitudes of slant range."""
    altitude, r = float(recorded.altitude.mean()), recorded.slant_range
    near = (r >= min(FROM * altitude, 0.9 * float(r[-1]))) & (r <= TO * altitude)
    return float(np.median(_ratio(recorded, simulated)[near]))


def correct_gains(gains: Pairs, recorded: SoundedBed, simulated: SoundedBed) -> Pairs:
    """Gains in dB by bin, changed until a simulated record has the level of a recorded one at every slant range."""
    ratio = _ratio(recorded, simulated)
    first = int(np.searchsorted(recorded.slant_range, recorded.altitude.min()))
    places = np.unique(np.linspace(min(first, ratio.size - 1), ratio.size - 1, GAIN_KNOTS).astype(np.int64))
    return _added(gains, places.astype(np.float64), ratio[places])


def correct_beam(levels: Pairs, recorded: SoundedBed, simulated: SoundedBed, passes: int) -> Pairs:
    """One-way levels in dB of a vertical beam by the angle below the horizontal, corrected in the same way."""
    angles = recorded.level.angles
    own = np.interp(angles, simulated.level.angles, simulated.level.by_angle)
    return _added(levels, angles, (recorded.level.by_angle - own) / passes)


def _added(pairs: Pairs, places: NDArray[np.float64], more: NDArray[np.float64]) -> Pairs:
    """Piecewise linear table plus values at places."""
    levels = np.clip(more + np.interp(places, *np.array(pairs).T), -MOST_GAIN, MOST_GAIN)
    return tuple((round(float(place), 4), round(float(level), 3)) for place, level in zip(places, levels))


def _ratio(recorded: SoundedBed, simulated: SoundedBed) -> NDArray[np.float64]:
    """Return the recorded over the simulated level at every slant range, in dB."""
    return recorded.level.by_range - simulated.level.by_range
