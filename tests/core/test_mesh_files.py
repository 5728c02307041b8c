"""Meshes in files: every format gives the same triangles, and what is wrong is told in one sentence."""

import base64
import json
import os
import struct

import numpy as np
import pytest
import trimesh

from insonify.io.file_access import FileFault
from insonify.io.meshes import MESHES, bounds_bodies, read_mesh
from insonify.kernels.geometry.bvh import build_mesh
from insonify.scene import SceneError, bundled_meshes, load_scene
from insonify.scene.targets.shape import block
from insonify.simulation import prepare

FORMATS = ["obj", "stl", "ply", "glb", "gltf"]


def shape() -> trimesh.Trimesh:
    """Something lopsided, exact in float32."""
    vertices = [[0, 0, 0], [3, 0, 0], [0, 2, 0], [0, 0, 1], [3, 2, 0.5]]
    return trimesh.Trimesh(vertices, [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 4], [2, 3, 4], [3, 1, 4]], process=False)


def write(folder, suffix: str, mesh: trimesh.Trimesh):
    """Write a mesh as trimesh does; glTF with y up."""
    path = folder / f"shape.{suffix}"
    if suffix in ("glb", "gltf"):
        mesh = trimesh.Trimesh(mesh.vertices[:, [0, 2, 1]] * [1, 1, -1], mesh.faces, process=False)
    if suffix == "gltf":
        for name, content in trimesh.Scene(mesh).export(file_type="gltf").items():
            (folder / name).write_bytes(content)
        (folder / "model.gltf").rename(path)
    else:
        mesh.export(path)
    return path


def as_rows(corners: np.ndarray) -> np.ndarray:
    """Triangles in an order of their own, each from its least corner on, its sense kept."""
    turns = np.stack([np.roll(corners, k, axis=1).reshape(-1, 9) for k in range(3)], axis=1)
    first = np.array([min(range(3), key=lambda k: tuple(turn[k])) for turn in turns])
    rows = turns[np.arange(len(turns)), first]
    return rows[np.lexsort(rows.T)]


def test_a_scene_is_flattened_with_its_transforms(tmp_path):
    scene = trimesh.Scene()
    for k in range(3):
        move = np.eye(4)
        move[:3, 3] = [10.0 * k, 0.0, 1.0]
        scene.add_geometry(shape(), transform=move)
    scene.export(tmp_path / "three.glb")
    corners = read_mesh(str(tmp_path / "three.glb"))
    assert len(corners) == 18
    # x stays, y up becomes z up.
    np.testing.assert_allclose(corners.min(axis=(0, 1)), [0.0, -2.0, 0.0], atol=1e-6)
    np.testing.assert_allclose(corners.max(axis=(0, 1)), [23.0, -1.0, 2.0], atol=1e-6)


def volume(corners: np.ndarray) -> float:
    return float(np.linalg.det(corners).sum() / 6.0)


@pytest.mark.parametrize("seed", range(4))
def test_closed_surfaces_wind_outward_however_they_were_written(tmp_path, seed):
    ball, block = trimesh.creation.icosphere(subdivisions=2), trimesh.creation.box((1.0, 2.0, 3.0))
    block.apply_translation([5.0, 0.0, 0.0])
    both = trimesh.util.concatenate([ball, block])
    faces = np.array(both.faces)
    wrong = np.random.default_rng(seed).random(len(faces)) < [0.5, 0.0, 1.0, 0.1][seed]
    faces[wrong] = faces[wrong][:, ::-1]
    path = tmp_path / "both.stl"  # which knows no shared corners
    trimesh.Trimesh(both.vertices, faces, process=False).export(path)
    corners = read_mesh(str(path))
    assert volume(corners[corners[:, 0, 0] < 3]) == pytest.approx(ball.volume, rel=1e-6)
    assert volume(corners[corners[:, 0, 0] > 3]) == pytest.approx(6.0, rel=1e-6)


def area(corners: np.ndarray) -> float:
    return float(
        np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1).sum() / 2
    )


