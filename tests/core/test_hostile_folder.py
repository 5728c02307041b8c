"""Nothing of the current folder is run: neither by a command nor by a process that it starts."""

import importlib.util
import os
import shutil
import sys
from pathlib import Path

import pytest

import insonify
from commands import run_python
from insonify.cli import main
from insonify.files import resources
from small_sets import SET, SURVEY
from strangers import traces, write_modules

COMMANDS = """
scenes
targets
lesson
plan default
relief default -o relief.png
rays thermocline -o rays.png
light pipe-on-bed --set seabed.relief=flat --set track.pings=8 -o light.png
render default --set track.pings=8 -o new.nc
render record.nc -o record.png
compare record.nc record.nc -o compared.png
explain default --ping 3 --range 25
mosaic record.nc -o mosaic.tif
"""
# The process that reads files is part of the commands above; that which compiles is in compiler/test_processes.py.
ONE_AFTER_THE_OTHER = """
import sys
from insonify.__main__ import load
command = load()
for line in sys.stdin:
    assert command(line.split()) == 0, line
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A folder with a record, specifications, and a module of a stranger by every name that could be imported."""
    place = tmp_path_factory.mktemp("data")
    assert main(["render", "default", "--set", "track.pings=160", "-o", str(place / "record.nc")]) == 0
    (place / "set.toml").write_text(SET.replace("scenes = 8", "scenes = 1").replace("= 96", "= 64"))
    (place / "survey.toml").write_text(SURVEY.replace("24.0, 30.0", "24.0, 9.0").replace("0.0, 30.0", "0.0, 9.0"))
    write_modules(place)
    (place / ".numba_config.yaml").write_text("cache_dir: stranger\ndisable_jit: [\n")  # neither obeyed nor parsed
    os.mkfifo(place / ".ncrc")
    (place / "matplotlibrc").write_bytes(b"text.usetex: True\n\xff\n")
    return place


def test_commands_import_nothing_of_the_current_folder(folder):
    """A json.py or a numpy.py beside somebody's data is not part of the program."""
    code, *told = run_python("-P", "-c", ONE_AFTER_THE_OTHER, cwd=folder, input=COMMANDS.lstrip())
    assert (code, traces(folder)) == (0, set()), told
    assert not (folder / "stranger").exists()


def test_kernels_are_compiled_without_settings_of_the_current_folder(folder):
    code, *told = run_python("-P", "-c", "import insonify; insonify.plan(insonify.load_scene('figure-3'))", cwd=folder)
    assert (code, traces(folder)) == (0, set()), told


# Both start workers in the same way.
@pytest.mark.parametrize("words", [pytest.param("survey survey.toml", marks=pytest.mark.slow), "dataset set.toml"])
def test_workers_import_nothing_of_the_current_folder(folder, words):
    installed = Path(sys.executable).with_name("insonify")
    code, *told = run_python(
        str(installed), *words.split(), "-o", words.split()[0], "--scheduler", "local:1", cwd=folder
    )
    assert (code, traces(folder)) == (0, set()), told


@pytest.fixture(scope="module")
def loaded(tmp_path_factory):
    """Names of the packages, and of modules that Python takes from the current folder before it runs one of them."""
    place = tmp_path_factory.mktemp("probe")
    (place / "probe.py").write_text("import sys; print(*sys.modules)")
    code, found, _ = run_python("-m", "probe", cwd=place)
    assert code == 0
    return {"insonify", "insonify_viewer", *found.split()}


@pytest.mark.parametrize("words", ["insonify plan default", "insonify render record.nc -o m.png", "insonify_viewer -h"])
def test_python_with_m_imports_nothing_else_of_the_current_folder(folder, loaded, tmp_path, words):
    """Python puts the folder first, and the program takes it out."""
    shutil.copy(folder / "record.nc", tmp_path)
    write_modules(tmp_path, left_out=loaded)
    code, *told = run_python("-X", "faulthandler", "-m", *words.split(), cwd=tmp_path)
    assert (code, traces(tmp_path)) == (0, set()), told


def test_python_with_m_runs_a_checkout(loaded, tmp_path):
    """The folder of the package itself comes last: it lends modules that Python lacks alone."""
    lacking = {name for name in sys.stdlib_module_names if importlib.util.find_spec(name) is None}
    core = tmp_path / "core"
    core.mkdir()
    write_modules(core, left_out=loaded | lacking)
    (core / "insonify").symlink_to(Path(insonify.__file__).parent)
    (tmp_path / "resources").symlink_to(resources())
    code, *told = run_python("-X", "faulthandler", "-m", "insonify", "scenes", cwd=core)
    assert (code, traces(core)) == (0, set()), told
