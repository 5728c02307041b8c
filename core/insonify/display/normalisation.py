"""Amplitudes of records relative to the echo of a level bed, or of a recording relative to its own median curve.

A record falls by tens of decibels with range. Divided by the curve of a perfect Lambert bed under the same ping, a
uniform bed looks uniform and the rest stands out.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from insonify.acoustics.flat_bed import flat_bed_curve
from insonify.array_cache import keep_arrays
from insonify.arrays import Echoes, Floats, Integers, Reals, Singles
from insonify.kernels.display.rows import ROWS_A_THREAD, relate_amplitudes
from insonify.parallel import in_parallel
from insonify.tow.poses import interpolate_bed_beneath

if TYPE_CHECKING:
    from insonify.simulation import Simulation

MOST_EIGHTHS = 2**53  # of a bin, the greatest altitude of a level bed
_PINGS = 2000  # pings that suffice for the median curve of a recording
_TOGETHER = 64  # bins that are sorted at a time
_FIRST = 1.25  # altitudes from which the bed of a recording counts
_FLATTEST = 1e-6  # least sine of a grazing angle: at smaller ones, the square underflows
_SMOOTH = 64  # the median curve is smoothed over the bins divided by this


class LevelBed:
    """Record of a level, perfect Lambert bed under every ping, by which a picture of a simulation is normalised."""

    def __init__(self, simulation: Simulation) -> None:
        self._simulation = simulation
        self._step = simulation.arrays.bin_length / 8.0
        self._kept = keep_arrays(self._curve)

    def curves(self, pings: Integers) -> Floats:
        """Compute the records of level beds at the altitudes of pings, each rounded to an eighth of a bin."""
        curves, which = self._curves_of(pings)
        return curves[which]

    def normalise(self, intensity: Singles, pings: Integers) -> Singles:
        """Compute amplitudes relative to the level beds of pings."""
        return _relate(np.array(intensity, dtype=np.float32, order="C"), *self._curves_of(pings))

    def amplitudes(self, pings: Integers) -> Singles:
        """Trace pings and compute their amplitudes relative to the level beds, in the memory of their intensities."""
        return self.trace(pings)[0]

    def trace(self, pings: Integers) -> tuple[Singles, Singles]:
        """Trace pings, and compute their amplitudes as `amplitudes` does and their estimated errors, (pings,)."""
        intensity, errors = self._simulation.trace_record(pings)
        return _relate(np.ascontiguousarray(intensity), *self._curves_of(pings)), errors

    def _curves_of(self, pings: Integers) -> tuple[Floats, Integers]:
        """Curves, (curves, bins), and which of them each ping has, (pings, 1)."""
        simulation = self._simulation
        beneath = interpolate_bed_beneath(simulation.scene, simulation.ground, pings)
        # Far from all places there is no number for the height of the bed.
        eighths = np.nan_to_num(np.rint((simulation.poses(pings).z - beneath) / self._step), nan=1.0)
        numbers, which = np.unique(np.clip(eighths, 1, MOST_EIGHTHS).astype(np.int64), return_inverse=True)
        curves = np.array([self._kept(int(number)) for number in numbers])
        return curves.reshape(-1, simulation.arrays.bins), which[:, None]

    def _curve(self, eighths: int) -> Floats:
        echo = extend_to_water_column(flat_bed_curve(self._simulation.arrays, eighths * self._step))
        return self._simulation.reception.expected(echo)


def extend_to_water_column(curve: Floats) -> Floats:
    """Extend the first return of a curve over the bins before it, in which objects above the bed may echo."""
    # The first bin of the bed is partly filled, so the larger of the first two values is used.
    positive = np.flatnonzero(curve > 0.0)
    if positive.size == 0:
        return np.ones_like(curve)
    first = int(positive[0])
    filled = curve.copy()
    filled[: first + 1] = curve[first : first + 2].max()
    return filled


class MedianCurve(NamedTuple):
    """Curve by which a picture of a recording of unknown sonar and bed is normalised."""

    level: Floats | None  # (bins,) intensities of a bed under a vertical ray; None of a record without echoes
    slant_range: Floats  # (bins,) in metres

    def at(self, altitude: Floats) -> Floats:
        """Curves of pings at some altitudes above the bed in metres, (pings, bins)."""
        if self.level is None:
            return np.ones((altitude.size, self.slant_range.size))
        return self.level * _sine(altitude, self.slant_range) ** 2


def estimate_median_curve(intensity: Echoes, altitude: Floats, bin_length: float) -> MedianCurve:
    """Estimate the curve of a recording, (2, pings, bins), from its median at every slant range."""
    # Lambert's law removes the effect of the grazing angle as the altitude changes.
    some = slice(None, None, intensity.shape[1] // _PINGS + 1)
    r = (np.arange(intensity.shape[-1]) + 0.5) * bin_length
    echoes, height = np.asarray(intensity[:, some]), altitude[some]
    curve = np.empty(len(r))
    for first in range(0, len(r), _TOGETHER):
        part = slice(first, first + _TOGETHER)
        # At shorter range an error of the altimeter would count water as bed.
        below = r[part] >= _FIRST * height[:, None]
        upright = np.where(below, echoes[:, :, part] / _sine(height, r[part]) ** 2, 0.0)
        curve[part] = _middles(upright.reshape(-1, upright.shape[-1]))
    known = np.flatnonzero(curve > 0.0)
    if known.size == 0:
        return MedianCurve(None, r)
    logarithm = np.interp(np.arange(len(r)), known, np.log(curve[known]))
    from scipy.ndimage import gaussian_filter1d, median_filter  # lazy: only recordings need SciPy

    steady = median_filter(logarithm, size=len(r) // _SMOOTH + 1)  # removes marks that recorders put at the edges
    return MedianCurve(np.exp(gaussian_filter1d(steady, len(r) / _SMOOTH)), r)


def _sine(altitude: Floats, slant_range: Floats) -> Floats:
    """Sine of the grazing angle on a level bed, (pings, bins); 1 where the altitude is not known."""
    return np.clip(np.where(altitude > 0.0, altitude, np.inf)[:, None] / slant_range, _FLATTEST, 1.0)


def _middles(echoes: Reals) -> Floats:
    """Median of the positive echoes in each bin, (echoes, bins), 0 where there are none."""
    positive = echoes > 0.0
    number, ordered = positive.sum(axis=0), np.sort(np.where(positive, echoes, np.inf), axis=0)
    lower, upper = (ordered[at, np.arange(number.size)] for at in (np.maximum(number - 1, 0) // 2, number // 2))
    return np.where(number > 0, 0.5 * (lower + upper), 0.0)


def normalise(intensity: Singles, curve: Floats) -> Singles:
    """Compute amplitudes relative to a curve."""
    curves = np.asarray(curve, dtype=np.float64)
    which = np.arange(math.prod(curves.shape[:-1])).reshape(curves.shape[:-1])
    amplitude = np.array(intensity, dtype=np.float32, order="C")
    return _relate(amplitude, curves.reshape(-1, curves.shape[-1]), which)


def _relate(intensity: Singles, curves: Floats, which: Integers) -> Singles:
    """Turn intensities into amplitudes relative to curves, (curves, bins), one of them for each row of a record."""
    # They are written in place: to touch fresh memory takes longer than the arithmetic.
    record, inverse = intensity.reshape(-1, intensity.shape[-1]), 1.0 / curves
    rows = np.broadcast_to(which, intensity.shape[:-1]).flatten()  # a view is read-only, and compiled for on its own

    def block(first: int, last: int) -> None:
        relate_amplitudes(record[first:last], inverse, rows[first:last])

    in_parallel(block, len(rows), least=ROWS_A_THREAD)
    return intensity
