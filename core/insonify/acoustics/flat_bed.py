"""Record of a level bed in closed form, by which errors and pictures are normalised, and the bins that errors count in.

Nearer than `ERROR_ALTITUDES` bins have strong echoes near nadir, to which no tolerance applies.

Theory: docs/theory/error.md.
"""

import math

import numpy as np

from insonify.arrays import Floats
from insonify.compiler.jit import kernel
from insonify.kernels.beam.pattern import ring_responses
from insonify.kernels.common.range_bins import range_weight
from insonify.kernels.common.types import LIGHT, Poses, RangeDecay, SceneArrays
from insonify.kernels.sweep.plane_errors import ERROR_ALTITUDES as ERROR_ALTITUDES
from insonify.scene.seabed.materials.catalogue import Reflectivity
from insonify.scene.seabed.materials.sediments import scattering_strength

LAMBERT = Reflectivity(1.0, 0.0, 1.0)


@kernel
def _first_weight(decay: RangeDecay, k: int, position: float, span: float) -> float:
    """Range weight of the first bin, kept on disk for calls from Python."""
    return range_weight(decay, k, position, span)


def flat_bed_curve(arrays: SceneArrays, altitude: float, reflectivity: Reflectivity | None = None) -> Floats:
    """Record of a level bed under a level sonar with a uniform vertical beam."""
    diffuse, specular, shininess = (reflectivity or LAMBERT)[:3]
    edges = np.arange(arrays.bins + 1) * arrays.bin_length
    near, far = np.maximum(edges[:-1], altitude), np.maximum(edges[1:], altitude)
    # As a product, because rounding may make the difference of two squares negative.
    x_near, x_far = (np.sqrt((r - altitude) * (r + altitude)) for r in (near, far))
    reached = far > near
    r = np.where(reached, 0.5 * (near + far), 1.0)
    cos_incidence = np.where(reached, altitude / r, 0.0)
    factor, first = arrays.range_factor.copy(), int(altitude / arrays.bin_length)
    if first < arrays.bins:  # that bin begins with the first return, nearer than which there is no bed
        spanned = (far[first] - near[first]) / arrays.bin_length
        factor[first] *= _first_weight(arrays.range_decay, first, r[first] / arrays.bin_length, spanned)
    if arrays.law == LIGHT:
        mirrored = np.maximum(2.0 * cos_incidence**2 - 1.0, 0.0) ** shininess
        shade = diffuse * cos_incidence + specular * mirrored
        return np.where(reached, shade * (far - near) / arrays.bin_length * factor, 0.0)
    sigma = scattering_strength(reflectivity or LAMBERT, cos_incidence)
    x = 0.5 * (x_near + x_far)
    return np.where(reached, sigma * (x_far - x_near) * along_track_width(arrays, x, r) * factor, 0.0)


def compute_flat_bed_curves(arrays: SceneArrays, poses: Poses) -> Floats:
    """Record of a level Lambert bed under every pose, (n, 1, bins) float64."""
    # A sonar below the mean bed, in a trough, is taken one bin above it.
    altitudes, which = np.unique(np.maximum(poses.z, arrays.bin_length), return_inverse=True)
    curves = np.array([flat_bed_curve(arrays, float(altitude)) for altitude in altitudes])
    return curves.reshape(-1, arrays.bins)[which][:, None, :]


def along_track_width(arrays: SceneArrays, x: Floats, r: Floats) -> Floats:
    """Length of the arc of a level bed inside the beam at ground range ``x`` and slant range ``r``, in metres."""
    # The beam angle φ_b of azimuth φ and grazing angle θ obeys sin φ_b = cos θ sin φ. A top-hat holds all azimuths with
    # |sin φ_b| below the sine of its half width, so all of them near nadir; a pattern weighs them. A knife is 1 m wide
    # by definition.
    if arrays.half_width <= 0.0:
        return np.ones_like(x)
    if arrays.pattern.tabulated:
        angles = np.empty_like(x)
        ring_responses(arrays.pattern, x, r, angles)
        return x * angles
    reach = np.sin(arrays.half_width) * r / np.maximum(x, 1e-300)
    return 2.0 * x * np.arcsin(np.minimum(reach, 1.0))


def find_first_bin(altitudes: float, arrays: SceneArrays, poses: Poses) -> int:
    """First bin that lies beyond a number of altitudes under every pose, at most the number of bins."""
    return min(math.ceil(altitudes * float(poses.z.max(initial=0.0)) / arrays.bin_length), arrays.bins)
