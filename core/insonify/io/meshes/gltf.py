"""glTF 2.0: a scene of nodes that place meshes, as JSON with buffers of numbers, y up."""

import base64
import json
from collections import defaultdict
from functools import cache
from typing import Any
from urllib.parse import unquote

import numpy as np

from insonify.arrays import Floats
from insonify.io.file_access import FileFault, companion, open_regular
from insonify.io.formats import FileFormat
from insonify.io.meshes import REMEDY, check_count

GLB, JSON, BINARY = b"glTF", b"JSON", b"BIN\0"  # names of a binary file and its chunks
COMPONENTS = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT2": 4, "MAT3": 9, "MAT4": 16}
TRIANGLES, STRIP, FAN = 4, 5, 6  # modes of a primitive; lower ones are points and lines
# Beginnings of names of extensions that leave triangles as they are, or that are read here.
READ = (
    "KHR_materials_",
    "KHR_texture_",
    "EXT_texture_",
    "MSFT_texture_",
    "KHR_lights_",
    "EXT_lights_",
    "KHR_mesh_quantization",
)
INSTANCES = "EXT_mesh_gpu_instancing"  # places a mesh many times, also in files that do not require it


def read_gltf(path: str) -> Floats:
    """Corners of all triangles of a scene, (n, 3, 3), rotated from y up to z up."""
    with open_regular(path) as file:
        corners = _Document(path, file.read()).corners()
    return corners[..., [0, 2, 1]] * [1.0, -1.0, 1.0]


