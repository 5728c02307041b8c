"""Pictures of records as arrays: normalisation, contrast, palette, slant and ground range.

A record falls by tens of decibels with range. A picture shows its amplitude relative to a perfect Lambert bed under the
same ping, or a recording relative to its own median at every range, so that a uniform bed looks uniform and the
rest stands out.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache, lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d, median_filter
from skimage import exposure

from insonify.acoustics.flat_bed import flat_bed_curve
from insonify.display.display_options import PALETTES, find_palettes
from insonify.kernels.display.rows import average_bins, relate_amplitudes
from insonify.packing.navigation import interpolate_bed_beneath
from insonify.parallel import in_parallel
from insonify.scene import SceneError

if TYPE_CHECKING:
    from insonify.simulation import Simulation

__all__ = [
    "PALETTES",
    "LevelBed",
    "average_columns",
    "choose_contrast",
    "colour_amplitudes",
    "compute_column_edges",
    "estimate_median_curve",
    "extend_to_water_column",
    "load_palette",
    "map_tones",
    "mirror_channels",
    "normalise",
]

ROWS_A_THREAD = 512  # rows worth handing to a thread, some 0.3 ms
_rescale: Callable[..., Any] = exposure.rescale_intensity
_ENOUGH = 200_000  # amplitudes that suffice for a percentile
_PINGS = 2000  # pings that suffice for the median curve of a recording
_FIRST = 1.25  # altitudes from which the bed of a recording counts
_SMOOTH = 64  # the median curve is smoothed over the bins divided by this


@cache
def load_palette(name: str) -> NDArray[np.uint8]:
    """Read a palette: its file holds one colour per line, ``#rrggbb``, evenly spaced from silence to the maximum.

    Parameters
    ----------
    name : str
        Name of a palette, see `find_palettes`.

    Returns
    -------
    (256, 3) uint8
        Red, green, blue; entry 0 stands for silence.

    Raises
    ------
    SceneError
        If there is no such palette.
    """
    palettes = find_palettes()
    if name not in palettes:
        raise SceneError(f"palette {name!r} is not known; choose one of {', '.join(palettes)}")
    lines = palettes[name].read_text(encoding="utf-8").splitlines()
    anchors = np.array([list(bytes.fromhex(line[1:])) for line in lines if not line.startswith("# ")], dtype=np.float64)
    at, given = np.linspace(0.0, 1.0, 256), np.linspace(0.0, 1.0, len(anchors))
    table = np.stack([np.interp(at, given, channel) for channel in anchors.T], axis=1)
    colours = np.rint(table).astype(np.uint8)
    colours.flags.writeable = False
    return colours


class LevelBed:
    """Record of a level, perfect Lambert bed under every ping, by which a picture of a simulation is normalised.

    Parameters
    ----------
    simulation : Simulation
        Prepared simulation.
    """

    def __init__(self, simulation: Simulation) -> None:
        self._simulation = simulation
        self._kept = lru_cache(maxsize=1024)(self._curve)

    def curves(self, pings: NDArray[np.int64]) -> NDArray[np.float64]:
        """Compute the records of level beds at the altitudes of pings, each rounded to an eighth of a bin.

        Parameters
        ----------
        pings : (n,) int64
            Ping numbers.

        Returns
        -------
        (n, 1, bins) float64
            Positive in every bin.
        """
        curves, which = self._curves_of(pings)
        return curves[which][:, None]

    def normalise(self, intensity: NDArray[np.float32], pings: NDArray[np.int64]) -> NDArray[np.float32]:
        """Compute amplitudes relative to the level beds of pings.

        Parameters
        ----------
        intensity : (n, 2, bins) float32
            Record of the pings.
        pings : (n,) int64
            Ping numbers.

        Returns
        -------
        (n, 2, bins) float32
            As `normalise` by the curves of the pings.
        """
        curves, which = self._curves_of(pings)
        return _relate(intensity, curves, np.repeat(which, intensity.shape[1]))

    def _curves_of(self, pings: NDArray[np.int64]) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
        """Curves, (curves, bins), and which of them each ping has."""
        simulation = self._simulation
        beneath = interpolate_bed_beneath(simulation.scene, simulation.ground, pings)
        eighths = np.rint((simulation.poses(pings).z - beneath) / self._step).astype(np.int64)
        numbers, which = np.unique(np.maximum(eighths, 1), return_inverse=True)
        curves = np.array([self._kept(int(number)) for number in numbers])
        return curves.reshape(-1, simulation.arrays.bins), which

    @property
    def _step(self) -> float:
        return self._simulation.arrays.bin_length / 8.0

    def _curve(self, eighths: int) -> NDArray[np.float64]:
        echo = extend_to_water_column(flat_bed_curve(self._simulation.arrays, eighths * self._step))
        return self._simulation.reception.expected(echo)


def extend_to_water_column(curve: NDArray[np.float64]) -> NDArray[np.float64]:
    """Extend the first return of a curve over the bins before it, in which objects above the bed may echo.

    The first bin of the bed is partly filled, so the larger of the first two values is used.

    Parameters
    ----------
    curve : (bins,) float64
        Record of a level bed.

    Returns
    -------
    (bins,) float64
        Positive everywhere; 1 where there is no return at all.
    """
    heard = np.flatnonzero(curve > 0.0)
    if heard.size == 0:
        return np.ones_like(curve)
    first = int(heard[0])
    filled = curve.copy()
    filled[: first + 1] = curve[first : first + 2].max()
    return filled


def estimate_median_curve(
    intensity: NDArray[np.float32], altitude: NDArray[np.float64], bin_length: float
) -> NDArray[np.float64]:
    """Estimate the curve by which a picture of a recording of unknown sonar and bed is normalised.

    It is the median of the recording at every slant range, after Lambert's law has removed the effect of the grazing
    angle as the altitude changes.

    Parameters
    ----------
    intensity : (2, pings, bins) float32
        Energy of the record.
    altitude : (pings,) float64
        Height above the bed, in metres; 0 where it is not known.
    bin_length : float
        Slant range of a bin, in metres.

    Returns
    -------
    (pings, 1, bins) float64
        Positive everywhere; smooth over a 64th of the bins.
    """
    some = slice(None, None, intensity.shape[1] // _PINGS + 1)
    r = (np.arange(intensity.shape[-1]) + 0.5) * bin_length
    sine = np.minimum(np.where(altitude > 0.0, altitude, np.inf)[:, None] / r, 1.0)
    # At shorter range an error of the altimeter would count water as bed.
    below = r >= _FIRST * altitude[some, None]
    upright = intensity[:, some] / sine[some] ** 2
    curve = np.array([_middle(upright[:, below[:, bin_], bin_]) for bin_ in range(len(r))])
    known = np.flatnonzero(curve > 0.0)
    if known.size == 0:
        return np.ones((len(altitude), 1, len(r)))
    logarithm = np.interp(np.arange(len(r)), known, np.log(curve[known]))
    steady = median_filter(logarithm, size=len(r) // _SMOOTH + 1)  # removes marks that recorders put at the edges
    smooth = np.exp(gaussian_filter1d(steady, len(r) / _SMOOTH))
    return (smooth * sine**2)[:, None, :]


def _middle(echoes: NDArray[np.floating]) -> float:
    """Median of the positive echoes, 0 if there are none."""
    heard = echoes[echoes > 0.0]
    return float(np.median(heard)) if heard.size else 0.0


def normalise(intensity: NDArray[np.float32], curve: NDArray[np.float64]) -> NDArray[np.float32]:
    """Compute amplitudes relative to a curve.

    Parameters
    ----------
    intensity : (..., bins) float32
        Energy of a record.
    curve : (bins,) or (..., bins) float64
        Positive curve by which the record is divided.

    Returns
    -------
    (..., bins) float32
        Square root of the ratio; 0 where the record is silent.
    """
    curves = np.asarray(curve, dtype=np.float64)
    which = np.arange(math.prod(curves.shape[:-1])).reshape(curves.shape[:-1])
    return _relate(intensity, curves.reshape(-1, curves.shape[-1]), np.broadcast_to(which, intensity.shape[:-1]))


def _relate(
    intensity: NDArray[np.float32], curves: NDArray[np.float64], which: NDArray[np.int64]
) -> NDArray[np.float32]:
    """Amplitudes relative to the curve, (curves, bins), that each row of a record has."""
    bins = intensity.shape[-1]
    energies, inverse = np.ascontiguousarray(intensity, dtype=np.float32).reshape(-1, bins), 1.0 / curves
    rows, out = np.ascontiguousarray(which).ravel(), np.empty(energies.shape, np.float32)

    def block(first: int, last: int) -> None:
        relate_amplitudes(energies[first:last], inverse, rows[first:last], out[first:last])

    in_parallel(block, len(rows), least=ROWS_A_THREAD)
    return out.reshape(intensity.shape)


def choose_contrast(amplitude: NDArray[np.float32]) -> tuple[float, float]:
    """Choose the amplitudes that become the darkest and the brightest colour.

    Shadows (zeros) do not count. The span follows the texture of the bed within limits: a bed without texture stays in
    the middle of the palette and distinct from a shadow, one strong target does not darken the rest, and a material
    that covers a tenth of the picture keeps its texture however strong it is.

    Parameters
    ----------
    amplitude : float32 array
        From ``normalise``.

    Returns
    -------
    (float, float)
        Low and high; (0, 1) for a picture without echoes.
    """
    sample = amplitude.ravel()[:: amplitude.size // _ENOUGH + 1]
    heard = sample[np.isfinite(sample) & (sample > 0.0)]
    if heard.size == 0:
        return 0.0, 1.0
    weak, middle, upper, strong = (float(p) for p in np.percentile(heard, [2.0, 50.0, 90.0, 99.7]))
    low = min(weak, 0.6 * middle) - 0.2 * middle
    return max(low, 0.0), min(max(strong, 1.5 * middle, 1.3 * upper), max(2.4 * middle, 1.3 * upper))


def map_tones(amplitude: NDArray[np.float32], levels: tuple[float, float], gain: float = 0.0) -> NDArray[np.uint8]:
    """Turn amplitudes into entries of a palette.

    Parameters
    ----------
    amplitude : float32 array
        From ``normalise``.
    levels : (float, float)
        From ``contrast``.
    gain : float
        Display gain in dB.

    Returns
    -------
    uint8 array
        Same shape; 0 at and below the low level, 255 at and above the high one.
    """
    low, high = levels
    amplified = np.nan_to_num(amplitude) * np.float32(10.0 ** (gain / 20.0))
    scaled = _rescale(amplified, in_range=(low, high), out_range=(0.0, 255.0))
    return np.rint(scaled).astype(np.uint8)


def mirror_channels(
    sides: NDArray[np.float32],
    edges: NDArray[np.float64],
    side: str = "both",
) -> NDArray[np.float32]:
    """Lay out the channels with port to the left of nadir and the newest ping on top.

    Parameters
    ----------
    sides : (pings, 2, bins) float32
        Amplitudes, oldest ping first.
    edges : (pings, columns + 1) float64
        Edges of a side's columns, in bins, from nadir outwards; from ``column_edges``.
    side : str
        ``both``, or ``port`` or ``starboard`` alone, then with nadir at the left.

    Returns
    -------
    (pings, columns or 2 columns) float32
    """
    newest_first = slice(None, None, -1)
    port, starboard = (average_columns(sides[newest_first, channel], edges[newest_first]) for channel in (0, 1))
    if side == "both":
        return np.concatenate([port[:, ::-1], starboard], axis=1)
    return port if side == "port" else starboard


def compute_column_edges(
    altitude: NDArray[np.float64],
    bins: int,
    bin_length: float,
    columns: int,
    ground_reach: float | None = None,
) -> NDArray[np.float64]:
    """Compute the edges of equally wide columns as positions in the bins of one side.

    Parameters
    ----------
    altitude : (pings,) float64
        Height of the sonar above the bed, in metres.
    bins : int
        Range bins of a side.
    bin_length : float
        Slant range of a bin, in metres.
    columns : int
        Columns of a side.
    ground_reach : float, optional
        Ground range of the outermost edge, in metres: columns are then steps of x = sqrt(r² − altitude²). Steps of
        slant range when left out.

    Returns
    -------
    (pings, columns + 1) float64
    """
    if ground_reach is None:
        return np.broadcast_to(np.linspace(0.0, bins, columns + 1), (len(altitude), columns + 1))
    x = np.linspace(0.0, ground_reach, columns + 1)
    return np.minimum(np.hypot(x[None, :], altitude[:, None]) / bin_length, bins)


def average_columns(rows: NDArray[np.float32], edges: NDArray[np.float64]) -> NDArray[np.float32]:
    """Average every row between successive edges, with parts of bins weighted by their width.

    Columns wider than a bin average it, so that no narrow echo is lost; columns narrower than a bin repeat it.

    Parameters
    ----------
    rows : (n, bins) float32
        Amplitudes.
    edges : (n, columns + 1) float64
        Increasing positions in bins; equal edges give 0.

    Returns
    -------
    (n, columns) float32
    """
    # Rows that share their edges are views of one row.
    grids = edges[:1] if edges.strides[0] == 0 else edges
    which = np.minimum(np.arange(len(rows)), len(grids) - 1)
    values, at = np.ascontiguousarray(rows), np.ascontiguousarray(grids)
    out = np.empty((len(rows), edges.shape[1] - 1), np.float32)

    def block(first: int, last: int) -> None:
        average_bins(values[first:last], at, which[first:last], out[first:last])

    in_parallel(block, len(rows), least=ROWS_A_THREAD)
    return out


def colour_amplitudes(
    amplitude: NDArray[np.float32],
    name: str = "copper",
    gain: float = 0.0,
    levels: tuple[float, float] | None = None,
) -> NDArray[np.uint8]:
    """Colour amplitudes.

    Parameters
    ----------
    amplitude : (rows, columns) float32
        From ``mirrored``.
    name : str
        Palette.
    gain : float
        Display gain in dB.
    levels : (float, float), optional
        Darkest and brightest amplitude; chosen by ``contrast`` when left out.

    Returns
    -------
    (rows, columns, 3) uint8
    """
    return load_palette(name)[map_tones(amplitude, choose_contrast(amplitude) if levels is None else levels, gain)]
