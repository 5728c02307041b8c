"""Statistics of a record by which recordings and simulations are compared: speckle, spectra, depth of shadows.

They are measured on amplitudes relative to the record's median curve (`estimate_median_curve`) beyond 1.4 times the
altitude, so that gain, range and the strong echoes near nadir have no effect.
"""

import math
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from insonify.acoustics.flat_bed import ERROR_ALTITUDES
from insonify.arrays import Booleans, Floats, Integers, Reals, Singles
from insonify.display.normalisation import normalise
from insonify.display.sheet import fill_altitude, find_median_curve
from insonify.scene import SceneError
from insonify.terrain.periodic_waves import frequencies

STRETCH = 512  # pings that are read together
MOST_ECHOES = 2**25  # echoes that are measured; of a longer record, in stretches evenly along it
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
LEAST_STEPS = 4.0  # least median amplitude, in steps of the record, from which it is measured
OFF_STEP = 0.02  # greatest distance of an amplitude from a multiple of the step: 16 bits in single precision
CLIPPED = 1e-4  # share of samples at the greatest amplitude above which it counts as full scale
LOWEST_WAVE = 4.0  # cycles per period; lower frequencies have few waves and are clamped
LEAST_SPAN = 16.0  # cycles per period between the lowest and the highest frequency


Patches = tuple[Singles, Floats, Integers]  # with the unevenness and the place of each


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
    """Measure the statistics of a record, of a long one from stretches that lie evenly along it."""
    measured = _Stretches(record)
    variation, amplitude = measured.even_patches()
    along = measured.spectrum(1, measure_ping_spacing(record))
    across = measured.spectrum(2, 2.0 * float(record["slant_range"].values[0]))
    if variation.size == 0 or along is None or across is None:
        raise SceneError(
            f"{record.attrs.get('title', 'record')}: has too little bed to measure; "
            f"give at least {SEGMENT} pings that move on and {SEGMENT} bins beyond {ERROR_ALTITUDES} altitudes"
        )
    return RecordStatistics(variation, amplitude, along, across, *measured.shadows())


