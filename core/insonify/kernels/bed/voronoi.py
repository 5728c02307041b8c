"""Voronoi patches of a bed: the hashed seed point nearest to each place."""

import math

import numpy as np

from insonify.compiler.jit import kernel
from insonify.kernels.common.hashing import hash_integers, hash_uniform

# A square of the lattice holds one point anywhere in it, so that the nearest lies at most two squares away.
REACH = 2
ACROSS, ALONG, KIND = 0, 1, 2


@kernel
def _distance_to_square(place, square):
    """Distance along one axis from a place to a unit square, 0 inside."""
    return max(square - place, place - square - 1.0, 0.0)


@kernel
def nearest_seed_hash(seed, stream, u, v, repeat):
    """Hash of the seed point nearest to a place."""
    column, row = math.floor(u), math.floor(v)
    nearest, owner_a, owner_b = np.inf, column, row
    for step_v in range(2 * REACH + 1):
        # From the place's own square outwards, 0, 1, −1, 2, −2, so that most squares are skipped.
        j = row + (step_v + 1) // 2 * (1 - 2 * (step_v % 2))
        for step_u in range(2 * REACH + 1):
            i = column + (step_u + 1) // 2 * (1 - 2 * (step_u % 2))
            if _distance_to_square(u, i) ** 2 + _distance_to_square(v, j) ** 2 >= nearest:
                continue
            a, b = (i % repeat, j % repeat) if repeat > 0 else (i, j)
            du = i + hash_uniform(seed, stream, a, b, ACROSS) - u
            dv = j + hash_uniform(seed, stream, a, b, ALONG) - v
            distance = du * du + dv * dv
            if distance < nearest:
                nearest, owner_a, owner_b = distance, a, b
    return hash_integers(seed, stream, owner_a, owner_b, np.int64(KIND))


@kernel
def voronoi_materials(seed, stream, u, v, repeat, count):
    """Map of Voronoi patches, each of one material.

    Parameters
    ----------
    seed, stream : int
        What the patches derive from.
    u, v : ndarray of float64
        Places along both axes, in squares of a lattice that hold one seed point each.
    repeat : int
        Squares after which the lattice repeats; 0 if it never does.
    count : int
        Materials.

    Returns
    -------
    ndarray of uint8, shape (v.size, u.size)
        Index of the material.
    """
    indices = np.empty((v.size, u.size), dtype=np.uint8)
    for j in range(v.size):
        for i in range(u.size):
            indices[j, i] = nearest_seed_hash(seed, stream, u[i], v[j], repeat) % np.uint64(count)
    return indices
