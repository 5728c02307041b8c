"""Fluctuation of gain and travel time from ping to ping, as turbulent water causes it."""

import math
from dataclasses import dataclass
from typing import Self

import numpy as np

from insonify.arrays import Floats, Integers, Singles
from insonify.kernels.common.streams import PING_DELAY, PING_GAIN
from insonify.kernels.receiver.pulse import delay_pings
from insonify.kernels.speckle.random_fields import fill_slow_normals
from insonify.receiver.stage import ReceiverSetup, Sound, Stage
from insonify.receiver.waves import Waves

# White noise smoothed by a triangle of half width 1 is correlated by the cubic B-spline, which is 1/e at this lag.
CORRELATION_LAG = 0.85972
TINY = np.finfo(np.float32).tiny


@dataclass(frozen=True, eq=False)
class Fluctuation(Stage):
    """Gain and delay of the pings, two slow random processes."""

    name, detail, rank = "fluctuation", "of this ping", 30.0
    seed: int  # seed of both processes
    half_width: float  # half width of the triangle that smooths white noise into them, in pings
    spread: float  # standard deviation of the logarithm of the gain
    delay: float  # standard deviation of the delay, in bins
    samples: int  # of a bin, where waves are summed

    @classmethod
    def prepare(cls, setup: ReceiverSetup) -> Self | None:
        """None where pings do not vary."""
        scene, arrays, declared = setup.scene, setup.arrays, setup.scene.receiver.fluctuation
        if declared is None:
            return None
        pings = declared.correlation_time * scene.sonar.ping_rate
        return cls(
            seed=scene.seed,
            half_width=max(pings / CORRELATION_LAG, 0.5),
            spread=declared.level * math.log(10.0) / 10.0,
            delay=0.5 * arrays.water.reference * declared.travel_time / arrays.bin_length,
            samples=setup.samples,
        )

    def act_on_energies(self, sound: Sound) -> None:
        """Delay the echoes of every ping, and raise or lower them."""
        sound.scale(self.gains(sound.pings))
        if self.delay == 0.0:
            return
        normals = self._slow_normals(sound.pings, PING_DELAY)
        late = self.delay * normals
        sound.weighted = None if sound.weighted is None else _shift(sound.weighted, late)
        sound.background = None if sound.background is None else _shift(sound.background, late)
        if sound.traced is None:
            sound.energy = _shift(sound.energy, late)
        else:
            sound.split_traced()
            sound.waves = _shift_waves(sound.waves, self.samples * self.delay * normals)

    def gains(self, pings: Integers) -> Singles:
        """Lognormal factors of mean 1, (n, 1, 1)."""
        level = self.spread * self._slow_normals(pings, PING_GAIN)
        return np.exp(level - 0.5 * self.spread**2).astype(np.float32)[:, None, None]

    def _slow_normals(self, pings: Integers, stream: int) -> Floats:
        """One number for each ping of a stationary normal process of mean 0 and variance 1."""
        out = np.empty(pings.size)
        spacing = 2 ** max(0, math.floor(math.log2(0.5 * self.half_width)))
        fill_slow_normals(self.seed, stream, pings, self.half_width, spacing, out)
        return out


def _shift(energy: Singles, late: Floats) -> Singles:
    """Energies with every ping delayed by a number of bins, (n,)."""
    out = np.empty_like(energy)
    delay_pings(energy, late, out)
    return out


def _shift_waves(waves: Waves, late: Floats) -> Waves:
    """Waves with every ping delayed: energies and phases are interpolated between neighbouring samples."""
    energy = _shift(waves.real**2 + waves.imaginary**2, late)
    real, imaginary = _shift(waves.real, late), _shift(waves.imaginary, late)
    amplitude = np.sqrt(energy / np.maximum(real**2 + imaginary**2, TINY))
    return Waves(amplitude * real, amplitude * imaginary)
