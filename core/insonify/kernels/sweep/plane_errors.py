"""Error of a sum over the planes of a beam, estimated from the planes themselves while they are swept.

Planes sample the azimuths of a beam systematically, and how far their sum may be from the integral follows from the
differences of neighbouring planes (Matheron 1965; Kiêu, Souchet & Istas 1999). If half the mean square of the
difference of two planes grows as their distance to the power p, a plane adds the variance α(p) / 2 times the mean
square of second differences. The power is measured as well, from planes one and two spacings apart. Planes are compared
by their densities: their energies over those of a level bed. Derived in docs/theory/error.md.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.compiler.jit import inlined_uncounted, kernel_uncounted
from insonify.kernels.beam.azimuth_sector import sector_weight
from insonify.kernels.common.range_bins import FIXED_POINT
from insonify.kernels.common.types import LIGHT
from insonify.kernels.geometry.solids import highest_place

ERROR_ALTITUDES = 1.4  # altitudes of the sonar above the mean bed
REGIONS = 3
COLUMN, NEAR, BEYOND = range(REGIONS)  # bins before the first return, from there to `ERROR_ALTITUDES`, and beyond
NODES = 32  # places along the ground, and level sound, at which a plane is weighed
LEAST_PLANES = 3  # that give an estimate
# α(p) for p = 0, 1/4 .. 2: with q = (p - 1) / 2, Γ(2q+2) ζ(2q+2) cos(πq) / ((2π)^(2q+2) (1 - 2^(2q-1))), Kiêu et al.
ALPHA = np.array([1.0 / 3.0, 0.228015, 0.160791, 0.115298, 1.0 / 12.0, 0.060322, 0.043506, 0.031116, 0.021963])
POWER_STEP = 0.25
SOONER = 0.9  # least time of refracted sound over that of straight sound
ZERO = np.float32(0.0)
LEAST_SHARE = np.float32(1e-4)  # of the echo of a level bed, below which a plane is not compared with its neighbours
MISSED, COMPARED, ALL, FIRST, SECOND = range(5)  # sums of each region


class PlaneSums(NamedTuple):
    """Work space for the planes of one side of a ping, swept in the order of their azimuths."""

    total: NDArray[np.int64]  # (bins,) energy of all planes so far
    scale: NDArray[np.float32]  # (bins,) one over the echo of a level bed; in the water column, the range factor
    density: NDArray[np.float32]  # (3, bins) energy of the last three planes over that of a level bed
    share: NDArray[np.float32]  # (3, bins) their shares of the echo of a level bed
    azimuth: NDArray[np.float64]  # (3,) their azimuths, rad
    squares: NDArray[np.float32]  # (bins,) squares of what planes may miss, but for α
    # (regions, 3) squares of what planes may miss, and of the shares of planes: of those that are compared and of all.
    sums: NDArray[np.float64]
    edges: NDArray[np.int64]  # (regions, 2) bins at which the regions begin and end
    nodes: NDArray[np.float64]  # (NODES,) bins at which planes are weighed
    weights: NDArray[np.float64]  # (NODES + 1,) weights of all planes there, and last that of level sound
    # (regions, 5) of the planes since the last border of a target: the same, but for α, and squares of differences of
    # planes one and two spacings apart.
    piece: NDArray[np.float64]
    ends: NDArray[np.int64]  # (3,) bins at which the last three planes end
    planes: NDArray[np.int64]  # (2,) planes since the last border of a target; bin nearer than which there is no echo


def empty_plane_sums(bins: int) -> PlaneSums:
    """Make room for the planes of a side."""
    return PlaneSums(
        np.zeros(bins, np.int64), np.zeros(bins, np.float32), np.zeros((3, bins), np.float32),
        np.zeros((3, bins), np.float32), np.zeros(3), np.zeros(bins, np.float32), np.zeros((REGIONS, 3)),
        np.zeros((REGIONS, 2), np.int64), np.zeros(NODES), np.zeros(NODES + 1), np.zeros((REGIONS, 5)),
        np.zeros(3, np.int64), np.zeros(2, np.int64),
    )  # fmt: skip


@kernel_uncounted
def divide_bins(sums, arrays, height):
    """Find the regions of the bins, the echo of a level bed in them, and the places at which planes are weighed."""
    bins, length, edges, scale = arrays.bins, arrays.bin_length, sums.edges, sums.scale
    height = max(height, length)
    first = min(math.ceil(height / length), bins)
    beyond = min(math.ceil(ERROR_ALTITUDES * height / length), bins)
    # Bed above the mean may return between the water column and the first return of a level bed.
    edges[COLUMN, 1] = min(max(math.floor((height - max(arrays.bed.high, 0.0)) / length) - 1, 0), first)
    # Refracted sound may come a little sooner.
    nearest = (height - max(arrays.bed.high, highest_place(arrays))) * (SOONER if arrays.water.bent else 1.0)
    sums.planes[1] = min(max(math.floor(nearest / length) - 1, 0), first)
    edges[NEAR, 0], edges[NEAR, 1] = first, beyond
    edges[BEYOND, 0], edges[BEYOND, 1] = beyond, bins
    for k in range(first):
        scale[k] = arrays.range_factor[k] / FIXED_POINT
    before = 0.0
    for k in range(first, bins):
        cosine = height / ((k + 0.5) * length)
        far = math.sqrt(max((k + 1) * length - height, 0.0) * ((k + 1) * length + height))
        echo = cosine if arrays.law == LIGHT else cosine * cosine * (far - before)
        scale[k], before = 1.0 / (echo * FIXED_POINT), far
    farthest = math.sqrt(max((bins * length) ** 2 - height * height, length * length))
    for n in range(NODES):
        x = farthest * ((n + 0.5) / (NODES - 0.5)) ** 2
        sums.nodes[n] = math.sqrt(x * x + height * height) / length


@inlined_uncounted
def weigh_plane(sums, arrays, height, sector, weights):
    """Weights of a plane's sector over a level bed at the nodes, and last the weight of level sound."""
    height = max(height, arrays.bin_length)
    for n in range(NODES):
        r = sums.nodes[n] * arrays.bin_length
        x = math.sqrt(max(r * r - height * height, 1e-12))
        weights[n] = sector_weight(x, -height, r, sector, arrays.pattern, arrays.law)
    weights[NODES] = sector_weight(height, 0.0, height, sector, arrays.pattern, arrays.law)


