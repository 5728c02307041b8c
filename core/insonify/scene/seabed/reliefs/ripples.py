"""Sand ripples."""

import math

import numpy as np

from insonify.arrays import Floats
from insonify.scene.base import angle, metres, parameter, share
from insonify.scene.seabed.materials import MaterialMap
from insonify.scene.seabed.reliefs.random_relief import ExtendableRelief, density_waves
from insonify.scene.seabed.reliefs.spectrum import (
    LONGEST_WAVES,
    Band,
    Density,
    PeriodicWaves,
    rotate_frequencies,
    row_groups,
)

FEWEST_CELLS = 3  # of one ripple
FADE = 0.3  # share of the rms amplitude below which crests fade: they end at singularities of the phase


class Ripples(ExtendableRelief, kind="ripples", rank=50):
    """Crests of equal height that bend, fork and end: shaped from the phase of a narrow band of waves."""

    shaped = True
    wavelength: float = metres(0.8, "mean distance from crest to crest", (0.3, 20.0), most=1e5)
    heading: float = angle("direction along the crests, counter-clockwise from east; 45T is 45° by the compass", 30.0)
    height: float = metres(0.08, "height from trough to crest", (0.005, 2.0), least=0.0, most=1e4)
    bandwidth: float = parameter(
        0.1,
        "spread of the wave numbers across the crests over their mean; more makes crests less regular",
        gt=0.0,
        le=0.5,
        slider=(0.01, 0.3),
    )
    bandwidth_along: float = parameter(
        0.08,
        "spread of the wave numbers along the crests over their mean; more makes crests shorter",
        gt=0.0,
        le=0.5,
        slider=(0.01, 0.3),
    )
    sharpness: float = share(0.6, "0: crests as round as the troughs; 1: sharp crests between rounded troughs")

    @property
    def wave(self) -> tuple[float, float]:
        """Mean wave along x and y, cycles a metre, to the left of the crests' heading."""
        angle = math.radians(self.heading)
        return -math.sin(angle) / self.wavelength, math.cos(angle) / self.wavelength

    def band(self, narrowest: float = 0.0) -> Density:
        """Band of waves about zero for the ripples' phase; its level does not matter."""
        spread_across = max(self.bandwidth / self.wavelength, narrowest)
        spread_along = max(self.bandwidth_along / self.wavelength, narrowest)

        def density(fx: Floats, fy: Floats) -> Floats:
            f_along, f_across = rotate_frequencies(fx, fy, self.heading)
            return np.asarray(np.exp(-0.5 * ((f_across / spread_across) ** 2 + (f_along / spread_along) ** 2)))

        return density

    def heights(self, waves: PeriodicWaves, reference: PeriodicWaves) -> Floats:
        """Shape the phase of the analytic signal of a narrow band of waves."""
        band, wave = self.band(LONGEST_WAVES / self.period), self.wave

        def about_both(fx: Floats, fy: Floats) -> Floats:
            return band(fx - wave[0], fy - wave[1]) + band(fx + wave[0], fy + wave[1])

        made = density_waves(about_both, self.period, waves)
        level = math.sqrt(2.0 * waves.variance(made))
        # Turned by a quarter of a cycle: the Hilbert transform across the crests.
        (fx, fy), turned = waves.frequencies(), np.empty_like(made)
        for rows in row_groups(len(made)):
            _, across = rotate_frequencies(fx, fy[rows], self.heading)
            np.multiply(-1j * np.sign(across), made[rows], out=turned[rows])
        imaginary, heights = waves.field(turned), waves.field(made)
        for rows in row_groups(len(heights)):
            heights[rows] = self.shape_waves(heights[rows], imaginary[rows], level)
        return heights

    def bands(self) -> tuple[Band, ...]:
        """Return the band about the mean wave."""
        narrow = min(self.bandwidth, self.bandwidth_along) / self.wavelength
        return (Band(self.band(), narrow, self.wave),)

    def shape_waves(self, real: Floats, imaginary: Floats, level: float) -> Floats:
        """Heights from a complex field with phase 0 on crests."""
        # A sharp profile has crests with a corner, 4 height/wavelength steep, over parabolic troughs; a round one is a
        # cosine.
        phase = np.abs(np.arctan2(imaginary, real))
        sharp = 2.0 * (1.0 - phase / math.pi) ** 2 - 2.0 / 3.0  # about its own mean
        profile = np.cos(phase) + self.sharpness * (sharp - np.cos(phase))
        amplitude = np.hypot(real, imaginary)
        # A grid without waves has no crests.
        whole = np.maximum(np.hypot(amplitude, FADE * level), np.finfo(np.float64).tiny)
        return np.asarray(0.5 * self.height * profile * (amplitude / whole))

    def check(self, spacing: float, material: MaterialMap) -> None:
        """Check the wavelength against the spacing and the period."""
        super().check(spacing, material)
        if self.wavelength < FEWEST_CELLS * spacing * (1.0 - 1e-9):
            raise ValueError(
                f"relief.wavelength {self.wavelength:g} m spans fewer than {FEWEST_CELLS} cells of spacing "
                f"{spacing:g} m; lengthen it or reduce the spacing"
            )
        if 2.0 * self.wavelength > self.period and not self.endless:
            raise ValueError(
                f"relief.wavelength {self.wavelength:g} m fits less than twice into period {self.period:g} m; "
                "shorten it or lengthen the period"
            )
