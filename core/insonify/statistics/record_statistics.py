"""Statistics of a record by which recordings and simulations are compared: speckle, spectra, depth of shadows.

They are measured on amplitudes relative to the record's median curve (`estimate_median_curve`) beyond 1.4 times the
altitude, so that gain, range and the strong echoes near nadir have no effect.
"""

from typing import NamedTuple

import numpy as np
import xarray as xr
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from insonify.acoustics.flat_bed import ERROR_ALTITUDES
from insonify.arrays import Booleans, Floats, Reals, Singles
from insonify.display.normalisation import normalise
from insonify.display.sheet import compute_median_curve, fill_altitude
from insonify.scene import SceneError
from insonify.terrain.periodic_waves import frequencies

PATCH = 16  # pings and bins of a patch
EVENEST = 0.25  # share of the patches that count as even
SEGMENT = 128  # samples of a segment for a spectrum
ENOUGH = 20_000  # segments that settle a spectrum, or amplitudes that settle a step
BLOCK = (4, 16)  # pings and bins of a block that may lie in shadow
BAND = 1024  # least number of blocks at neighbouring ranges; the darkest of them give the noise floor
DARKEST = 4e-3  # share of them
FEWEST = 1e-3  # least share of all blocks; fewer are due to chance, not shadows
SPREADS = 5.0  # below the median, in spreads of the bed's own levels, that chance does not reach
LEAST_DEPTH = 3.0  # dB
SILENCE = -60.0  # dB; nothing counts as darker
STEPS = 4.0  # least median amplitude, in steps of the record, from which it is measured
OFF_STEP = 0.02  # greatest distance of an amplitude from a multiple of the step: 16 bits in single precision
CLIPPED = 1e-4  # share of samples at the greatest amplitude above which it counts as full scale
LOWEST_WAVE = 4.0  # cycles per period; lower frequencies have few waves and are clamped
LEAST_SPAN = 16.0  # cycles per period between the lowest and the highest frequency


