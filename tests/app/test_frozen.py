"""The program as a folder that needs no Python: its processes, and the recipe itself where PyInstaller is installed."""

import os
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import pytest
from PIL import Image

from bathymetry_files import sloped, write_tiff
from insonify import child_process

FROZEN = Path(__file__).parents[2] / "app" / "frozen"
# What PyInstaller makes of the interpreter: the executable runs the program alone, and takes no options of Python.
EXECUTABLE = """#!{python}
import runpy, sys
sys.frozen, sys.executable = True, {executable!r}
runpy.run_path({program!r}, run_name="__main__")
"""


def test_a_frozen_program_starts_itself(monkeypatch):
    monkeypatch.setattr(sys, "frozen", True, raising=False)
    assert child_process.own_command("render", "default") == [sys.executable, "render", "default"]


@pytest.mark.skipif(sys.platform == "win32", reason="a script is no executable there")
def test_processes_of_a_frozen_program_are_the_program_again(tmp_path):
    """A grid is read by a child, and kernels are compiled by another where the cache is empty."""
    path, program = tmp_path / "insonify", str(FROZEN / "program.py")  # a stand-in for the executable
    path.write_text(EXECUTABLE.format(python=sys.executable, executable=str(path), program=program), encoding="utf-8")
    path.chmod(0o755)
    write_tiff(tmp_path / "bed.tif", sloped(64, 64))
    words = ["relief", "default", "--set", f"seabed.relief={{ kind = 'dem', path = '{tmp_path / 'bed.tif'}' }}"]
    done = subprocess.run([path, *words, "-o", "bed.png"], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.slow
@pytest.mark.skipif(find_spec("PyInstaller") is None, reason="PyInstaller is not installed")
def test_the_folder_simulates_and_draws_its_window_without_python(tmp_path):
    """Built by the recipe, and run without any variable of the environment, so that nothing is found by PATH."""
    places = ["--distpath", str(tmp_path / "dist"), "--workpath", str(tmp_path / "build")]
    command = [sys.executable, "-m", "PyInstaller", "--noconfirm", *places, str(FROZEN / "insonify.spec")]
    subprocess.run(command, check=True, capture_output=True)
    program = tmp_path / "dist" / "insonify" / "insonify"
    home = tmp_path / "home"
    home.mkdir()
    bare = {"HOME": str(home), "PATH": ""} if os.name == "posix" else None
    for words in (
        ["render", "default", "--set", "track.pings=8", "-o", "record.nc"],
        ["render", "record.nc", "-o", "record.png"],
        ["view", "default", "--set", "track.pings=64", "--snapshot", "window.png"],
        ["dataset", "mines", "--scenes", "2", "-o", "mines", "--scheduler", "local:1"],
    ):
        done = subprocess.run([program, *words], cwd=home, env=bare, capture_output=True, text=True, check=False)
        assert (words, done.returncode) == (words, 0), done.stderr
    assert Image.open(home / "window.png").getcolors(1000) is None
