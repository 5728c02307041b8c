"""Visible stretches of the bed in the planes of a beam, and whether a place lies in one."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.compiler.jit import inlined, kernel
from insonify.kernels.bed.slice import slice_bed
from insonify.kernels.refraction.apparent_positions import straight_grid
from insonify.kernels.sweep.sweep import aim_plane
from insonify.kernels.sweep.visibility import NADIR


class VisibleBed(NamedTuple):
    """Stretches of the bed that the planes of one side see, one row a plane, from the sternmost to the foremost."""

    borders: NDArray[np.float64]  # (planes - 1,) sines of the azimuths between neighbours
    reach: NDArray[np.float64]  # (planes,) ground range at which each leaves the beam, m
    edges: NDArray[np.float64]  # (planes, n) ground ranges at which visible stretches begin and end, alternating
    edge_count: NDArray[np.int64]  # (planes,) how many edges there are


def empty_visible_bed(azimuth: NDArray[np.float64], capacity: int) -> VisibleBed:
    """Make room for the visible stretches of planes at ascending azimuths, rad, of at most ``capacity`` knots each."""
    planes = azimuth.size
    borders = np.sin(0.5 * (azimuth[1:] + azimuth[:-1]))
    return VisibleBed(borders, np.zeros(planes), np.zeros((planes, capacity + 2)), np.zeros(planes, np.int64))


@kernel
def find_visible_bed(arrays, poses, ping, side, planes, profile, visible_bed):
    """Find the visible stretches of the bed in all planes of one side of one ping."""
    for k in range(planes.azimuth.size):
        plane, _, reach = aim_plane(arrays, poses, ping, side, planes, k, straight_grid())
        knots = slice_bed(arrays.bed, arrays.limits, plane.x, plane.y, plane.z, plane.ex, plane.ey, reach, profile)
        visible_bed.reach[k] = reach
        visible_bed.edge_count[k] = _mark_visible(knots, profile.x, profile.z, profile.area, visible_bed.edges[k])


@inlined
def _mark_visible(knots, x, z, area, edges):
    """Walk a profile outward with one running horizon; return how many edges its visible stretches have."""
    count, horizon = 0, NADIR
    for i in range(knots - 1):
        # The bed straight below is visible at any height of the knot. NaN, a hole in the bed, compares false.
        here = z[i] / x[i] if x[i] > 0.0 else NADIR
        horizon = here if here > horizon else horizon
        if not (z[i + 1] > horizon * x[i + 1] and area[i] == area[i]):
            continue
        start = x[i]
        if horizon > here:
            slope = (z[i + 1] - z[i]) / (x[i + 1] - x[i])
            start = min(max((z[i] - slope * x[i]) / (horizon - slope), x[i]), x[i + 1])
        if count == 0 or start > edges[count - 1]:
            edges[count], count = start, count + 2
        edges[count - 1] = x[i + 1]
    return count


@inlined
def is_bed_visible(borders, reach, edges, edge_count, sine, x):
    """Whether the bed is visible at a ground range, in the plane nearest to an azimuth."""
    k, longest = np.searchsorted(borders, sine), np.argmax(reach)
    # Beyond the beam's reach in a plane, the next plane inwards stands for the azimuths that remain.
    while x > reach[k] and k != longest:
        k += 1 if k < longest else -1
    return np.searchsorted(edges[k, : edge_count[k]], x) % 2 == 1
