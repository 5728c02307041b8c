"""Mesh files that the library trimesh reads: OBJ, STL, PLY, glTF."""

from __future__ import annotations

import logging

import numpy as np
from numpy.typing import NDArray

from insonify.io.formats import FileFormat
from insonify.io.meshes.mesh import MESHES


def read_z_up(path: str) -> NDArray[np.float64]:
    """Corners of all triangles of a file whose z points up, (n, 3, 3)."""
    import trimesh  # half a second, which only scenes with meshes pay for

    logger = logging.getLogger("trimesh")
    was, logger.disabled = logger.disabled, True
    try:
        # Textures and merged corners are of no use here.
        mesh = trimesh.load_scene(path, process=False, skip_materials=True).to_mesh()
        return np.asarray(mesh.vertices, np.float64).reshape(-1, 3)[np.asarray(mesh.faces, np.int64).reshape(-1, 3)]
    except Exception as error:  # every format's reader fails in ways of its own
        raise MESHES.unreadable(path, error, "export it again as OBJ, STL, PLY or glTF") from None
    finally:
        logger.disabled = was


def read_y_up(path: str) -> NDArray[np.float64]:
    """Corners of all triangles of a file whose y points up, turned so that z does, (n, 3, 3)."""
    return read_z_up(path)[..., [0, 2, 1]] * [1.0, -1.0, 1.0]


OBJ = FileFormat("OBJ", (".obj",), read_z_up)
STL = FileFormat("STL", (".stl",), read_z_up)
PLY = FileFormat("PLY", (".ply",), read_z_up)
GLTF = FileFormat("glTF", (".gltf", ".glb"), read_y_up)
