"""Mesh files that the library trimesh reads: OBJ, STL, PLY, glTF."""

import os
import re
from collections.abc import Iterator, Mapping
from urllib.parse import unquote

import numpy as np

from insonify.arrays import Floats
from insonify.io.file_access import FileFault, companion, open_regular
from insonify.io.formats import FileFormat
from insonify.io.meshes import MOST_TRIANGLES

REMEDY = "export it again as OBJ, STL, PLY or glTF"
HEADER = 2**14  # bytes, which hold the number of triangles of a binary STL, or of a PLY
OTHER_DOCUMENT = "model.gltf"  # which trimesh reads instead of a document that is no JSON


class _Companions(Mapping[str, bytes]):
    """Files that a mesh refers to, such as buffers of glTF, as a mapping for trimesh."""

    def __init__(self, path: str) -> None:
        self.path = path

    def __getitem__(self, name: str) -> bytes:
        if name == OTHER_DOCUMENT:
            raise FileFault("is not a glTF document (it is not JSON)", REMEDY)
        found = companion(self.path, name)
        if not found.exists():
            found = companion(self.path, unquote(name))  # glTF escapes spaces and other characters as in an address
        try:
            with open_regular(found) as file:
                return file.read()
        except FileFault as error:
            raise FileFault(f"refers to {name[:80]!r}, which {error.fault}", "put it beside the mesh") from None

    def __iter__(self) -> Iterator[str]:
        return iter(())

    def __len__(self) -> int:
        return 0


def read_z_up(path: str) -> Floats:
    """Corners of all triangles of a file with z up, (n, 3, 3)."""
    import trimesh  # slow to import, and only meshes need it

    with open_regular(path) as file:
        _check_count(file.read(HEADER), os.path.getsize(path))
        file.seek(0)
        # Textures and merged corners are of no use here.
        kind = path.rpartition(".")[2].lower()
        scene = trimesh.load_scene(file, file_type=kind, resolver=_Companions(path), process=False, skip_materials=True)
    mesh = scene.to_mesh()
    return np.asarray(mesh.vertices, np.float64).reshape(-1, 3)[np.asarray(mesh.faces, np.int64).reshape(-1, 3)]


def _check_count(header: bytes, size: int) -> None:
    """Refuse a file whose header announces too many triangles, before they are read."""
    stl = int.from_bytes(header[80:84], "little")
    ply = re.match(rb"ply\s.*?\selement\s+face\s+(\d{1,18})\s", header, re.DOTALL)
    count = int(ply[1]) if ply else stl if size == 84 + 50 * stl else 0
    if count > MOST_TRIANGLES:
        raise FileFault(f"has {count} triangles", f"thin it to at most {MOST_TRIANGLES}")


def read_y_up(path: str) -> Floats:
    """Corners of all triangles of a file with y up, rotated to z up, (n, 3, 3)."""
    return read_z_up(path)[..., [0, 2, 1]] * [1.0, -1.0, 1.0]


OBJ = FileFormat("OBJ", (".obj",), read_z_up, isolated=True, remedy=REMEDY)
STL = FileFormat("STL", (".stl",), read_z_up, isolated=True, remedy=REMEDY)
PLY = FileFormat("PLY", (".ply",), read_z_up, isolated=True, remedy=REMEDY)
GLTF = FileFormat("glTF", (".gltf", ".glb"), read_y_up, isolated=True, remedy=REMEDY)