def test_what_bounds_bodies_is_closed_and_faces_outwards(tmp_path):
    wedge, cube = read_mesh("mine-wedge"), block((1.0, 1.0, 1.0))
    two = np.concatenate([cube, cube + np.array([1.0, 1.0, 0.0])])  # which share an edge
    path = str(tmp_path / "body.stl")
    for k, (corners, closed) in enumerate([
        (wedge, True), (two, True), (wedge[1:], False), (two[1:], False), (wedge[:, ::-1], True),
        (np.concatenate([two[:12], two[12:, ::-1]]), True),
    ]):  # fmt: skip
        content = np.concatenate([np.zeros((len(corners), 1, 3)), corners], axis=1).astype("<f4").reshape(-1, 48 // 4)
        rows = b"".join(row.tobytes() + b"\0\0" for row in content)
        (tmp_path / "body.stl").write_bytes(b"\0" * 80 + struct.pack("<I", len(corners)) + rows)
        os.utime(path, (k, k))
        assert bounds_bodies(path) == closed
        assert not closed or volume(read_mesh(path)) > 0.0


def test_an_open_surface_winds_as_its_first_triangle_does_and_one_of_one_side_is_taken_as_it_is(tmp_path):
    path = tmp_path / "sheet.obj"
    path.write_text("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 3 2\nf 1 3 4\n")
    corners = read_mesh(str(path))
    tree = build_mesh(corners, np.zeros(2, np.int64), np.zeros(2, np.int64))
    np.testing.assert_array_equal(tree.normal, [[0, 0, -1], [0, 0, -1]])
    angle = np.linspace(0.0, 2.0 * np.pi, 40, endpoint=False)
    across = np.stack([np.cos(angle / 2) * np.cos(angle), np.cos(angle / 2) * np.sin(angle), np.sin(angle / 2)], axis=1)
    middle = np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1) * 3.0
    vertices = np.concatenate([middle - across, middle + across])
    k = np.arange(39)
    faces = np.concatenate([np.stack([k, k + 1, k + 40], 1), np.stack([k + 1, k + 41, k + 40], 1)])
    faces = np.concatenate([faces, [[39, 40, 79], [40, 0, 79]]])
    trimesh.Trimesh(vertices, faces, process=False).export(tmp_path / "strip.obj")
    assert len(read_mesh(str(tmp_path / "strip.obj"))) == 80


def test_triangles_without_area_are_dropped_even_by_rounding_and_a_material_library_may_be_missing(tmp_path, capfd):
    path = tmp_path / "needle.obj"
    path.write_text("mtllib none.mtl\nusemtl x\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 2 0 0\nf 1 2 3\nf 1 2 4\nf 1 1 3\n")
    assert len(read_mesh(str(path))) == 1
    assert capfd.readouterr() == ("", "")
    (tmp_path / "far.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1e14 0 0\nv 0 1e14 0\nf 1 2 3\nf 1 4 5\n")
    scene = scene_of(tmp_path, ("far.obj", "position = [0.1, 0.3]\nscale = 1e-6"))
    with np.errstate(all="raise"):
        mesh = prepare(scene).arrays.mesh
    assert np.isfinite(mesh.normal).all()


@pytest.mark.parametrize("suffix", ["stl", "ply"])
def test_too_many_triangles_are_refused_by_the_header(tmp_path, suffix):
    """Ten million of them took 19 s and 4.5 GB; this file holds none of those that it announces."""
    path = tmp_path / f"many.{suffix}"
    stl = b"\0" * 80 + struct.pack("<I", 10**7)
    path.write_bytes(stl if suffix == "stl" else b"ply\nformat ascii 1.0\nelement vertex 3\nelement face 10000000\n")
    os.truncate(path, 84 + 50 * 10**7)
    reader = next(each for each in MESHES.formats() if f".{suffix}" in each.suffixes).read
    with pytest.raises(FileFault, match=r"has 10000000 triangles.*thin it to at most 2000000"):
        reader(str(path))


@pytest.mark.parametrize("suffix", FORMATS)
def test_every_format_gives_the_same_triangles_and_a_file_written_anew_its_new_ones(tmp_path, suffix):
    path = write(tmp_path, suffix, shape())
    corners = read_mesh(str(path))
    np.testing.assert_array_equal(as_rows(corners), as_rows(np.array(shape().triangles)))
    assert read_mesh(str(path)) is corners
    write(tmp_path, suffix, trimesh.creation.box())
    os.utime(path, (1, 1))
    assert len(read_mesh(str(path))) == 12


