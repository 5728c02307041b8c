"""The sea surface as a mirror of many facets: how high and how steep the wind's waves are, and what that does to sound.

At sonar frequencies a rough surface keeps next to nothing of the coherent mirror image, exp(−4k²h² sin²θ) of its energy
for an rms height h; facets of all heights and tilts take the image's place, and what they mirror is the same energy.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray
from scipy import special

from insonify.kernels.common.types import SurfaceMultipath, no_surface_multipath
from insonify.scene.surfaces import SurfaceKind

STRATA = 8  # of tilts, each met by two of heights


def make_ghosts(surface: SurfaceKind) -> SurfaceMultipath:
    """Turn a declared surface into what kernels see of it.

    Parameters
    ----------
    surface : SurfaceKind

    Returns
    -------
    Ghosts
        A flat surface has one facet; that of a sea is met by sixteen.
    """
    paths = surface.paths
    if not any(paths):
        return no_surface_multipath()
    if surface.rms_height == 0.0:
        return SurfaceMultipath(True, *paths, 0.0, 0.0, np.zeros((2, 1, 4)))
    return SurfaceMultipath(True, *paths, surface.rms_height, surface.slope_variance, facets())


def facets() -> NDArray[np.float64]:
    """Facets that stand for a sea, all of the same share of it.

    Returns
    -------
    (2, 16, 4) float64
        For sound that passes the surface once and twice: from and to which height, in rms heights, and from and to
        which squared tilt, in variances of the slope, a facet reaches. Heights are Gaussian, of mean 0 and variance 1.
        The square of one Gaussian tilt, or the mean of two squares, has mean 1. To every stratum of tilts belong a
        high facet and one as low, so that the two are uncorrelated.
    """
    heights = _heights(2 * STRATA)
    ranks = 7 * (np.arange(STRATA) + 1) % (STRATA + 1) - 1
    rows = []
    for passes in (1, 2):
        tilts = _squared_tilts(0.5 * passes)
        low, high = heights[ranks], heights[2 * STRATA - 1 - ranks]
        rows.append(np.concatenate([np.hstack([low, tilts]), np.hstack([high, tilts])]))
    return np.stack(rows)


def _heights(strata: int) -> NDArray[np.float64]:
    """Find the ends of equally likely strata of a Gaussian, (strata, 2), of mean 0 and variance 1 if spread evenly."""
    inner = special.ndtri(np.arange(1, strata) / strata)
    outer = 2.0 * strata * math.exp(-0.5 * inner[-1] ** 2) / math.sqrt(2.0 * math.pi) - inner[-1]
    ends = np.column_stack([np.concatenate([[-outer], inner]), np.concatenate([inner, [outer]])])
    return np.asarray(ends / math.sqrt((ends**2).sum() / 3.0 / strata + ends.prod(axis=1).sum() / 3.0 / strata))


def _squared_tilts(shape: float) -> NDArray[np.float64]:
    """Find the ends of strata of a gamma distribution, likewise, (strata, 2), of mean 1 if spread evenly."""
    inner = special.gammaincinv(shape, np.arange(1, STRATA) / STRATA) / shape
    beyond = special.gammaincc(shape + 1.0, shape * inner[-1]) * STRATA  # mean of the last stratum
    ends = np.column_stack([np.concatenate([[0.0], inner]), np.concatenate([inner, [2.0 * beyond - inner[-1]]])])
    return np.asarray(ends / ends.mean())
