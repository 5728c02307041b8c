"""Nothing of the current folder is run: neither by a command nor by a process that it starts."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from small_sets import SET, SURVEY
from strangers import traces, write_modules

COMMANDS = (
    "scenes",
    "targets",
    "lesson",
    "plan default",
    "relief default -o relief.png",
    "rays thermocline -o rays.png",
    "light default --set track.pings=8 -o light.png",
    "render default --set track.pings=8 -o new.nc",
    "render record.nc -o record.png",
    "compare record.nc record.nc -o compared.png",
    "explain default --ping 3 --range 25",
    "mosaic record.nc -o mosaic.tif",
    "survey survey.toml -o survey --scheduler local:1",
    "dataset set.toml -o set --scheduler local:1",
)
# The process that reads files is part of the commands above.
COMPILED = """
from insonify.compiler.processes import CompilingProcess
process = CompilingProcess(reports=False)
process.request(b"no kernel")
assert process.wait(b"no kernel")
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A folder with a record, specifications, and a module of a stranger by every name that could be imported."""
    place = tmp_path_factory.mktemp("data")
    assert run(place, "render", "default", "--set", "track.pings=160", "-o", "record.nc").returncode == 0
    (place / "set.toml").write_text(SET.replace("scenes = 8", "scenes = 1").replace("= 96", "= 64"))
    (place / "survey.toml").write_text(SURVEY.replace("24.0, 30.0", "24.0, 9.0").replace("0.0, 30.0", "0.0, 9.0"))
    write_modules(place)
    (place / ".numba_config.yaml").write_text("cache_dir: stranger\n")
    return place


def run(place: Path, *words: str) -> subprocess.CompletedProcess[str]:
    """Run the installed command in a folder."""
    script = Path(sys.executable).with_name("insonify")
    return subprocess.run([script, *words], cwd=place, capture_output=True, text=True, check=False)


@pytest.mark.parametrize("words", COMMANDS)
def test_a_command_imports_nothing_of_the_current_folder(folder, words):
    """A json.py or a numpy.py beside somebody's data is not part of the program."""
    done = run(folder, *words.split())
    assert (done.returncode, traces(folder)) == (0, set()), done.stderr
    assert not (folder / "stranger").exists()


def test_a_process_that_compiles_imports_nothing_of_the_current_folder(folder):
    """A queue.py there would otherwise run whenever a kernel is compiled for the first time."""
    done = subprocess.run([sys.executable, "-P", "-c", COMPILED], cwd=folder, capture_output=True, text=True)
    assert (done.returncode, traces(folder)) == (0, set()), done.stderr
