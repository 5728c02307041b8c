"""Random waves of one period of a bed.

Frequencies are whole cycles per period. The coefficient of a wave is a hash of the seed and its frequency, so that the
same seed gives the same landscape on every grid.

NumPy transforms them, not SciPy: it is as fast on as many threads, its numbers are the same bit for bit, and importing
SciPy takes longer than tracing a preview.
"""

import numpy as np

from insonify.array_cache import keep_arrays
from insonify.arrays import Complexes, Floats
from insonify.kernels.common.hashing import wave_noise
from insonify.parallel import in_parallel
from insonify.scene.seabed.reliefs.spectrum import ROWS, Density

GridShape = tuple[int, int]

# Largest noise that is cached: 2048 squared takes 34 MB.
KEPT_CELLS = 2048**2
MOST_THREADS = 2  # more do not speed up a transform that is limited by memory


class WaveGrid:
    """Random waves of one period, sampled on a grid."""

    def __init__(self, shape: GridShape, seed: int, stream: int) -> None:
        self.shape, self._seed, self._stream = shape, seed, stream

    def noise(self, *, gaussian: bool = True) -> Complexes:
        """Coefficients of unit variance, (ny, nx // 2 + 1), cached so that a new spectrum costs only the filter."""
        make = _kept_noise if self.shape[0] * self.shape[1] <= KEPT_CELLS else wave_noise
        return make(self._seed, self._stream, *self.shape, gaussian)

    def filtered(self, amplitude: Density, *, gaussian: bool = True) -> Complexes:
        """Multiply the noise by an amplitude of the frequencies, some rows at a time."""
        noise = self.noise(gaussian=gaussian)
        waves = np.empty_like(noise)
        fx, fy = self.frequencies()

        def filter_groups(first: int, last: int) -> None:
            for group in range(first, last):
                rows = slice(group * ROWS, (group + 1) * ROWS)
                np.multiply(noise[rows], amplitude(fx, fy[rows]), out=waves[rows])

        in_parallel(filter_groups, -(-self.shape[0] // ROWS), MOST_THREADS, least=1)
        return waves

    def frequencies(self) -> tuple[Floats, Floats]:
        """Cycles per period of the coefficients: fx (1, nx // 2 + 1) and fy (ny, 1)."""
        return frequencies(self.shape)

    def variance(self, waves: Complexes) -> float:
        """Variance of the sum of waves by Parseval's theorem: all columns but the first stand for ±f."""
        # einsum sums products without storing them, ten times as fast as an array of products.
        every, first = waves.view(np.float64).ravel(), np.ascontiguousarray(waves[:, 0]).view(np.float64)
        return float(2.0 * np.einsum("i,i", every, every) - np.einsum("i,i", first, first))

    def field(self, waves: Complexes) -> Floats:
        """Sum of waves, (ny, nx); the array of waves is overwritten."""
        field = np.empty(self.shape)

        def sum_columns(first: int, last: int) -> None:
            columns = waves[:, first:last]
            columns[...] = np.fft.ifft(columns, axis=0, norm="forward")

        def sum_rows(first: int, last: int) -> None:
            np.fft.irfft(waves[first:last], n=self.shape[1], norm="forward", out=field[first:last])

        in_parallel(sum_columns, waves.shape[1], MOST_THREADS, ROWS)
        in_parallel(sum_rows, self.shape[0], MOST_THREADS, ROWS)
        return field

    def transform(self, field: Floats) -> Complexes:
        """Waves of a field."""
        return np.asarray(np.fft.rfft2(field, norm="forward"))


def frequencies(shape: GridShape) -> tuple[Floats, Floats]:
    """Cycles per period of ``irfft2``'s coefficients: fx (1, nx // 2 + 1) and fy (ny, 1)."""
    ny, nx = shape
    fy = (np.arange(ny) + ny // 2) % ny - ny // 2
    return np.arange(nx // 2 + 1, dtype=np.float64)[np.newaxis, :], fy.astype(np.float64)[:, np.newaxis]


_kept_noise = keep_arrays(wave_noise)
