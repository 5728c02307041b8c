"""Stages of the receiver: the base class, what they are prepared from, and the sound that they act on."""

import math
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import ClassVar, Self

import numpy as np

from insonify.acoustics.beam_patterns import directivity
from insonify.acoustics.flat_bed import flat_bed_curve
from insonify.acoustics.pulses import Taps, coherent_taps, pulse_taps, samples_per_bin, spread_curve
from insonify.acoustics.resolution_cell import bin_centres, vertical_at
from insonify.arrays import Complexes, Floats, Integers, Singles
from insonify.kernels.common.types import LIGHT, SceneArrays
from insonify.kernels.receiver.pulse import convolve_pulse
from insonify.plugins import extensions
from insonify.receiver.waves import WaveField, Waves, make_field, no_waves
from insonify.scene import Scene, SceneError
from insonify.scene.receiver.noises import NoiseConditions
from insonify.scene.seabed.materials.catalogue import Reflectivity
from insonify.terrain import AnyGround

Traced = Singles | Complexes

PHASES, DETECTION = 40.0, 80.0  # ranks: echoes have phases from the first on, and are energies again from the second on


def power(level: float) -> float:
    """Ratio of powers of a level in decibels."""
    return float(10.0 ** (level / 10.0))


@dataclass(frozen=True, eq=False)
class ReceiverSetup:
    """What the stages of a receiver are prepared from."""

    scene: Scene  # the declaration
    arrays: SceneArrays  # the whole scene as tracers take it: beam, bins, water, reflectivities
    altitude: float  # of the sonar above the bed at its first ping, m
    depth: float  # and below the sea surface
    # Shape of the K speckle of every material, by rows of ``arrays.reflectivity``; None for that of the receiver.
    k_shapes: Sequence[float | None] = ()
    ground: AnyGround | None = None  # the bed; without it there are no schools or plumes

    @cached_property
    def taps(self) -> Taps:
        """Energy that the pulse spreads over neighbouring bins."""
        taps = pulse_taps(self.scene.sonar.pulse, self.arrays.water.reference, self.arrays.bin_length)
        if self.arrays.law == LIGHT:
            # Law light: the radiance of the paper does not depend on the length of the pulse.
            taps = Taps(taps.weights / taps.weights.sum(), taps.before)
        return taps

    @cached_property
    def samples(self) -> int:
        """Samples of a bin at which waves are summed; 1 unless single scatterers interfere."""
        if not self.scene.receiver.speckle.interferes:
            return 1
        return samples_per_bin(self.scene.sonar.pulse, self.arrays.water.reference, self.arrays.bin_length)

    @cached_property
    def level_bed(self) -> Floats:
        """Mean echo of a level bed of albedo 1 after the pulse, with the source level, (bins,)."""
        return self.source * float(self.taps.weights.sum()) * flat_bed_curve(self.arrays, self.altitude)

    @property
    def bin_time(self) -> float:
        """Travel time of a bin, there and back, in seconds."""
        return float(2.0 * self.arrays.bin_length / self.arrays.water.reference)

    @cached_property
    def directivity(self) -> float:
        """Response to a wave on the axis over that to isotropic noise, as a ratio."""
        return directivity(self.scene.sonar, self.arrays.water.reference)

    @cached_property
    def mean_bed(self) -> Floats:
        """Mean echo of a level bed of the scene's materials, spread by the pulse, with the source level, (bins,)."""
        curve = sum(share * flat_bed_curve(self.arrays, self.altitude, row) for row, share in self.materials)
        return self.source * spread_curve(curve * vertical_at(self.arrays, -self.grazing), self.taps)

    @property
    def grazing(self) -> Floats:
        """Angle of rays below the horizontal to a level bed, (bins,); straight down before its first echo."""
        return np.arcsin(np.minimum(self.altitude / bin_centres(self.arrays), 1.0))

    @property
    def materials(self) -> list[tuple[Reflectivity, float]]:
        """Materials of the bed at the beginning of the track, with the share of the bed of each."""
        bed = self.arrays.bed
        counts = np.bincount(bed.materials.ravel()) if bed.mapped else np.ones(1)
        rows = np.flatnonzero(counts)
        return [(Reflectivity(*self.arrays.reflectivity[row]), counts[row] / counts.sum()) for row in rows]

    @cached_property
    def noise(self) -> float:
        """Mean intensity of the noise before the time-varied gain; 0 without noise."""
        sonar, declared = self.scene.sonar, self.scene.receiver.noise
        if declared is None:
            return 0.0
        bandwidth, gain = sonar.pulse.noise_bandwidth(self.bin_time), 10.0 * math.log10(self.directivity)
        return power(declared.received(NoiseConditions(sonar.frequency, bandwidth, gain, self._bed_level)))

    def _bed_level(self, slant_range: float) -> float:
        """Mean level of the bed's echo at a slant range, in dB."""
        place = slant_range / self.scene.sonar.range * self.arrays.bins - 0.5
        level = float(np.interp(place, np.arange(self.arrays.bins), self.mean_bed))
        if not (slant_range <= self.scene.sonar.range and level > 0.0):
            raise SceneError(
                f"receiver.noise: there is no echo of the bed at {slant_range:g} m; give a slant range from the first, "
                f"at {self.altitude:.4g} m, up to {self.scene.sonar.range:g} m"
            )
        return 10.0 * math.log10(level)

    @property
    def source(self) -> float:
        """Factor of intensity of the source level."""
        return power(self.scene.receiver.source_level)

    def field_of(self, stream: int) -> WaveField:
        """Waves that the receiver's filter correlates along range and that are new in every ping.

        Whatever drifts by a quarter of the wavelength between pings returns another phase: 1 mm at 400 kHz.
        """
        arrays, samples = self.arrays, self.samples
        taps = coherent_taps(self.scene.sonar.pulse, arrays.water.reference, arrays.bin_length / samples)
        return make_field(self.scene.seed, stream, taps, np.zeros(arrays.bins * samples))


