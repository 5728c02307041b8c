"""White noise on an endless lattice; each value is a hash of its position."""

import math

import numpy as np
from numpy.typing import NDArray

from insonify.kernels.common.hashing import FIRST_MULTIPLIER, GOLDEN, SECOND_MULTIPLIER, SHIFTS, splitmix64

Field = NDArray[np.float64]
Bits = NDArray[np.uint64]

HALF = np.uint64(32)
LOW = np.uint64(0xFFFFFFFF)
UNIT = np.float32(2.0**-32)
TINY = np.float32(2.0**-33)  # keeps a logarithm finite
STRIP = 64  # rows at a time, which stay in the processor's cache


def lattice_noise(
    seed: int, stream: int, spacing: float, rows: range, columns: range, out: Field | None = None
) -> Field:
    """White Gaussian noise of unit variance on a rectangle of an endless lattice."""
    key = splitmix64(splitmix64(splitmix64(np.uint64(seed)) ^ np.uint64(stream)) ^ np.float64(spacing).view(np.uint64))
    keys = _mixed(np.uint64(key) ^ np.array(rows, dtype=np.int64).view(np.uint64))
    # One hash gives the two numbers of a pair of neighbours (Box and Muller 1958). Their 24 bits suffice, because
    # filters sum many of them.
    pairs = np.arange(columns.start // 2, columns.stop // 2, dtype=np.int64).view(np.uint64)
    noise = np.empty((len(rows), len(columns))) if out is None else out
    for first in range(0, len(keys), STRIP):
        _draw(keys[first : first + STRIP], pairs, noise[first : first + STRIP])
    return noise


def _draw(keys: Bits, pairs: Bits, noise: Field) -> None:
    """Set some rows of noise from the keys of the rows and the numbers of the pairs."""
    bits = _mixed(keys[:, np.newaxis] ^ pairs)
    modulus = np.sqrt(np.float32(-2.0) * np.log((bits >> HALF).astype(np.float32) * UNIT + TINY))
    angle = (bits & LOW).astype(np.float32) * (np.float32(2.0 * math.pi) * UNIT)
    np.multiply(modulus, np.cos(angle), out=noise[:, 0::2])
    np.multiply(modulus, np.sin(angle), out=noise[:, 1::2])


def _mixed(value: Bits) -> Bits:
    """Apply splitmix64, as in `insonify.kernels.common.hashing`, to an array."""
    mixed = value + GOLDEN
    mixed = (mixed ^ (mixed >> SHIFTS[0])) * FIRST_MULTIPLIER
    mixed = (mixed ^ (mixed >> SHIFTS[1])) * SECOND_MULTIPLIER
    return np.asarray(mixed ^ (mixed >> SHIFTS[2]))
