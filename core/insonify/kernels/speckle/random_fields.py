"""Random fields over pings and range bins that are the same however the pings are divided into blocks.

White noise is hashed at nodes, one node a ping or, for a field that changes more slowly, every 2, 4, 8 ... pings, and
smoothed along the track by a triangle: at most eight nodes a ping, however slowly the field changes. The weights'
squares are made to sum to 1, so that every value keeps its distribution exactly. Derived in
docs/theory/speckle.md.
"""

import math

import numpy as np

from insonify.compiler.jit import inlined, kernel
from insonify.kernels.common.hashing import hash_integers, hash_uniform, splitmix64

HALF = np.uint64(32)
LOW_HALF = np.uint64(0xFFFFFFFF)
SHARE = 2.0**-32
MOST_NODES = 8
# Of a float32's bits: the mantissa, that of √2, an exponent's step, and the exponent of 1.
MANTISSA, ROOT_2, STEP, ONE = np.int32(0x7FFFFF), np.int32(0x3504F3), np.int32(0x800000), np.int32(0x3F800000)
LN_2, TURN = np.float32(math.log(2.0)), np.float32(2.0 * math.pi)


@kernel
def fill_white_noise(seed, stream, nodes, octave, first, real, imaginary):
    """Complex Gaussian white noise with E|c|² = 1, a function of node, octave, side and bin alone.

    Half of a hash makes the modulus, half the phase (Box and Muller 1958), in passes that suit the vector units.

    Parameters
    ----------
    seed, stream : int
        What it derives from.
    nodes : ndarray of int64, shape (nodes,)
    octave : int
        Of the spacing of the nodes.
    first : int
        Bin of the first column, of any sign.
    real, imaginary : ndarray of float32, shape (nodes, 2, n)
        Filled.
    """
    bins = real.shape[2]
    uniform, turns, modulus = np.empty(bins, np.float32), np.empty(bins, np.float32), np.empty(bins, np.float32)
    for row in range(nodes.size):
        for side in range(2):
            key = hash_integers(seed, stream, nodes[row], side, octave)
            for k in range(bins):
                bits = splitmix64(key ^ np.uint64(first + k))
                uniform[k] = max(np.float32(bits >> HALF), np.float32(0.5))
                turns[k] = np.float32(np.int64(bits & LOW_HALF)) * np.float32(SHARE) - np.float32(0.5)
            _rayleigh_moduli(uniform, modulus)
            for k in range(bins):
                # |turns| <= ½; quarters of a turn away from where each vanishes.
                across = np.float32(0.25) - abs(turns[k])
                along = math.copysign(np.float32(0.25) - abs(across), turns[k])
                real[row, side, k] = modulus[k] * _sine_of_turns(across)
                imaginary[row, side, k] = modulus[k] * _sine_of_turns(along)


@inlined
def _rayleigh_moduli(uniform, modulus):
    """Root of −log of uniform numbers, given in units of 2⁻³² and overwritten: log by exponent and mantissa."""
    words = uniform.view(np.int32)
    for k in range(words.size):
        # A mantissa between √½ and √2, and the exponent that goes with it.
        over = STEP if (words[k] & MANTISSA) > ROOT_2 else np.int32(0)
        exponent = (words[k] - ONE + over) >> 23
        modulus[k] = np.float32(32 - exponent) * LN_2
        words[k] = (words[k] & MANTISSA) + ONE - over
    for k in range(words.size):
        modulus[k] = math.sqrt(max(modulus[k] - _log_of_mantissa(uniform[k]), np.float32(0.0)))


@inlined
def _log_of_mantissa(mantissa):
    """Natural logarithm of √½ to √2, to float32 (Moshier, Cephes, logf)."""
    f = np.float32
    x = mantissa - f(1.0)
    p = f(7.0376836292e-2) * x - f(1.1514610310e-1)
    p = p * x + f(1.1676998740e-1)
    p = p * x - f(1.2420140846e-1)
    p = p * x + f(1.4249322787e-1)
    p = p * x - f(1.6668057665e-1)
    p = p * x + f(2.0000714765e-1)
    p = p * x - f(2.4999993993e-1)
    p = p * x + f(3.3333331174e-1)
    return x + x * x * (x * p - f(0.5))


@inlined
def _sine_of_turns(turns):
    """Sine of up to a quarter of a turn either way, to float32, by Taylor's series."""
    f = np.float32
    x = TURN * turns
    z = x * x
    p = f(1.0 / 362880.0) - z * f(1.0 / 39916800.0)
    p = f(-1.0 / 5040.0) + z * p
    p = f(1.0 / 120.0) + z * p
    p = f(-1.0 / 6.0) + z * p
    return x + x * z * p


