"""Patches of a bed: which hashed seed point a place lies nearest to."""

from __future__ import annotations

import math

import numpy as np

from insonify.kernels.hashing import hash_integers, hash_uniform
from insonify.kernels.jit import kernel

# A square of the lattice holds one point anywhere in it, so that the nearest lies at most two squares away.
REACH = 2
ACROSS, ALONG, KIND = 0, 1, 2


@kernel
def nearest_patch(seed, stream, u, v, repeat):
    """Hash of the seed point nearest to (u, v), in lattice squares; the lattice repeats after ``repeat`` (0: never)."""
    column, row = math.floor(u), math.floor(v)
    nearest, owner = np.inf, np.uint64(0)
    for j in range(row - REACH, row + REACH + 1):
        for i in range(column - REACH, column + REACH + 1):
            a, b = (i % repeat, j % repeat) if repeat > 0 else (i, j)
            du = i + hash_uniform(seed, stream, a, b, ACROSS) - u
            dv = j + hash_uniform(seed, stream, a, b, ALONG) - v
            distance = du * du + dv * dv
            if distance < nearest:
                nearest, owner = distance, hash_integers(seed, stream, a, b, KIND)
    return owner


@kernel
def patch_map(seed, stream, u, v, repeat, count):
    """Index map (v.size, u.size) uint8 of patches that each take one of ``count`` materials."""
    indices = np.empty((v.size, u.size), dtype=np.uint8)
    for j in range(v.size):
        for i in range(u.size):
            indices[j, i] = nearest_patch(seed, stream, u[i], v[j], repeat) % np.uint64(count)
    return indices
