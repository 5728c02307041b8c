"""Texture of an image in grey levels: distribution of greys, correlation, spectrum, and local patterns."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from insonify.arrays import Floats

PERCENTILES = (1, 5, 25, 50, 75, 95, 99)
RADII = (1, 3)  # pixels, of local binary patterns
POINTS = 8  # on the circle of a pattern
BLOCK = 8  # pixels, side of the squares of which means and deviations are compared
LEAST = 16  # pixels, of either side of an image
LOWEST = 0.03  # cycles per pixel, at which the fit of a spectral slope begins


def measure_texture(image: NDArray[Any]) -> dict[str, dict[str, float]]:
    """Quantities of the texture of an image, 0 to 255, by group; none depends on its size but by chance."""
    # "Along" is down the rows; each side has at least `LEAST` pixels.
    grey = np.asarray(image, float) / 255.0
    centred = grey - grey.mean()
    deviation = max(float(grey.std()), 1e-6)
    scaled = centred / deviation
    greys = {
        "amplitude variation": deviation / max(float(grey.mean()), 1e-6),
        "skewness": float((scaled**3).mean()),
        "kurtosis": float((scaled**4).mean()),
        **{f"percentile {p}": float(v) for p, v in zip(PERCENTILES, np.percentile(grey, PERCENTILES))},
        "black": float((grey == 0.0).mean()),
        "white": float((grey == 1.0).mean()),
        "mean against deviation": _coupling(grey),
    }
    along, across = (_correlation(centred, axis) for axis in (0, 1))
    correlation = {
        "correlation length along": _length(along),
        "correlation length across": _length(across),
        "anisotropy": float(np.log(_length(along) / _length(across))),
        **{f"correlation along, {lag} px": float(along[lag]) for lag in (1, 2, 4)},
        **{f"correlation across, {lag} px": float(across[lag]) for lag in (1, 2, 4)},
    }
    spectrum = {f"spectral slope {name}": _slope(scaled, axis) for name, axis in (("along", 0), ("across", 1))}
    return {"greys": greys, "correlation": correlation, "spectrum": spectrum, "patterns": _patterns(grey)}


def _coupling(grey: Floats) -> float:
    """Correlation of mean and deviation of small squares; 0 where one is constant."""
    rows, columns = (size // BLOCK * BLOCK for size in grey.shape)
    squares = grey[:rows, :columns].reshape(rows // BLOCK, BLOCK, columns // BLOCK, BLOCK)
    means, deviations = squares.mean(axis=(1, 3)).ravel(), squares.std(axis=(1, 3)).ravel()
    if min(means.std(), deviations.std()) < 1e-9:
        return 0.0
    return float(np.corrcoef(means, deviations)[0, 1])


def _correlation(centred: Floats, axis: int) -> Floats:
    """Autocorrelation at lags along one axis, up to half of it."""
    moved = np.moveaxis(centred, axis, 0)
    size = len(moved)
    power = np.abs(np.fft.rfft(moved, 2 * size, axis=0)) ** 2
    sums = np.fft.irfft(power.sum(axis=1))[: size // 2]
    return np.asarray(sums / (size - np.arange(size // 2)) * size / max(float(sums[0]), 1e-12))


def _length(correlation: Floats) -> float:
    """Lag at which an autocorrelation first falls to 1/e, between lags by linear interpolation."""
    below = np.flatnonzero(correlation < np.exp(-1.0))
    if not below.size or below[0] == 0:
        return float(len(correlation))
    last = int(below[0])
    before, after = correlation[last - 1 : last + 1]
    return float(last - 1 + (before - np.exp(-1.0)) / (before - after))


def _slope(scaled: Floats, axis: int) -> float:
    """Slope of the logarithm of the power spectrum along an axis over that of frequency."""
    size = scaled.shape[axis]
    power = (np.abs(np.fft.rfft(scaled, axis=axis)) ** 2).mean(axis=1 - axis)
    frequency = np.fft.rfftfreq(size)
    fitted = frequency > LOWEST
    return float(np.polyfit(np.log(frequency[fitted]), np.log(power[fitted] + 1e-9 * size), 1)[0])


def _patterns(grey: Floats) -> dict[str, float]:
    """Shares of the uniform local binary patterns."""
    # lazy: slow to import
    from skimage.feature import local_binary_pattern

    levels = np.rint(255.0 * grey).astype(np.uint8)
    shares: dict[str, float] = {}
    for radius in RADII:
        codes = local_binary_pattern(levels, POINTS, radius, "uniform")  # type: ignore[no-untyped-call]
        counts = np.bincount(codes.astype(int).ravel(), minlength=POINTS + 2)
        shares |= {f"pattern {n}, {radius} px": count / codes.size for n, count in enumerate(counts.tolist())}
    return shares
