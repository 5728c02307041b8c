"""Bedded outcrop: the edges of tilted layers of rock."""

import math

import numpy as np

from insonify.arrays import Floats
from insonify.scene.base import angle, metres, parameter
from insonify.scene.seabed.reliefs.random_relief import RandomRelief, density_waves
from insonify.scene.seabed.reliefs.spectrum import PeriodicWaves


class Strata(RandomRelief, kind="strata", rank=66):
    """Tilted layers: each ends in a scarp, above which its face dips gently to the next scarp."""

    height: float = metres(0.8, "height of the scarps", (0.05, 5.0), least=0.0, most=1e4)
    interval: float = metres(8.0, "mean distance from scarp to scarp", (0.5, 50.0), least=1e-3, most=1e5)
    heading: float = angle("direction along the scarps, counter-clockwise from east; 45T is 45° by the compass")
    bends: float = parameter(
        1.0, "rms departure of the scarps from straight lines, in intervals", ge=0.0, le=100.0, slider=(0.0, 5.0)
    )
    scarp: float = parameter(0.15, "width of a scarp over the interval", gt=0.0, lt=1.0, slider=(0.02, 0.5))

    def heights(self, waves: PeriodicWaves, reference: PeriodicWaves) -> Floats:
        """Sawtooth of the phase of a tilted, uneven plane: whole layers fill a period."""
        turn = math.radians(self.heading)
        cycles = [round(self.period * wave / self.interval) for wave in (-math.sin(turn), math.cos(turn))]
        shortest = 1.0 / self.interval

        def uneven(fx: Floats, fy: Floats) -> Floats:
            squared = fx**2 + fy**2
            return np.asarray(np.exp(-squared / shortest**2) / (squared + self.period**-2) ** 1.5)

        made = density_waves(uneven, self.period, waves)
        level = math.sqrt(waves.variance(made))
        field = waves.field(made) * (self.bends / max(level, float(np.finfo(np.float64).tiny)))
        ny, nx = waves.shape
        phase = field + cycles[0] * np.arange(nx) / nx + (cycles[1] * np.arange(ny) / ny)[:, None]
        share = phase % 1.0
        rise = np.where(share < self.scarp, share / self.scarp, (1.0 - share) / (1.0 - self.scarp))
        return np.asarray(self.height * (rise - 0.5))
