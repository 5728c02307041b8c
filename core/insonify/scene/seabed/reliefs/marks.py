"""Scattered marks on a level bed: boulders, mounds, pockmarks, and scars of trawls and anchors."""

import math
from statistics import NormalDist

import numpy as np

from insonify.arrays import Floats
from insonify.scene.base import angle, metres, parameter
from insonify.scene.seabed.reliefs.random_relief import RandomRelief, density_waves
from insonify.scene.seabed.reliefs.spectrum import LONGEST_WAVES, PeriodicWaves, rotate_frequencies


class Marks(RandomRelief, kind="marks", rank=65):
    """Round or long mounds at random places, or with a negative height pits and furrows.

    They are the excursions of a Gaussian field above a high threshold: apart from one another, nearly paraboloids, of
    exponentially distributed height and width (Adler 1981, chapter 6).
    """

    height: float = parameter(
        0.5, "mean height of the marks; negative for pits", "m", ge=-1e3, le=1e3, slider=(-2.0, 2.0)
    )
    size: float = metres(2.0, "mean width of a mark, across its heading", (0.3, 20.0), least=1e-3, most=1e5)
    length: float = parameter(
        1.0, "length of a mark along its heading over its width", ge=1.0, le=1e4, slider=(1.0, 100.0), log=True
    )
    heading: float = angle("direction along the marks, counter-clockwise from east; 45T is 45° by the compass")
    share: float = parameter(0.02, "share of the bed that the marks cover", gt=0.0, le=0.3, slider=(0.001, 0.2))

    def heights(self, waves: PeriodicWaves, reference: PeriodicWaves) -> Floats:
        """Excess of the field over its threshold t, on average 1/t; a peak is 2√2/(2π·spread·t) wide there."""
        threshold = NormalDist().inv_cdf(1.0 - self.share)
        across = math.sqrt(2.0) / (math.pi * max(threshold, 1.0) * self.size)  # cycles a metre
        narrowest = LONGEST_WAVES / self.period
        spreads = max(across / self.length, narrowest), max(across, narrowest)

        def density(fx: Floats, fy: Floats) -> Floats:
            along, beside = rotate_frequencies(fx, fy, self.heading)
            return np.asarray(np.exp(-0.5 * ((along / spreads[0]) ** 2 + (beside / spreads[1]) ** 2)))

        made = density_waves(density, self.period, waves)
        level = math.sqrt(waves.variance(made))
        field = waves.field(made) / max(level, float(np.finfo(np.float64).tiny))
        excess = np.maximum(field - float(np.quantile(field, 1.0 - self.share)), 0.0)
        return np.asarray(self.height * threshold * excess)
