"""Kinds, commands and file formats are found by standing in a package, here or in an installed one."""

import json
import os
from contextlib import contextmanager
from functools import partial
from importlib.metadata import EntryPoint
from pathlib import Path
from types import SimpleNamespace
from typing import Literal

import numpy as np
import pytest
import xarray as xr

import insonify.commands
from bathymetry_files import scene
from commands import run_python
from insonify import cli, plugins
from insonify.io.bathymetry import BATHYMETRY, Grid
from insonify.io.formats import FileFormat, FormatRegistry
from insonify.io.meshes import MESHES, read_mesh
from insonify.io.navigation import NAVIGATION, read_navigation
from insonify.io.record_schema import join_blocks
from insonify.io.records import RECORDS, read_record
from insonify.io.sound_speed_casts import CASTS, read_cast
from insonify.scene import Scene, SceneError, edit, load_scene, scene_to_toml
from insonify.scene.base import Declaration, Family, models_of, parameter
from insonify.scene.seabed.materials import MATERIAL_MAPS, MaterialMap
from insonify.scene.targets import TARGETS, Posed, Target
from insonify.terrain import build_ground
from own_kinds import forgetting

SMALL = ("pipe-span", "--set", "track.pings=3", "--set", "sonar.bins=100")


def write_text(path, blocks):
    Path(path).write_text(json.dumps(join_blocks(list(blocks)).to_dict(), default=lambda value: value.item()))


def read_text(path):
    return xr.Dataset.from_dict(json.loads(Path(path).read_text()))


@contextmanager
def added_format(registry, extra):
    formats = registry.formats()
    formats.append(extra)
    try:
        yield
    finally:
        formats.remove(extra)


def test_a_new_record_format_is_written_read_drawn_and_named_in_help(tmp_path, capsys):
    path = tmp_path / "record.json"
    assert cli.main(["render", *SMALL, "-o", str(path)]) == 2
    assert "end the name in" in capsys.readouterr().err
    with added_format(RECORDS, FileFormat("JSON text", (".json",), read_text, write_text)):
        for out in (path, tmp_path / "record.npz"):
            assert cli.main(["render", *SMALL, "-o", str(out)]) == 0
        expected = read_record(tmp_path / "record.npz")
        np.testing.assert_allclose(read_record(path).intensity, expected.intensity, rtol=1e-6)
        assert cli.main(["render", str(path), "-o", str(tmp_path / "record.png")]) == 0
        for command in ("render", "compare"):
            capsys.readouterr()
            with pytest.raises(SystemExit):
                cli.main([command, "--help"])
            assert ".json (JSON text)" in " ".join(capsys.readouterr().out.split())
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
    monkeypatch.setattr(plugins, "announced", lambda group: entries if group == "insonify.shelf" else [])
    sentence = "shelf: {path} {fault}; {remedy}"
    registry: FormatRegistry[str] = FormatRegistry("a text", "shelf", "insonify.shelf", sentence)
    assert registry.readable() == (".txt", ".odd")
    assert registry.writable() == ()
    assert registry.describe(registry.readable()) == ".txt (plain text), .odd (odd text)"
    (tmp_path / "Ab.TXT").touch()
    assert registry.read(str(tmp_path / "Ab.TXT")) == str(tmp_path / "Ab.TXT").upper()
    with pytest.raises(SceneError, match=r"^shelf: ab\.nc is not a format known here; give a file that ends in one of"):
        registry.read("ab.nc")
    with pytest.raises(SceneError, match=r"^shelf: ab\.odd does not exist; give the path of a text$"):
        registry.read("ab.odd")


def test_new_formats_of_beds_casts_meshes_and_navigation_are_read(tmp_path):
    file = tmp_path / "made.up"
    file.touch()
    heights = -20.0 - np.arange(12.0).reshape(3, 4)
    made_up = partial(FileFormat, "made up", (".up",))
    with added_format(BATHYMETRY, made_up(lambda path: Grid(heights))):
        assert build_ground(scene(file)).heights.shape == (3, 4)
    depth = np.arange(0.0, 20.0)
    with added_format(CASTS, made_up(lambda path: {"depth": depth, "sound_speed": 1500.0 + depth})):
        np.testing.assert_allclose(read_cast(str(file)).sound_speed, 1500.0 + depth)
    with added_format(MESHES, made_up(lambda path: np.eye(3)[None])):
        assert read_mesh(str(file)).shape == (1, 3, 3)
    with added_format(NAVIGATION, made_up(lambda path: {"time": depth, "x": depth, "y": depth})):
        np.testing.assert_array_equal(read_navigation(str(file)).columns["x"], depth)


def test_no_two_formats_share_a_suffix():
    for registry in (RECORDS, BATHYMETRY, CASTS, MESHES, NAVIGATION):
        readable, writable = registry.readable(), registry.writable()
        assert len(set(readable)) == len(readable) > 1
        assert len(set(writable)) == len(writable)


GREET = """
def register(subparsers):
    parser = subparsers.add_parser("greet", help="say hello")
    parser.add_argument("name")
    parser.set_defaults(run=lambda arguments: print("hello", arguments.name) or 0)
"""


@pytest.mark.parametrize("installed", [False, True])
def test_one_new_file_or_an_installed_package_adds_a_sub_command(tmp_path, monkeypatch, capsys, installed):
    if installed:
        (tmp_path / "stranger_greet.py").write_text(GREET)
        monkeypatch.syspath_prepend(tmp_path)
        entries = [EntryPoint("greet", "stranger_greet:register", cli.COMMANDS)]
        monkeypatch.setattr(cli, "announced", lambda group: entries)
    else:
        (tmp_path / "greet.py").write_text(GREET)
        monkeypatch.setattr(insonify.commands, "__path__", [*insonify.commands.__path__, str(tmp_path)])
    assert cli.main(["greet", "world"]) == 0
    assert capsys.readouterr().out == "hello world\n"


