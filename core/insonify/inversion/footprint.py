"""Footprint of a sonar in the spectra of its record: averaging by beam, pulse and bins, and the spectrum of speckle."""

from typing import NamedTuple

import numpy as np

from insonify.acoustics.pulses import coherence, pulse_taps
from insonify.arrays import Floats
from insonify.scene import Scene
from insonify.scene.sonar.beams import BeamConditions
from insonify.scene.sonar.pulses import PulseKind

DIRECTIONS = 64  # of the beam that are summed
FAINTEST = 0.05  # least spectrum of speckle over its mean, at frequencies that the pulse suppresses


class Footprint(NamedTuple):
    """Resolution of a sonar."""

    pulse: PulseKind
    sound_speed: float  # m/s
    bin_length: float  # slant range of a bin, in metres
    directions: Floats  # (n,) sines along the track and the two-way response of the beam there; none for a knife
    sensitivity: Floats
    light: bool  # whether the law of scattering is `light`

    @property
    def cell(self) -> float:
        """Length of the resolution cell in slant range, in metres."""
        return max(self.bin_length, self.pulse.cell(self.sound_speed))

    def average_along(self, frequency: Floats, slant_range: float) -> Floats:
        """Share of the power of waves along the track (cycles a metre) that remains after averaging over the beam."""
        if self.directions.size == 0:
            return np.ones_like(frequency)
        phase = 2.0 * np.pi * slant_range * np.multiply.outer(frequency, self.directions)
        total = float(self.sensitivity.sum())
        real, imaginary = (wave(phase) @ self.sensitivity / total for wave in (np.cos, np.sin))
        return np.asarray(real**2 + imaginary**2)

    def average_across(self, frequency: Floats) -> Floats:
        """Share of the power of waves in slant range (cycles a metre) that remains after averaging over a bin."""
        taps = pulse_taps(self.pulse, self.sound_speed, self.bin_length).weights
        lags = np.arange(taps.size)[:, None] * self.bin_length
        waves = (taps[:, None] * np.exp(-2j * np.pi * lags * frequency)).sum(axis=0) / taps.sum()
        return np.asarray(np.abs(waves) ** 2 * np.sinc(frequency * self.bin_length) ** 2)

    def speckle(self, frequency: Floats) -> Floats:
        """Spectrum of speckle in slant range over its mean: the transform of |ρ|², ρ being the coherence of bins."""
        lines = coherence(self.pulse, self.sound_speed, self.bin_length)[1:, None] ** 2
        lags = np.arange(1, lines.size + 1)[:, None] * self.bin_length
        spectrum = 1.0 + 2.0 * (lines * np.cos(2.0 * np.pi * lags * frequency)).sum(axis=0)
        return np.maximum(spectrum, FAINTEST)

    def respond_to_slope(self, sine: float) -> float:
        """Relative change of a Lambert bed's amplitude with its slope, by the sine of the grazing angle."""
        # Law `sonar`: a step of slant range returns sin²(θ + δ) / cos(θ + δ) from a bed that rises by δ; half the
        # logarithm of it changes by cot θ + ½ tan θ. Law `light`: sin(θ + δ), hence ½ cot θ.
        cotangent = float(np.sqrt(1.0 - sine**2)) / sine
        return 0.5 * cotangent if self.light else cotangent + 0.5 / cotangent


def footprint_of(scene: Scene, sound_speed: float) -> Footprint:
    """Footprint of the sonar of a scene in water of that sound speed (m/s)."""
    sonar = scene.sonar
    conditions = BeamConditions(sound_speed, sonar.frequency, sonar.range)
    directions = sensitivity = np.zeros(0)
    if sonar.beam.has_width:
        table = sonar.beam.tabulate(conditions)
        count = table.energy.shape[1] // DIRECTIONS * DIRECTIONS
        edges = np.linspace(-1.0, 1.0, table.energy.shape[1])[:count]
        directions = table.extent[-1] * edges.reshape(DIRECTIONS, -1).mean(axis=1)
        sensitivity = table.energy[-1, :count].reshape(DIRECTIONS, -1).mean(axis=1)
    light = sonar.law == "light"
    return Footprint(sonar.pulse, sound_speed, sonar.range / sonar.bins, directions, sensitivity, light)