@dataclass(eq=False)
class Sound:
    """Sound of a block of pings in the receiver.

    Stages replace arrays of energies, and never change their elements, which may belong to the tracer.
    """

    pings: Integers  # (n,) numbers of the pings
    # (n, 2, bins) mean energy of the echoes, port first; after detection the intensity of the record. ``factors`` still
    # apply.
    energy: Singles
    # The same with the echo of every material divided by the shape of its K speckle; None if one shape holds for all.
    weighted: Singles | None = None
    phased: bool = False  # whether echoes are speckled
    sums_waves: bool = False  # whether speckled echoes meet other waves, so that amplitudes add
    # (n, 2, bins * samples) echoes of single scatterers, if these are traced with their phases.
    traced: Complexes | None = None
    # (n or 1, 1 or 2, bins) mean energy of Gaussian waves that are new in every ping and not added to ``waves`` yet.
    background: Singles | None = None
    # Amplitudes of all that is received, between speckle and detection.
    waves: Waves = field(default_factory=lambda: no_waves(0, 0))
    look: int = 0  # number of the independent record that is summed
    # Factors, (n or 1, 1, 1) or numbers, that are still to be applied to ``energy`` and ``background``.
    factors: list[Singles | np.float32] = field(default_factory=list)

    def scale(self, factor: Singles | np.float32) -> None:
        """Raise the energy of each ping by a factor, (n or 1, 1, 1) or a number."""
        if not self.waves.real.size:
            self.factors.append(factor)
            return
        amplitude = np.sqrt(factor)
        self.waves = Waves(amplitude * self.waves.real, amplitude * self.waves.imaginary)
        self.background = None if self.background is None else self.background * factor

    def apply_factors(self) -> None:
        """Apply all factors to what is received so far."""
        # The latest first: float32 rounds in this order, and records do not change with the version.
        for factor in reversed(self.factors):
            self.energy = self.energy * factor
            self.background = None if self.background is None else self.background * factor
        self.factors.clear()

    def take_level(self) -> Singles | np.float32:
        """Product of the factors, which count as applied to all that is received so far."""
        level: Singles | np.float32 = np.float32(1.0)
        for factor in self.factors:
            level = level * factor
        self.factors.clear()
        if self.background is not None:
            self.background = level * self.background
        return level

    def split_traced(self) -> None:
        """Make waves of the traced scatterers, with all factors applied."""
        if self.traced is not None:
            waves = self.traced * np.sqrt(self.take_level())
            self.waves = Waves(*(np.ascontiguousarray(part, dtype=np.float32) for part in (waves.real, waves.imag)))
            self.traced = None

    def add_background(self, energy: Singles) -> None:
        """Add Gaussian waves of a mean energy, (n or 1, 1 or 2, bins), that are new in every ping."""
        self.background = energy if self.background is None else self.background + energy

    def draw_background(self, field: WaveField) -> None:
        """Draw the waves of the background and add them to those received."""
        if self.background is not None:
            samples = self.waves.real.shape[2] // self.background.shape[2]
            energy = self.background if samples == 1 else np.repeat(self.background, samples, axis=2)
            field.add_to(self.waves, energy, self.pings, self.look)
            self.background = None