class _Document:
    """A glTF document with its buffers."""

    def __init__(self, path: str, content: bytes) -> None:
        self.path, self.binary = path, b""
        if content.startswith(GLB):
            chunks, at = dict[bytes, bytes](), 12
            while at < len(content):
                length = int.from_bytes(content[at : at + 4], "little")
                chunks.setdefault(content[at + 4 : at + 8], content[at + 8 : at + 8 + length])
                at += 8 + length
            content, self.binary = chunks.get(JSON, b""), chunks.get(BINARY, b"")
        try:
            self.document = json.loads(content)
        except ValueError:
            raise FileFault("is not a glTF document (it is not JSON)", REMEDY) from None
        version = str(self.document.get("asset", {}).get("version", "2.0"))
        if not version.startswith("2."):
            raise FileFault(f"is in version {version[:20]} of glTF", "export it as glTF 2.0")
        for name in self.document.get("extensionsRequired", ()):
            if not name.startswith(READ):
                raise _not_read(name)
        self.buffer = cache(self._buffer)

    def corners(self) -> Floats:
        """Corners of the triangles of all meshes where the scene places them."""
        nodes = self.document.get("nodes", [])
        worlds, reached = self._place(nodes)
        users = defaultdict[tuple[Any, ...], list[int]](list)
        for k in reached:
            if INSTANCES in nodes[k].get("extensions", ()):
                raise _not_read(INSTANCES)
            if "mesh" in nodes[k]:
                users[nodes[k]["mesh"], nodes[k].get("skin"), tuple(nodes[k].get("weights", ()))].append(k)
        count, pieces = 0, [np.empty((0, 3, 3))]
        for (mesh, skin, weights), places in users.items():
            given = self._item("meshes", mesh)
            for primitive in given["primitives"]:
                corners = self._read_primitive(primitive, weights or given.get("weights", ()), skin, worlds)
                count += len(corners) * len(places)
                check_count(count)
                # A skin places its mesh by joints alone.
                place = np.eye(4)[None] if skin is not None else worlds[places]
                placed = corners @ place[:, None, :3, :3].swapaxes(2, 3) + place[:, None, None, :3, 3]
                mirrored = np.linalg.det(place[:, :3, :3]) < 0.0
                placed[mirrored] = placed[mirrored][:, :, ::-1]
                pieces.append(placed.reshape(-1, 3, 3))
        return np.concatenate(pieces)

    def _item(self, kind: str, index: Any) -> Any:
        """Return an object of the document by its index."""
        held = self.document.get(kind, [])
        if not isinstance(index, int) or not 0 <= index < len(held):
            raise FileFault(f"refers to number {index!r:.20} of {len(held)} {kind}", REMEDY)
        return held[index]

    def _place(self, nodes: list[Any]) -> tuple[Floats, list[int]]:
        """Return the matrix of each node in the scene, (nodes, 4, 4), and the nodes that belong to the scene."""
        if scenes := self.document.get("scenes"):
            level = list(scenes[self.document.get("scene", 0)].get("nodes", ()))
        else:
            level = sorted({*range(len(nodes))} - {child for node in nodes for child in node.get("children", ())})
        local, reached = _local_matrices(nodes), list[int]()
        seen, parents = set[int](), list[int]()
        while level:
            for k in level:
                self._item("nodes", k)
                if k in seen:
                    raise FileFault("has a node in more than one place", REMEDY)
                seen.add(k)
            reached += level
            if parents:
                local[level] = local[parents] @ local[level]
            pairs = [(k, child) for k in level for child in nodes[k].get("children", ())]
            parents, level = [k for k, _ in pairs], [child for _, child in pairs]
        return local, reached

    def _read_primitive(self, primitive: Any, weights: Any, skin: int | None, worlds: Floats) -> Floats:
        """Corners of the triangles of a part of a mesh, (n, 3, 3), with the weights of its shapes and its skin."""
        mode, attributes = primitive.get("mode", TRIANGLES), primitive["attributes"]
        if mode < TRIANGLES or "POSITION" not in attributes:
            return np.empty((0, 3, 3))
        for name in primitive.get("extensions", ()):
            if not name.startswith(READ) and "bufferView" not in self._item("accessors", attributes["POSITION"]):
                raise _not_read(name)
        points = self._read_numbers(attributes["POSITION"])
        for weight, target in zip(weights, primitive.get("targets", ())):
            points = points + weight * self._read_numbers(target["POSITION"]) if "POSITION" in target else points
        if skin is not None:
            points = self._bend(points, attributes, self._item("skins", skin), worlds)
        order = np.arange(len(points))
        if "indices" in primitive:
            order = self._read_numbers(primitive["indices"])[:, 0].astype(np.int64)
        if mode == TRIANGLES:
            faces = order[: len(order) // 3 * 3].reshape(-1, 3)
        elif mode == STRIP:
            faces = np.stack([order[:-2], order[1:-1], order[2:]], axis=1)
            faces[1::2] = faces[1::2, [0, 2, 1]]
        elif mode == FAN:
            faces = np.stack([np.broadcast_to(order[:1], order[2:].shape), order[1:-1], order[2:]], axis=1)
        else:
            raise FileFault(f"has a mesh of mode {mode!r:.20}", REMEDY)
        if faces.size and faces.max() >= len(points):
            raise FileFault(f"has a face with a vertex that is not among its {len(points)}", REMEDY)
        return points[faces]

    def _bend(self, points: Floats, attributes: Any, skin: Any, worlds: Floats) -> Floats:
        """Return the points of a mesh where the joints of its skin place them."""
        joints = worlds[skin["joints"]]
        if "inverseBindMatrices" in skin:
            joints = joints @ self._read_numbers(skin["inverseBindMatrices"]).reshape(-1, 4, 4).swapaxes(1, 2)
        bent = np.zeros_like(points)
        for name in (name for name in attributes if name.startswith("JOINTS_")):
            of, weights = (self._read_numbers(attributes[each]) for each in (name, name.replace("JOINTS", "WEIGHTS")))
            for joint, weight in zip(of.T.astype(np.int64), weights.T):
                matrix = joints[joint]
                bent += weight[:, None] * ((matrix[:, :3, :3] @ points[..., None])[..., 0] + matrix[:, :3, 3])
        return bent

    def _read_numbers(self, index: Any) -> Floats:
        """Numbers of an accessor, (count, components), as they are meant."""
        given = self._item("accessors", index)
        count, kind, width = int(given["count"]), np.dtype(COMPONENTS[given["componentType"]]), WIDTHS[given["type"]]
        check_count(count // 3)
        numbers = np.zeros((count, width))
        if "bufferView" in given:
            numbers[:] = self._view(given["bufferView"], given.get("byteOffset", 0), kind, count, width)
        if sparse := given.get("sparse"):
            at, values = (
                self._view(part["bufferView"], part.get("byteOffset", 0), of, sparse["count"], components)
                for part, of, components in (
                    (sparse["indices"], np.dtype(COMPONENTS[sparse["indices"]["componentType"]]), 1),
                    (sparse["values"], kind, width),
                )
            )
            numbers[at[:, 0]] = values
        if given.get("normalized") and kind.kind != "f":
            numbers = np.maximum(numbers / np.iinfo(kind).max, -1.0)
        return numbers

    def _view(self, index: Any, offset: int, kind: np.dtype[Any], count: int, width: int) -> Any:
        """Return numbers of a part of a buffer, (count, width)."""
        view = self._item("bufferViews", index)
        stride, start = view.get("byteStride", width * kind.itemsize), view.get("byteOffset", 0) + offset
        content = self.buffer(view["buffer"])
        if count and not 0 <= start <= start + stride * (count - 1) + width * kind.itemsize <= len(content):
            raise FileFault(f"refers to more than the {len(content)} bytes of its buffer", REMEDY)
        return np.ndarray((count, width), kind, content, start, (stride, kind.itemsize))

    def _buffer(self, index: Any) -> bytes:
        """Content of a buffer: of the binary file, of a file beside it, or of its own address."""
        given = self._item("buffers", index)
        uri = given.get("uri")
        if uri is None:
            if index == 0 and self.binary:
                return self.binary
            raise _not_read(next(iter(given.get("extensions", ())), "a buffer without content"))
        if uri.startswith("data:"):
            return base64.b64decode(uri.partition(",")[2])
        found = companion(self.path, uri)
        if not found.exists():
            found = companion(self.path, unquote(uri))  # spaces and other characters are escaped as in an address
        try:
            with open_regular(found) as file:
                return file.read()
        except FileFault as error:
            raise FileFault(f"refers to {uri[:80]!r}, which {error.fault}", "put it beside the mesh") from None


def _local_matrices(nodes: list[Any]) -> Floats:
    """Matrix of each node in its parent, (nodes, 4, 4)."""
    from scipy.spatial.transform import Rotation  # lazy: slow to import, and only glTF needs it

    matrices = np.tile(np.eye(4), (len(nodes), 1, 1))
    if nodes:
        turn = Rotation.from_quat([node.get("rotation", (0.0, 0.0, 0.0, 1.0)) for node in nodes]).as_matrix()
        matrices[:, :3, :3] = turn * np.array([node.get("scale", (1.0, 1.0, 1.0)) for node in nodes])[:, None, :]
        matrices[:, :3, 3] = [node.get("translation", (0.0, 0.0, 0.0)) for node in nodes]
    for k in (k for k, node in enumerate(nodes) if "matrix" in node):
        matrices[k] = np.reshape(nodes[k]["matrix"], (4, 4)).T
    return matrices


def _not_read(name: str) -> FileFault:
    """Return the fault of a file with an extension that changes its triangles and is not read."""
    return FileFault(f"needs {name[:80]}, which is not read here", "export it without compression or extensions")


GLTF = FileFormat("glTF", (".gltf", ".glb"), read_gltf, isolated=True, remedy=REMEDY)
