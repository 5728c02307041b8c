"""Wavefront OBJ: faces of vertices, in plain text."""

from array import array

import numpy as np

from insonify.arrays import Floats
from insonify.io.file_access import FileFault, open_regular
from insonify.io.formats import FileFormat
from insonify.io.meshes import REMEDY
from insonify.io.meshes.polygons import triangulate

CURVED = (b"surf", b"curv", b"curv2")  # free-form surfaces, which have no faces


def read_obj(path: str) -> Floats:
    """Corners of all triangles of a file, (n, 3, 3)."""
    with open_regular(path) as file:
        content = file.read().replace(b"\\\r\n", b" ").replace(b"\\\n", b" ")
    vertices, corners, lengths = array("d"), array("q"), array("q")
    for line in content.splitlines():
        word, *rest = line.split(b"#", 1)[0].split() or (b"",)
        if word == b"v":
            vertices.extend(map(float, rest[:3]))
        elif word in (b"f", b"fo"):
            given = [int(corner.split(b"/", 1)[0]) for corner in rest]
            # Vertices count from 1, or backwards from the last one before the face.
            corners.extend(k - 1 if k > 0 else len(vertices) // 3 + k if k < 0 else -1 for k in given)
            lengths.append(len(given))
        elif word in CURVED:
            raise FileFault("holds free-form surfaces", "export its surfaces as faces")
    points = np.frombuffer(vertices) if len(vertices) else np.empty(0)
    return triangulate(points.reshape(-1, 3), np.array(corners, np.int64), np.array(lengths, np.int64))


OBJ = FileFormat("OBJ", (".obj",), read_obj, isolated=True, remedy=REMEDY)
