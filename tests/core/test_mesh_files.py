"""Meshes in files: every format gives the same triangles, and what is wrong is told in one sentence."""

import os
import struct

import numpy as np
import pytest
import trimesh

from insonify.io.file_access import FileFault
from insonify.io.meshes import bounds_bodies, read_mesh
from insonify.io.meshes.trimesh_files import read_z_up
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


def test_what_bounds_bodies_is_closed_and_faces_outwards():
    wedge, cube = read_mesh("mine-wedge"), block((1.0, 1.0, 1.0))
    two = np.concatenate([cube, cube + np.array([1.0, 1.0, 0.0])])  # which share an edge
    assert bounds_bodies(wedge)
    assert bounds_bodies(two)
    assert not bounds_bodies(wedge[1:])
    assert not bounds_bodies(two[1:])
    assert not bounds_bodies(wedge[:, ::-1])
    assert not bounds_bodies(np.concatenate([two[:12], two[12:, ::-1]]))


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


def test_triangles_without_area_are_dropped_and_a_missing_material_library_is_no_matter(tmp_path, capfd):
    path = tmp_path / "needle.obj"
    path.write_text("mtllib none.mtl\nusemtl x\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 2 0 0\nf 1 2 3\nf 1 2 4\nf 1 1 3\n")
    assert len(read_mesh(str(path))) == 1
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize("suffix", ["stl", "ply"])
def test_too_many_triangles_are_refused_by_the_header(tmp_path, suffix):
    """Ten million of them took 19 s and 4.5 GB; this file holds none of those that it announces."""
    path = tmp_path / f"many.{suffix}"
    stl = b"\0" * 80 + struct.pack("<I", 10**7)
    path.write_bytes(stl if suffix == "stl" else b"ply\nformat ascii 1.0\nelement vertex 3\nelement face 10000000\n")
    os.truncate(path, 84 + 50 * 10**7)
    with pytest.raises(FileFault, match=r"has 10000000 triangles.*thin it to at most 2000000"):
        read_z_up(str(path))


@pytest.mark.parametrize("suffix", FORMATS)
def test_every_format_gives_the_same_triangles_and_a_file_written_anew_its_new_ones(tmp_path, suffix):
    path = write(tmp_path, suffix, shape())
    corners = read_mesh(str(path))
    np.testing.assert_array_equal(as_rows(corners), as_rows(np.array(shape().triangles)))
    assert read_mesh(str(path)) is corners
    write(tmp_path, suffix, trimesh.creation.box())
    os.utime(path, (1, 1))
    assert len(read_mesh(str(path))) == 12


WRONG = {
    "none.obj": (None, "does not exist"),
    "shape.dae": (b"<COLLADA/>", "is not a format known here"),
    "bare": (b"", "is not a format known here"),
    "empty.obj": (b"", "holds no triangles"),
    "empty.stl": (b"", "holds no triangles"),
    "empty.ply": (b"", "cannot be read"),
    "empty.glb": (b"", "cannot be read"),
    "empty.gltf": (b"{}", "holds no triangles"),
    "noise.stl": (bytes(range(256)) * 4, "holds no triangles"),
    "noise.glb": (bytes(range(256)) * 4, "cannot be read"),
    "cut.stl": (b"\0" * 80 + struct.pack("<I", 9) + b"\0" * 70, "holds no triangles"),
    "cut.ply": (b"ply\nformat ascii 1.0\nelement vertex 3\n", "cannot be read"),
    "points.obj": (b"v 0 0 0\nv 1 0 0\nv 0 1 0\n", "holds no triangles"),
    "flat.obj": (b"v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n", "holds no triangles"),
    "nan.obj": (b"v 0 0 0\nv 1 0 0\nv 0 nan 0\nf 1 2 3\n", "not finite"),
    "far.obj": (b"v 0 0 0\nv 1e300 0 0\nv 0 1 0\nf 1 2 3\n", "lie beyond 1e\\+15"),
    "index.obj": (b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n", "cannot be read"),
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
    assert bounds_bodies(corners) == (name != "figure")  # which has single triangles that belong to no body


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


def test_triangles_lost_by_rounding_far_from_the_origin_are_dropped(tmp_path, capfd):
    (tmp_path / "far.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1e14 0 0\nv 0 1e14 0\nf 1 2 3\nf 1 4 5\n")
    scene = scene_of(tmp_path, ("far.obj", "position = [0.1, 0.3]\nscale = 1e-6"))
    with np.errstate(all="raise"):
        mesh = prepare(scene).arrays.mesh
    assert np.isfinite(mesh.normal).all()