@dataclass(frozen=True, eq=False)
class Stage(ABC):
    """One effect of the receiver, prepared for a scene: it acts on the sound of a block of pings.

    Stages act in the order of their ranks. The pulse is spread over the bins before the first of them. Echoes are mean
    energies up to the rank `PHASES`, and intensities of the record after `DETECTION`: stages of these ranks act on
    energies. In between, stages act on energies too, unless speckled echoes meet other waves: then amplitudes add, and
    stages act on waves, once for each independent record that speckle averages.

    A stage is found by being declared in a module of this package, or in a module that an installed package announces
    as an entry point of the group ``insonify.receiver_stages``. Derive a frozen dataclass, for what is prepared.

    Attributes
    ----------
    name : str
        Name of the stage's term in the explanation of a pixel, such as ``"time-varied gain"``.
    detail : str
        What it comes from, in few words.
    rank : float
        Place among the stages: 10 source level, 20 water column, 30 fluctuation, 40 speckle, 50 crosstalk, 60 noise,
        70 ringing and interference, 90 time-varied gain, 100 recorder.
    adds_waves : bool
        Whether its waves interfere with speckled echoes, so that amplitudes add rather than energies.
    phased : bool
        Whether echoes have phases once it acts.
    coherent : bool
        Whether it stands for the interference of single scatterers, which are traced with pulse and phases.
    """

    name: ClassVar[str]
    detail: ClassVar[str]
    rank: ClassVar[float]
    adds_waves: ClassVar[bool] = False
    phased: ClassVar[bool] = False
    coherent: ClassVar[bool] = False

    def __init_subclass__(cls) -> None:
        """Add the stage to the stages that make up receivers."""
        if "rank" in vars(cls):
            KINDS.append(cls)

    @property
    def gain(self) -> float | Floats:
        """Factor by which it raises a mean echo, a number or one for every bin, (bins,)."""
        return 1.0

    @property
    def added(self) -> float:
        """Mean energy that it adds in every bin."""
        return 0.0

    @classmethod
    @abstractmethod
    def prepare(cls, setup: ReceiverSetup) -> Self | None:
        """Prepare the stage for a scene.

        Parameters
        ----------
        setup : ReceiverSetup
            The scene, its arrays, and what all stages need of them.

        Returns
        -------
        Stage or None
            None for a scene whose record it would not change.
        """

    @abstractmethod
    def act_on_energies(self, sound: Sound) -> None:
        """Change mean energies of echoes before detection, or intensities after it.

        Parameters
        ----------
        sound : Sound
            Replace ``sound.energy``, or call `Sound.scale`, `Sound.add_background`. Results must depend on the numbers
            of the pings alone, not on the block in which they are received. An energy that is added after the level of
            the source applies takes `Sound.apply_factors` first.
        """

    def act_on_waves(self, sound: Sound) -> None:
        """Change the waves of one look, in a scene whose speckled echoes meet other waves.

        Parameters
        ----------
        sound : Sound
            Replace or change ``sound.waves``, or call `Sound.scale`, `Sound.add_background`.
        """
        raise NotImplementedError(f"{type(self).__name__} acts between speckle and detection, but not on waves")


KINDS: list[type[Stage]] = []


def stage_kinds() -> list[type[Stage]]:
    """All stages, in the order in which they act."""
    extensions("insonify.receiver", "insonify.receiver_stages")  # classes add themselves
    return sorted(KINDS, key=lambda kind: kind.rank)


def spread_echoes(taps: Taps, traced: Traced) -> Singles:
    """Spread echoes over range bins by the taps of the pulse; for an ideal pulse they are returned as they are."""
    echoes = np.asarray(traced, np.float32)
    if taps.weights.size == 1:
        return echoes
    record = np.zeros_like(echoes)
    convolve_pulse(echoes, taps.weights.astype(np.float32), taps.before, record)
    return record
