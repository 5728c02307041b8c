"""The beam of a line of transducers."""

import math
from typing import Literal

import numpy as np

from insonify.arrays import Complexes, Floats
from insonify.scene.base import metres, parameter
from insonify.scene.sonar.beams import PATTERN_COLUMNS, AimedBeam, BeamConditions, BeamTable

ELEMENTS = 1024  # point sources from which its pattern is computed
FEWEST_ELEMENTS = 512  # from which the coherence of its echoes is computed
FEWEST_ROWS = 4.0  # per octave of slant range
# Rows per radian by which the phase at the ends of the array, π L² / 4 λ r, changes over an octave, at some range.
ROWS_PER_RADIAN, AT_LENGTHS = 2.0, 20.0
# Sidelobes that count on either side of the main lobe, in steps of wavelength over length; beyond lies less than 0.5 %.
LOBES = {True: 6.0, False: 32.0}
# Half width of the main lobe of each taper to its first null, in the same steps.
FIRST_NULL = {"uniform": 1.0, "cosine": 1.5, "hamming": 2.0, "taylor": 1.36}
TAYLOR_SIDELOBES, TAYLOR_NEARLY_EQUAL = 30, 4  # dB, and how many of them are nearly equal
LOBE_RANGE = 0.4  # share of the range at which the width of the main lobe is measured


