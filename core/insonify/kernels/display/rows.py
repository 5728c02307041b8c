"""Rows of a picture: amplitudes of a ping relative to a curve, their averages over columns, and their colours.

Theory: docs/theory/error.md.
"""

import math

import numpy as np

from insonify.compiler.jit import kernel

ROWS_A_THREAD = 512  # rows worth handing to a thread, some 0.3 ms


@kernel
def relate_amplitudes(record, inverse, curve_of):
    """Replace intensities by the square root of their ratios to curves.

    Parameters
    ----------
    record : ndarray of float32, shape (n, bins)
        Intensities; takes the amplitudes.
    inverse : ndarray of float64, shape (curves, bins)
        One over each curve.
    curve_of : ndarray of int64, shape (n,)
        Curve of each row.
    """
    for row in range(record.shape[0]):
        values, curve = record[row], inverse[curve_of[row]]
        for k in range(values.size):
            # The ratio is formed in 64 bits: far bins hold 1e-9 and less, and their curve is as small.
            values[k] = math.sqrt(np.float32(values[k] * curve[k]))


@kernel
def average_bins(rows, picked, nearest, step, bins, edges, edges_of, out):
    """Average rows between successive edges, parts of bins weighted by their width.

    Parameters
    ----------
    rows : ndarray of float32, shape (m, columns of rows)
    picked : ndarray of int64, shape (n,)
        Which of the rows to average.
    nearest, step, bins : int
        Column of a row that holds the first bin, from there to the next bin (1 or -1), and number of bins.
    edges : ndarray of float64, shape (grids, columns + 1)
        Increasing positions in bins, from 0 to ``bins``; equal edges give 0.
    edges_of : ndarray of int64, shape (n,)
        Which of the grids each picked row has.
    out : ndarray of float32, shape (n, columns)
        Takes the averages.
    """
    for row in range(picked.size):
        values, at, means = rows[picked[row]], edges[edges_of[row]], out[row]
        for k in range(means.size):
            near, far = at[k], at[k + 1]
            first, last = min(int(near), bins - 1), min(int(far), bins - 1)
            place = nearest + step * first
            total = values[nearest + step * last] * (far - last) - values[place] * (near - first)
            for _ in range(first, last):
                total += values[place]
                place += step
            means[k] = max(total / (far - near), 0.0) if far > near else 0.0


@kernel
def colour_values(values, low, scale, table, out):
    """Look values up in a table of colours, those beyond its ends at its ends.

    Parameters
    ----------
    values : ndarray of float32, shape (n, columns)
    low : float32
        Value of the first colour.
    scale : float32
        Colours over a value of 1.
    table : ndarray of uint32, shape (colours,)
    out : ndarray of uint32, shape (n, columns)
        Takes the colours.
    """
    last = table.size - 1
    for row in range(values.shape[0]):
        value, colour = values[row], out[row]
        for k in range(value.size):
            place = (value[k] - low) * scale
            if place >= last:
                colour[k] = table[last]
            else:  # NaN takes the first colour
                colour[k] = table[int(place) if place > 0.0 else 0]