@kernel
def smooth_noise(pings, spacing, nodes, start, per_bin, first, noise, out):
    """Smooth white noise at nodes to noise at pings, in bins that share a spacing of nodes.

    Parameters
    ----------
    pings : ndarray of int64, shape (n,)
    spacing : int
        Pings between nodes.
    nodes : ndarray of int64
        Those that the noise is given at, ascending.
    start : ndarray of int64, shape (n,)
        Each ping's first row of nodes.
    per_bin : ndarray of float32, shape (bins,)
        Steepness of the triangle in every bin, 1 / half width.
    first : int
        Column of ``out`` for the first bin.
    noise : tuple of two ndarray of float32, shape (nodes, 2, bins)
        Real and imaginary parts.
    out : tuple of two ndarray of float32, shape (n, 2, ...)
        Takes both parts.
    """
    real, imaginary, out_real, out_imaginary = noise[0], noise[1], out[0], out[1]
    bins = per_bin.size
    squares, gentlest = np.empty(bins, np.float32), per_bin.min()
    for ping in range(pings.size):
        squares[:] = 0.0
        for row in range(start[ping], min(start[ping] + MOST_NODES, nodes.size)):
            distance = np.float32(abs(pings[ping] - nodes[row] * spacing))
            if distance * gentlest >= 1.0:
                continue
            for k in range(bins):
                weight = max(np.float32(0.0), np.float32(1.0) - distance * per_bin[k])
                squares[k] += weight * weight
                for side in range(2):
                    out_real[ping, side, first + k] += weight * real[row, side, k]
                    out_imaginary[ping, side, first + k] += weight * imaginary[row, side, k]
        for side in range(2):
            for k in range(bins):
                scale = np.float32(1.0) / math.sqrt(squares[k])
                out_real[ping, side, first + k] *= scale
                out_imaginary[ping, side, first + k] *= scale


@kernel
def filter_noise(newest, past, spacing, filters, edges, noise, out):
    """Filter noise at nodes along the track to noise at pings, with weights for every distance from a node.

    Parameters
    ----------
    newest : ndarray of int64, shape (n,)
        Row of the last node at or before each ping.
    past : ndarray of int64, shape (n,)
        Steps from that node to the ping.
    spacing : int
        Steps between nodes.
    filters : ndarray of float64, shape (rows, steps)
        Weights of a node 0, 1, 2 ... steps before the ping.
    edges : ndarray of int64, shape (rows + 1,)
        Bins between which each row of filters applies.
    noise : tuple of two ndarray of float32, shape (nodes, 2, bins)
        Real and imaginary parts.
    out : tuple of two ndarray of float32, shape (n, 2, bins)
        Added to.
    """
    real, imaginary, out_real, out_imaginary = noise[0], noise[1], out[0], out[1]
    for ping in range(newest.size):
        for row in range(filters.shape[0]):
            weights = filters[row, past[ping] :: spacing]
            scale = 1.0 / math.sqrt((weights * weights).sum())
            for k in range(weights.size):
                weight, node = np.float32(weights[k] * scale), newest[ping] - k
                for side in range(2):
                    for column in range(edges[row], edges[row + 1]):
                        out_real[ping, side, column] += weight * real[node, side, column]
                        out_imaginary[ping, side, column] += weight * imaginary[node, side, column]


@inlined
def _filter_line(noise, taps, line):
    """Convolve one line of noise, which begins early enough for the filter, with its taps."""
    line[:] = 0.0
    for tap in range(taps.size):
        before = noise[taps.size - 1 - tap :]
        for k in range(line.size):
            line[k] += taps[tap] * before[k]


@kernel
def add_filtered_energy(real, imaginary, taps, share, out):
    """Filter complex noise along range and add its energy times a share.

    Parameters
    ----------
    real, imaginary : ndarray of float32, shape (n, 2, taps - 1 + bins)
        The noise begins so many bins before the record as the filter looks back.
    taps : ndarray of float32
    share : float
    out : ndarray of float32, shape (n, 2, bins)
        Added to.
    """
    pings, sides, bins = out.shape
    line_re, line_im = np.empty(bins, np.float32), np.empty(bins, np.float32)
    for ping in range(pings):
        for side in range(sides):
            _filter_line(real[ping, side], taps, line_re)
            _filter_line(imaginary[ping, side], taps, line_im)
            for k in range(bins):
                out[ping, side, k] += share * (line_re[k] * line_re[k] + line_im[k] * line_im[k])


