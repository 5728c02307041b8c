"""Meshes: the triangles of a file, checked, wound alike, and outwards where their surface is closed.

A format is one module here that holds a `FileFormat`.
"""

from pathlib import Path

import numpy as np

from insonify.arrays import Booleans, Floats, Integers
from insonify.files import bundled_meshes, kept_until_changed
from insonify.io.file_access import FileFault
from insonify.io.formats import FormatRegistry

__all__ = ["MESHES", "bounds_bodies", "has_area", "read_mesh"]

MESHES: FormatRegistry[Floats] = FormatRegistry(
    "a mesh", "insonify.io.meshes", "insonify.mesh_formats", "{path!r} {fault}; {remedy}"
)
MOST_TRIANGLES = 2_000_000  # more must be decimated first
FARTHEST = 1e15  # units of a file from its origin; squares of squares of it are still numbers
FLAT = 1e-12  # height of a triangle over its longest side, below which its area is rounding error


def read_mesh(path: str) -> Floats:
    """Read the triangles of a file."""
    return _read_triangles(str(bundled_meshes().get(path, Path(path))))


@kept_until_changed(maxsize=8)
def _read_triangles(path: str) -> Floats:
    with MESHES.guarded(path):
        corners = MESHES.read(path, f", or the name of a bundled mesh ({', '.join(bundled_meshes())})")
        if len(corners) > MOST_TRIANGLES:
            raise FileFault(f"has {len(corners)} triangles", f"thin it to at most {MOST_TRIANGLES}")
        if not (np.abs(corners) < FARTHEST).all():
            raise FileFault(f"has corners that are not finite or lie beyond {FARTHEST:g}", "export it again")
        corners = corners[has_area(corners)]
        if not len(corners):
            raise FileFault("holds no triangles", "check that it is whole and holds surfaces")
    return _wind_outwards(corners)


def has_area(corners: Floats) -> Booleans:
    """Whether triangles have an area beyond rounding error."""
    edges = corners - np.roll(corners, 1, axis=1)
    longest_squared = (edges**2).sum(axis=2).max(axis=1)
    area = np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1)
    return np.asarray(area > FLAT * longest_squared)


def _wind_outwards(corners: Floats) -> Floats:
    """Wind neighbouring triangles alike, and closed surfaces counter-clockwise as seen from outside."""
    n, faces = len(corners), _numbered(corners.reshape(-1, 3)).reshape(-1, 3)
    first, second, alike = _neighbours(faces)
    surface = _components(first, second, n)
    # Triangles to reverse are found on the double cover, which holds every triangle once in either winding.
    side = np.where(alike, 0, n)
    cover = _components(np.concatenate([first, first + n]), np.concatenate([second + side, second + n - side]), 2 * n)
    _, leaders = np.unique(surface, return_index=True)
    one_sided = cover[:n] == cover[n:]
    flipped = (cover[:n] != cover[leaders][surface]) & ~one_sided
    wound = np.where(flipped[:, None, None], corners[:, ::-1], corners)
    closed, volume = _measure_surfaces(wound, np.where(flipped[:, None], faces[:, ::-1], faces), surface)
    inside_out = closed & (volume < 0.0)
    return np.where(inside_out[surface][:, None, None], wound[:, ::-1], wound)


def bounds_bodies(corners: Floats) -> bool:
    """Whether triangles, wound outwards, are the whole surface of one body or several."""
    faces = _numbered(corners.reshape(-1, 3)).reshape(-1, 3)
    first, second, _ = _neighbours(faces)
    closed, volume = _measure_surfaces(corners, faces, _components(first, second, len(faces)))
    return bool((closed & (volume > 0.0)).all())


def _measure_surfaces(corners: Floats, faces: Integers, surface: Integers) -> tuple[Booleans, Floats]:
    """Whether each surface runs along every edge as often in one sense as in the other; six times its signed volume."""
    edge, _, forward = _edges(faces)
    of = np.repeat(surface, 3)
    _, place = np.unique(edge * (surface.max() + 1) + of, return_inverse=True)
    closed = np.ones(surface.max() + 1, np.bool_)
    closed[of[np.bincount(place, weights=np.where(forward, 1.0, -1.0))[place] != 0.0]] = False
    # Summed over tetrahedra from the centroid.
    a, b, c = np.moveaxis(corners - corners.mean(axis=(0, 1)), 1, 0)
    volume: Floats = np.bincount(surface, weights=(a * np.cross(b, c)).sum(axis=1)).astype(np.float64)
    return closed, volume


def _numbered(points: Floats) -> Integers:
    """Return the number of each point among the distinct points, from 0."""
    order = np.lexsort(points.T)
    is_new = np.any(np.diff(points[order], axis=0) != 0.0, axis=1)
    number = np.empty(len(points), dtype=np.int64)
    number[order] = np.concatenate([[0], np.cumsum(is_new)])
    return number


def _neighbours(faces: Integers) -> tuple[Integers, Integers, Booleans]:
    """Pairs of triangles with an edge that no third one shares, and whether they run along it in opposite senses."""
    edge, times, forward = _edges(faces)
    order = np.argsort(edge, kind="stable")
    pairs = order[times[edge[order]] == 2].reshape(-1, 2)
    return pairs[:, 0] // 3, pairs[:, 1] // 3, forward[pairs[:, 0]] != forward[pairs[:, 1]]


def _edges(faces: Integers) -> tuple[Integers, Integers, Booleans]:
    """Return the edge that begins at each corner, how often each edge occurs, and in which sense it runs there."""
    begin, end = faces.ravel(), np.roll(faces, -1, axis=1).ravel()
    edge = np.minimum(begin, end) * (faces.max() + 1) + np.maximum(begin, end)
    _, edge, times = np.unique(edge, return_inverse=True, return_counts=True)
    return edge, times, begin < end


def _components(first: Integers, second: Integers, n: int) -> Integers:
    """Find the connected component of each of n nodes with links between pairs."""
    # lazy: SciPy's sparse graphs, which only meshes need
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    links = coo_array((np.ones(first.size, np.int8), (first, second)), shape=(n, n))
    return np.asarray(connected_components(links, directed=False)[1], dtype=np.int64)
