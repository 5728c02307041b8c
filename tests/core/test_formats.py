"""File formats: a module in a package, or in an installed one, adds a format to all that reads or writes."""

import json
import sys
from importlib.metadata import EntryPoint
from pathlib import Path

import numpy as np
import pytest

import insonify.io.formats
from commands import refused
from insonify import cli
from insonify.io.bathymetry import BATHYMETRY, Grid
from insonify.io.formats import FileFormat, FormatRegistry
from insonify.io.meshes import MESHES, read_mesh
from insonify.io.navigation import NAVIGATION, read_navigation
from insonify.io.record_schema import join_blocks
from insonify.io.records import RECORDS, read_record
from insonify.io.sound_speed_casts import CASTS, read_cast
from insonify.scene import SceneError, load_scene
from insonify.terrain import build_ground

SMALL = ("pipe-span", "--set", "track.pings=3", "--set", "sonar.bins=100")


def write_text(path, blocks):
    Path(path).write_text(json.dumps(join_blocks(list(blocks)).to_dict(), default=lambda value: value.item()))


def read_text(path):
    import xarray as xr

    return xr.Dataset.from_dict(json.loads(Path(path).read_text()))


DUMMY = FileFormat("JSON text", (".json",), read_text, write_text)


def words(capsys, *arguments):
    with pytest.raises(SystemExit):
        cli.main(arguments)
    return " ".join("".join(capsys.readouterr()).split())


def test_a_new_record_format_is_written_read_drawn_and_named_in_help(tmp_path, capsys):
    path = tmp_path / "record.json"
    assert cli.main(["render", *SMALL, "-o", str(path)]) == 2
    assert "end the name in" in capsys.readouterr().err
    with RECORDS.adding(DUMMY):
        for out in (path, tmp_path / "record.npz"):
            assert cli.main(["render", *SMALL, "-o", str(out)]) == 0
        expected = read_record(tmp_path / "record.npz")
        np.testing.assert_allclose(read_record(path).intensity, expected.intensity, rtol=1e-6)
        assert cli.main(["render", str(path), "-o", str(tmp_path / "record.png")]) == 0
        capsys.readouterr()
        assert ".json (JSON text)" in words(capsys, "render", "--help")
        assert ".json (JSON text)" in words(capsys, "compare", "--help")
    with pytest.raises(SceneError, match=r"record\.json: is not a format known here; give a file that ends in one of"):
        read_record(path)


def test_one_new_file_adds_a_format(tmp_path, monkeypatch):
    package = tmp_path / "shelf"
    package.mkdir()
    (package / "__init__.py").touch()
    (package / "plain.py").write_text(
        "from insonify.io.formats import FileFormat\nPLAIN = FileFormat('plain text', ('.txt',), read=str.upper)\n"
    )
    (tmp_path / "stranger.py").write_text(
        "from insonify.io.formats import FileFormat\nODD = FileFormat('odd text', ('.odd',), read=str.lower)\n"
    )
    monkeypatch.syspath_prepend(tmp_path)
    entries = [EntryPoint("odd", "stranger", "insonify.shelf"), EntryPoint("same", "stranger:ODD", "insonify.shelf")]
    monkeypatch.setattr(insonify.io.formats, "announced", lambda group: entries if group == "insonify.shelf" else [])
    registry: FormatRegistry[str] = FormatRegistry(
        "a text", "shelf", "insonify.shelf", "shelf: {path} {fault}; {remedy}"
    )
    assert registry.readable() == (".txt", ".odd")
    assert registry.writable() == ()
    assert registry.describe(registry.readable()) == ".txt (plain text), .odd (odd text)"
    (tmp_path / "Ab.TXT").touch()
    assert registry.read(str(tmp_path / "Ab.TXT")) == str(tmp_path / "Ab.TXT").upper()
    with pytest.raises(SceneError, match=r"^shelf: ab\.nc is not a format known here; give a file that ends in one of"):
        registry.read("ab.nc")
    with pytest.raises(SceneError, match=r"^shelf: ab\.odd does not exist; give the path of a text$"):
        registry.read("ab.odd")
    for name in ("shelf", "shelf.plain", "stranger"):
        monkeypatch.delitem(sys.modules, name)


def test_new_formats_of_beds_casts_meshes_and_navigation_are_read(tmp_path):
    file = tmp_path / "made.up"
    file.touch()
    heights = -20.0 - np.arange(12.0).reshape(3, 4)
    with BATHYMETRY.adding(FileFormat("made up", (".up",), lambda path: Grid(heights))):
        scene = load_scene("real-bed")
        relief = scene.seabed.relief.model_copy(update={"path": str(file), "scale": 1.0, "datum": 0.0})
        seabed = scene.seabed.model_copy(update={"relief": relief})
        assert build_ground(scene.model_copy(update={"seabed": seabed})).heights.shape == (3, 4)
    depth = np.arange(0.0, 20.0)
    with CASTS.adding(FileFormat("made up", (".up",), lambda path: {"depth": depth, "sound_speed": 1500.0 + depth})):
        np.testing.assert_allclose(read_cast(str(file)).sound_speed, 1500.0 + depth)
    with MESHES.adding(FileFormat("made up", (".up",), lambda path: np.eye(3)[None])):
        assert read_mesh(str(file)).shape == (1, 3, 3)
    with NAVIGATION.adding(FileFormat("made up", (".up",), lambda path: {"time": depth, "x": depth, "y": depth})):
        np.testing.assert_array_equal(read_navigation(str(file)).columns["x"], depth)


def test_no_two_formats_share_a_suffix():
    for registry in (RECORDS, BATHYMETRY, CASTS, MESHES, NAVIGATION):
        readable, writable = registry.readable(), registry.writable()
        assert len(set(readable)) == len(readable) > 1
        assert len(set(writable)) == len(writable)


def test_a_new_format_that_fails_leaves_the_old_file(tmp_path, capsys):
    def write_half(path, blocks):
        Path(path).write_text("half")
        raise OSError(28, "No space left on device")

    path = tmp_path / "record.json"
    path.write_text("old")
    with RECORDS.adding(FileFormat("JSON text", (".json",), read_text, write_half)):
        assert f"{path}: No space left on device" in refused(capsys, "render", *SMALL, "-o", str(path))
    assert [file.name for file in tmp_path.iterdir()] == ["record.json"]
    assert path.read_text() == "old"
