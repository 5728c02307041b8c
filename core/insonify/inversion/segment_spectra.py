"""Two-dimensional spectra of a record's relative amplitude, in segments of the bed grouped by grazing angle."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from insonify.acoustics.error_range import ERROR_ALTITUDES
from insonify.display.normalisation import normalise
from insonify.inversion.level_curve import LevelCurve, fit_level_curve
from insonify.scene import SceneError

SEGMENT = 128  # pings and bins of a segment
GROUPS = 4  # of grazing angles
MOST_SEGMENTS = 400  # that are measured; more change nothing
# Efficiency of the median of periodograms against their mean, 0.48 = ln²2, times that of segments that overlap by half.
EFFICIENCY = 0.48 * 0.5

Field = NDArray[np.float64]


class SoundedBed(NamedTuple):
    """A record with the altitude that its own first echoes tell."""

    title: str  # name of the record in messages
    intensity: NDArray[np.float32]  # (2, pings, bins) linear, port first
    altitude: Field  # (pings,) height of the sonar above the bed, in metres
    bin_length: float  # slant range of a bin, in metres
    ping_spacing: float  # mean distance between pings, in metres
    level: LevelCurve  # level by range and angle

    @property
    def slant_range(self) -> Field:
        """Slant ranges of the centres of the bins, (bins,) in metres."""
        return np.asarray((np.arange(self.intensity.shape[2]) + 0.5) * self.bin_length)

    def amplitude(self) -> NDArray[np.float32]:
        """Amplitude relative to the level of the record, (2, pings, bins)."""
        return normalise(self.intensity, self.level.intensity(self.altitude, self.slant_range))


class AngleGroup(NamedTuple):
    """Median spectrum of the segments of similar grazing angle."""

    sine: float  # sine of the mean grazing angle
    slant_range: float  # mean slant range, in metres
    # (SEGMENT, SEGMENT // 2 + 1) density of the relative amplitude in m², over frequencies along the track (in
    # the order of `numpy.fft`) and in slant range; its integral over both signs of both frequencies is the
    # variance.
    power: Field
    segments: int  # number of segments


class SegmentSpectra(NamedTuple):
    """Spectra of a record by grazing angle."""

    along: Field  # (SEGMENT,) frequencies along the track, cycles a metre
    across: Field  # (SEGMENT // 2 + 1,) frequencies in slant range, cycles a metre
    groups: tuple[AngleGroup, ...]  # from grazing to steep angles
    sample: float  # area of a sample, distance between pings times length of a bin, in m²


def sound_bed(record: xr.Dataset, altitude: Field, *, separate: bool) -> SoundedBed:
    """Take from a record what its bed is learned from."""
    x, y = record["platform_x"].values, record["platform_y"].values
    spacing = float(np.hypot(np.diff(x), np.diff(y)).mean()) if len(x) > 1 else 0.0
    intensity = record["intensity"].transpose("channel", "ping_time", "range_sample").values
    title = str(record.attrs.get("title", "record"))
    bin_length = 2.0 * float(record["slant_range"].values[0])
    altitude = np.maximum(altitude, bin_length)  # of a sonar in a trough of a rough bed
    level = fit_level_curve(intensity, altitude, bin_length, separate=separate)
    return SoundedBed(title, intensity, altitude, bin_length, spacing, level)


def measure_segment_spectra(bed: SoundedBed) -> SegmentSpectra:
    """Measure the spectra of a bed beyond 1.4 altitudes.

    The amplitude is the square root of the intensity over the level of the record. For a Lambert bed it is nearly
    linear in the slope along the line of sight. The median over the segments of a group is robust against targets.
    """
    sine, ranges, power = _measure_periodograms(bed)
    order = np.argsort(sine, kind="stable")
    groups = tuple(
        AngleGroup(float(sine[part].mean()), float(ranges[part].mean()), _median_power(power[part]), part.size)
        for part in np.array_split(order, min(GROUPS, order.size))
    )
    along, across = np.fft.fftfreq(SEGMENT, bed.ping_spacing), np.fft.rfftfreq(SEGMENT, bed.bin_length)
    return SegmentSpectra(np.asarray(along), np.asarray(across), groups, bed.ping_spacing * bed.bin_length)


def _median_power(power: NDArray[np.float32]) -> Field:
    """Mean of exponential variables by their median, ln 2 times that."""
    return np.asarray(np.median(power, axis=0) / np.log(2.0))


def _measure_periodograms(bed: SoundedBed) -> tuple[Field, Field, NDArray[np.float32]]:
    """Sines of the grazing angles, slant ranges and periodograms of all segments."""
    amplitude = bed.amplitude()
    grazing = np.minimum(bed.altitude[:, None] / bed.slant_range, 1.0)
    found = [
        (float(grazing[part[1:]].mean()), float(bed.slant_range[part[2]].mean()), _periodogram(amplitude[part], bed))
        for part in _segments(bed)
        if amplitude[part].mean() > 0.0
    ]
    if not found or not bed.ping_spacing > 0.0:
        raise SceneError(
            f"{bed.title}: has too little bed to learn from; give a record of at least {SEGMENT} pings that move on, "
            f"with {SEGMENT} bins beyond {ERROR_ALTITUDES} altitudes"
        )
    sine, ranges, power = zip(*found)
    return np.array(sine), np.array(ranges), np.array(power)


def _segments(bed: SoundedBed) -> list[tuple[int, slice, slice]]:
    """Channel, pings and bins of the segments that hold bed alone; they overlap by half."""
    _, pings, bins = bed.intensity.shape
    half = SEGMENT // 2
    found = []
    for first in range(0, pings - SEGMENT + 1, half):
        together = slice(first, first + SEGMENT)
        nearest = np.searchsorted(bed.slant_range, ERROR_ALTITUDES * bed.altitude[together].max())
        starts = range(int(nearest), bins - SEGMENT + 1, half)
        found += [(channel, together, slice(start, start + SEGMENT)) for start in starts for channel in (0, 1)]
    return found[:: len(found) // MOST_SEGMENTS + 1]


def _periodogram(amplitude: NDArray[np.float32], bed: SoundedBed) -> NDArray[np.float32]:
    """Periodogram of one segment over its mean, less its mean plane, under Hann windows."""
    relative = amplitude / amplitude.mean(dtype=np.float64) - 1.0
    ramp = np.linspace(-1.0, 1.0, SEGMENT)
    for slope in (ramp[:, None], ramp[None, :]):
        relative -= slope * ((relative * slope).mean() / (ramp**2).mean())
    hann = 0.5 - 0.5 * np.cos(2.0 * np.pi * np.arange(SEGMENT) / SEGMENT)
    power = np.abs(np.fft.rfft2(relative * hann[:, None] * hann)) ** 2
    return np.asarray(power * (bed.ping_spacing * bed.bin_length / (hann**2).sum() ** 2), dtype=np.float32)