@kernel
def add_filtered_waves(real, imaginary, taps, energy, wave_re, wave_im):
    """Filter complex noise along range and add it, with the given mean energy, to waves.

    Parameters
    ----------
    real, imaginary : ndarray of float32, shape (n, 2, taps - 1 + bins)
        The noise begins so many bins before the record as the filter looks back.
    taps : ndarray of float32
    energy : ndarray of float32, shape (n or 1, 2 or 1, bins)
        Mean energy; one row stands for all.
    wave_re, wave_im : ndarray of float32, shape (n, 2, bins)
        Added to.
    """
    pings, sides, bins = wave_re.shape
    line_re, line_im = np.empty(bins, np.float32), np.empty(bins, np.float32)
    for ping in range(pings):
        for side in range(sides):
            _filter_line(real[ping, side], taps, line_re)
            _filter_line(imaginary[ping, side], taps, line_im)
            mean = energy[min(ping, energy.shape[0] - 1), min(side, energy.shape[1] - 1)]
            for k in range(bins):
                amplitude = math.sqrt(mean[k])
                wave_re[ping, side, k] += amplitude * line_re[k]
                wave_im[ping, side, k] += amplitude * line_im[k]


@kernel
def add_detected(wave_re, wave_im, samples, share, out):
    """Detect waves: add a share of their energy, the mean over each bin's samples, to a record.

    Parameters
    ----------
    wave_re, wave_im : ndarray of float32, shape (n, 2, bins * samples)
    samples : int
        Of a bin.
    share : float
    out : ndarray of float32, shape (n, 2, bins)
        Added to.
    """
    pings, sides, bins = out.shape
    for ping in range(pings):
        for side in range(sides):
            if samples == 1:
                re, im = wave_re[ping, side], wave_im[ping, side]
                for k in range(bins):
                    out[ping, side, k] += share * (re[k] * re[k] + im[k] * im[k])
                continue
            for k in range(bins):
                total = np.float32(0.0)
                for place in range(k * samples, (k + 1) * samples):
                    total += wave_re[ping, side, place] ** 2 + wave_im[ping, side, place] ** 2
                out[ping, side, k] += share * total / np.float32(samples)


@kernel
def transform_distribution(field, table, first, per_octave, place):
    """Give an exponential field another distribution, by a table of log₂ of the new value over log₂ of the old one.

    Parameters
    ----------
    field : ndarray of float32, shape (n, 2, bins)
        Transformed in place.
    table : ndarray of float32, shape (rows, columns)
        log₂ of the new value; below the table its first slope continues.
    first : float
        log₂ of the old value in the first column.
    per_octave : float
        Columns per doubling of the old value.
    place : ndarray of float32, shape (n, 2, bins)
        Row of the table for each value, whole or not.
    """
    pings, sides, bins = field.shape
    columns = table.shape[1]
    for ping in range(pings):
        for side in range(sides):
            for k in range(bins):
                octave = math.log(max(field[ping, side, k], np.float32(1e-30))) * (np.float32(1.0) / LN_2)
                column = (octave - np.float32(first)) * np.float32(per_octave)
                low = min(max(int(column), 0), columns - 2)
                row = min(int(place[ping, side, k]), table.shape[0] - 2)
                part, above = column - np.float32(low), place[ping, side, k] - np.float32(row)
                here = table[row, low] + part * (table[row, low + 1] - table[row, low])
                there = table[row + 1, low] + part * (table[row + 1, low + 1] - table[row + 1, low])
                field[ping, side, k] = math.exp(LN_2 * (here + above * (there - here)))


@kernel
def fill_slow_normals(seed, stream, pings, half_width, spacing, out):
    """Fill an array with standard normal numbers that change slowly from ping to ping.

    Parameters
    ----------
    seed, stream : int
        What they derive from.
    pings : ndarray of int64, shape (n,)
    half_width : float
        Of the triangle that smooths them, in pings.
    spacing : int
        Pings between nodes.
    out : ndarray of float64, shape (n,)
        Filled.
    """
    for row in range(pings.size):
        total, squares = 0.0, 0.0
        first = math.ceil((pings[row] - half_width) / spacing)
        last = math.floor((pings[row] + half_width) / spacing)
        for node in range(first, last + 1):
            weight = 1.0 - abs(pings[row] - node * spacing) / half_width
            total += weight * _normal(seed, stream, node, spacing)
            squares += weight * weight
        out[row] = total / math.sqrt(squares)


@inlined
def _normal(seed, stream, node, spacing):
    """One standard normal number (Box and Muller 1958)."""
    modulus = math.sqrt(-2.0 * math.log(hash_uniform(seed, stream, node, spacing, 0)))
    return modulus * math.cos(2.0 * math.pi * hash_uniform(seed, stream, node, spacing, 1))
