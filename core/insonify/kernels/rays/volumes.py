"""Echoes of points of the water column along straight lines, in front of everything else.

Theory: docs/theory/speckle.md.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.compiler.jit import inlined, kernel
from insonify.kernels.beam.pattern import two_way_response
from insonify.kernels.common.range_bins import range_weight
from insonify.kernels.common.types import SONAR
from insonify.kernels.rays.launch import beam_touches_ball, orient_beam

KNIFE = 0.5  # m, half the thickness of the slab from which a knife receives echoes


class EchoPoints(NamedTuple):
    """Points of the water column that echo, in groups of neighbours."""

    place: NDArray[np.float64]  # (m, 3) above the datum, m
    strength: NDArray[np.float64]  # (m,) backscattering cross section of each, m²
    end: NDArray[np.int64]  # (groups,) row after the last of each group
    centre: NDArray[np.float64]  # (groups, 3) of a ball around each
    bound: NDArray[np.float64]  # (groups,) its radius, m


@kernel
def add_volume_echoes(arrays, poses, points, out):
    """Add the mean energy of points of the water to the range bins of n pings, float32 of shape (n, 2, bins)."""
    for ping in range(poses.x.size):
        for side in range(2):
            beam, begin = orient_beam(arrays, poses, ping, side), 0
            for row in range(points.end.size):
                x, y, z = points.centre[row, 0] - beam.x, points.centre[row, 1] - beam.y, points.centre[row, 2] - beam.z
                if beam_touches_ball(beam, x, y, z, math.sqrt(x * x + y * y + z * z), points.bound[row] + KNIFE):
                    _add_points(arrays, beam, points.place, points.strength, begin, points.end[row], out[ping, side])
                begin = points.end[row]


@kernel
def _add_points(arrays, beam, place, strength, begin, end, out):
    """Add the energy of some points to the bins of one side of one ping."""
    for k in range(begin, end):
        x, y, z = place[k, 0] - beam.x, place[k, 1] - beam.y, place[k, 2] - beam.z
        r = math.sqrt(x * x + y * y + z * z)
        if x * beam.side_x + y * beam.side_y >= 0.0 and 0.0 < r < beam.reach:
            number = min(int(r / arrays.bin_length), arrays.bins - 1)
            nearness = range_weight(arrays.range_decay, number, r / arrays.bin_length, 0.0)
            factor = arrays.range_factor[number] * nearness
            out[number] += strength[k] * _response(arrays, beam, x / r, y / r, z / r, r) * factor


@inlined
def _response(arrays, beam, dx, dy, dz, r):
    """Two-way response in a direction; a knife receives from a slab of water 1 m thick."""
    fan = arrays.half_width > 0.0
    if fan and not beam.s_low <= dx * beam.axis_x + dy * beam.axis_y + dz * beam.axis_z <= beam.s_high:
        return 0.0
    if not fan and abs(dx * beam.ahead_x + dy * beam.ahead_y) * r > KNIFE:
        return 0.0
    return two_way_response(arrays.pattern, beam, fan, SONAR, dx, dy, dz, r) if arrays.pattern.tabulated else 1.0
