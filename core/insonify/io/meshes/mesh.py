"""Meshes: the triangles of a file, checked and wound outwards."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from insonify.files import bundled_meshes, kept_until_changed
from insonify.io.formats import FormatRegistry
from insonify.io.meshes.trimesh_files import MOST_TRIANGLES

MESHES: FormatRegistry[NDArray[np.float64]] = FormatRegistry(
    "a mesh", "insonify.io.meshes", "insonify.mesh_formats", "{path!r} {fault}; {remedy}"
)
FARTHEST = 1e15  # units of a file from its origin; squares of squares of it are still numbers
FLAT = 1e-12  # height of a triangle over its longest side, below which its area is rounding error


def read_mesh(path: str) -> NDArray[np.float64]:
    """Read the triangles of a file."""
    return _read_triangles(str(bundled_meshes().get(path, Path(path))))


@kept_until_changed(maxsize=8)
def _read_triangles(path: str) -> NDArray[np.float64]:
    corners = MESHES.read(path, f", or the name of a bundled mesh ({', '.join(bundled_meshes())})")
    if len(corners) > MOST_TRIANGLES:
        raise MESHES.refusal(path, f"has {len(corners)} triangles", f"thin it to at most {MOST_TRIANGLES}")
    if not (np.abs(corners) < FARTHEST).all():
        raise MESHES.refusal(path, f"has corners that are not finite or lie beyond {FARTHEST:g}", "export it again")
    corners = corners[has_area(corners)]
    if not len(corners):
        raise MESHES.refusal(path, "holds no triangles", "check that it is whole and holds surfaces")
    # lazy: SciPy's sparse graphs, which only meshes need
    from insonify.io.meshes.winding import wind_outwards

    return wind_outwards(corners)


def has_area(corners: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Whether triangles have an area beyond rounding error."""
    edges = corners - np.roll(corners, 1, axis=1)
    longest_squared = (edges**2).sum(axis=2).max(axis=1)
    area = np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1)
    return np.asarray(area > FLAT * longest_squared)
