"""A multifractal bed."""

import math

import numpy as np

from insonify.arrays import Floats
from insonify.scene.base import parameter
from insonify.scene.seabed.reliefs.random_relief import RandomRelief, rms_height
from insonify.scene.seabed.reliefs.spectrum import PeriodicWaves


class Cascade(RandomRelief, kind="cascade", rank=60):
    """A multifractal: lognormal flux, cascading from the period down, integrated fractionally.

    Structure functions scale as ζ(q) = qH − C₁(q² − q) (Schertzer and Lovejoy 1987, α = 2).
    """

    rms: float = rms_height()
    intermittency: float = parameter(
        0.15, "codimension C₁ of the mean flux; 0 is not multifractal", ge=0.0, le=1.0, slider=(0.0, 0.5)
    )
    hurst: float = parameter(0.7, "order H of the fractional integration", gt=0.0, le=2.0, slider=(0.1, 1.0))

    def unscaled(self, waves: PeriodicWaves) -> Floats:
        """Lognormal flux, its logarithm of density C₁/(πf²), integrated by f^−H (Schertzer and Lovejoy 1987)."""
        # A density C₁/(πf²) over the octaves down to a resolution λ has the variance 2 C₁ ln λ, so that the moments of
        # the flux are ⟨φ^q⟩ = λ^K(q) with K(q) = C₁(q² − q).
        fx, fy = waves.frequencies()
        squared = fx**2 + fy**2
        squared[0, 0] = np.inf
        noise = waves.noise()
        if self.intermittency == 0.0:
            return waves.field(noise * squared ** (-0.5 * (self.hurst + 1.0)))
        logarithm = waves.field(noise * np.sqrt(self.intermittency / (math.pi * squared)))
        flux = waves.transform(np.exp(logarithm))
        flux *= (noise != 0.0) * squared ** (-0.5 * self.hurst)
        return waves.field(flux)
