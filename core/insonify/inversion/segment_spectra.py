"""Two-dimensional spectra of a record's relative amplitude, in segments of the bed grouped by grazing angle."""

from typing import NamedTuple

import numpy as np
import xarray as xr
from scipy.sparse import csr_array

from insonify.acoustics.flat_bed import ERROR_ALTITUDES
from insonify.arrays import Floats, Singles
from insonify.display.normalisation import estimate_median_curve, normalise
from insonify.scene import SceneError
from insonify.statistics.record_statistics import measure_ping_spacing

RISE = 1.5  # ratio of the highest to the lowest altitude above which effects of range and angle are separable
BLOCK = (16, 4)  # pings and bins of a block, which counts by its median
RANGE_KNOTS, ANGLE_KNOTS = 24, 20
RIDGE = 0.3  # weight of a prior of no effect, in blocks, at every knot
ROUNDS, SPREAD = 12, 1.0  # of reweighting, and the residual in dB from which blocks count less: targets, shadows
STEEPEST = 85.0  # degrees
SEGMENT = 128  # pings and bins of a segment
GROUPS = 4  # of grazing angles
MOST_SEGMENTS = 400  # that are measured; more change nothing
# Efficiency of the median of periodograms against their mean, 0.48 = ln²2, times that of segments that overlap by half.
EFFICIENCY = 0.48 * 0.5


class LevelCurve(NamedTuple):
    """Level of a record, in dB: a function of range plus a function of grazing angle, on top of Lambert's sin² θ."""

    by_range: Floats  # (bins,) gain, spreading, absorption and material
    # (n,) vertical beam and the bed's own law of scattering, by the grazing angle in degrees; zero throughout for
    # a level track, where angle and range are one.
    angles: Floats
    by_angle: Floats

    def intensity(self, altitude: Floats, slant_range: Floats) -> Floats:
        """Intensity of the bed under every ping, (pings, bins)."""
        sine = _sine(altitude, slant_range)
        level = self.by_range + np.interp(np.degrees(np.arcsin(sine)), self.angles, self.by_angle)
        return np.asarray(10.0 ** (level / 10.0) * sine**2)


def fit_level_curve(intensity: Singles, altitude: Floats, bin_length: float, *, separate: bool) -> LevelCurve:
    """Fit the level of a record: its median at every slant range, and its dependence on the grazing angle."""
    r = np.asarray((np.arange(intensity.shape[2]) + 0.5) * bin_length)
    lowest = int(np.argmin(altitude))
    median = estimate_median_curve(intensity, altitude, bin_length).at(altitude[[lowest]])[0]
    upright = median / _sine(altitude[[lowest]], r)[0] ** 2
    plain = LevelCurve(10.0 * np.log10(np.maximum(upright, 1e-300)), np.array([0.0, 90.0]), np.zeros(2))
    if not separate or altitude.max() < RISE * altitude.min():
        return plain
    return _separate(intensity, altitude, r, plain)


def _separate(intensity: Singles, altitude: Floats, r: Floats, plain: LevelCurve) -> LevelCurve:
    """Separate the effects of range and angle in the medians of blocks, by robust least squares."""
    relative = np.mean(intensity, axis=0, dtype=np.float64) / plain.intensity(altitude, r)
    angle = np.degrees(np.arcsin(_sine(altitude, r)))
    blocks, angles = _blocks(relative), np.mean(_blocks(angle), axis=-1)
    ranges = np.broadcast_to(np.mean(_blocks(np.broadcast_to(r, angle.shape)), axis=-1), angles.shape)
    level = 10.0 * np.log10(np.maximum(np.median(blocks, axis=-1), 1e-30))
    bed = (np.max(_blocks(angle), axis=-1) < STEEPEST) & (level > -100.0)
    far = np.linspace(r[0], r[-1], RANGE_KNOTS)
    steep = np.linspace(angles[bed].min(), angles[bed].max(), ANGLE_KNOTS)
    design = np.hstack([_hats(ranges[bed], far), _hats(angles[bed], steep)])
    found = _solve(design, level[bed])
    by_angle = found[RANGE_KNOTS:] - found[RANGE_KNOTS:].mean()
    by_range = np.interp(r, far, found[:RANGE_KNOTS]) + found[RANGE_KNOTS:].mean()
    return LevelCurve(plain.by_range + by_range, steep, by_angle)


def _solve(design: Floats, level: Floats) -> Floats:
    """Least absolute deviations by reweighting, with a weak pull of all effects to zero."""
    pull = RIDGE * np.eye(design.shape[1])
    weight = np.ones(level.size)
    few = csr_array(design)  # at most four knots of 44 count for a block
    for _ in range(ROUNDS):
        weighted = few.T.multiply(weight)
        found = np.linalg.solve((weighted @ few).toarray() + pull, weighted @ level)
        weight = 1.0 / np.maximum(np.abs(level - few @ found), SPREAD)
    return np.asarray(found)


def _hats(values: Floats, knots: Floats) -> Floats:
    """Weights of the knots at values between them, (values, knots)."""
    return np.stack([np.interp(values, knots, one) for one in np.eye(knots.size)], axis=1)