# Entry points of an installed package, each of another group, and why they are left out.
BROKEN = {
    "commands": ("no_such_package:register", "ModuleNotFoundError: No module named 'no_such_package'"),
    "tracers": ("broken_at_once", "ZeroDivisionError: division by zero"),
    "receiver_stages": ("broken_to_end", "SystemExit: 3"),
    "targets": ("broken_syntax", "SyntaxError: "),
    "waters": ("broken_values:none", "AttributeError: module 'broken_values' has no attribute 'none'"),
    "beams": ("not an entry", ""),
    "materials": ("broken_values:folder", "stone.toml: is not valid TOML"),
    "panels": ("broken_values:number", "AttributeError: 'int' object has no attribute 'rank'"),
    "schedulers": ("broken_values:number", "AttributeError: 'int' object has no attribute 'prefix'"),
}
STRANGER = {
    "broken_at_once": "1 / 0",
    "broken_to_end": "raise SystemExit(3)",
    "broken_syntax": "def",
    "broken_values": "number = 3\nfolder = __file__.rpartition('/')[0]",
}
ALL_OF_THEM = """
import warnings
from insonify.cli import main
assert main("render sediments --set track.pings=2 -o a.nc".split()) == 0
warnings.showwarning = lambda message, *_: print("insonify:", message)
from insonify.surveys.schedulers import find_schedulers
from insonify_viewer.panels import find_panels
assert find_schedulers() and find_panels()
"""


def test_an_entry_point_that_is_broken_is_named_and_left_out_and_all_else_works(tmp_path):
    for module, text in STRANGER.items():
        (tmp_path / f"{module}.py").write_text(text)
    (tmp_path / "stone.toml").write_text("[stone")
    (tmp_path / "broken-1.dist-info").mkdir()
    (tmp_path / "broken-1.dist-info" / "METADATA").write_text("Name: broken\nVersion: 1\n")
    lines = (f"[insonify.{group}]\nodd = {value}\n" for group, (value, _) in BROKEN.items())
    (tmp_path / "broken-1.dist-info" / "entry_points.txt").write_text("".join(lines))
    path = os.pathsep.join((str(tmp_path), str(Path(__file__).parents[1])))
    code, *told = run_python("-c", ALL_OF_THEM, cwd=tmp_path, env=os.environ | {"PYTHONPATH": path})
    assert code == 0, told
    named = [line for line in "".join(told).splitlines() if line.startswith("insonify: 'odd' of ")]
    for value, cause in BROKEN.values():
        assert sum(f"of {value} is left out (" in line and cause in line for line in named) == 1, (value, cause, told)
    assert len(named) == len(BROKEN)
    assert all(line.endswith("; update or remove the package that announces it") for line in named)


def test_every_module_of_a_command_is_named_after_it():
    modules = {module.__name__.rpartition(".")[2] for module in cli.modules_in(cli.COMMANDS)}
    assert modules == {*insonify.commands.OWN, "options"}
    assert {*insonify.commands.OWN, *insonify.commands.OF_VIEWER} == set(cli.build_parser()[1])
    assert insonify.commands.OWN["render"].endswith(f".png (picture), {RECORDS.describe(RECORDS.writable())}")


def test_a_kind_that_is_declared_late_is_a_kind_like_others_and_can_be_forgotten() -> None:
    scene = load_scene("targets")
    before = models_of(Scene, "targets")
    with forgetting(TARGETS):

        class Egg(Posed):
            """An egg."""

            kind: Literal["egg"] = "egg"
            width: float = parameter(1.0, unit="m", description="widest", gt=0.0)

        assert models_of(Scene, "targets") == (*before, Egg)
        changed = edit(scene, {"targets.0.kind": "egg", "targets.0.width": 2.0})
        assert changed.targets[0].position == scene.targets[0].position
        assert 'kind = "egg"' in scene_to_toml(changed)
        with pytest.raises(SceneError, match=r"targets\.0\.width: -1\.0 is out of bounds"):
            edit(scene, {"targets.0.kind": "egg", "targets.0.width": -1.0})
    assert models_of(Scene, "targets") == before
    with pytest.raises(SceneError, match="'egg' is not a known kind"):
        edit(scene, {"targets.0.kind": "egg"})


def test_kinds_of_installed_packages_are_found_by_their_entry_points(monkeypatch: pytest.MonkeyPatch) -> None:
    family = Family("eggs")

    def load() -> None:
        class Quail(Declaration):
            """An egg of another package."""

            kind: Literal["quail"] = "quail"

        family.add(Quail)

    entries = {"insonify.eggs": [SimpleNamespace(load=load)]}
    monkeypatch.setattr(plugins, "announced", lambda group: entries[group])
    assert list(family.models(Declaration)) == ["quail"]


def test_kinds_stand_in_the_order_of_their_ranks_and_new_ones_last() -> None:
    # Kinds without a rank follow those with one, so that a new one needs no number.
    assert list(TARGETS.models(Target))[:5] == ["pipe", "sphere", "box", "cone", "mesh"]
    assert list(MATERIAL_MAPS.models(MaterialMap))[:5] == ["uniform", "patches", "fractal", "pattern", "image"]