# Plane polygons, and their areas.
HOOK = [(0, 0), (5, 0), (5, 4), (1, 4), (1, 3), (4, 3), (4, 1), (0, 1)], 11.0
POLYGONS = {
    "dart": ([(0, 0), (3, 2), (0, 4), (1, 2)], 4.0),
    "hook": HOOK,
    "frame, bridged": ([(0, 0), (4, 0), (4, 4), (0, 4), (0, 0), (1, 1), (1, 3), (3, 3), (3, 1), (1, 1)], 12.0),
    "two holes, bridged": (
        [
            (0, 0),
            (9, 0),
            (9, 3),
            (0, 3),
            (0, 0),
            (1, 1),
            (1, 2),
            (2, 2),
            (7, 1),
            (7, 2),
            (8, 2),
            (8, 1),
            (7, 1),
            (2, 2),
            (2, 1),
            (1, 1),
        ],
        25.0,
    ),
    "comb": ([*((x, 5 * (x % 2)) for x in range(40)), (39, -1), (0, -1)], 39.0 * 3.5),
    "mid-points": ([(0, 0), (1, 0), (2, 0), (3, 0), (3, 1), (2, 1), (1, 1), (1, 2), (1, 3), (0, 3), (0, 1)], 5.0),
}


def write_polygon(path, vertices) -> None:
    """Write one polygon beside a triangle of area 2: as OBJ, or as PLY in text or in binary of either order."""
    n, triangle = len(vertices), np.array([[50.0, 0.0, 0.0], [52.0, 0.0, 0.0], [50.0, 2.0, 0.0]])
    points = np.concatenate([vertices, triangle])
    if path.suffix == ".obj":
        v = "".join(f"v {x} {y} {z}\n" for x, y, z in points)
        path.write_text(f"{v}f {' '.join(f'{k + 1}//1' for k in range(n))}  # a face\nf -3 \\\n -2 -1\n")
        return
    form = path.stem
    head = f"ply\nformat {form} 1.0\ncomment none\nelement vertex {n + 3}\n" + "".join(
        f"property double {axis}\n" for axis in "xyz"
    )
    head += "element face 2\nproperty uchar red\nproperty list uchar int vertex_index\nend_header\n"
    rows = [(9, n, *range(n)), (9, 3, n, n + 1, n + 2)]
    if form == "ascii":
        body = "\n".join(" ".join(map(repr, row)) for row in [*points.tolist(), *rows]).encode()
    else:
        order = "<" if "little" in form else ">"
        body = points.astype(f"{order}f8").tobytes() + b"".join(
            struct.pack(f"{order}BB{row[1]}i", *row) for row in rows
        )
    path.write_bytes(head.encode() + body)


@pytest.mark.parametrize("name", POLYGONS)
@pytest.mark.parametrize("file", ["a.obj", "ascii.ply", "binary_little_endian.ply", "binary_big_endian.ply"])
def test_polygons_are_covered_once_from_any_corner_in_either_sense_and_any_attitude(tmp_path, name, file):
    outline, size = POLYGONS[name]
    turn = np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))[0]
    for k in (0, 1, 3, len(outline) - 1):
        vertices = np.roll(np.pad(np.array(outline, float), ((0, 0), (0, 1))), k, axis=0) @ turn.T
        for way in (1, -1):
            write_polygon(tmp_path / file, vertices[::way])
            os.utime(tmp_path / file, (k, k + 100 * way + 200))
            assert area(read_mesh(str(tmp_path / file))) == pytest.approx(size + 2.0)


