"""Propagation paths by two images of the sonar, out by one and back by the other; the direct path has the sonar twice.

Derived in docs/theory/multipath.md.
"""

from typing import NamedTuple

from insonify.compiler.jit import inlined_uncounted
from insonify.kernels.common.scattering import backscatter_strength, bistatic_strength
from insonify.kernels.common.types import LIGHT

DIRECT, SURFACE_BOTTOM, SURFACE_BOTTOM_SURFACE, SECOND_BOTTOM, SURFACE_ECHO, PATH_COUNT = 0, 1, 2, 3, 4, 5


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
    raised: float  # height of the other above the one, m
    orders: int  # 2 if they differ, because sound travels the path in both directions
    passes: int  # of the sea surface
    is_detailed: bool  # whether stretches need more than slant ranges and energy: for their contributors or for waves
    path: int  # DIRECT, SURFACE_BOTTOM, SURFACE_BOTTOM_SURFACE or SECOND_BOTTOM
    law: int
    bin_length: float  # m
    rms_height: float  # of the waves, m
    slope_variance: float  # of the waves, along one direction
    reach: float  # slant range over a calm sea up to which waves may bring an echo into the record, m
    farthest: float  # ground range beyond which no echo returns within the reach, m; 0 if the path is not traced


@inlined_uncounted
def direct_path(law, bin_length, is_detailed):
    """Path from the sonar and straight back."""
    sonar = ImageSource(0.0, False, 1.0, 0.0)
    return ImagePath(sonar, sonar, 0.0, 1, 0, is_detailed, DIRECT, law, bin_length, 0.0, 0.0, 0.0, 0.0)


@inlined_uncounted
def path_strength(cos_one, cos_other, mirrored, diffuse, specular, shininess, path):
    """Strength of a surface for a path, times its orders and the share that mirrors reflect."""
    if path.raised == 0.0:
        return backscatter_strength(cos_one, diffuse, specular, shininess, path.law)
    value = bistatic_strength(cos_one, cos_other, mirrored, diffuse, specular, shininess, path.law)
    if path.orders == 2 and path.law == LIGHT:
        value += bistatic_strength(cos_other, cos_one, mirrored, diffuse, specular, shininess, LIGHT)
    elif path.orders == 2:
        value *= 2.0  # law SONAR is reciprocal
    return value * path.one.share * path.other.share


@inlined_uncounted
def spreading_ratio(r_one, r_other, law):
    """Ratio of the spreading along two ways to the record's own 1/r⁴: r⁴ / (R² R'²) with r = (R + R') / 2."""
    if law == LIGHT or r_one == r_other:
        return 1.0
    r = 0.5 * (r_one + r_other)
    return (r * r / (r_one * r_other)) ** 2  # docs/theory/multipath.md


@inlined_uncounted
def path_delays(path, drop, r_one, r_other):
    """Slant ranges that waves of rms height and facets tilted by one standard deviation add to a path, m.

    The place lies ``drop`` below the lower image, ``r_one`` from it and ``r_other`` from the higher one.
    """
    if not (path.rms_height > 0.0 or path.slope_variance > 0.0):
        return 0.0, 0.0
    rise, tilt = (
        height_delay(path.one, drop, r_one, path.rms_height),
        tilt_delay(path.one, drop, r_one, path.slope_variance),
    )
    drop += path.raised
    rise += height_delay(path.other, drop, r_other, path.rms_height)
    return rise, tilt + tilt_delay(path.other, drop, r_other, path.slope_variance)


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
