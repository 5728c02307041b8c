"""Shapes in files of triangles: OBJ, STL, PLY, glTF."""

from __future__ import annotations

import logging
from functools import lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from insonify.errors import SceneError
from insonify.files import bundled_meshes

Y_UP = (".gltf", ".glb")
FORMATS = (".obj", ".stl", ".ply", *Y_UP)
MOST = 2_000_000  # triangles; a larger file was surely meant to be thinned
FARTHEST = 1e15  # units of a file from its origin; squares of squares of it are still numbers
FLAT = 1e-12  # a triangle's height over its longest side, below which it has no area worth a name


def read_mesh(path: str) -> NDArray[np.float64]:
    """Read the triangles of a file.

    Parameters
    ----------
    path : str
        OBJ, STL, PLY, glTF or GLB file, or the name of a bundled mesh.

    Returns
    -------
    (n, 3, 3) float64
        Corners in the file's units, z up, at least one triangle and none without area; shared with later calls, so
        not to be written to. Neighbours wind alike, and closed surfaces counter-clockwise as seen from outside.

    Raises
    ------
    SceneError
        One sentence with what is wrong with the file and the remedy.
    """
    file = bundled_meshes().get(path, Path(path))
    if file.suffix.lower() not in FORMATS:
        known = ", ".join(FORMATS)
        raise _refusal(path, "is not a format known here", f"give a file that ends in {known}, or {_names()}")
    if not file.is_file():
        raise _refusal(path, "does not exist", f"give the path of a mesh, or {_names()}")
    status = file.stat()
    return _kept(path, file, (status.st_mtime_ns, status.st_size))


@lru_cache(maxsize=8)
def _kept(path: str, file: Path, version: tuple[int, int]) -> NDArray[np.float64]:
    del version  # part of the key alone: a file written anew is read anew
    corners = _triangles(path, file)
    if len(corners) > MOST:
        raise _refusal(path, f"has {len(corners)} triangles", f"thin it to at most {MOST}")
    if not (np.abs(corners) < FARTHEST).all():
        raise _refusal(path, f"has corners that are not finite or lie beyond {FARTHEST:g}", "export it again")
    corners = corners[_has_area(corners)]
    if not len(corners):
        raise _refusal(path, "holds no triangles", "check that it is whole and holds surfaces")
    from insonify.io.meshes.orient import outward  # with SciPy's sparse graphs, which only scenes with meshes pay for

    return outward(corners)


def _triangles(path: str, file: Path) -> NDArray[np.float64]:
    """Flatten whatever scene a file holds."""
    import trimesh  # half a second, likewise

    logger = logging.getLogger("trimesh")
    was, logger.disabled = logger.disabled, True
    try:
        # Textures and merged corners are of no use here.
        mesh = trimesh.load_scene(file, process=False, skip_materials=True).to_mesh()
        corners = np.asarray(mesh.vertices, np.float64).reshape(-1, 3)[np.asarray(mesh.faces, np.int64).reshape(-1, 3)]
    except Exception as error:  # every format's reader fails in ways of its own
        reason = " ".join(str(error).split())[:100] or type(error).__name__
        raise _refusal(path, f"cannot be read ({reason})", "export it again as OBJ, STL, PLY or glTF") from None
    finally:
        logger.disabled = was
    return corners[..., [0, 2, 1]] * [1.0, -1.0, 1.0] if file.suffix.lower() in Y_UP else corners


def _has_area(corners: NDArray[np.float64]) -> NDArray[np.bool_]:
    edges = corners - np.roll(corners, 1, axis=1)
    longest_squared = (edges**2).sum(axis=2).max(axis=1)
    area = np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1)
    return np.asarray(area > FLAT * longest_squared)


def _names() -> str:
    return f"the name of a bundled one ({', '.join(bundled_meshes())})"


def _refusal(path: str, fault: str, remedy: str) -> SceneError:
    return SceneError(f"{path!r} {fault}; {remedy}")