class _Stretches:
    """Stretches of a record with its echoes relative to its median curve, read one after another."""

    def __init__(self, record: xr.Dataset) -> None:
        pings, bins = record.sizes["ping_time"], record.sizes["range_sample"]
        # Stretches begin at whole patches, blocks and segments.
        every = -(-2 * pings * bins // MOST_ECHOES)
        self.stretches = [slice(at, min(at + STRETCH, pings)) for at in range(0, pings, STRETCH * every)]
        self._record, self._pings = record, pings
        self._range, self._altitude = record["slant_range"].values, fill_altitude(record)
        self._curve = find_median_curve(record, self._altitude)
        self._step, self._full = 0.0, np.inf
        self._step, self._full = self._find_scale()

    def _echoes(self, some: slice) -> Singles:
        return np.asarray(self._record.variables["intensity"][:, some])

    def _relate(self, some: slice) -> tuple[Singles, Singles]:
        """Intensities of some pings, (2, n, bins), and their amplitudes relative to the curve."""
        echoes = self._echoes(some)
        return echoes, normalise(echoes, self._curve.at(self._altitude[some]))

    def _bed(self, some: slice) -> tuple[Booleans, Floats]:
        """Which echoes of some pings, (n, bins), are of the bed and above the noise of numbers, and the curve there."""
        altitude = self._altitude[some]
        curve = self._curve.at(altitude)
        bed = (self._range >= ERROR_ALTITUDES * altitude[:, None]) & (np.sqrt(curve) >= LEAST_STEPS * self._step)
        return bed, curve

    def _find_scale(self) -> tuple[float, float]:
        """Step of the amplitudes in bits, all multiples of it, 0 of others; intensity of full scale, or infinity."""
        least, greatest, number = np.inf, 0.0, 0
        for some in self.stretches:
            echoes = self._echoes(some)
            positive = echoes[echoes > 0.0]
            number += positive.size
            greatest = max(greatest, float(echoes.max()))
            least = min(least, float(positive.min())) if positive.size else least
        if number == 0:
            return 0.0, np.inf
        step, off, full, size = float(np.sqrt(least)), 0.0, 0, 0
        for some in self.stretches:
            echoes = self._echoes(some)
            multiples = np.sqrt(echoes[echoes > 0.0][:: number // ENOUGH + 1].astype(np.float64)) / step
            off = max(off, float(np.abs(multiples - np.rint(multiples)).max(initial=0.0)))
            full, size = full + int((echoes >= greatest).sum()), size + echoes.size
        # The greatest amplitude is full scale, unless it is rare.
        return step if off < OFF_STEP else 0.0, greatest if full > CLIPPED * size else np.inf

    def even_patches(self) -> tuple[Floats, Singles]:
        """Variation and relative amplitudes of the most even patches: without targets, shadows or slopes."""
        half, tiles = PATCH // 2, 0
        kept: Patches = np.empty((0, PATCH, PATCH), dtype=np.float32), np.empty(0), np.empty(0, dtype=np.int64)
        most = sum((some.stop - some.start) // PATCH for some in self.stretches) * 2 * (self._range.size // PATCH)
        number = 0
        for some in self.stretches:
            echoes, amplitude = self._relate(some)
            bed, _ = self._bed(some)
            whole = _tiles(bed & (echoes < self._full), (PATCH, PATCH)).all(axis=(1, 2))
            patches = _tiles(amplitude, (PATCH, PATCH))
            # Of equally even patches those of port, then the first ones, count.
            places = np.arange(len(patches)).reshape(2, -1) + np.array([[0], [most]]) + tiles
            tiles += len(patches) // 2
            chosen = np.flatnonzero(whole & (patches.mean(axis=(1, 2)) > 0.0))
            number += chosen.size
            patches = patches[chosen]
            quarters = patches.astype(np.float64).reshape(-1, 2, half, 2, half).mean(axis=(2, 4)).reshape(-1, 4)
            unevenness = np.ptp(quarters, axis=1) / quarters.mean(axis=1)
            kept = (
                np.concatenate([kept[0], patches]), np.concatenate([kept[1], unevenness]),
                np.concatenate([kept[2], places.reshape(-1)[chosen]]),
            )  # fmt: skip
            if len(kept[0]) > 2 * EVENEST * most:
                kept = _most_even(kept, math.ceil(EVENEST * most))
        patches = _most_even(kept, math.ceil(EVENEST * number))[0]
        variation = np.empty(len(patches))
        for first in range(0, len(patches), ENOUGH):
            part = patches[first : first + ENOUGH].astype(np.float64)
            relative = (part / part.mean(axis=(1, 2))[:, None, None]).reshape(-1, PATCH * PATCH)
            variation[first : first + ENOUGH] = relative.std(axis=1)
            patches[first : first + ENOUGH] = relative.reshape(part.shape)
        return variation, patches.reshape(-1, PATCH * PATCH)

    def spectrum(self, axis: int, step: float) -> AmplitudeSpectrum | None:
        """Median of the periodograms, detrended and under a Hann window, of segments of bed, 1 along, 2 across."""
        if not step > 0.0:
            return None
        rooms = []
        for some in self.stretches:
            # Segments along the track end in the pings behind a stretch.
            bed, _ = self._bed(self._extended(some, axis))
            rooms.append(_segments(bed if axis == 2 else bed.T).all(axis=-1))
        along = 1 if axis == 1 else 0  # of a room: its stretches follow each other there
        room = np.concatenate(rooms, axis=along)
        whole = np.nonzero(np.broadcast_to(room, (2, *room.shape)))
        picked = np.stack([index[:: index.size // ENOUGH + 1] for index in whole])
        first, found = 0, []
        for some, size in zip(self.stretches, (each.shape[along] for each in rooms)):
            own = picked[:, (picked[1 + along] >= first) & (picked[1 + along] < first + size)]
            own[1 + along] -= first
            first += size
            if own.size:
                _, amplitude = self._relate(self._extended(some, axis))
                segments = _segments(amplitude if axis == 2 else amplitude.swapaxes(1, 2))
                found.append(segments[tuple(own)].astype(np.float64))
        segments = np.concatenate([*found, np.empty((0, SEGMENT))])
        mean = segments.mean(axis=-1)
        segments = segments[mean > 0.0] / mean[mean > 0.0, None]
        if len(segments) == 0:
            return None
        power = _periodograms(segments, step)
        # The median is robust against targets; that of an exponential variable is ln 2 times its mean.
        median = np.median(power[:, 1:-1], axis=0) / np.log(2.0)
        return AmplitudeSpectrum(np.arange(1, SEGMENT // 2) / (SEGMENT * step), median)

    def _extended(self, some: slice, axis: int) -> slice:
        return slice(some.start, min(some.stop + SEGMENT // 2, self._pings)) if axis == 1 else some

    def shadows(self) -> tuple[float, bool]:
        """Depth of shadows in dB, NaN where there are none, and whether most are darker than the record resolves."""
        parts = []
        for some in self.stretches:
            bed, curve = self._bed(some)
            tiles = _tiles(self._relate(some)[1], BLOCK).astype(np.float64)
            limit = _tiles((0.5 * self._step) ** 2 / curve[None], BLOCK).mean(axis=(1, 2))
            columns = np.arange(limit.size) % max(self._range.size // BLOCK[1], 1)
            whole = _tiles(bed[None], BLOCK).all(axis=(1, 2))
            of_sides = (tiles**2).mean(axis=(1, 2)).reshape(2, -1)
            parts.append((of_sides[:, whole], limit[whole], columns[whole]))
        level = np.concatenate([part[0] for part in parts], axis=1).ravel()
        limit, columns = (np.tile(np.concatenate([part[at] for part in parts]), 2) for at in (1, 2))
        return _measure_shadows(level, limit, columns)


def _most_even(patches: Patches, count: int) -> Patches:
    """Take the first patches by unevenness and place."""
    first = np.lexsort(patches[:0:-1])[:count]
    return patches[0][first], patches[1][first], patches[2][first]


def _segments(values: NDArray[Any]) -> NDArray[Any]:
    """Segments along the last axis, each half over the next, as a view (..., segments, SEGMENT)."""
    if values.shape[-1] < SEGMENT:
        return np.empty((*values.shape[:-1], 0, SEGMENT), dtype=values.dtype)
    return sliding_window_view(values, SEGMENT, axis=-1)[..., :: SEGMENT // 2, :]


def _periodograms(segments: Floats, step: float) -> Floats:
    """Power per frequency of segments less their linear trends and under a Hann window; the middle ones count twice."""
    # The same as `scipy.signal.periodogram`; importing that would take 0.3 s and 40 MB.
    count = segments.shape[-1]
    window = 0.5 - 0.5 * np.cos(2.0 * np.pi * np.arange(count) / count)
    line = np.arange(count) - 0.5 * (count - 1)
    slope = segments @ line / (line @ line)
    level = segments - segments.mean(axis=-1, keepdims=True) - slope[..., None] * line
    return np.asarray(2.0 * step * np.abs(np.fft.rfft(window * level)) ** 2 / (window @ window))


def _measure_shadows(level: Floats, limit: Floats, columns: Integers) -> tuple[float, bool]:
    """Depth of shadows by the energies of blocks of bed, the least that each resolves, and their places in range."""
    # The darkest blocks at neighbouring ranges give the noise floor there, since nothing but noise is in a shadow.
    # Where it lies farther below the bed's median than the bed's own levels spread, blocks nearer the floor than the
    # median, in decibels, are shadows.
    middle = np.median(level)
    if not middle > 0.0:  # most of the record is silent: it has no level to compare shadows with
        return float("nan"), False
    least = np.maximum(limit, 10.0 ** (SILENCE / 10.0) * middle)
    decibels = 10.0 * np.log10(np.maximum(level, least) / middle)
    order = np.argsort(columns, kind="stable")
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
    """Cut (sides, pings, bins) into tiles (n, *shape) without the remainders at the ends."""
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
