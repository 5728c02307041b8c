"""Solved sonar equation of a scene: its terms in groups at a slant range, and sentences about both."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from insonify.acoustics.bed_materials import describe_limits, misfit
from insonify.scene import Scene
from insonify.scene.seabed.materials import Material
from insonify_viewer.core_types import Level, SonarEquation

COMPARED = "Compared"  # heading of levels over one another, which have no terms


class Group(NamedTuple):
    """A level and the terms that add up to it."""

    name: str
    level: float | None  # dB; None for a group of levels that do not add up
    rows: tuple[tuple[str, float], ...]  # name and dB


@dataclass(frozen=True, eq=False)
class SolvedBudget:
    """Sonar equation of a scene over its record and beyond."""

    scene: Scene
    target_strength: float  # dB re 1 m²
    record: SonarEquation
    farther: SonarEquation  # over several times the range, without gain

    @property
    def unit(self) -> str:
        """Reference of the levels."""
        return "dB re 1 µPa" if self.scene.receiver.source_level > 0.0 else "dB re the source at 1 m"

    def groups(self, slant_range: float) -> Iterator[Group]:
        """Yield the terms at a slant range, by the level that they add up to; levels over one another come last."""
        rows: list[tuple[str, float]] = []
        compared: list[tuple[str, float]] = []
        for term, is_sum in self.record.table(slant_range):
            if not is_sum:
                rows.append((term.name, term.decibels))
            elif rows:
                yield Group(term.name, term.decibels, tuple(rows))
                rows = []
            else:
                compared.append((term.name, term.decibels))
        yield Group(COMPARED, None, tuple(compared))

    def describe(self, slant_range: float) -> str:
        """Describe in a sentence which echoes stand above the noise at a slant range, and up to where."""
        k = self.record.bin_at(slant_range)
        bed, noise = float(self.record.bed.decibels[k]), float(self.record.disturbance[k])
        if not math.isfinite(bed):
            return f"At {slant_range:.1f} m there is no echo of the bed."
        if not self.record.disturbances:
            return f"At {slant_range:.1f} m the bed returns {signed(bed)}; the scene has no noise."
        over = f"{abs(bed - noise):.1f} dB {'over' if bed > noise else 'under'} the noise"
        ends = f"it {self._end(self.farther.bed)}, the target {self._end(self.farther.target)}"
        return f"At {slant_range:.1f} m the bed stands {over}; {ends}."

    def describe_model(self, slant_range: float) -> str:
        """Describe in sentences how far the bed's level is from its backscatter model, and where that is not valid."""
        material, frequency = self.scene.seabed.material, self.scene.sonar.frequency
        limits = *describe_limits(self.scene), *self.scene.describe_limits()
        words = [f"{sentence[0].upper()}{sentence[1:]}." for sentence in limits]
        if isinstance(material, Material) and material.model is not None:
            grazing = self.record.grazing[self.record.bin_at(slant_range)]
            off = misfit(material, frequency, np.array(grazing))
            assert off is not None
            name = material.name.replace("_", " ")
            angle = math.degrees(float(grazing))
            words.insert(0, f"{name.capitalize()}: {signed(float(off))} over its backscatter model at {angle:.0f}°.")
        return " ".join(words)

    def _end(self, level: Level) -> str:
        """Describe up to where a level stands above the noise."""
        farthest = self.farther.farthest(level)
        if farthest == 0.0:
            return "is below the noise everywhere"
        end = float(self.farther.slant_range[-1])
        return f"is above it up to {f'{end:.0f} m at least' if math.isinf(farthest) else f'{farthest:.1f} m'}"


def signed(level: float) -> str:
    """Level with a true minus sign; minus infinity is no echo."""
    return f"{round(level, 1) + 0.0:.1f} dB".replace("-", "−") if math.isfinite(level) else "no echo"
