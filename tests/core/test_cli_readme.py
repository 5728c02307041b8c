"""What the README says works."""

import re
import runpy
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

from insonify.cli import build_parser
from insonify.commands.options import chosen_scene, is_record
from insonify.scene import scene_from_toml

ROOT = Path(__file__).parents[2]
README = ROOT / "README.md"
GALLERY = runpy.run_path(str(ROOT / "docs" / "gallery.py"))["cells"](README.read_text(encoding="utf-8"))


def blocks(language: str) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", README.read_text(encoding="utf-8"), flags=re.DOTALL)


def commands() -> list[str]:
    lines = [line for block in blocks("sh") for line in block.splitlines()]
    return [line for line in lines if re.match(r"insonify \w+ ", line) and line.split()[1] in build_parser()[1]]


def test_there_are_commands_to_try():
    assert len(commands()) > 8


@pytest.mark.parametrize("line", [*commands(), *(command for _, command in GALLERY)])
def test_every_command_is_understood(line):
    words = shlex.split(line, comments=True)[1:]
    arguments = build_parser()[0].parse_args(words)
    if hasattr(arguments, "scene") and not is_record(arguments.scene):
        chosen_scene(arguments)


def test_the_gallery_is_whole_and_light():
    pictures = [ROOT / path for path, _ in GALLERY]
    assert len(pictures) == README.read_text(encoding="utf-8").count("](docs/gallery/")
    assert {path.name for path in pictures} == {path.name for path in (ROOT / "docs" / "gallery").iterdir()}
    sizes = [path.stat().st_size for path in pictures]
    assert max(sizes) < 300_000
    assert sum(sizes) < 4_000_000


def test_the_scene_is_one_and_its_parts_are_of_one():
    whole, *parts = map(scene_from_toml, blocks("toml"))
    assert whole.targets[0].length == 30.0
    assert ("heave", "yaw", "turn") in {part.track.kinds for part in parts}
    assert "pattern" in {part.seabed.material.kind for part in parts}


def test_the_python_runs():
    """In a fresh interpreter, as a reader would."""
    text = "\n".join(blocks("python"))
    done = subprocess.run([sys.executable, "-c", text], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert "('ping_time', 'range_sample')" in done.stdout
    assert "[475.43062234 239.22822184  31.28132944]" in done.stdout
