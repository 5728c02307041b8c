"""Image sources: the sonar mirrored in the level sea surface and in the bed beneath it.

The surface is a perfect mirror at its own height. For the second bottom echo the bed beneath the sonar is a level
mirror, which reflects the share R0² of the energy that its material sets. Derived in docs/theory/multipath.md.
"""

import math

from insonify.compiler.jit import inlined_uncounted, kernel, kernel_uncounted
from insonify.kernels.geometry.solids import highest_place
from insonify.kernels.rays.cell_walk import Ray, meet_bed
from insonify.kernels.sweep.image_paths import (
    SECOND_BOTTOM,
    SURFACE_BOTTOM,
    SURFACE_BOTTOM_SURFACE,
    ImagePath,
    ImageSource,
)

DEEPEST = 1e6  # m, for a sonar without a bed beneath it

PAIRS = 3  # paths that are made by two images


@kernel_uncounted
def surface_image(arrays, z):
    """Image of the sonar in the sea surface."""
    up = max(arrays.water.surface - z, 0.0)
    return ImageSource(2.0 * up, True, 1.0, up)


@kernel_uncounted
def bottom_image(arrays, x, y, z):
    """Image of the sonar in the bed beneath it, and of that in the sea surface."""
    up = max(arrays.water.surface - z, 0.0)
    down, row, _, _, _ = meet_bed(arrays.bed, Ray(x, y, z, 0.0, 0.0, -1.0), DEEPEST)
    if not down < DEEPEST:
        return ImageSource(0.0, False, 0.0, 0.0)
    return ImageSource(2.0 * (up + down), False, arrays.interface[row, 0] ** 2, up + 2.0 * down)


@kernel_uncounted
def image_pairs(arrays, x, y, z):
    """Pairs of images that make the propagation paths by way of the sea surface and back from the bed."""
    multipath, sonar, drop = arrays.multipath, ImageSource(0.0, False, 1.0, 0.0), z - highest_place(arrays)
    surface, bottom = surface_image(arrays, z), bottom_image(arrays, x, y, z)
    is_by_bottom = multipath.second_bottom and bottom.share > 0.0
    return (
        _image_pair(arrays, SURFACE_BOTTOM, sonar, surface, drop, multipath.surface_bottom),
        _image_pair(arrays, SURFACE_BOTTOM_SURFACE, surface, surface, drop, multipath.surface_bottom_surface),
        _image_pair(arrays, SECOND_BOTTOM, sonar, bottom, drop, is_by_bottom),
    )


@inlined_uncounted
def _image_pair(arrays, path, one, other, drop, is_traced):
    """Pair of images that makes one propagation path; ``drop`` is the height of the sonar above the highest place."""
    multipath, twice = arrays.multipath, path == SURFACE_BOTTOM_SURFACE
    passes, orders = (2, 1) if twice else (1, 2)
    reach = arrays.bins * arrays.bin_length + wave_advance(multipath, passes)
    farthest = _farthest_ground_range(drop + one.height, drop + other.height, reach) if is_traced else 0.0
    waves, raised = (multipath.rms_height, multipath.slope_variance), other.height - one.height
    return ImagePath(
        one, other, raised, orders, passes, True, path, arrays.law, arrays.bin_length, *waves, reach, farthest
    )


@inlined_uncounted
def _farthest_ground_range(lower, higher, reach):
    """Ground range beyond which no echo returns within a reach to two images so high above the highest place."""
    # Both legs are shortest to the highest places: R + R' = 2 r is an ellipse there.
    lower, higher, sum_ = max(lower, 0.0), max(higher, 0.0), 2.0 * reach
    if not lower + higher < sum_:
        return 0.0
    leg = 0.5 * (sum_ - (higher * higher - lower * lower) / sum_)
    return math.sqrt(max(leg * leg - lower * lower, 0.0))


@kernel
def wave_advance(multipath, passes):
    """Greatest slant range by which waves can shorten a path by way of the sea surface."""
    if not multipath.enabled:
        return 0.0
    # Of η sin θ for each pass; tilts only lengthen.
    return -passes * multipath.rms_height * multipath.facets[passes - 1, :, 0].min()


@inlined_uncounted
def plane_reach(arrays, pair, per_height, height):
    """Ground range to which a plane takes in anything of a propagation path."""
    # If sound passes the beam only once, the beam of the higher image counts, which reaches farther out.
    one_way = arrays.pattern.tabulated and not arrays.pattern.two_way
    highest = pair.other.height if one_way else pair.one.height
    return min(per_height * (height + highest), pair.farthest)
