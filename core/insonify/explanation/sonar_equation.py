"""Sonar equation of a scene, term by term over slant range: echoes of its bed and of a target against noise.

The bed is level and of the scene's materials, at the altitude of the first ping; rays are straight. Echoes are means
without speckle. Levels are in dB re 1 µPa with a source level, else re the source at 1 m (Urick 1983, ch. 2; Lurton
2010, ch. 6). Theory: docs/theory/speckle.md.
"""

import csv
import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np

from insonify.acoustics.pulses import spread_curve
from insonify.acoustics.resolution_cell import axial_response, bin_centres, vertical_at
from insonify.acoustics.water import absorption_coefficient
from insonify.arrays import Floats
from insonify.explanation.pixel import Term
from insonify.io.atomic import replacing
from insonify.kernels.common.range_bins import mean_over_centre
from insonify.packing.packed_scene import pack
from insonify.packing.scene_arrays import range_factor
from insonify.receiver.levels import time_varied_gain
from insonify.receiver.reception import prepare_setup
from insonify.receiver.stage import ReceiverSetup
from insonify.receiver.water_column import reverberation_curves
from insonify.scene import Scene, SceneError
from insonify.scene.seabed.materials.sediments import scattering_strength
from insonify.scene.water.absorptions import NEPER_PER_DB

FARTHER = 16  # ranges of the record up to which the end of detection is sought
MOST_BINS = 400_000  # in which it is sought
SILENCE = -math.inf


@dataclass(frozen=True, eq=False)
class Level:
    """A level over slant range as the sum of its terms."""

    name: str
    terms: dict[str, Floats]  # (n,) each, dB

    @cached_property
    def decibels(self) -> Floats:
        """The sum, (n,)."""
        return np.asarray(sum(self.terms.values()))


@dataclass(frozen=True, eq=False)
class SonarEquation:
    """Levels of a scene's echoes and noise in its record before the time-varied gain."""

    scene: Scene
    slant_range: Floats  # (n,) of the bins' centres, m
    grazing: Floats  # (n,) at the bed, rad
    energy: float  # of the pulse at 1 m, dB re 1 µPa² s or relative
    bed: Level
    target: Level  # on the axis of the beam, where the bed is
    disturbances: tuple[Level, ...]  # noise and reverberation, those that are declared
    gain: Floats  # (n,) time-varied gain, dB

    @cached_property
    def disturbance(self) -> Floats:
        """Level of noise and reverberation together, (n,); minus infinity without either."""
        silence = np.full(self.slant_range.size, SILENCE)
        return add_levels(silence, *(each.decibels for each in self.disturbances))

    @cached_property
    def record(self) -> Floats:
        """Mean level of the record of a level bed, (n,)."""
        return add_levels(self.bed.decibels, self.disturbance) + self.gain

    def bin_at(self, slant_range: float) -> int:
        """Bin that contains a slant range of the record in metres, at most the last one."""
        return min(int(slant_range / self.scene.sonar.range * self.scene.sonar.bins), self.slant_range.size - 1)

    def farthest(self, level: Level) -> float:
        """Slant range in metres up to which a level exceeds noise and reverberation, infinity if it does everywhere."""
        above = np.flatnonzero(level.decibels > self.disturbance)
        if above.size == 0:
            return 0.0
        return math.inf if above[-1] == self.slant_range.size - 1 else float(self.slant_range[above[-1]])

    def table(self, slant_range: float) -> Iterator[tuple[Term, bool]]:
        """Yield the terms at a slant range, each with whether it is the sum of those before it."""
        k = self.bin_at(slant_range)
        for level in (self.bed, *self.disturbances):
            yield from _rows(level, k)
        bed, target, disturbance = (
            float(each[k]) for each in (self.bed.decibels, self.target.decibels, self.disturbance)
        )
        yield from _rows(self.target, k)
        yield Term("target over the bed", target - bed), True
        if self.disturbances:
            yield Term("bed over noise", bed - disturbance, "and reverberation"), True
            yield Term("target over noise", target - disturbance, "and reverberation"), True
        yield Term("time-varied gain", float(self.gain[k])), False
        yield Term("record of the bed", float(self.record[k]), "with noise and reverberation"), True


def solve_sonar_equation(scene: Scene, target_strength: float = -20.0) -> tuple[SonarEquation, SonarEquation]:
    """Solve the sonar equation for a target strength in dB: over the record, and over several times its range."""
    if scene.sonar.law == "light":
        raise SceneError("sonar.law 'light' has no areas and no spreading, hence no sonar equation; use law 'sonar'")
    packed = pack(scene)
    setup = prepare_setup(scene, packed.ground, packed.arrays)
    gain = 10.0 * np.log10(time_varied_gain(setup))
    bins = max(min(FARTHER * setup.arrays.bins, MOST_BINS), setup.arrays.bins)
    centres = (np.arange(bins, dtype=np.float64) + 0.5) * setup.arrays.bin_length
    factor = range_factor(scene, centres, setup.depth) * mean_over_centre(bins, setup.arrays.range_decay)
    farther = replace(setup, arrays=setup.arrays._replace(bins=bins, range_factor=factor))
    return _solve(setup, setup.noise, target_strength, gain), _solve(
        farther, setup.noise, target_strength, 0.0 * centres
    )


