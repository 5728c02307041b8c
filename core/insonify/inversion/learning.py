"""Bed from a record: a scene with a similar simulated record, found by simulation, and compared with the record."""

import math
import tempfile
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from insonify.arrays import Floats
from insonify.inversion.bed_parameters import (
    USUAL_SPEED,
    BedParameters,
    PowerLaw,
    set_bed,
    slope_above,
    variance_of_looks,
)
from insonify.inversion.footprint import footprint_of
from insonify.inversion.recorded_sonar import RecordedSonar, declare_sonar
from insonify.inversion.roughness_fit import (
    FINEST,
    PowerLawFit,
    RoughnessFit,
    estimate_beam,
    estimate_pulse,
    fit_roughness,
)
from insonify.inversion.segment_spectra import SegmentSpectra, SoundedBed, measure_segment_spectra, sound_bed
from insonify.io.atomic import replacing, write_text
from insonify.scene import Scene, scene_to_toml
from insonify.scene.edit import edit
from insonify.simulation import simulate
from insonify.statistics.record_statistics import RecordStatistics, measure_statistics

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
MATCHED, DIFFERS, TAKEN, ESTIMATED, UNKNOWN = "matched", "differs", "as recorded", "estimated", "not in the record"
LONGEST = 2048  # pings, from the middle of a longer record
DESCRIPTION = (
    "Relief, material and speckle are learned from a record. The landscape is another one of the same statistics, and "
    "targets are left out: place your own. Change the seed for another bed of this kind."
)
Navigation = Mapping[str, Floats]


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
            angles, wanted = self._recorded.level.angles, self._recorded.level.by_angle
            own = np.interp(angles, simulated.level.angles, simulated.level.by_angle)
            vertical = _added(vertical, angles, (wanted - own) / self._scene.sonar.beam.passes)
        # Gains by bin, with which the record has the level of the recorded one at every slant range.
        ratio = _ratio(self._recorded, simulated)
        first = int(np.searchsorted(self._recorded.slant_range, self._recorded.altitude.min()))
        places = np.unique(np.linspace(min(first, ratio.size - 1), ratio.size - 1, GAIN_KNOTS).astype(np.int64))
        gains = _added(candidate.gains, places.astype(np.float64), ratio[places])
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


def _added(pairs: Pairs, places: Floats, more: Floats) -> Pairs:
    """Piecewise linear table plus values at places."""
    levels = np.clip(more + np.interp(places, *np.array(pairs).T), -MOST_GAIN, MOST_GAIN)
    return tuple((round(float(place), 4), round(float(level), 3)) for place, level in zip(places, levels))


def _ratio(recorded: SoundedBed, simulated: SoundedBed) -> Floats:
    """Return the recorded over the simulated level at every slant range, in dB."""
    return recorded.level.by_range - simulated.level.by_range


class Finding(NamedTuple):
    """One line of the report."""

    quantity: str  # name of the quantity
    recorded: str  # its values; empty if unknown
    simulated: str
    verdict: str  # ``matched``, ``differs``, ``as recorded``, ``estimated`` or ``not in the record``


@dataclass(frozen=True)
class Learned:
    """A scene learned from a record, and the comparison of both records."""

    scene: Scene  # on a straight, level track
    findings: tuple[Finding, ...]  # quantities that match, that differ, and that the record does not show
    # Time, x, y, altitude and heading of a track that is not straight and level.
    navigation: Navigation | None = None

    def lines(self) -> list[str]:
        """Lay out the findings as lines of a table with a heading."""
        rows = [("", "record", "scene", ""), *self.findings]
        widths = [max(len(row[column]) for row in rows) for column in range(3)]
        return ["  ".join([*(text.ljust(width) for text, width in zip(row, widths)), row[3]]).rstrip() for row in rows]

    def summarise(self) -> str:
        """Summarise in one clause how the record of the scene compares with the recording."""
        differing = [found.quantity for found in self.findings if found.verdict == DIFFERS]
        return f"differs from the recording in: {', '.join(differing)}" if differing else "matches the recording"

    def write(self, path: str | Path) -> list[Path]:
        """Write the scene as TOML, and its track as CSV beside it where that is not straight; return the files."""
        path, scene = Path(path), self.scene
        written = [path]
        if self.navigation is not None:
            beside = path.with_name(f"{path.stem}-track.csv")
            with replacing(beside) as unfinished:
                scene = _on_track(scene, self.navigation, unfinished, beside.name)
            written.append(beside)
        write_text(path, scene_to_toml(scene))
        return written


