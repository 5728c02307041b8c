"""STL: triangles, in binary or as text."""

import re

import numpy as np

from insonify.arrays import Floats
from insonify.io.file_access import FileFault, open_regular
from insonify.io.formats import FileFormat
from insonify.io.meshes import REMEDY, check_count

HEAD = 84  # bytes before the triangles: a title and their number
TRIANGLE = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
# Lines of text without corners: names of solids, normals, beginnings and ends.
OTHER_LINES = re.compile(rb"(?im)^[ \t]*(?:(?:end)?(?:solid|facet|loop)|outer)\b.*$")


def read_stl(path: str) -> Floats:
    """Corners of all triangles of a file, (n, 3, 3)."""
    with open_regular(path) as file:
        head = file.read(HEAD)
        count, size = int.from_bytes(head[80:], "little"), file.seek(0, 2)
        is_text = head.lstrip()[:5].lower() == b"solid" and size != HEAD + count * TRIANGLE.itemsize
        if is_text:
            file.seek(0)
            return _read_text(file.read())
        held = max(size - HEAD, 0) // TRIANGLE.itemsize
        if count > held:
            raise FileFault(f"announces {count} triangles and holds {held}", REMEDY)
        check_count(count)
        file.seek(HEAD)
        return np.fromfile(file, TRIANGLE, count)["corners"].astype(np.float64)


def _read_text(content: bytes) -> Floats:
    """Corners of the triangles of an STL file in text."""
    lines = OTHER_LINES.sub(b"", content).lower().replace(b"vertex", b" ")
    numbers = np.fromstring(lines, sep=" ")
    if numbers.size != 9 * len(re.findall(rb"(?im)^[ \t]*endfacet", content)):
        raise FileFault("has facets that are not three vertices of three numbers", REMEDY)
    return numbers.reshape(-1, 3, 3)


STL = FileFormat("STL", (".stl",), read_stl, isolated=True, remedy=REMEDY)
