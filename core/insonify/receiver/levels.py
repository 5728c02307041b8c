"""Stages that raise or add levels: source level, crosstalk, ambient noise and time-varied gain."""

from dataclasses import dataclass
from typing import Self

import numpy as np

from insonify.acoustics.resolution_cell import bin_centres
from insonify.acoustics.water import absorption_coefficient
from insonify.arrays import Floats
from insonify.kernels.common.streams import REVERBERATION
from insonify.receiver.stage import ReceiverSetup, Sound, Stage, power
from insonify.receiver.waves import WaveField
from insonify.scene.receiver.gains import RangeBins

SMALLEST = float(np.finfo(np.float32).tiny)  # intensity that stands for the noise floor where there is no noise
GREATEST_GAIN = 330.0  # dB, of source level and gain together: float32 ends at 385 dB


@dataclass(frozen=True, eq=False)
class SourceLevel(Stage):
    """Level of the source, which raises all echoes."""

    name, detail, rank = "source level", "at 1 m", 10.0
    factor: float  # of intensity

    @classmethod
    def prepare(cls, setup: ReceiverSetup) -> Self | None:
        """None at 0 dB, where the record is relative to the source."""
        factor = power(setup.scene.receiver.source_level)
        return None if factor == 1.0 else cls(factor)

    @property
    def gain(self) -> float:
        """Factor of intensity."""
        return self.factor

    def act_on_energies(self, sound: Sound) -> None:
        """Raise all pings alike."""
        sound.scale(np.float32(self.factor))


@dataclass(frozen=True, eq=False)
class Crosstalk(Stage):
    """Share of each side's energy that leaks into the other side."""

    name, detail, rank = "crosstalk", "from the other side", 50.0
    adds_waves = True
    share: float
    field: WaveField  # of the background that leaks with the echoes, of mean energy 1

    @classmethod
    def prepare(cls, setup: ReceiverSetup) -> Self | None:
        """None where no level is declared."""
        level = setup.scene.receiver.crosstalk
        return None if level is None else cls(power(level), setup.field_of(REVERBERATION))

    def act_on_energies(self, sound: Sound) -> None:
        """Add to each side a share of the other's energy."""
        sound.energy = sound.energy + np.float32(self.share) * sound.energy[:, ::-1]

    def act_on_waves(self, sound: Sound) -> None:
        """Add to each side the other's waves, including waves of the water column."""
        sound.draw_background(self.field)
        for part in (sound.waves.real, sound.waves.imaginary):
            part += np.float32(np.sqrt(self.share)) * part[:, ::-1]


@dataclass(frozen=True, eq=False)
class Noise(Stage):
    """Ambient noise: Gaussian waves, new in every ping."""

    name, detail, rank = "noise", "ambient", 60.0
    adds_waves = True
    level: float  # mean intensity
    bins: int

    @classmethod
    def prepare(cls, setup: ReceiverSetup) -> Self | None:
        """None where there is no noise."""
        return cls(setup.noise, setup.arrays.bins) if setup.noise > 0.0 else None

    @property
    def added(self) -> float:
        """Mean intensity."""
        return self.level

    def act_on_energies(self, sound: Sound) -> None:
        """Add waves to the background, with which they are drawn."""
        sound.apply_factors()
        sound.add_background(np.full((1, 1, self.bins), self.level, np.float32))

    act_on_waves = act_on_energies


@dataclass(frozen=True, eq=False)
class TimeVariedGain(Stage):
    """Gain of every bin after detection."""

    name, detail, rank = "time-varied gain", "of this bin", 90.0
    curve: Floats  # (bins,) factors of intensity

    @classmethod
    def prepare(cls, setup: ReceiverSetup) -> Self | None:
        """None where no bin is raised or lowered."""
        curve = time_varied_gain(setup)
        return cls(curve) if (curve != 1.0).any() else None

    @property
    def gain(self) -> Floats:
        """Factor of every bin, (bins,)."""
        return self.curve

    def act_on_energies(self, sound: Sound) -> None:
        """Raise every bin."""
        sound.energy = sound.energy * self.curve.astype(np.float32)


def time_varied_gain(setup: ReceiverSetup) -> Floats:
    """Factor of intensity by which the time-varied gain raises every bin, (bins,)."""
    scene, declared = setup.scene, setup.scene.receiver.tvg
    r = bin_centres(setup.arrays)
    bins = RangeBins(np.arange(r.size, dtype=np.float64), r, 2.0 * r / setup.arrays.water.reference)
    if declared.stops_at_noise:
        audible = np.flatnonzero(setup.level_bed > max(setup.noise, SMALLEST))
        last = audible[-1] if audible.size else 0
        bins = RangeBins(*(np.minimum(column, column[last]) for column in bins))
    absorption = absorption_coefficient(scene.water.absorption, scene.sonar.frequency, abs(setup.depth))
    decibels = declared.decibels(bins, absorption)
    return np.asarray(10.0 ** (np.minimum(decibels, GREATEST_GAIN - scene.receiver.source_level) / 10.0))
