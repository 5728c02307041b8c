"""Places on the grid of a bed: indices of nodes, wrapped where the bed repeats, and the part of a line within it."""

import math

from insonify.compiler.jit import inlined_uncounted

# Knots closer to a grid corner than this share of a cell merge with it.
MERGED = 1e-6
# Slope of a plane against the grid's nearer axis from which on its strips are too short to be walked one by one, and
# segments bulge too much for an even density of their echo.
OBLIQUE = 0.06


@inlined_uncounted
def wrap_index(index, size):
    """Index of a node on a bed that repeats: the whole number within [0, size)."""
    if 0 <= index < size:
        return index
    return index % size


@inlined_uncounted
def clip_to_grid(origin, rate, highest, near, far):
    """Part of an interval on which a coordinate stays within a grid."""
    if rate == 0.0:
        return (near, far) if 0.0 <= origin <= highest else (1.0, 0.0)
    one, other = -origin / rate, (highest - origin) / rate
    return max(near, min(one, other)), min(far, max(one, other))


@inlined_uncounted
def first_line(v, step):
    """Last grid line at or behind a place of a walk; a line just ahead counts as reached."""
    # With ``-step`` it is the first line at or beyond the place; a line just behind counts as reached.
    return math.floor(v + MERGED) if step > 0 else math.ceil(v - MERGED)


@inlined_uncounted
def is_oblique(ex, ey):
    """Whether a plane is so oblique to the grid that its segments bulge and are walked line by line."""
    return min(abs(ex), abs(ey)) > OBLIQUE * max(abs(ex), abs(ey))
