"""Image sources: the sonar mirrored in the level sea surface and in the bed beneath it.

The surface is a perfect mirror at its own height. For the second bottom echo the bed beneath the sonar is a level
mirror, which reflects the share R0² of the energy that its material sets. Derived in docs/theory/multipath.md.
"""

import math
from typing import NamedTuple

from insonify.compiler.jit import inlined_uncounted, kernel, kernel_uncounted
from insonify.kernels.common.scattering import bistatic_strength
from insonify.kernels.common.types import LIGHT
from insonify.kernels.geometry.solids import highest_place
from insonify.kernels.rays.cell_walk import Ray, meet_bed

DEEPEST = 1e6  # m, for a sonar without a bed beneath it

# Propagation paths; 0 is the direct one.
SURFACE_BOTTOM, SURFACE_BOTTOM_SURFACE, SECOND_BOTTOM, SURFACE_ECHO, PATH_COUNT = 1, 2, 3, 4, 5
PAIRS = 3  # paths that are made by two images


class ImageSource(NamedTuple):
    """The sonar, or one of its images."""

    height: float  # above the sonar, m
    mirrored: bool  # whether sound that comes down from it left the sonar upwards at the same angle
    share: float  # share of the energy that the mirrors reflect
    above: float  # height above the sea surface, m; 0 for the sonar itself


class ImagePath(NamedTuple):
    """A propagation path by two images of the sonar, out by one and back by the other, with the waves on its way."""

    one: ImageSource  # the lower of the two
    other: ImageSource
    orders: int  # 2 if they differ, because sound travels the path in both directions
    passes: int  # of the sea surface
    path: int  # SURFACE_BOTTOM, SURFACE_BOTTOM_SURFACE or SECOND_BOTTOM
    law: int
    bin_length: float  # m
    rms_height: float  # of the waves, m
    slope_variance: float  # of the waves, along one direction
    reach: float  # slant range over a calm sea up to which waves may bring an echo into the record, m
    farthest: float  # ground range beyond which no echo returns within the reach, m; 0 if the path is not traced


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
    waves = multipath.rms_height, multipath.slope_variance
    return ImagePath(one, other, orders, passes, path, arrays.law, arrays.bin_length, *waves, reach, farthest)


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


@inlined_uncounted
def pair_strength(cos_one, cos_other, mirrored, diffuse, specular, shininess, pair):
    """Bistatic strength of a surface for a pair of images, times its orders and the share that mirrors reflect."""
    value = bistatic_strength(cos_one, cos_other, mirrored, diffuse, specular, shininess, pair.law)
    if pair.orders == 2 and pair.law == LIGHT:
        value += bistatic_strength(cos_other, cos_one, mirrored, diffuse, specular, shininess, LIGHT)
    elif pair.orders == 2:
        value *= 2.0  # law SONAR is reciprocal
    return value * pair.one.share * pair.other.share


@inlined_uncounted
def spreading_ratio(r_one, r_other, law):
    """Ratio of the spreading along two ways to the record's own 1/r⁴: r⁴ / (R² R'²) with r = (R + R') / 2."""
    if law == LIGHT:
        return 1.0
    r = 0.5 * (r_one + r_other)
    return (r * r / (r_one * r_other)) ** 2  # docs/theory/multipath.md


@inlined_uncounted
def height_delay(image, drop, r, rms_height):
    """Slant range that waves of rms height η add to a leg: η sin θ at the grazing angle θ on the surface."""
    return rms_height * drop / r if image.above > 0.0 else 0.0


@inlined_uncounted
def tilt_delay(image, drop, r, slope_variance):
    """Slant range that facets tilted by one standard deviation add to a leg."""
    # A facet tilted by t mirrors to the same place from 2t / (sin θ (1/r₁ + 1/r₂)) farther along the surface, by a way
    # longer by 2 t² r₁ r₂ / (r₁ + r₂), of which slant range counts half; r₁ and r₂ = r − r₁ lead to the surface and on.
    # Tilts across the plane are left out: they turn as much sound out of a narrow beam as into it.
    return slope_variance * image.above * max(drop - image.above, 0.0) * r / (drop * drop)