def test_a_bent_polygon_keeps_its_outline_and_a_body_of_polygons_is_closed_whatever_lies_on_their_edges(tmp_path):
    bent = tmp_path / "bent.obj"
    bent.write_text("v 0 0 0\nv 3 2 0.1\nv 0 4 0\nv 1 2 0.3\nf 1 2 3 4\n")
    corners = read_mesh(str(bent))
    assert (len(corners), area(corners)) == (2, pytest.approx(4.08, abs=0.1))
    # A sliver whose digits let it cross itself is no reason to refuse a file.
    bent.write_text("v 0 0 0\nv 1 1e-7 0\nv 1 0 0\nv 0 1e-7 0\nf 1 2 3 4\nv 0 2 0\nf 1 2 5\n")
    os.utime(bent, (1, 1))
    assert area(read_mesh(str(bent))) == pytest.approx(1.0, abs=1e-5)
    # A prism over the hook, all faces inwards, with more vertices on the edges of its caps.
    outline = np.array(HOOK[0], float)
    outline = np.stack([outline, 0.5 * (outline + np.roll(outline, -1, axis=0))], axis=1).reshape(-1, 2)
    n = len(outline)
    lines = [f"v {x} {y} {z}" for z in (0, 2) for x, y in outline]
    lines += ["f " + " ".join(str(k + 1) for k in range(n)), "f " + " ".join(str(2 * n - k) for k in range(n))]
    lines += [f"f {k + 1} {k + 1 + n} {(k + 1) % n + 1 + n} {(k + 1) % n + 1}" for k in range(n)]
    (tmp_path / "prism.obj").write_text("\n".join(lines))
    corners = read_mesh(str(tmp_path / "prism.obj"))
    assert volume(corners) == pytest.approx(22.0)
    assert bounds_bodies(str(tmp_path / "prism.obj"))


def test_relative_numbers_of_an_obj_count_from_their_own_line(tmp_path):
    path = tmp_path / "relative.obj"
    path.write_text("v 0 0 0\nv 2 0 0\nv 0 2 0\nf -3 -2 -1\nv 7 0 0\nv 9 0 0\nv 7 2 0\nf -3/-3 -2/1 -1\nf 1 -2 6\n")
    np.testing.assert_array_equal(read_mesh(str(path))[:2, 0], [[0, 0, 0], [7, 0, 0]])
    assert len(read_mesh(str(path))) == 3