def _blocks(values: Floats) -> Floats:
    """Cut a field into blocks, (rows, columns, samples)."""
    rows, columns = (size // step for size, step in zip(values.shape, BLOCK))
    cut = values[: rows * BLOCK[0], : columns * BLOCK[1]].reshape(rows, BLOCK[0], columns, BLOCK[1])
    return cut.swapaxes(1, 2).reshape(rows, columns, -1)


def _sine(altitude: Floats, slant_range: Floats) -> Floats:
    """Sine of the grazing angle, (pings, bins), 1 above the bed."""
    return np.asarray(np.minimum(altitude[:, None] / slant_range, 1.0))


class SoundedBed(NamedTuple):
    """A record with the altitude by its own first echoes."""

    title: str  # name of the record in messages
    intensity: Singles  # (2, pings, bins) linear, port first
    altitude: Floats  # (pings,) height of the sonar above the bed, in metres
    bin_length: float  # slant range of a bin, in metres
    ping_spacing: float  # mean distance between pings, in metres
    level: LevelCurve  # level by range and angle

    @property
    def slant_range(self) -> Floats:
        """Slant ranges of the centres of the bins, (bins,) in metres."""
        return np.asarray((np.arange(self.intensity.shape[2]) + 0.5) * self.bin_length)


class AngleGroup(NamedTuple):
    """Median spectrum of the segments of similar grazing angle."""

    sine: float  # sine of the mean grazing angle
    slant_range: float  # mean slant range, in metres
    # (SEGMENT, SEGMENT // 2 + 1) density of the relative amplitude in m², over frequencies along the track (in
    # the order of `numpy.fft`) and in slant range; its integral over both signs of both frequencies is the
    # variance.
    power: Floats
    segments: int  # number of segments


class SegmentSpectra(NamedTuple):
    """Spectra of a record by grazing angle."""

    along: Floats  # (SEGMENT,) frequencies along the track, cycles a metre
    across: Floats  # (SEGMENT // 2 + 1,) frequencies in slant range, cycles a metre
    groups: tuple[AngleGroup, ...]  # from grazing to steep angles
    sample: float  # area of a sample, distance between pings times length of a bin, in m²


def sound_bed(record: xr.Dataset, altitude: Floats, *, separate: bool) -> SoundedBed:
    """Take the data of a record from which a bed is learned."""
    intensity = record["intensity"].transpose("channel", "ping_time", "range_sample").values
    title = str(record.attrs.get("title", "record"))
    bin_length = 2.0 * float(record["slant_range"].values[0])
    altitude = np.maximum(altitude, bin_length)  # of a sonar in a trough of a rough bed
    level = fit_level_curve(intensity, altitude, bin_length, separate=separate)
    return SoundedBed(title, intensity, altitude, bin_length, measure_ping_spacing(record), level)


def measure_segment_spectra(bed: SoundedBed) -> SegmentSpectra:
    """Measure the spectra of a bed beyond 1.4 altitudes."""
    # The amplitude is the square root of the intensity over the level of the record. For a Lambert bed it is nearly
    # linear in the slope along the line of sight. The median over the segments of a group is robust against targets.
    sine, ranges, power = _measure_periodograms(bed)
    order = np.argsort(sine, kind="stable")
    groups = []
    for part in np.array_split(order, min(GROUPS, order.size)):
        median = np.median(power[part], axis=0) / np.log(2.0)  # the median of an exponential variable is ln 2 means
        groups.append(AngleGroup(float(sine[part].mean()), float(ranges[part].mean()), np.asarray(median), part.size))
    along, across = np.fft.fftfreq(SEGMENT, bed.ping_spacing), np.fft.rfftfreq(SEGMENT, bed.bin_length)
    return SegmentSpectra(np.asarray(along), np.asarray(across), tuple(groups), bed.ping_spacing * bed.bin_length)


def _measure_periodograms(bed: SoundedBed) -> tuple[Floats, Floats, Singles]:
    """Sines of the grazing angles, slant ranges and periodograms of all segments."""
    amplitude = normalise(bed.intensity, bed.level.intensity(bed.altitude, bed.slant_range))
    grazing = _sine(bed.altitude, bed.slant_range)
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


def _periodogram(amplitude: Singles, bed: SoundedBed) -> Singles:
    """Periodogram of one segment over its mean, less its mean plane, under Hann windows."""
    relative = amplitude / amplitude.mean(dtype=np.float64) - 1.0
    ramp = np.linspace(-1.0, 1.0, SEGMENT)
    for slope in (ramp[:, None], ramp[None, :]):
        relative -= slope * ((relative * slope).mean() / (ramp**2).mean())
    hann = 0.5 - 0.5 * np.cos(2.0 * np.pi * np.arange(SEGMENT) / SEGMENT)
    power = np.abs(np.fft.rfft2(relative * hann[:, None] * hann)) ** 2
    return np.asarray(power * (bed.ping_spacing * bed.bin_length / (hann**2).sum() ** 2), dtype=np.float32)
