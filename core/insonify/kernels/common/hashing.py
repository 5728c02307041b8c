"""Random numbers by hashing: each is a function of its purpose and place alone, never of the order of execution."""

import math

import numpy as np

from insonify.compiler.jit import inlined, kernel

# Constants of splitmix64 (Steele, Lea and Flood 2014; Vigna's public-domain implementation).
GOLDEN = np.uint64(0x9E3779B97F4A7C15)
FIRST_MULTIPLIER = np.uint64(0xBF58476D1CE4E5B9)
SECOND_MULTIPLIER = np.uint64(0x94D049BB133111EB)
SHIFTS = (np.uint64(30), np.uint64(27), np.uint64(31))
LOW_BITS = np.uint64(12)
UNIT = 2.0**-52


@kernel
def splitmix64(value):
    """Return the splitmix64 output that follows a state (Steele, Lea and Flood 2014, OOPSLA)."""
    mixed = np.uint64(value) + GOLDEN
    mixed = (mixed ^ (mixed >> SHIFTS[0])) * FIRST_MULTIPLIER
    mixed = (mixed ^ (mixed >> SHIFTS[1])) * SECOND_MULTIPLIER
    return mixed ^ (mixed >> SHIFTS[2])


@kernel
def hash_integers(seed, stream, a, b, c):
    """Hash a seed, a stream and three integers to 64 random bits."""
    key = splitmix64(np.uint64(seed))
    key = splitmix64(key ^ np.uint64(stream))
    key = splitmix64(key ^ np.uint64(a))
    key = splitmix64(key ^ np.uint64(b))
    return splitmix64(key ^ np.uint64(c))


@kernel
def unit_interval(bits):
    """Turn 64 random bits into a uniform number inside (0, 1), both ends excluded."""
    # 52 bits: with 53 the half would round the largest up to 1.
    return (np.float64(bits >> LOW_BITS) + 0.5) * UNIT


@inlined
def hash_uniform(seed, stream, a, b, c):
    """Hash a seed, a stream and three integers to a uniform number inside (0, 1)."""
    # A literal would be a type of its own, for which all is compiled again.
    return unit_interval(hash_integers(seed, stream, a, b, np.int64(c)))


@kernel
def wave_noise(seed, stream, ny, nx, gaussian):
    """Random coefficients of the waves of a real field, one per frequency of ``irfft2``.

    Parameters
    ----------
    seed, stream : int
        What they derive from.
    ny, nx : int
        Shape of the field. A coefficient depends on its frequency alone, so that any two grids share their common band.
    gaussian : bool
        Complex Gaussian coefficients with E|c|² = 1; if not, of modulus 1 and random phase.

    Returns
    -------
    ndarray of complex128, shape (ny, nx // 2 + 1)
        The mean and the Nyquist row and column are 0.
    """
    noise = np.zeros((ny, nx // 2 + 1), dtype=np.complex128)
    for fx in range((nx + 1) // 2):
        for row in range(ny):
            fy = row if 2 * row < ny else row - ny
            if 2 * row == ny or (fx == 0 and fy == 0):
                continue
            # A real field has conjugate coefficients at ±f: on the axis fx = 0 both signs are stored.
            mirrored = fx == 0 and fy < 0
            wave = abs(fy) if mirrored else fy
            phase = 2.0 * math.pi * hash_uniform(seed, stream, fx, wave, 0)
            modulus = math.sqrt(-math.log(hash_uniform(seed, stream, fx, wave, 1))) if gaussian else 1.0
            noise[row, fx] = modulus * complex(math.cos(phase), -math.sin(phase) if mirrored else math.sin(phase))
    return noise
