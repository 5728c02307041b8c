"""Pings differ: the water between is never quite the same."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from insonify.kernels.common.types import SceneArrays
from insonify.kernels.receiver.pulse import delay_pings
from insonify.kernels.speckle.random_fields import fill_slow_normals
from insonify.scene import Scene
from insonify.scene.fluctuations.none import NoFluctuation

GAIN_STREAM, TIME_STREAM = 3000, 3001
# Noise smoothed by a triangle of half width 1 has the cubic B-spline for its correlation: it is 1/e at this distance.
TRIANGLE_TIME = 0.85972


@dataclass(frozen=True)
class Fluctuation:
    """Gain and delay of every ping.

    Attributes
    ----------
    seed : int
        What they derive from.
    half_width : float
        Of the triangle that smooths them, in pings.
    spread : float
        Standard deviation of the logarithm of the gain.
    delay : float
        Standard deviation of the delay, in bins.
    """

    seed: int
    half_width: float
    spread: float
    delay: float

    def gains(self, pings: NDArray[np.int64]) -> NDArray[np.float32]:
        """Lognormal factors of mean 1, (n, 1, 1)."""
        level = self.spread * self._wander(pings, GAIN_STREAM)
        return np.exp(level - 0.5 * self.spread**2).astype(np.float32)[:, None, None]

    def shifted(self, record: NDArray[np.float32], pings: NDArray[np.int64]) -> NDArray[np.float32]:
        """Delay the echoes of every ping; ``record`` itself where nothing is delayed."""
        if self.delay == 0.0:
            return record
        out = np.empty_like(record)
        delay_pings(record, self.delay * self._wander(pings, TIME_STREAM), out)
        return out

    def _wander(self, pings: NDArray[np.int64], stream: int) -> NDArray[np.float64]:
        """Stationary standard normal numbers."""
        out = np.empty(pings.size)
        spacing = 2 ** max(0, math.floor(math.log2(0.5 * self.half_width)))
        fill_slow_normals(self.seed, stream, pings, self.half_width, spacing, out)
        return out


def make_fluctuation(scene: Scene, arrays: SceneArrays) -> Fluctuation | None:
    """Derive a scene's fluctuation, None where it has none."""
    declared = scene.receiver.fluctuation
    if isinstance(declared, NoFluctuation):
        return None
    pings = declared.correlation_time * scene.sonar.ping_rate  # type: ignore[attr-defined]
    return Fluctuation(
        seed=scene.seed,
        half_width=max(pings / TRIANGLE_TIME, 0.5),
        spread=declared.level * math.log(10.0) / 10.0,  # type: ignore[attr-defined]
        delay=0.5 * arrays.water.reference * declared.travel_time / arrays.bin_length,  # type: ignore[attr-defined]
    )
