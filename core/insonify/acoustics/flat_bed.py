"""The record of a level bed, in closed form: what every error is measured against and every picture divided by."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from insonify.kernels.beam.pattern import ring_responses
from insonify.kernels.common.types import LIGHT, SceneArrays
from insonify.scene.materials import Reflectivity

LAMBERT = Reflectivity(1.0, 0.0, 1.0)


def flat_bed_curve(
    arrays: SceneArrays, altitude: float, reflectivity: Reflectivity | None = None
) -> NDArray[np.float64]:
    """Record of a level bed, heard by a level fish at every grazing angle alike.

    Parameters
    ----------
    arrays : SceneArrays
        Law, beam, bins and range factors.
    altitude : float
        Height of the sonar above the bed, in metres.
    reflectivity : Reflectivity, optional
        Of the bed; a perfect Lambert bed when left out.

    Returns
    -------
    (bins,) float64
        Energy (law `sonar`) or radiance (law `light`) per bin; 0 before the first return.
    """
    diffuse, specular, shininess = (reflectivity or LAMBERT)[:3]
    edges = np.arange(arrays.bins + 1) * arrays.bin_length
    near, far = np.maximum(edges[:-1], altitude), np.maximum(edges[1:], altitude)
    # As a product: the difference of two squares may come out below zero.
    x_near, x_far = (np.sqrt((r - altitude) * (r + altitude)) for r in (near, far))
    heard = far > near
    r = np.where(heard, 0.5 * (near + far), 1.0)
    cos_incidence = altitude / r
    mirrored = np.maximum(2.0 * cos_incidence**2 - 1.0, 0.0) ** shininess
    if arrays.law == LIGHT:
        shade = diffuse * cos_incidence + specular * mirrored
        return np.where(heard, shade * (far - near) / arrays.bin_length, 0.0) * arrays.range_factor
    sigma = cos_incidence**2 * (diffuse / np.pi + specular * (shininess + 2.0) / (2.0 * np.pi) * mirrored)
    x = 0.5 * (x_near + x_far)
    return np.where(heard, sigma * (x_far - x_near) * along_track_width(arrays, x, r), 0.0) * arrays.range_factor


def along_track_width(arrays: SceneArrays, x: NDArray[np.float64], r: NDArray[np.float64]) -> NDArray[np.float64]:
    """Arc of a level bed that the beam takes in at ground range ``x`` and slant range ``r``, in metres.

    A beam is a cone about the track: of a top-hat |sin φ_b| = cos θ |sin φ| stays within sin(half width), so that near
    nadir it takes in all azimuths; a pattern weighs them. A knife is 1 m wide by definition.
    """
    if arrays.half_width <= 0.0:
        return np.ones_like(x)
    if arrays.pattern.tabulated:
        angles = np.empty_like(x)
        ring_responses(arrays.pattern, x, r, angles)
        return x * angles
    reach = np.sin(arrays.half_width) * r / np.maximum(x, 1e-300)
    return 2.0 * x * np.arcsin(np.minimum(reach, 1.0))
