"""The beam of a line of transducers."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np

from insonify.scene.base import parameter
from insonify.scene.sonar.beams import COLUMNS, BeamTable, Sounding, Values
from insonify.scene.sonar.beams.aimed import AimedBeam

ELEMENTS = 1024  # as its pattern is computed
FEWEST_ROWS = 4.0  # per octave of slant range
# Rows per radian by which the phase at the ends of the array, π L² / 4 λ r, changes over an octave, at some range.
ROWS_PER_RADIAN, AT_LENGTHS = 2.0, 20.0
# Sidelobes that count on either side of the main lobe, in steps of wavelength over length; beyond lies less than 0.5 %.
LOBES = {True: 6.0, False: 32.0}
# Half the main lobe of each taper to its first null, in the same steps.
FIRST_NULL = {"uniform": 1.0, "cosine": 1.5, "hamming": 2.0, "taylor": 1.36}
TAYLOR_SIDELOBES, TAYLOR_NEARLY_EQUAL = 30, 4  # dB, and how many of them are nearly equal
FAR = 0.4  # share of the range at which the main lobe is taken to be as wide as there
# Width at half power of a line array's far field, in wavelengths over its length, one way and two way.


class LineArray(AimedBeam):
    """The beam of a line array, with its sidelobes and its near field, in which it is wider than in the far field."""

    rank = 40
    by_frequency = True
    kind: Literal["array"] = "array"
    length: float = parameter(
        0.5, unit="m", description="length of the array along the fish", gt=0.0, le=20.0, slider=(0.1, 2.0), log=True
    )
    taper: Literal["uniform", "cosine", "hamming", "taylor"] = parameter(
        "uniform", description="weight of the elements; a tapered array has lower sidelobes and a wider beam"
    )
    two_way: bool = parameter(
        True, description="whether the pattern applies to transmission and reception, or once", rare=True
    )

    @property
    def words(self) -> str:
        """Name of the beam for captions."""
        return self._named(f"{self.taper} array of {self.length:g} m {'two' if self.two_way else 'one'}-way")

    @property
    def passes(self) -> int:
        """How often sound passes the beam."""
        return 2 if self.two_way else 1

    def half_width(self, sounding: Sounding) -> float:
        """Angle of the first null, in radians.

        The beam of a long array is nearly as wide as the array is long within its near field, r < L²/λ.
        """
        far = FIRST_NULL[self.taper] * sounding.sound_speed / sounding.frequency / self.length
        near = 0.5 * self.length / (FAR * sounding.range)
        return math.asin(min(max(far, near + 0.5 * far), 1.0))

    def tabulate(self, sounding: Sounding) -> BeamTable:
        """Tabulate the near and the far field."""
        return self.near_field(sounding.wavelength, sounding.range)

    def near_field(self, wavelength: float, farthest_range: float) -> BeamTable:
        """Tabulate |∫ w(u) exp(−ik(us − u²/2r)) du|², Fresnel's approximation about the middle, for each pass."""
        length, first_range = self.length, self.length
        # Beyond some ten times L²/λ the waves are flat.
        farthest = max(min(farthest_range, 16.0 * length * length / wavelength), 2.0 * first_range)
        turn = 0.25 * math.pi * length / (AT_LENGTHS * wavelength)
        per_octave = FEWEST_ROWS * max(math.ceil(ROWS_PER_RADIAN * turn / FEWEST_ROWS), 1)
        rows = 1 + math.ceil(per_octave * math.log2(farthest / first_range))
        ranges = first_range * 2.0 ** (np.arange(rows) / per_octave)
        extent = self._extent_at(ranges, wavelength)
        weights = self._weights()
        energy = np.empty((rows, COLUMNS))
        for row in range(rows):
            energy[row] = self._energy_at(ranges[row], extent[row], wavelength, weights)
        return BeamTable(first_range, extent, energy, per_octave)

    def at_range(self, sounding: Sounding) -> BeamTable:
        """Tabulate the range alone."""
        extent = self._extent_at(np.array([sounding.range]), sounding.wavelength)
        energy = self._energy_at(sounding.range, extent[0], sounding.wavelength, self._weights())
        return BeamTable(sounding.range, extent, energy[None, :])

    def _extent_at(self, ranges: Values, wavelength: float) -> Values:
        """Sine at each range beyond which less than 0.5 % arrives."""
        return np.minimum(0.5 * self.length / ranges + LOBES[self.two_way] * wavelength / self.length, 1.0)

    def _weights(self) -> Values:
        """Weights of the elements, which sum to 1."""
        weights = taper_weights(self.taper)
        return weights / weights.sum()

    def _energy_at(self, slant_range: float, extent: float, wavelength: float, weights: Values) -> Values:
        """Sensitivity at one range by direction from -extent to extent."""
        from scipy.signal import czt  # takes longer to import than a preview takes to trace

        place = ((np.arange(ELEMENTS) + 0.5) / ELEMENTS - 0.5) * self.length
        wave_number = 2.0 * math.pi / wavelength
        curved = weights * np.exp(0.5j * wave_number * place**2 / slant_range)
        step = wave_number * (place[1] - place[0]) * 2.0 * extent / (COLUMNS - 1)
        start = wave_number * (place[1] - place[0]) * extent
        field = czt(curved, COLUMNS, np.exp(-1j * step), np.exp(-1j * start))
        return np.asarray(np.abs(field) ** (2.0 * self.passes))


def taper_weights(name: str) -> Values:
    """Weights of the elements of an array."""
    u = (np.arange(ELEMENTS) + 0.5) / ELEMENTS - 0.5
    if name == "cosine":
        return np.cos(np.pi * u)
    if name == "hamming":
        return 0.54 + 0.46 * np.cos(2.0 * np.pi * u)
    if name == "taylor":
        from scipy.signal.windows import taylor

        return np.asarray(taylor(ELEMENTS, TAYLOR_NEARLY_EQUAL, TAYLOR_SIDELOBES, norm=False))
    return np.ones(ELEMENTS)