class AmplitudeSpectrum(NamedTuple):
    """Power spectrum of the relative amplitude in one direction."""

    frequency: Floats  # (63,) cycles per metre, without zero and the highest
    # (63,) one-sided density in metres: its integral over frequency is the variance of amplitude over mean.
    power: Floats

    def slope(self) -> float:
        """Fit the exponent p of power ~ frequency^p below half the highest frequency."""
        low = slice(None, len(self.frequency) // 2)
        with np.errstate(divide="ignore"):
            return float(np.polyfit(np.log(self.frequency[low]), np.log(self.power[low]), 1)[0])


class RecordStatistics(NamedTuple):
    """Statistics of a record."""

    # (patches,) coefficient of variation of the amplitude in each even patch; 0.523 for fully developed speckle.
    variation: Floats
    amplitude: Singles  # (patches, 256) amplitudes in those patches, over the mean of each
    along: AmplitudeSpectrum  # along the track and across it; the latter in slant range
    across: AmplitudeSpectrum
    shadow_depth: float  # median level of shadows, in dB below the record's own median; NaN where there are none
    silent: bool  # whether shadows hold less than half a step of the record, so that they may be deeper still

    def lines(self) -> list[str]:
        """Describe the statistics in three lines."""
        low, middle, high = np.percentile(self.variation, [10.0, 50.0, 90.0])
        return [
            f"variation of amplitude in even patches {middle:.2f} ({low:.2f} to {high:.2f})",
            self._shadows(),
            f"slope of the spectrum along track {self.along.slope():.2f}, across {self.across.slope():.2f}",
        ]

    def described(self) -> dict[str, str]:
        """Describe each statistic by a short name, for a table of several records."""
        low, middle, high = np.percentile(self.variation, [10.0, 50.0, 90.0])
        return {
            "variation": f"{middle:.2f} ({low:.2f}–{high:.2f})",
            "shadows": self._shadows().removeprefix("shadows ").removesuffix(" shadows"),
            "slope along": f"{self.along.slope():.2f}",
            "slope across": f"{self.across.slope():.2f}",
        }

    def _shadows(self) -> str:
        """Describe the shadows."""
        if np.isnan(self.shadow_depth):
            return "no shadows"
        if self.shadow_depth >= -SILENCE:
            return "shadows without any echo"
        return f"shadows {'at least ' if self.silent else ''}{self.shadow_depth:.1f} dB deep"


def measure_statistics(record: xr.Dataset) -> RecordStatistics:
    """Measure the statistics of a record."""
    intensity = record["intensity"].transpose("channel", "ping_time", "range_sample").values
    curve = compute_median_curve(record)[:, 0]
    amplitude = normalise(intensity, curve)
    r, altitude = record["slant_range"].values, fill_altitude(record)
    step = _amplitude_step(intensity)
    bed = np.broadcast_to(
        (r >= ERROR_ALTITUDES * altitude[:, None]) & (np.sqrt(curve) >= STEPS * step), intensity.shape
    )
    full = intensity >= intensity.max()  # samples at full scale, unless the greatest intensity is rare
    patches = _even_patches(amplitude, bed & ~full if full.sum() > CLIPPED * intensity.size else bed)
    along = _spectrum(amplitude.swapaxes(1, 2), bed.swapaxes(1, 2), measure_ping_spacing(record))
    across = _spectrum(amplitude, bed, 2.0 * float(r[0]))
    if patches.size == 0 or along is None or across is None:
        raise SceneError(
            f"{record.attrs.get('title', 'record')}: has too little bed to measure; "
            f"give at least {SEGMENT} pings that move on and {SEGMENT} bins beyond {ERROR_ALTITUDES} altitudes"
        )
    mean = patches.mean(axis=(1, 2))
    relative = (patches / mean[:, None, None]).reshape(len(patches), -1)
    limit = np.broadcast_to((0.5 * step) ** 2 / curve, bed.shape)
    return RecordStatistics(relative.std(axis=1), relative, along, across, *_measure_shadows(amplitude, bed, limit))


def _even_patches(amplitude: Singles, bed: Booleans) -> Floats:
    """Choose the most even patches by the means of their quarters: without targets, shadows or slopes."""
    patches, whole = _tiles(amplitude, (PATCH, PATCH)), _tiles(bed, (PATCH, PATCH)).all(axis=(1, 2))
    patches = patches[whole & (patches.mean(axis=(1, 2)) > 0.0)].astype(np.float64)
    half = PATCH // 2
    quarters = patches.reshape(-1, 2, half, 2, half).mean(axis=(2, 4)).reshape(-1, 4)
    unevenness = np.ptp(quarters, axis=1) / quarters.mean(axis=1)
    return patches[np.argsort(unevenness, kind="stable")[: int(np.ceil(EVENEST * len(patches)))]]


def _spectrum(amplitude: Singles, bed: Booleans, step: float) -> AmplitudeSpectrum | None:
    """Median of the periodograms, detrended and under a Hann window, of all segments of bed along the last axis."""
    if amplitude.shape[-1] < SEGMENT or not step > 0.0:
        return None
    starts = (..., slice(None, None, SEGMENT // 2), slice(None))
    whole = np.nonzero(sliding_window_view(bed, SEGMENT, axis=-1)[starts].all(axis=-1))
    some = tuple(index[:: len(index) // ENOUGH + 1] for index in whole)
    segments = sliding_window_view(amplitude, SEGMENT, axis=-1)[starts][some].astype(np.float64)
    mean = segments.mean(axis=-1)
    segments = segments[mean > 0.0] / mean[mean > 0.0, None]
    if len(segments) == 0:
        return None
    power = _periodograms(segments, step)
    # The median is robust against targets; that of an exponential variable is ln 2 times its mean.
    median = np.median(power[:, 1:-1], axis=0) / np.log(2.0)
    return AmplitudeSpectrum(np.arange(1, SEGMENT // 2) / (SEGMENT * step), median)


def _periodograms(segments: Floats, step: float) -> Floats:
    """Power per frequency of segments less their linear trends and under a Hann window; the middle ones count twice."""
    # The same as `scipy.signal.periodogram`; importing that would take 0.3 s and 40 MB.
    count = segments.shape[-1]
    window = 0.5 - 0.5 * np.cos(2.0 * np.pi * np.arange(count) / count)
    line = np.arange(count) - 0.5 * (count - 1)
    slope = segments @ line / (line @ line)
    level = segments - segments.mean(axis=-1, keepdims=True) - slope[..., None] * line
    return np.asarray(2.0 * step * np.abs(np.fft.rfft(window * level)) ** 2 / (window @ window))


def _amplitude_step(intensity: Singles) -> float:
    """Step of the amplitudes of a record in bits, all multiples of it; 0 for any other record."""
    amplitude = np.sqrt(intensity[intensity > 0.0].astype(np.float64))
    if amplitude.size == 0:
        return 0.0
    step = float(amplitude.min())
    multiples = amplitude[:: amplitude.size // ENOUGH + 1] / step
    return step if np.abs(multiples - np.rint(multiples)).max() < OFF_STEP else 0.0


def _measure_shadows(amplitude: Singles, bed: Booleans, limit: Floats) -> tuple[float, bool]:
    """Depth of shadows in dB, NaN where there are none, and whether most are darker than the record resolves."""
    # The darkest blocks at neighbouring ranges give the noise floor there, since nothing but noise is in a shadow.
    # Where it lies farther below the bed's median than the bed's own levels spread, blocks nearer the floor than the
    # median, in decibels, are shadows.
    whole = _tiles(bed, BLOCK).all(axis=(1, 2))
    level = (_tiles(amplitude, BLOCK)[whole].astype(np.float64) ** 2).mean(axis=(1, 2))
    if not np.median(level) > 0.0:  # most of the record is silent: it has no level to compare shadows with
        return float("nan"), False
    least = np.maximum(_tiles(limit, BLOCK)[whole].mean(axis=(1, 2)), 10.0 ** (SILENCE / 10.0) * np.median(level))
    decibels = 10.0 * np.log10(np.maximum(level, least) / np.median(level))
    columns = np.broadcast_to(
        np.arange(bed.shape[2] // BLOCK[1]), (2, bed.shape[1] // BLOCK[0], bed.shape[2] // BLOCK[1])
    )
    order = np.argsort(columns.reshape(-1)[whole], kind="stable")
    bands = np.array_split(order, max(order.size // BAND, 1))
    dark = np.concatenate([band[_shadowed(decibels[band])] for band in bands])
    if dark.size <= FEWEST * level.size:
        return float("nan"), False
    return float(-np.median(decibels[dark])), bool((level <= least)[dark].mean() > 0.5)


def _shadowed(decibels: Floats) -> Booleans:
    """Which of the levels of one band are nearer its noise floor than its median."""
    low, median = np.percentile(decibels, [16.0, 50.0])
    floor = np.median(np.sort(decibels)[: max(int(DARKEST * decibels.size), 1)])
    if median - floor < max(LEAST_DEPTH, SPREADS * (median - low)):
        return np.zeros(decibels.shape, dtype=np.bool_)
    return decibels < 0.5 * (floor + median)


def _tiles(values: NDArray[np.generic], shape: tuple[int, int]) -> NDArray[np.generic]:
    """Cut (2, pings, bins) into tiles (n, *shape) without the remainders at the ends."""
    rows, columns = (size // step for size, step in zip(values.shape[1:], shape))
    cut = values[:, : rows * shape[0], : columns * shape[1]]
    tiles = cut.reshape(len(cut), rows, shape[0], columns, shape[1]).swapaxes(2, 3)
    return tiles.reshape(len(cut) * rows * columns, *shape)


def measure_ping_spacing(record: xr.Dataset) -> float:
    """Measure the mean distance between pings, in metres."""
    x, y = record["platform_x"].values, record["platform_y"].values
    return float(np.hypot(np.diff(x), np.diff(y)).mean()) if len(x) > 1 else 0.0


def amplitude_exponent(heights: Reals) -> float:
    """Exponent β of the amplitude spectrum f^−β of a field, by maximum likelihood."""
    from scipy.optimize import minimize_scalar

    highest = min(heights.shape) / 2.0
    if highest - LOWEST_WAVE < LEAST_SPAN:
        raise SceneError(
            f"heights: {heights.shape} samples hold too few waves to measure an exponent; "
            f"give at least {2 * int(LOWEST_WAVE + LEAST_SPAN)} a side"
        )
    fx, fy = frequencies((heights.shape[0], heights.shape[1]))
    radius = np.hypot(fx, fy)
    power = np.abs(np.fft.rfft2(heights)) ** 2
    inside = (radius >= LOWEST_WAVE) & (radius < highest) & (fx > 0)
    log_radius, power = np.log(radius[inside]), power[inside]

    def misfit(exponent: float) -> float:
        return float(np.log((power * np.exp(exponent * log_radius)).mean()) - exponent * log_radius.mean())

    return float(0.5 * minimize_scalar(misfit, bounds=(-0.5, 11.0), method="bounded").x)
