"""Tables of apparent positions in layered water, and whether each place is reached by one ray alone.

Theory: docs/theory/refraction.md.
"""

import math

import numpy as np

from insonify.compiler.jit import kernel
from insonify.kernels.refraction.apparent_positions import LEVEL, RISE, TUBE, TURN
from insonify.kernels.refraction.arcs import RANGE, launch_in_layers, speed_at
from insonify.kernels.refraction.eigenrays import FOUND, find_direct_ray, follow_to_range

NEAR = 1e-3  # ground range of the first column, in columns: straight below the sonar x'/x is undefined
FANNED = 256  # rays that are compared to see whether any two cross
LOOKED = 64  # ground ranges at which they are compared


@kernel
def fill_apparent_table(height, speed, reference, z, first_row, row_step, column_step, surface, out):
    """Fill the table of a sonar at height z.

    Parameters
    ----------
    height, speed : ndarray, shape (n,)
        Nodes of the water, ascending.
    reference : float
        Speed by which travel time becomes slant range, m/s.
    z : float
        Height of the sonar, m.
    first_row : float
        Height of the first row, m.
    row_step, column_step : float
        Between rows and columns, m.
    surface : float
        Height above which no ray may go, m.
    out : ndarray of float32, shape (rows, columns, 4)
        Takes LEVEL, RISE, TUBE and TURN.

    Returns
    -------
    bool
        Whether every place of the table is reached, and the higher ones along the steeper rays.
    """
    rows, columns, _ = out.shape
    for i in range(columns):
        x = max(i, NEAR) * column_step
        before = -math.inf
        for j in range(rows):
            place = first_row + j * row_step
            status, ray = find_direct_ray(height, speed, z, place, x, -math.inf, surface)
            slope = ray.sine0 / ray.cosine0
            if status != FOUND or not ray.q > 0.0 or not slope > before:
                return False
            before = slope
            r = reference * ray.time
            out[j, i, LEVEL] = r * ray.cosine0 / x - 1.0
            out[j, i, RISE] = r * ray.sine0 - (place - z)
            out[j, i, TUBE] = ray.q / r - 1.0
            out[j, i, TURN] = math.atan2(ray.sine, ray.cosine) - math.atan2(ray.sine0, ray.cosine0)
    return True


@kernel
def is_single_valued(height, speed, z, low, high, reach, surface):
    """Whether no place between two heights is reached by two rays, within a ground range.

    Only rays that turn can meet others: those launched so flatly that sound of the same slowness along the level is
    found nowhere beyond their turning points. Where rays are launched the more steeply, they must come out the higher.

    Parameters
    ----------
    height, speed : ndarray, shape (n,)
        Nodes of the water, ascending.
    z : float
        Height of the sonar, m.
    low, high : float
        The two heights, m.
    reach : float
        The ground range, m.
    surface : float
        Height above which no ray may go, m.
    """
    c0 = speed_at(height, speed, z)
    flattest = math.acos(min(c0 / speed.max(), 1.0))
    if flattest == 0.0:
        return True
    below = np.full(LOOKED, -math.inf)
    for k in range(FANNED + 1):
        angle = flattest * (2.0 * k / FANNED - 1.0)
        ray, gone = launch_in_layers(height, speed, z, math.cos(angle), math.sin(angle)), False
        for i in range(LOOKED):
            if not gone:
                status, ray = follow_to_range(height, speed, ray, (i + 1) * reach / LOOKED, -math.inf, surface)
                gone = status != RANGE
            here = math.inf if gone else ray.z
            if here <= below[i] and here <= high and below[i] >= low:
                return False
            below[i] = here
    return True
