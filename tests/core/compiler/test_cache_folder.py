"""Machine code is run as it is: nobody else may put it where it is read."""

import os
import pickle
import subprocess
import sys
from pathlib import Path

import numba
import pytest

USE = """
import sys
import numpy as np
from insonify.kernels.common.hashing import splitmix64
print(splitmix64(np.uint64(1234567)), sum(splitmix64.entry.stats.cache_hits.values()))
"""
VALUE = "6457827717110365317"  # first output of Vigna's reference implementation from that state
pytestmark = pytest.mark.skipif(
    bool(numba.config.DISABLE_JIT) or not hasattr(os, "getuid"), reason="nothing is compiled, or files have no owner"
)


class Poison:
    """What leaves a trace when it is unpickled."""

    def __init__(self, trace: Path) -> None:
        self.trace = trace

    def __reduce__(self) -> tuple[object, ...]:
        return Path.touch, (self.trace,)


def use_kernel(cache: Path | None, **options: object) -> tuple[int, str]:
    """Call a kernel in a new process; how often its machine code was read from disk, and what was warned of."""
    environment = os.environ | ({"NUMBA_CACHE_DIR": str(cache)} if cache else {})
    done = subprocess.run(
        [sys.executable, "-c", USE], env=environment, capture_output=True, check=True, text=True, **options
    )
    value, hits = done.stdout.split()
    assert value == VALUE
    return int(hits), done.stderr


@pytest.fixture
def cache(tmp_path: Path) -> Path:
    """A folder with the machine code of the kernel."""
    assert use_kernel(tmp_path / "cache") == (0, "")
    assert use_kernel(tmp_path / "cache") == (1, "")
    return tmp_path / "cache"


def test_the_folder_is_made_for_this_user_alone(cache: Path) -> None:
    assert (cache / "insonify" / "kernels").stat().st_mode & 0o777 == 0o700


@pytest.mark.parametrize("place", ["insonify/kernels", "insonify", ""])
def test_a_folder_to_which_others_may_write_is_not_used(cache: Path, place: str) -> None:
    (cache / place).chmod(0o777)
    hits, warned = use_kernel(cache)
    assert hits == 0
    assert f"other users may write to {cache / place}" in warned
    assert warned.count("neither read") == 1


@pytest.mark.skipif(not hasattr(os, "getuid") or os.getuid() != 0, reason="only root gives folders away")
@pytest.mark.parametrize("place", ["insonify/kernels", ""])
def test_a_folder_of_another_user_is_not_used_even_by_root(cache: Path, place: str) -> None:
    os.chown(cache / place, 12345, 12345)
    hits, warned = use_kernel(cache)
    assert hits == 0
    assert f"{cache / place} belongs to another user" in warned


def test_nothing_is_read_below_the_current_folder_where_the_user_has_no_home(tmp_path: Path) -> None:
    strange = "import os, platformdirs\nplatformdirs.user_cache_dir = lambda name: f'~/.cache/{name}'\n"
    environment = {name: value for name, value in os.environ.items() if name != "NUMBA_CACHE_DIR"}
    command = [sys.executable, "-c", strange + USE]
    done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, check=True, text=True)
    assert done.stdout.split() == [VALUE, "0"]
    assert "this user has no home folder" in done.stderr
    assert not list(tmp_path.iterdir())


def test_an_index_is_never_unpickled(cache: Path) -> None:
    for index in cache.rglob("*.nbi"):
        index.write_bytes(pickle.dumps(numba.__version__) + pickle.dumps(("", Poison(cache / "trace"))))
    assert use_kernel(cache) == (0, "")
    assert not (cache / "trace").exists()


def test_code_that_is_not_what_its_name_says_is_never_unpickled(cache: Path) -> None:
    for code in cache.rglob("*.nbc"):
        code.write_bytes(pickle.dumps(Poison(cache / "trace")))
    assert use_kernel(cache) == (0, "")
    assert not (cache / "trace").exists()


def test_a_setting_of_numba_in_the_current_folder_moves_nothing(tmp_path: Path) -> None:
    (tmp_path / ".numba_config.yaml").write_text("cache_dir: strange\n")
    use_kernel(None, cwd=tmp_path)
    assert not (tmp_path / "strange").exists()