class LineArray(AimedBeam, kind="array", rank=40):
    """The beam of a line array, with its sidelobes and its near field, where it is wider than in the far field."""

    caption = "{taper} array of {length:g} m {ways}"
    by_frequency = True
    length: float = metres(0.5, "length of the array along the towfish", (0.1, 2.0), most=20.0)
    taper: Literal["uniform", "cosine", "hamming", "taylor"] = parameter(
        "uniform", "weight of the elements; a tapered array has lower sidelobes and a wider beam"
    )
    two_way: bool = parameter(
        True, "whether the pattern applies to transmission and reception, or only once", rare=True
    )

    def half_width(self, conditions: BeamConditions) -> float:
        """Angle of the first null, in radians."""
        # Within the near field of a long array, r < L²/λ, the beam is nearly as wide as the array is long.
        far = FIRST_NULL[self.taper] * conditions.sound_speed / conditions.frequency / self.length
        near = 0.5 * self.length / (LOBE_RANGE * conditions.range)
        return math.asin(min(max(far, near + 0.5 * far), 1.0))

    def tabulate(self, conditions: BeamConditions) -> BeamTable:
        """Tabulate |∫ w(u) exp(−ik(us − u²/2r)) du|², Fresnel's approximation about the middle, for each pass."""
        ranges, extent, per_octave = self._rows(conditions)
        energy = np.abs(self._fields(ranges, extent, conditions.wavelength)) ** (2.0 * self.passes)
        return BeamTable(self.length, extent, energy, per_octave)

    def phases(self, conditions: BeamConditions) -> Floats:
        """Phases of the same integral, continuous from the axis on."""
        ranges, extent, _ = self._rows(conditions)
        # From the first element to the middle.
        way = 0.5 * (1.0 - 1.0 / ELEMENTS) * self.length / conditions.wavelength
        turns = np.angle(self._fields(ranges, extent, conditions.wavelength)) / math.tau
        turns += way * extent[:, None] * np.linspace(-1.0, 1.0, PATTERN_COLUMNS)
        steps = np.diff(turns, axis=1)
        turns[:, 1:] -= np.cumsum(np.round(steps), axis=1)
        return self.passes * (turns - np.round(turns[:, [PATTERN_COLUMNS // 2]]))

    def _rows(self, conditions: BeamConditions) -> tuple[Floats, Floats, float]:
        """Slant range and extent of every row of the table, and rows per octave."""
        length, first_range, wavelength = self.length, self.length, conditions.wavelength
        # Beyond some ten times L²/λ the waves are flat.
        farthest = max(min(conditions.range, 16.0 * length * length / wavelength), 2.0 * first_range)
        turn = 0.25 * math.pi * length / (AT_LENGTHS * wavelength)
        per_octave = FEWEST_ROWS * max(math.ceil(ROWS_PER_RADIAN * turn / FEWEST_ROWS), 1)
        rows = 1 + math.ceil(per_octave * math.log2(farthest / first_range))
        ranges = first_range * 2.0 ** (np.arange(rows) / per_octave)
        return ranges, self._extent_at(ranges, wavelength), per_octave

    def at_range(self, conditions: BeamConditions) -> BeamTable:
        """Tabulate the sensitivity at the range of the conditions alone."""
        ranges = np.array([conditions.range])
        extent = self._extent_at(ranges, conditions.wavelength)
        energy = np.abs(self._fields(ranges, extent, conditions.wavelength)) ** (2.0 * self.passes)
        return BeamTable(conditions.range, extent, energy)

    def coherence(self, spacing: float, conditions: BeamConditions) -> Floats:
        """Correlations by the field of the array in Fresnel's approximation, near or far."""
        # On a line of scatterers at r the two-way field is that of phase centres m halfway between two elements,
        # A(m) = ∫ w(m + d/2) w(m - d/2) exp(ikd²/4r) dd, convolved with exp(ikx²/r). That chirp leaves correlations as
        # they are: docs/theory/speckle.md. One way the centres lie half as far out as the elements.
        curvature = 2.0 * math.pi / conditions.wavelength / max(conditions.range, self.length)
        # Neighbours at the ends are 1 rad apart.
        count = 1 << math.ceil(math.log2(max(FEWEST_ELEMENTS, curvature * self.length**2)))
        step = self.length / count
        place = (np.arange(count) + 0.5) * step - 0.5 * self.length
        centres = taper_weights(self.taper, count) * np.exp(0.5j * curvature * place**2 / (3 - self.passes))
        if self.passes == 2:
            middle = 0.5 * step * np.arange(1 - count, count + 1)
            centres = np.fft.ifft(np.fft.fft(centres, 2 * count) ** 2) * np.exp(-1j * curvature * middle**2)
        correlation = np.fft.irfft(np.abs(np.fft.fft(centres, 2 * centres.size)[: centres.size + 1]) ** 2)
        lags = spacing * np.arange(math.ceil(0.5 * self.passes * self.length / spacing))
        return np.interp(lags, 0.5 * step * np.arange(centres.size), correlation[: centres.size] / correlation[0])

    def _extent_at(self, ranges: Floats, wavelength: float) -> Floats:
        """Sine at each range beyond which less than 0.5 % arrives."""
        return np.minimum(0.5 * self.length / ranges + LOBES[self.two_way] * wavelength / self.length, 1.0)

    def _fields(self, ranges: Floats, extents: Floats, wavelength: float) -> Complexes:
        """One-way field relative to that of the first element, at ranges, in directions from -extent to extent."""
        from scipy.signal import czt  # lazy: takes longer to import than a preview takes to trace

        place = ((np.arange(ELEMENTS) + 0.5) / ELEMENTS - 0.5) * self.length
        wave_number, weights = 2.0 * math.pi / wavelength, taper_weights(self.taper)
        fields = np.empty((ranges.size, PATTERN_COLUMNS), np.complex128)
        for field, slant_range, extent in zip(fields, ranges, extents):
            curved = weights * np.exp(0.5j * wave_number * place**2 / slant_range)
            step = wave_number * (place[1] - place[0]) * 2.0 * extent / (PATTERN_COLUMNS - 1)
            start = wave_number * (place[1] - place[0]) * extent
            field[:] = czt(curved, PATTERN_COLUMNS, np.exp(-1j * step), np.exp(-1j * start))
        return fields


def taper_weights(name: str, count: int = ELEMENTS) -> Floats:
    """Weights of the elements of an array, of unit sum."""
    u = (np.arange(count) + 0.5) / count - 0.5
    weights = np.ones(count)
    if name == "cosine":
        weights = np.cos(np.pi * u)
    elif name == "hamming":
        weights = 0.54 + 0.46 * np.cos(2.0 * np.pi * u)
    elif name == "taylor":
        from scipy.signal.windows import taylor

        weights = np.asarray(taylor(count, TAYLOR_NEARLY_EQUAL, TAYLOR_SIDELOBES, norm=False))
    return weights / weights.sum()