@kernel_uncounted
def share_planes(sums, weights):
    """Turn the weights of all planes, (planes, NODES + 1), into their shares, and divide the scale by their sum."""
    planes, edges, scale, whole = weights.shape[0], sums.edges, sums.scale, sums.weights
    for n in range(NODES + 1):
        total = 0.0
        for k in range(planes):
            total += weights[k, n]
        whole[n] = total
        for k in range(planes):
            weights[k, n] = weights[k, n] / total if total > 0.0 else 0.0
    spread = sums.share[0]
    _spread_nodes(sums, whole, 0, spread.size, spread)
    for k in range(edges[NEAR, 0], edges[BEYOND, 1]):
        scale[k] = scale[k] / spread[k] if spread[k] > 0.0 else 0.0


@inlined_uncounted
def _spread_nodes(sums, values, start, end, out):
    """Interpolate values at the nodes from a bin to another; in the water column, values of level sound."""
    nodes, k = sums.nodes, min(max(sums.edges[NEAR, 0], start), end)
    out[start:k] = values[NODES]
    for n in range(NODES - 1):
        if k >= end:
            return
        last = min(max(math.ceil(nodes[n + 1] - 0.5), k), end)
        rate = (values[n + 1] - values[n]) / (nodes[n + 1] - nodes[n])
        part, start = out[k:last], values[n] + rate * max(k - nodes[n] + 0.5, 0.0)
        for i in range(part.size):
            part[i] = start + rate * i
        k = last
    out[k:end] = values[NODES - 1]


@inlined_uncounted
def begin_side(sums):
    """Clear the sums of a side."""
    sums.total[:] = 0
    sums.squares[:] = 0.0
    sums.sums[:, :] = 0.0
    sums.piece[:, :] = 0.0
    sums.planes[0] = 0


@inlined_uncounted
def add_plane(sums, bins, shares, reach, azimuth, is_apart):
    """Take the steps of one plane, and compare it with those before it unless a border of a target lies between.

    ``reach`` is the bin beyond which the plane has no echoes of the bed.
    """
    if is_apart:
        _end_piece(sums)
    slot, steps, start = sums.planes[0] % 3, bins.steps, sums.planes[1]
    end = max(_find_end(steps, reach, sums.total.size), start)
    sums.planes[0] += 1
    sums.ends[slot], sums.azimuth[slot] = end, azimuth
    total, own_steps = sums.total[start:end], steps[start:end]
    density, energy = sums.density[slot][start:end], np.int64(0)
    for k in range(total.size):
        energy += own_steps[k]
        total[k] += energy
        density[k] = energy
    steps[start : end + 2] = 0
    share = sums.share[slot]
    _spread_nodes(sums, shares, start, end, share)
    scale, own = sums.scale[start:end], share[start:end]
    for k in range(density.size):
        density[k] = density[k] * scale[k] / own[k] if own[k] > LEAST_SHARE else ZERO
    for region in range(REGIONS):
        part, squares = share[_within(sums, region, start, end)], ZERO
        for k in range(part.size):
            squares += part[k] * part[k]
        sums.piece[region, ALL] += squares
    if sums.planes[0] >= LEAST_PLANES:
        _compare_planes(sums, (slot + 1) % 3, (slot + 2) % 3, slot)


@inlined_uncounted
def _within(sums, region, start, end):
    """Bins of a region from a bin to another."""
    return slice(min(max(sums.edges[region, 0], start), end), min(max(sums.edges[region, 1], start), end))


@inlined_uncounted
def _find_end(steps, reach, size):
    """Bin at which the steps of a plane end, if it has none beyond its reach."""
    end, beyond = min(reach, size), np.int64(0)
    rest = steps[end:size]
    for k in range(rest.size):
        beyond |= rest[k]
    return size if beyond != 0 else end


