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
REMEDY = "export it again as OBJ, STL, PLY or glTF"
MOST_TRIANGLES = 2_000_000  # more must be decimated first
FARTHEST_CORNER = 1e15  # units of a file from its origin; squares of squares of it are still numbers
FLAT = 1e-12  # height of a triangle over its longest side, below which its area is rounding error


def read_mesh(path: str) -> Floats:
    """Read the triangles of a file."""
    return _read_triangles(str(bundled_meshes().get(path, Path(path))))[0]


def bounds_bodies(path: str) -> bool:
    """Whether the triangles of a file are the whole surface of one body or several."""
    return _read_triangles(str(bundled_meshes().get(path, Path(path))))[1]


@kept_until_changed(maxsize=8)
def _read_triangles(path: str) -> tuple[Floats, bool]:
    with MESHES.guarded(path):
        corners = MESHES.read(path, f", or the name of a bundled mesh ({', '.join(bundled_meshes())})")
        check_count(len(corners))
        if not (np.abs(corners) < FARTHEST_CORNER).all():
            raise FileFault(f"has corners that are not finite or lie beyond {FARTHEST_CORNER:g}", "export it again")
        whole = has_area(corners)
        if not whole.any():
            raise FileFault("holds no triangles", "check that it is whole and holds surfaces")
    wound, closed = _wind_outwards(corners[whole])
    if not closed and not whole.all():
        # Triangles without area may close a surface: those that join an edge to several along it.
        other, closed = _wind_outwards(corners)
        wound = other[has_area(other)] if closed else wound
    return wound, closed


def check_count(count: int) -> None:
    """Raise FileFault for too many triangles, which readers check before they read them."""
    if count > MOST_TRIANGLES:
        raise FileFault(f"has {count} triangles", f"thin it to at most {MOST_TRIANGLES}")


def has_area(corners: Floats) -> Booleans:
    """Whether triangles have an area beyond rounding error."""
    edges = corners - np.roll(corners, 1, axis=1)
    longest_squared = (edges**2).sum(axis=2).max(axis=1)
    area = np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1)
    return np.asarray(area > FLAT * longest_squared)


def _wind_outwards(corners: Floats) -> tuple[Floats, bool]:
    """Wind neighbouring triangles alike, and closed surfaces counter-clockwise as seen from outside.

    Return also whether all surfaces are closed and hold a volume.
    """
    faces = _numbered(corners.reshape(-1, 3)).reshape(-1, 3)
    distinct = (faces != np.roll(faces, 1, axis=1)).all(axis=1)
    corners, faces, n = corners[distinct], faces[distinct], int(distinct.sum())
    begin, end = faces.ravel(), np.roll(faces, -1, axis=1).ravel()
    forward = begin < end
    # An edge begins at each corner; equal edges come together.
    edge = np.minimum(begin, end) * (faces.max() + 1) + np.maximum(begin, end)
    order = np.argsort(edge, kind="stable")
    starts = np.flatnonzero(np.diff(edge[order], prepend=-1))
    times = np.diff(starts, append=order.size)
    pairs = order[starts[times == 2, None] + [0, 1]]  # edges that no third triangle shares
    first, second = np.ascontiguousarray(pairs.T) // 3
    surface = _components(first, second, n)
    # Triangles to reverse are found on the double cover, which holds every triangle once in either winding.
    side = np.where(forward[pairs[:, 0]] != forward[pairs[:, 1]], 0, n)
    cover = _components(np.concatenate([first, first + n]), np.concatenate([second + side, second + n - side]), 2 * n)
    _, leaders = np.unique(surface, return_index=True)
    one_sided = cover[:n] == cover[n:]
    flipped = (cover[:n] != cover[leaders][surface]) & ~one_sided
    wound = np.where(flipped[:, None, None], corners[:, ::-1], corners)
    # A closed surface runs along every edge as often in one sense as in the other.
    sense = np.where(forward ^ np.repeat(flipped, 3), 1.0, -1.0)
    closed = np.ones(leaders.size, np.bool_)
    closed[surface[first[sense[pairs].sum(axis=1) != 0.0]]] = False
    others = order[np.repeat(times != 2, times)]
    of = surface[others // 3]
    _, place = np.unique(np.stack([edge[others], of]), axis=1, return_inverse=True)
    closed[of[np.bincount(place.ravel(), weights=sense[others])[place.ravel()] != 0.0]] = False
    # Six times the signed volume, summed over tetrahedra from the centroid.
    a, b, c = np.moveaxis(wound - wound.mean(axis=(0, 1)), 1, 0)
    volume = np.bincount(surface, weights=(a * np.cross(b, c)).sum(axis=1))
    inside_out = closed & (volume < 0.0)
    outwards = np.where(inside_out[surface][:, None, None], wound[:, ::-1], wound)
    return outwards, bool((closed & (volume != 0.0)).all())


def _numbered(points: Floats) -> Integers:
    """Return the number of each point among the distinct points, from 0."""
    order = np.lexsort(points.T)
    is_new = np.any(np.diff(points[order], axis=0) != 0.0, axis=1)
    number = np.empty(len(points), dtype=np.int64)
    number[order] = np.concatenate([[0], np.cumsum(is_new)])
    return number


def _components(first: Integers, second: Integers, n: int) -> Integers:
    """Find the connected component of each of n nodes with links between pairs."""
    # lazy: SciPy's sparse graphs, which only meshes need
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    links = coo_array((np.ones(first.size, np.int8), (first, second)), shape=(n, n))
    return np.asarray(connected_components(links, directed=False)[1], dtype=np.int64)
