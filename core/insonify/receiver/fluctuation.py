"""Fluctuation of gain and travel time from ping to ping, as turbulent water causes it."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from insonify.kernels.common.streams import PING_DELAY, PING_GAIN
from insonify.kernels.common.types import SceneArrays
from insonify.kernels.receiver.pulse import delay_pings
from insonify.kernels.speckle.random_fields import fill_slow_normals
from insonify.receiver.waves import Waves
from insonify.scene import Scene

# White noise smoothed by a triangle of half width 1 is correlated by the cubic B-spline, which is 1/e at this lag.
CORRELATION_LAG = 0.85972
TINY = np.finfo(np.float32).tiny


@dataclass(frozen=True)
class Fluctuation:
    """Gain and delay of the pings, two slow random processes."""

    seed: int  # seed of both processes
    half_width: float  # half width of the triangle that smooths white noise into them, in pings
    spread: float  # standard deviation of the logarithm of the gain
    delay: float  # standard deviation of the delay, in bins

    def gains(self, pings: NDArray[np.int64]) -> NDArray[np.float32]:
        """Lognormal factors of mean 1, (n, 1, 1)."""
        level = self.spread * self._slow_normals(pings, PING_GAIN)
        return np.exp(level - 0.5 * self.spread**2).astype(np.float32)[:, None, None]

    def shifted(self, record: NDArray[np.float32], pings: NDArray[np.int64]) -> NDArray[np.float32]:
        """Record with the echoes of every ping delayed; ``record`` itself where the delay is 0."""
        if self.delay == 0.0:
            return record
        out = np.empty_like(record)
        delay_pings(record, self.delay * self._slow_normals(pings, PING_DELAY), out)
        return out

    def shift_waves(self, waves: Waves, pings: NDArray[np.int64], samples: int) -> Waves:
        """Waves of every ping delayed: energies as of `shifted`, phases between those of neighbouring samples."""
        if self.delay == 0.0:
            return waves
        late = samples * self.delay * self._slow_normals(pings, PING_DELAY)
        energy, real, imaginary = (np.empty_like(waves.real) for _ in range(3))
        delay_pings(waves.real**2 + waves.imaginary**2, late, energy)
        delay_pings(waves.real, late, real)
        delay_pings(waves.imaginary, late, imaginary)
        amplitude = np.sqrt(energy / np.maximum(real**2 + imaginary**2, TINY))
        return Waves(amplitude * real, amplitude * imaginary)

    def _slow_normals(self, pings: NDArray[np.int64], stream: int) -> NDArray[np.float64]:
        """One number for each ping of a stationary normal process of mean 0 and variance 1."""
        out = np.empty(pings.size)
        spacing = 2 ** max(0, math.floor(math.log2(0.5 * self.half_width)))
        fill_slow_normals(self.seed, stream, pings, self.half_width, spacing, out)
        return out


def make_fluctuation(scene: Scene, arrays: SceneArrays) -> Fluctuation | None:
    """Fluctuation that a scene declares, None where it declares none."""
    declared = scene.receiver.fluctuation
    if declared is None:
        return None
    pings = declared.correlation_time * scene.sonar.ping_rate
    return Fluctuation(
        seed=scene.seed,
        half_width=max(pings / CORRELATION_LAG, 0.5),
        spread=declared.level * math.log(10.0) / 10.0,
        delay=0.5 * arrays.water.reference * declared.travel_time / arrays.bin_length,
    )