@inlined_uncounted
def _compare_planes(sums, before, middle, after):
    """Compare three planes that follow one another."""
    azimuth, squares, piece = sums.azimuth, sums.squares, sums.piece
    nearer = np.float32((azimuth[after] - azimuth[middle]) / (azimuth[after] - azimuth[before]))
    farther = np.float32(1.0) - nearer
    end = min(sums.ends[before], sums.ends[middle], sums.ends[after])
    for region in range(REGIONS):
        # Slices, because loops from a bin that may be negative are not vectorised.
        part = _within(sums, region, sums.planes[1], end)
        a, b, c = sums.density[before][part], sums.density[middle][part], sums.density[after][part]
        u, v, w = sums.share[before][part], sums.share[middle][part], sums.share[after][part]
        own = squares[part]
        first = second = missed = compared = ZERO
        for k in range(own.size):
            least = u[k] if u[k] < v[k] else v[k]
            least = least if least < w[k] else w[k]
            weight = least * least if least > LEAST_SHARE else ZERO
            inward, outward = b[k] - a[k], c[k] - b[k]
            bend = nearer * inward - farther * outward
            square = weight * bend * bend
            own[k] += square
            first += weight * (inward * inward + outward * outward)
            second += weight * (inward + outward) * (inward + outward)
            missed += square
            compared += weight
        piece[region, FIRST] += first
        piece[region, SECOND] += second
        piece[region, MISSED] += missed
        piece[region, COMPARED] += compared


@inlined_uncounted
def _end_piece(sums):
    """Add the sums of the planes since the last border of a target to the sums of the side."""
    for region in range(REGIONS):
        piece, shares = sums.piece[region], sums.piece[region, ALL]
        sums.sums[region, ALL] += shares
        if piece[COMPARED] > 0.0:
            # Planes that have but one neighbour err as the others.
            missed = piece[MISSED] * shares / piece[COMPARED]
            sums.sums[region, MISSED] += variance_factor(piece[FIRST], piece[SECOND]) * missed
            sums.sums[region, COMPARED] += shares
    sums.piece[:, :] = 0.0
    sums.planes[0] = 0


@inlined_uncounted
def variance_factor(first, second):
    """α(p) of the power with which squares of differences grow from one spacing to two."""
    # `first` counts two differences where `second` counts one.
    power = math.log2(max(2.0 * second / first, 1.0)) if first > 0.0 else 0.0
    place = min(power, 2.0) / POWER_STEP
    k = min(int(place), ALPHA.size - 2)
    return ALPHA[k] + (place - k) * (ALPHA[k + 1] - ALPHA[k])


@kernel_uncounted
def finish_side(sums, factor, out, errors, bin_errors):
    """Turn the sum of all planes into intensities, and find by region the squares of its error.

    ``errors``, (regions, 2), takes those over the record of a level bed; NaN where no planes can be compared.
    ``bin_errors``, (bins,) or empty, takes the error of each bin as an intensity.
    """
    _end_piece(sums)
    for region in range(REGIONS):
        found = sums.sums[region]
        if found[COMPARED] > 0.0:
            square = 2.0 * found[MISSED] * found[ALL] / found[COMPARED]
            errors[region, 0] += square
            if bin_errors.size > 0:
                _share_error(sums, region, square, factor, bin_errors)
        elif found[ALL] > 0.0:
            errors[region, 0] = np.nan
            bin_errors[sums.edges[region, 0] : sums.edges[region, 1]] = np.nan
    if bin_errors.size > 0:
        bin_errors[sums.edges[COLUMN, 1] : sums.edges[NEAR, 0]] = np.nan  # where planes are not compared
    total = sums.total
    for k in range(total.size):
        # Weights interpolated in a table may be negative by rounding; intensities are never below zero.
        out[k] = max(total[k], np.int64(0)) * (factor[k] * (1.0 / FIXED_POINT))


@kernel_uncounted
def _share_error(sums, region, square, factor, bin_errors):
    """Add the square of a region's error to the squares of its bins, in proportion to the echo that planes may miss."""
    part, whole = slice(sums.edges[region, 0], sums.edges[region, 1]), 0.0
    squares, scale, decay, out = sums.squares[part], sums.scale[part], factor[part], bin_errors[part]
    for k in range(out.size):
        whole += squares[k]
    for k in range(out.size):
        if squares[k] > 0.0:
            own = math.sqrt(square * squares[k] / whole) * decay[k] / (scale[k] * FIXED_POINT)
            out[k] = math.hypot(out[k], own)


@kernel_uncounted
def square_record(sums, factor, record, errors):
    """Find by region the squares of a record over the record of a level bed."""
    for region in range(REGIONS):
        part, whole = slice(sums.edges[region, 0], sums.edges[region, 1]), 0.0
        echoes, scale, decay = record[part], sums.scale[part], factor[part]
        for k in range(echoes.size):
            echo = echoes[k] * (scale[k] * FIXED_POINT / decay[k])
            whole += echo * echo
        errors[region, 1] = whole
        if whole == 0.0:
            errors[region, 0] = 0.0
