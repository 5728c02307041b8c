"""Analytic bodies cut into flat triangles, for engines that know nothing else."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from insonify.kernels.common.types import SPHERE, Solids

# Chords of a circle of radius R then lie up to 3e-4 R beneath it, and their normals are up to 1.4 degrees off.
FACETS_AROUND = 128
# An icosahedron divided five times has edges of up to 2.3 degrees: 20,480 triangles, as fine as those chords.
DIVISIONS_OF_SPHERE = 5


def tessellate_solids(solids: Solids) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Triangles inscribed in spheres, cylinders and cones."""
    parts = [np.empty((0, 3, 3)), *_each_body(solids)]
    body = np.repeat(np.arange(-1, len(parts) - 1), [len(part) for part in parts])
    return np.concatenate(parts), body


def _each_body(solids: Solids) -> Iterator[NDArray[np.float64]]:
    """Triangles of every body, (m, 3, 3) each."""
    import trimesh.creation  # slow to import, and needed only with Embree

    ball = trimesh.creation.icosphere(subdivisions=DIVISIONS_OF_SPHERE).triangles
    for k, start in enumerate(solids.start):
        radius = float(solids.radius[k])
        if solids.shape[k] == SPHERE:
            yield start + radius * ball
            continue
        length = float(solids.length[k])
        outline = np.array([[0.0, 0.0], [radius, 0.0], [radius + solids.taper[k] * length, length], [0.0, length]])
        turn = trimesh.geometry.align_vectors([0.0, 0.0, 1.0], solids.axis[k])[:3, :3]  # type: ignore[no-untyped-call]
        yield start + trimesh.creation.revolve(outline, sections=FACETS_AROUND).triangles @ turn.T