def learn(
    record: xr.Dataset,
    changes: Mapping[str, Any] | None = None,
    *,
    progress: Callable[[float], None] | None = None,
) -> Learned:
    """Learn a scene from a record.

    Sonar and track are those that the record declares. Relief, material, speckle and level are fitted. Then the scene
    is simulated, the same fit is made of its record, and the difference corrects the parameters (indirect inference:
    Gouriéroux, Monfort and Renault 1993).

    Parameters
    ----------
    record : Dataset
        From ``records.read_record`` or `simulate`.
    changes : mapping of str to object, optional
        Fields of the scene by dotted path that the record does not contain, such as ``{"sonar.beam.width": 0.5}``.
    progress : callable, optional
        Called now and then with the share done, from 0 to 1; may raise to stop.

    Returns
    -------
    Learned

    Raises
    ------
    SceneError
        If the record shows too little bed, or a field is given that is learned.
    """
    first = max(record.sizes["ping_time"] - LONGEST, 0) // 2
    record = record.isel(ping_time=slice(first, first + LONGEST))  # the middle of a long record
    sonar = declare_sonar(record, changes or {})
    bed = sound_bed(record, sonar.altitude, separate=not sonar.simulated)
    spectra = measure_segment_spectra(bed)
    sonar = _estimate_sonar(sonar, bed, spectra)
    scene = sonar.scene
    with tempfile.TemporaryDirectory() as folder:
        if sonar.navigation is not None:
            track = Path(folder) / "track.csv"
            scene = _on_track(scene, sonar.navigation, track, str(track))
        candidate, fit = Matching(scene, sonar, bed, spectra, progress or (lambda share: None)).match()
        own = simulate(candidate.set_on(scene))
    title = f"Learned from {str(record.attrs.get('title', '')) or 'a record'}"[:200]
    learned = edit(candidate.set_on(sonar.scene), {"title": title, "description": DESCRIPTION})
    return Learned(learned, report_findings(record, own, sonar, learned, fit), sonar.navigation)


def _estimate_sonar(sonar: RecordedSonar, bed: SoundedBed, spectra: SegmentSpectra) -> RecordedSonar:
    """Estimate pulse and beam from the record where nothing declares them."""
    scene, speed = sonar.scene, speed_of_sound(sonar.scene)
    if "sonar.pulse" in sonar.assumed:
        scene = edit(scene, {"sonar.pulse": estimate_pulse(spectra, bed.bin_length, speed)})
    if "sonar.beam" in sonar.assumed:
        scene = edit(scene, {"sonar.beam.width": estimate_beam(spectra, scene, speed)})
    return sonar._replace(scene=scene)


def _on_track(scene: Scene, navigation: Navigation, file: Path, path: str) -> Scene:
    """Write a track as CSV, and return the scene towed along it by the path of the finished file."""
    table = np.column_stack(list(navigation.values()))
    np.savetxt(file, table, fmt="%.6g", delimiter=",", header=",".join(navigation), comments="")
    return edit(scene, {"track.motion": {"kind": "recorded", "path": path}})


def report_findings(
    record: xr.Dataset, own: xr.Dataset, sonar: RecordedSonar, scene: Scene, fit: RoughnessFit
) -> tuple[Finding, ...]:
    """Compare a record with the simulated record of the scene learned from it."""
    return (
        *_geometry(record, sonar, scene),
        *_sonar(sonar, scene),
        *_bed(record, own, sonar, scene, fit),
        *_statistics(measure_statistics(record), measure_statistics(own)),
        Finding("targets", "", "none", UNKNOWN),
    )


def _geometry(record: xr.Dataset, sonar: RecordedSonar, scene: Scene) -> Iterator[Finding]:
    """Altitude, track and range, which the scene copies."""
    low, mean, high = (float(value(sonar.altitude)) for value in (np.min, np.mean, np.max))
    kept = f"{scene.altitude:.1f} m" if sonar.navigation is None else f"{low:.1f} to {high:.1f} m"
    yield Finding("altitude", f"{mean:.1f} m ({low:.1f} to {high:.1f})", kept, TAKEN)
    pings, spacing = record.sizes["ping_time"], scene.track.speed / scene.sonar.ping_rate
    shape = "straight" if sonar.navigation is None else "as recorded"
    yield Finding("track", f"{pings} pings", f"{pings} pings {spacing:.3g} m apart, {shape}", TAKEN)
    reach = f"{scene.sonar.range:.4g} m in {scene.sonar.bins} bins"
    yield Finding("range", reach, reach, TAKEN)