def _solve(setup: ReceiverSetup, noise: float, target_strength: float, gain: Floats) -> SonarEquation:
    """Levels in the bins of a receiver."""
    scene, arrays, r = setup.scene, setup.arrays, bin_centres(setup.arrays)
    source = scene.receiver.source_level
    loss = absorption_coefficient(scene.water.absorption, scene.sonar.frequency, abs(setup.depth)) / NEPER_PER_DB
    way = {
        "source level": np.full(r.size, source),
        "spreading out": -20.0 * np.log10(r),
        "spreading back": -20.0 * np.log10(r),
        "absorption out": -loss * r,
        "absorption back": -loss * r,
        "beam vertically": _decibels(vertical_at(arrays, -setup.grazing)),
    }
    cosine = np.sin(setup.grazing)
    strength = _decibels(np.asarray(sum(share * scattering_strength(row, cosine) for row, share in setup.materials)))
    bed = _decibels(setup.mean_bed)
    with np.errstate(invalid="ignore"):
        # As the bed is spread by the pulse: that which an even beam needs to return as much.
        area = np.nan_to_num(bed - strength - sum(way.values()), nan=SILENCE, neginf=SILENCE)
    pulse = scene.sonar.pulse
    point = {
        "beam on the axis": _decibels(axial_response(arrays)),
        "target strength": np.full(r.size, target_strength),
        "share of the bin": np.full(r.size, 10.0 * math.log10(setup.taps.weights.max())),
    }
    return SonarEquation(
        scene=scene,
        slant_range=r * scene.sonar.range / (scene.sonar.bins * arrays.bin_length),
        grazing=setup.grazing,
        energy=source + 10.0 * math.log10(pulse.sent_for(setup.bin_time)),
        bed=Level("bed", way | {"backscatter": strength, "area": area}),
        target=Level("target", {"source, way, beam": np.asarray(sum(way.values()))} | point),
        disturbances=(*_noise(setup, noise), *_reverberation(setup)),
        gain=gain,
    )


def _noise(setup: ReceiverSetup, noise: float) -> Iterator[Level]:
    """Level of the noise from its spectral density, if there is any."""
    if noise > 0.0:
        pulse, even = setup.scene.sonar.pulse, np.ones(setup.arrays.bins)
        band, gain = (10.0 * math.log10(each(setup.bin_time)) for each in (pulse.band, pulse.processing_gain))
        directivity = 10.0 * math.log10(setup.directivity)
        density = 10.0 * math.log10(noise) - band + directivity + gain
        terms = {"noise density": density, "band": band, "directivity": -directivity, "processing gain": -gain}
        yield Level("noise", {name: term * even for name, term in terms.items()})


def _reverberation(setup: ReceiverSetup) -> Iterator[Level]:
    """Levels of volume and surface reverberation, spread by the pulse, those that are declared."""
    for name, strength, echo in reverberation_curves(setup):
        level = setup.source * spread_curve(echo, setup.taps)
        size = f"{'volume' if name.startswith('volume') else 'area'}, beam, way"
        yield Level(name, {"strength": np.full(echo.size, strength), size: _decibels(level) - strength})


def _rows(level: Level, k: int) -> Iterator[tuple[Term, bool]]:
    """Terms of a level in one bin, then their sum."""
    for name, term in level.terms.items():
        yield Term(name, float(term[k])), False
    yield Term(level.name, float(level.decibels[k])), True


def add_levels(*levels: Floats) -> Floats:
    """Level of the sum of intensities."""
    return _decibels(np.asarray(sum(10.0 ** (level / 10.0) for level in levels)))


def _decibels(ratio: Floats) -> Floats:
    with np.errstate(divide="ignore"):
        return np.asarray(10.0 * np.log10(ratio))


def write_sonar_equation(path: Path, solved: SonarEquation) -> None:
    """Write the levels over slant range as a table (.csv, with all terms) or as curves (.png, .svg)."""
    levels = (solved.bed, solved.target, *solved.disturbances)
    with replacing(path) as beside:
        if path.suffix.lower() != ".csv":
            _draw(beside, path.suffix[1:].lower(), solved, levels)
            return
        columns = {f"{level.name}: {name}": term for level in levels for name, term in level.terms.items()}
        columns |= {level.name: level.decibels for level in levels} | {"gain": solved.gain, "record": solved.record}
        with beside.open("w", newline="", encoding="utf-8") as file:
            writer = csv.writer(file)
            writer.writerow(["slant range (m)", *(f"{name} (dB)" for name in columns)])
            writer.writerows(np.round(np.column_stack([solved.slant_range, *columns.values()]), 4).tolist())


def _draw(path: Path, suffix: str, solved: SonarEquation, levels: tuple[Level, ...]) -> None:
    """Draw the curves of the levels."""
    # lazy: Matplotlib
    from insonify.display.style import BLUE, BROWN, FAINT, GREEN, VIOLET, label_axes, make_figure, style_axes

    figure = make_figure(7.2, 4.4, layout="constrained")
    axes, near = figure.add_subplot(), solved.slant_range.size // 50  # nearer, r⁻⁴ would take up the whole scale
    for level, colour in zip(levels, (BROWN, GREEN, FAINT, BLUE, VIOLET)):
        shown = np.where(np.isfinite(level.decibels), level.decibels, np.nan)
        axes.plot(solved.slant_range[near:], shown[near:], color=colour, linewidth=1.4, label=level.name)
    style_axes(axes, 9.0)
    axes.grid(color=FAINT, alpha=0.2, linewidth=0.6)
    unit = "re 1 µPa" if solved.scene.receiver.source_level > 0.0 else "re the source at 1 m"
    label_axes(axes, "slant range (m)", f"level in the record (dB {unit})")
    axes.legend(frameon=False, fontsize=9)
    figure.savefig(path, format=suffix, dpi=150)