def write_gltf(path, parts, nodes=None, **document) -> None:
    """Write a glTF with one primitive a part, each {attribute or "indices": (numbers, type, more)} and other keys."""
    content, views, accessors, primitives = b"", [], [], []

    def add(numbers, stride=0) -> int:
        nonlocal content
        rows = [row.tobytes().ljust(stride, b"\7") for row in np.atleast_1d(numbers)]
        views.append({"buffer": 0, "byteOffset": len(content), "byteLength": sum(map(len, rows))})
        views[-1] |= {"byteStride": stride} if stride else {}
        content += b"".join(rows) + b"\0" * (-sum(map(len, rows)) % 4)
        return len(views) - 1

    kinds = {"i1": 5120, "u1": 5121, "i2": 5122, "u2": 5123, "u4": 5125, "f4": 5126}
    for part in parts:
        attributes, extra = {}, {}
        for name, value in part.items():
            if not isinstance(value, tuple):
                extra[name] = value
                continue
            numbers, kind, more = np.array(value[0]), value[1], dict(value[2:])
            shape = {0: "SCALAR", 3: "VEC3", 4: "VEC4", 16: "MAT4"}[numbers.shape[1] if numbers.ndim > 1 else 0]
            accessors.append({"componentType": kinds[kind], "count": len(numbers), "type": shape} | more)
            if sparse := more.get("sparse"):
                at, values = add(np.array(sparse[0], "<u2")), add(np.array(sparse[1], f"<{kind}"))
                accessors[-1]["sparse"] = {
                    "count": len(sparse[0]),
                    "indices": {"bufferView": at, "componentType": 5123},
                    "values": {"bufferView": values},
                }
            if not more.get("empty"):
                numbers = numbers.astype(f"<{kind}")
                wide = -(-numbers[0].nbytes // 4) * 4 + 4 if numbers.ndim > 1 and numbers.shape[1] == 3 else 0
                accessors[-1]["bufferView"] = add(numbers, wide)
            if name == "indices":
                extra[name] = len(accessors) - 1
            else:
                attributes[name] = len(accessors) - 1
        primitives.append({"attributes": attributes} | extra)
    address = "data:application/octet-stream;base64," + base64.b64encode(content).decode()
    path.write_text(json.dumps({
        "asset": {"version": "2.0"}, "nodes": nodes or [{"mesh": 0}], "meshes": [{"primitives": primitives}],
        "accessors": accessors, "bufferViews": views, "buffers": [{"byteLength": len(content), "uri": address}],
    } | document))  # fmt: skip


PENTAGON = [(0, 0, 0), (2, 0, 0), (3, 2, 0), (1, 3, 0), (-1, 2, 0)]  # of area 8, which a fan covers
ZIGZAG = [(0, 0, 0), (0, 2, 0), (3, 0, 0), (3, 2, 0), (6, 0, 0)]  # of area 9, which a strip covers
SMALL = (0.5 * np.array(PENTAGON) * 127 / 2).round()
QUANTIZED = {"extensionsRequired": ["KHR_mesh_quantization"]}
GLTF = {  # parts, nodes and keys of the document, area and extent
    "fan": ([{"POSITION": (PENTAGON, "f4"), "mode": 6}], None, {}, 8.0, (4, 0, 3)),
    "fan by indices": (
        [{"POSITION": (PENTAGON[::-1], "f4"), "indices": ([4, 3, 2, 1, 0], "u1"), "mode": 6}], None, {}, 8.0, (4, 0, 3),
    ),
    "strip": ([{"POSITION": (ZIGZAG, "f4"), "mode": 5}], None, {}, 9.0, (6, 0, 2)),
    "mixed modes": (
        [
            {"POSITION": (PENTAGON, "f4"), "mode": 6}, {"POSITION": (ZIGZAG, "f4"), "mode": 5},
            {"POSITION": (ZIGZAG[:3], "f4")}, {"POSITION": (PENTAGON, "f4"), "mode": 1},
        ],
        None, {}, 8.0 + 9.0 + 3.0, (7, 0, 3),
    ),
    "bytes, normalised": (
        [{"POSITION": (SMALL, "i1", ("normalized", True)), "mode": 6}], [{"mesh": 0, "scale": [4, 4, 4]}], QUANTIZED,
        8.0, (4, 0, 3),
    ),
    "whole numbers": (
        [{"POSITION": (100 * np.array(ZIGZAG), "u2"), "mode": 5}], [{"mesh": 0, "scale": [0.01, 0.01, 0.01]}],
        QUANTIZED, 9.0, (6, 0, 2),
    ),
    "sparse": (
        [{"POSITION": ([*PENTAGON[:2], (9, 9, 9), *PENTAGON[3:]], "f4", ("sparse", ([2], [(3, 2, 0)]))), "mode": 6}],
        None, {}, 8.0, (4, 0, 3),
    ),
    "sparse alone": (
        [{"POSITION": (PENTAGON, "f4", ("empty", True), ("sparse", ([1, 2, 3, 4], PENTAGON[1:]))), "mode": 6}],
        None, {}, 8.0, (4, 0, 3),
    ),
    "turned in a turned parent, and mirrored": (
        [{"POSITION": (PENTAGON, "f4"), "mode": 6}],
        [
            {"children": [1], "rotation": [0, 0, 0.5**0.5, 0.5**0.5], "translation": [7, 0, 0]},
            {"mesh": 0, "matrix": [-2, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 5, 0, 1]},
        ],
        {"scene": 1, "scenes": [{"nodes": []}, {"nodes": [0]}]}, 16.0, (3, 0, 8),
    ),
    "joints": (
        [{
            "POSITION": (ZIGZAG, "f4"), "JOINTS_0": ([(0, 1, 0, 0)] * 5, "u1"),
            "WEIGHTS_0": ([(0.5, 0.5, 0, 0)] * 4 + [(0, 1, 0, 0)], "f4"), "mode": 5,
        }],
        [{"mesh": 0, "skin": 0, "translation": [99, 0, 0]}, {}, {"translation": [4, 0, 0]}],
        {"skins": [{"joints": [1, 2]}]}, 3.0 + 3.0 + 5.0, (8, 0, 2),
    ),
    "shapes": (
        [
            {"POSITION": (PENTAGON, "f4"), "mode": 6, "targets": [{"POSITION": 1}]},
            {"POSITION": (PENTAGON, "f4"), "mode": 0},
        ],
        [{"mesh": 0, "weights": [1.0]}], {}, 32.0, (8, 0, 6),
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", GLTF)
def test_a_gltf_is_what_its_modes_numbers_nodes_and_shapes_mean(tmp_path, name):
    parts, nodes, document, size, extent = GLTF[name]
    write_gltf(tmp_path / "a.gltf", parts, nodes, **document)
    corners = read_mesh(str(tmp_path / "a.gltf"))
    assert area(corners) == pytest.approx(size, rel=2e-2 if name.startswith("bytes") else 1e-6)
    np.testing.assert_allclose(np.ptp(corners, axis=(0, 1)), extent, atol=0.03 if name.startswith("bytes") else 1e-6)


NAMED = {  # extensions that change a shape, keys of the document and of the part
    "KHR_draco_mesh_compression": ({}, {"extensions": {"KHR_draco_mesh_compression": {}}}),
    "EXT_meshopt_compression": ({"buffers": [{"byteLength": 60, "extensions": {"EXT_meshopt_compression": {}}}]}, {}),
    "EXT_mesh_gpu_instancing": ({"nodes": [{"mesh": 0, "extensions": {"EXT_mesh_gpu_instancing": {}}}]}, {}),
    "ACME_own_surfaces": ({"extensionsRequired": ["KHR_materials_unlit", "ACME_own_surfaces"]}, {}),
}


@pytest.mark.parametrize("name", NAMED)
def test_a_gltf_whose_triangles_need_an_extension_is_refused_by_its_name(tmp_path, name):
    document, part = NAMED[name]
    empty = [("empty", True)] if "draco" in name else []
    write_gltf(tmp_path / "a.gltf", [{"POSITION": (PENTAGON, "f4", *empty)} | part], **document)
    with pytest.raises(SceneError, match=f"needs {name}, which is not read here; export it without"):
        read_mesh(str(tmp_path / "a.gltf"))


def test_a_gltf_may_have_many_nodes_side_by_side_or_in_a_chain_but_each_once(tmp_path):
    path, part = tmp_path / "many.gltf", {"POSITION": (ZIGZAG[:3], "f4")}
    side_by_side = [{"children": list(range(1, 20_000))}] + [
        {"mesh": 0, "translation": [k, 0, 0]} for k in range(19_999)
    ]
    chain = [{"mesh": 0, "translation": [1, 0, 0]} | {"children": [k + 1]} for k in range(19_998)] + [{"mesh": 0}]
    for nodes in (side_by_side, chain):
        write_gltf(path, [part], nodes)
        assert np.ptp(read_mesh(str(path))[..., 0]) == pytest.approx(19_998.0 + 3.0 - (nodes is chain))
        path.unlink()
    write_gltf(path, [part], [{"mesh": 0, "children": [1]}, {"mesh": 0, "children": [0]}], scenes=[{"nodes": [0]}])
    with pytest.raises(SceneError, match="has a node in more than one place"):
        read_mesh(str(path))


WRONG = {
    "none.obj": (None, "does not exist"),
    "shape.dae": (b"<COLLADA/>", "is not a format known here"),
    "bare": (b"", "is not a format known here"),
    "empty.obj": (b"", "holds no triangles"),
    "empty.stl": (b"", "holds no triangles"),
    "empty.ply": (b"", "is not a PLY file"),
    "empty.glb": (b"", "is not a glTF document"),
    "empty.gltf": (b"{}", "holds no triangles"),
    "noise.stl": (bytes(range(256)) * 4, "announces 1397903696 triangles and holds 18"),
    "noise.glb": (bytes(range(256)) * 4, "is not a glTF document"),
    "cut.stl": (b"\0" * 80 + struct.pack("<I", 9) + b"\0" * 70, "announces 9 triangles and holds 1"),
    "quads.stl": (
        b"solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 1 1 0\nvertex 0 1 0\n"
        b"endloop\nendfacet\nendsolid\n",
        "facets that are not three vertices",
    ),
    "cut.ply": (b"ply\nformat ascii 1.0\nelement vertex 3\n", "header without an end"),
    "short.ply": (
        b"ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty int z\nend_header\n0",
        "announces 3 of the element 'vertex' and holds fewer",
    ),
    "strips.ply": (
        b"ply\nformat ascii 1.0\nelement tristrips 1\nproperty list int int vertex_indices\nend_header\n3 0 1 2\n",
        "holds strips of triangles; export it with faces",
    ),
    "typed.ply": (b"ply\nformat ascii 1.0\nelement vertex 3\nproperty x\nend_header\n", "has the line 'property x'"),
    "points.obj": (b"v 0 0 0\nv 1 0 0\nv 0 1 0\n", "holds no triangles"),
    "flat.obj": (b"v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n", "holds no triangles"),
    "nan.obj": (b"v 0 0 0\nv 1 0 0\nv 0 nan 0\nf 1 2 3\n", "not finite"),
    "far.obj": (b"v 0 0 0\nv 1e300 0 0\nv 0 1 0\nf 1 2 3\n", "lie beyond 1e\\+15"),
    "index.obj": (b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n", "face with a vertex that is not among its 3"),
    "zero.obj": (b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 0 1 2\n", "face with a vertex that is not among its 3"),
    "before.obj": (b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf -4 -2 -1\n", "face with a vertex that is not among its 3"),
    "bow.obj": (b"v 0 0 0\nv 2 2 0\nv 2 0 0\nv 0 3 0\nf 1 2 3 4\n", "face of 4 vertices that crosses itself"),
    "even.obj": (b"v 0 0 0\nv 2 2 0\nv 2 0 0\nv 0 2 0\nf 1 2 3 4\n", "face of 4 vertices that crosses itself"),
    "curved.obj": (b"v 0 0 0\ncstype bspline\nsurf 0 1 0 1 1\n", "holds free-form surfaces"),
    "old.gltf": (b'{"asset": {"version": "1.0"}}', "is in version 1.0 of glTF; export it as glTF 2.0"),
}


def scene_of(folder, *targets):
    """Scene whose targets are meshes, each a path and other fields."""
    head = '[[targets]]\nkind = "mesh"\n'
    (folder / "scene.toml").write_text("".join(f'{head}path = "{path}"\n{fields}\n' for path, fields in targets))
    return load_scene(folder / "scene.toml")


@pytest.mark.parametrize("name", WRONG)
def test_a_wrong_file_is_told_in_one_sentence(tmp_path, name, capfd):
    content, fault = WRONG[name]
    if content is not None:
        (tmp_path / name).write_bytes(content)
    with pytest.raises(SceneError, match=fault) as caught:
        prepare(scene_of(tmp_path, (name, "position = [1.0, 2.0]")))
    sentence = str(caught.value)
    assert sentence.startswith("targets.0.path: ")
    assert name in sentence
    assert "\n" not in sentence
    assert len(sentence) < 500
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize("name", list(bundled_meshes()))
def test_a_bundled_mesh_has_a_name_and_is_closed(name):
    corners = read_mesh(name)
    assert volume(corners) > 0.0
    edges = np.stack([corners, np.roll(corners, -1, axis=1)], axis=2).reshape(-1, 2, 3)
    there, back = (set(map(tuple, e.reshape(-1, 6).tolist())) for e in (edges, edges[:, ::-1]))
    assert there == back
    assert bounds_bodies(name) == (name != "figure")  # which has single triangles that belong to no body


def test_meshes_are_found_beside_the_scene_or_by_name_and_scale_turns_units_into_metres_about_the_middle(tmp_path):
    path = write(tmp_path, "obj", shape())
    scene = scene_of(tmp_path, ("shape.obj", "position = [1.0, 2.0]"), ("tetrapod", "position = [9.0, 2.0]"))
    assert [target.path for target in scene.targets] == [str(tmp_path / "shape.obj"), "tetrapod"]
    mesh = prepare(scene).arrays.mesh
    assert np.bincount(mesh.target).tolist() == [6, 320]
    scene = scene_of(tmp_path, (path, "position = [5.0, 7.0]\nscale = 0.5\nheading = 90.0"))
    corners = prepare(scene).arrays.mesh.corners
    np.testing.assert_allclose(corners.min(axis=(0, 1)), [4.5, 6.25, 0.0], atol=1e-12)
    np.testing.assert_allclose(corners.max(axis=(0, 1)), [5.5, 7.75, 0.5], atol=1e-12)