def _sonar(sonar: RecordedSonar, scene: Scene) -> Iterator[Finding]:
    """Beam, pulse and frequency: declared, estimated or assumed."""
    pulse = scene.sonar.pulse
    lasts = f" of {1e6 * pulse.length:.3g} µs" if pulse.length > 0.0 else ""
    declared = {
        "frequency": (f"{scene.sonar.frequency / 1e3:.4g} kHz", UNKNOWN),
        "beam": (scene.sonar.beam.words, ESTIMATED),
        "pulse": (f"{pulse.kind}{lasts}", ESTIMATED),
    }
    for name, (text, otherwise) in declared.items():
        verdict = otherwise if f"sonar.{name}" in sonar.assumed else TAKEN
        yield Finding(name, text if verdict == TAKEN else "", text, verdict)


def _bed(
    record: xr.Dataset, own: xr.Dataset, sonar: RecordedSonar, scene: Scene, fit: RoughnessFit
) -> Iterator[Finding]:
    """Relief, patches, speckle and level."""
    footprint = footprint_of(scene, speed_of_sound(scene))
    altitude = own["platform_altitude"].values if sonar.simulated else sonar.altitude
    separate = not sonar.simulated
    recorded = sound_bed(record, sonar.altitude, separate=separate)
    simulated = sound_bed(own, altitude, separate=separate)
    patches = fit.patches is not None
    again = fit_roughness(measure_segment_spectra(simulated), footprint, patches=patches, near=fit)
    yield from _relief(fit, again, scene, FINEST * footprint.cell)
    yield _compare("speckle, variance of amplitude", fit.speckle, again.speckle, 0.15 * fit.speckle + 0.01, ".3f")
    difference = level_difference(recorded, simulated)
    if sonar.simulated:
        yield Finding("material level", "0.0 dB", f"{-difference:+.1f} dB", _verdict(difference, 0.0, 1.0))
    else:
        yield Finding("material level", "", scene.seabed.material.materials[0].name, UNKNOWN)
        yield Finding("level over range", "0.0 dB", f"{-difference:+.1f} dB", _verdict(difference, 0.0, 1.0))


def _relief(fit: RoughnessFit, again: RoughnessFit, scene: Scene, shortest: float) -> Iterator[Finding]:
    """Exponent and strength of the relief as both records show them, and the slope of the learned bed."""
    if fit.relief.log_level_error >= UNDETERMINED:
        yield Finding("relief", "none above the speckle", "flat", UNKNOWN)
        return
    one, other = fit.relief, again.relief
    error = f" ± {one.exponent_error:.2f}"
    verdict = _verdict(one.exponent, other.exponent, 0.15)
    yield Finding("relief, exponent as it shows", f"{one.exponent:.2f}{error}", f"{other.exponent:.2f}", verdict)
    ratio = float(np.exp(0.5 * (other.log_level - one.log_level)))
    yield Finding("relief, height as it shows", "1.00", f"{ratio:.2f}", _verdict(ratio, 1.0, 0.2))
    text = f"{getattr(scene.seabed.relief, 'beta', 0.0):.2f}; {slope_above(scene, shortest):.3f}"
    yield Finding(f"relief, exponent and slope above {shortest:.2g} m", "", text, ESTIMATED)


def _statistics(one: RecordStatistics, other: RecordStatistics) -> Iterator[Finding]:
    """Statistics that `insonify compare` measures."""
    middle, own = (float(np.median(each.variation)) for each in (one, other))
    yield _compare("variation in even patches", middle, own, 0.15 * middle + 0.01, ".2f")
    yield _compare("spectral slope along track", one.along.slope(), other.along.slope(), 0.15, ".2f")
    yield _compare("spectral slope across", one.across.slope(), other.across.slope(), 0.15, ".2f")
    depths = [one.shadow_depth, other.shadow_depth]
    shown = tuple("none" if np.isnan(depth) else f"{depth:.0f} dB" for depth in depths)
    alike = np.isnan(depths).all() or abs(depths[0] - depths[1]) <= 3.0
    yield Finding("shadows", shown[0], shown[1], MATCHED if alike else DIFFERS)


def _compare(quantity: str, one: float, other: float, tolerance: float, form: str) -> Finding:
    """Compare two numbers that may differ by a tolerance."""
    return Finding(quantity, f"{one:{form}}", f"{other:{form}}", _verdict(one, other, tolerance))


def _verdict(one: float, other: float, tolerance: float) -> str:
    return MATCHED if abs(one - other) <= tolerance else DIFFERS
