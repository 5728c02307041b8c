"""The sea surface as a mirror of facets, with the heights and tilts of wind waves.

At sonar frequencies a rough surface of rms height h keeps exp(−4k²h² sin²θ) of the energy of the coherent mirror image
(Eckart 1953), which is next to nothing. Facets of all heights and tilts reflect the rest.
"""

import math
from typing import Any

import numpy as np

from insonify.arrays import Floats
from insonify.kernels.common.types import SurfaceMultipath, no_surface_multipath
from insonify.scene.water.surfaces import WAYS, SurfaceKind

STRATA = 8  # of tilts, each combined with two of heights


def make_surface_multipath(surface: SurfaceKind) -> SurfaceMultipath:
    """Paths by the sea surface and its facets, packed for the kernels."""
    switched: dict[str, Any] = dict(zip(WAYS, surface.paths))
    calm = no_surface_multipath()._replace(enabled=any(surface.paths), **switched)
    if not calm.enabled or surface.rms_height == 0.0:
        return calm
    return calm._replace(rms_height=surface.rms_height, slope_variance=surface.slope_variance, facets=facets())


def facets() -> Floats:
    """Equally likely facets that represent a rough sea surface."""
    heights = _heights(2 * STRATA)
    ranks = 7 * (np.arange(STRATA) + 1) % (STRATA + 1) - 1
    rows = []
    for passes in (1, 2):
        tilts = _squared_tilts(0.5 * passes)
        low, high = heights[ranks], heights[2 * STRATA - 1 - ranks]
        rows.append(np.concatenate([np.hstack([low, tilts]), np.hstack([high, tilts])]))
    return np.stack(rows)


def _heights(strata: int) -> Floats:
    """Return the ends of equally likely strata of a Gaussian, (strata, 2); uniform within them, its variance is 1."""
    from scipy import special  # lazy: takes longer to import than a preview takes to trace

    inner = special.ndtri(np.arange(1, strata) / strata)
    outer = 2.0 * strata * math.exp(-0.5 * inner[-1] ** 2) / math.sqrt(2.0 * math.pi) - inner[-1]
    ends = np.column_stack([np.concatenate([[-outer], inner]), np.concatenate([inner, [outer]])])
    return np.asarray(ends / math.sqrt((ends**2).sum() / 3.0 / strata + ends.prod(axis=1).sum() / 3.0 / strata))


def _squared_tilts(shape: float) -> Floats:
    """Return the ends of equally likely strata of a gamma distribution, (strata, 2); uniform within, its mean is 1."""
    from scipy import special  # lazy, as above

    inner = special.gammaincinv(shape, np.arange(1, STRATA) / STRATA) / shape
    beyond = special.gammaincc(shape + 1.0, shape * inner[-1]) * STRATA  # mean of the last stratum
    ends = np.column_stack([np.concatenate([[0.0], inner]), np.concatenate([inner, [2.0 * beyond - inner[-1]]])])
    return np.asarray(ends / ends.mean())
