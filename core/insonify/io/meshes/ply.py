"""PLY, the Stanford triangle format: elements of scalars and lists, in binary or as text."""

import struct
from array import array
from typing import Any, NamedTuple

import numpy as np

from insonify.arrays import Floats, Integers
from insonify.io.file_access import FileFault, open_regular
from insonify.io.formats import FileFormat
from insonify.io.meshes import REMEDY, check_count
from insonify.io.meshes.polygons import triangulate

TYPES = {
    "char": "b", "uchar": "B", "short": "h", "ushort": "H", "int": "i", "uint": "I", "float": "f", "double": "d",
    "int8": "b", "uint8": "B", "int16": "h", "uint16": "H", "int32": "i", "uint32": "I", "float32": "f",
    "float64": "d", "int64": "q", "uint64": "Q",
}  # fmt: skip
ORDERS = {"binary_little_endian": "<", "binary_big_endian": ">", "ascii": "="}
CORNERS = ("vertex_indices", "vertex_index")  # names of the list of a face's vertices
HEADER = 2**16  # bytes


class _Property(NamedTuple):
    name: str
    of: str  # type of its value, or of the values of its list, as of `struct` and NumPy
    length: str  # type of the length of its list; empty: a scalar


class _Element(NamedTuple):
    name: str
    rows: int
    properties: list[_Property]


def read_ply(path: str) -> Floats:
    """Corners of all triangles of a file, (n, 3, 3)."""
    with open_regular(path) as file:
        order, elements = _read_header(file)
        content = file.read()
    if order == ORDERS["ascii"]:  # numbers one after another, as in binary: doubles throughout
        content = np.fromstring(content, sep=" ").tobytes()
    points, indices, lengths = np.empty((0, 3)), np.empty(0, np.int64), np.empty(0, np.int64)
    at = 0
    for element in elements:
        if any(each.length for each in element.properties):
            lists, at = _read_lists(element, content, at)
            if element.name == "face" and (found := next((lists[name] for name in CORNERS if name in lists), None)):
                indices, lengths = found
            elif element.name == "tristrips" and element.rows:
                raise FileFault("holds strips of triangles", "export it with faces")
        elif element.properties and element.rows:
            row = np.dtype([(each.name, each.of) for each in element.properties])
            _check_end(element, at + element.rows * row.itemsize, content)
            rows = np.frombuffer(content, row, element.rows, at)
            at += rows.nbytes
            if element.name == "vertex":
                points = np.stack([rows[axis] for axis in "xyz"], axis=1).astype(np.float64)
    return triangulate(points, indices, lengths)


def _read_header(file: Any) -> tuple[str, list[_Element]]:
    """Return the order of bytes and the elements of a file, which is left at its first element."""
    order, elements = "", list[_Element]()
    if file.readline(HEADER).strip() != b"ply":
        raise FileFault("is not a PLY file", REMEDY)
    while file.tell() < HEADER and (line := file.readline(HEADER)):
        match line.decode("latin-1").split():
            case ["format", form, *_] if form in ORDERS:
                order = ORDERS[form]
            case ["element", name, count]:
                check_count(int(count) if name == "face" else 0)
                elements.append(_Element(name, int(count), []))
            case ["property", "list", length, of, name]:
                elements[-1].properties.append(_Property(name, _code(order, of), _code(order, length)))
            case ["property", of, name]:
                elements[-1].properties.append(_Property(name, _code(order, of), ""))
            case ["end_header"] if order:
                return order, elements
            case ["comment" | "obj_info", *_] | []:
                pass
            case words:
                raise FileFault(f"has the line {' '.join(words)[:40]!r} in its header", REMEDY)
    raise FileFault("has a header without an end", REMEDY)


def _code(order: str, name: str) -> str:
    """Return the type of a property as `struct` and NumPy name it; numbers in text are doubles."""
    return order + ("d" if order == ORDERS["ascii"] else TYPES[name])


def _read_lists(element: _Element, content: bytes, at: int) -> tuple[dict[str, tuple[Integers, Integers]], int]:
    """Return the values of each list of an element, one after another, with their lengths, and where it ends."""
    if (alike := _read_equal_lists(element, content, at)) is not None:
        return alike
    found = {each.name: (array("q"), array("q")) for each in element.properties if each.length}
    try:
        for _ in range(element.rows):
            for name, of, length in element.properties:
                if length:
                    count = int(struct.unpack_from(length, content, at)[0])
                    at += struct.calcsize(length)
                    values, lengths = found[name]
                    if name in CORNERS:
                        values.extend(map(int, struct.unpack_from(f"{of[0]}{count}{of[1]}", content, at)))
                    lengths.append(count)
                    at += count * struct.calcsize(of)
                else:
                    at += struct.calcsize(of)
    except struct.error:
        _check_end(element, len(content) + 1, content)
    return {
        name: (np.array(values, np.int64), np.array(counts, np.int64)) for name, (values, counts) in found.items()
    }, at


def _read_equal_lists(
    element: _Element, content: bytes, at: int
) -> tuple[dict[str, tuple[Integers, Integers]], int] | None:
    """Read lists that have the same length in each row; None where they have not."""
    fields, place, counts = list[Any](), at, dict[str, int]()
    for name, of, length in element.properties:
        if length:
            if place + struct.calcsize(length) > len(content):
                return None
            counts[name] = int(struct.unpack_from(length, content, place)[0])
            fields += [(f"{name} length", length), (name, of, (max(counts[name], 0),))]
            place += struct.calcsize(length) + counts[name] * struct.calcsize(of)
        else:
            fields.append((name, of))
            place += struct.calcsize(of)
    row = np.dtype(fields)
    if at + element.rows * row.itemsize > len(content):
        return None
    rows = np.frombuffer(content, row, element.rows, at)
    if not all((rows[f"{name} length"] == count).all() for name, count in counts.items()):
        return None
    return {
        name: (rows[name].astype(np.int64).ravel(), np.full(element.rows, count, np.int64))
        for name, count in counts.items()
    }, at + rows.nbytes


def _check_end(element: _Element, end: int, content: bytes) -> None:
    """Raise FileFault for a file that ends before an element does."""
    if end > len(content):
        raise FileFault(f"announces {element.rows} of the element {element.name!r} and holds fewer", REMEDY)


PLY = FileFormat("PLY", (".ply",), read_ply, isolated=True, remedy=REMEDY)
