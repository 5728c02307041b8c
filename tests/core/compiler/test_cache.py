"""The cache of kernels' machine code: what names it, damaged files, and folders where nobody else may put code."""

import json
import os
import pickle
import re
import shutil
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numba
import platformdirs
import pytest

from commands import output_of, run_python
from insonify.compiler.cache import _CacheFile
from insonify.compiler.cache_folder import CacheWarning, cache_folder, is_private
from insonify.compiler.digests import source_digests

SOURCES = {
    "kernels/common/base.py": '"""Base."""\n\n\ndef base(x):\n    """Return x."""\n    return x\n',
    "kernels/sweep/user.py": "from insonify.kernels.common.base import base\n\n\ndef user(x):\n    return base(x)\n",
    "kernels/sweep/indirect.py": "from insonify.kernels.sweep import user\n\n\ndef far(x):\n    return user.user(x)\n",
    "kernels/rays/other.py": "import math\n\n\ndef other(x):\n    return math.sqrt(x)\n",
}
BASE, IMPORTERS = "kernels/common/base.py", {"kernels.sweep.user", "kernels.sweep.indirect"}

# One small kernel, compiled or read in a process of its own.
USE = """
import sys
import numba
import numpy as np
numba.__version__ = sys.argv[1]
from insonify.kernels.common.hashing import splitmix64
value = splitmix64(np.uint64(1234567))
print(value, sum(splitmix64.entry.stats.cache_hits.values()))
"""
interpreted = bool(numba.config.DISABLE_JIT)
compiled = pytest.mark.skipif(interpreted, reason="nothing is compiled")
owned = pytest.mark.skipif(
    interpreted or not hasattr(os, "getuid"), reason="nothing is compiled, or files have no owner"
)
VALUE = "6457827717110365317"  # first output of Vigna's reference implementation from that state


def digests_of(folder: Path, sources: dict[str, str]) -> dict[str, str]:
    for path, text in sources.items():
        (folder / path).parent.mkdir(parents=True, exist_ok=True)
        (folder / path).write_text(text)
    return source_digests(folder, folder / "kept")


@pytest.mark.parametrize(
    ("path", "text", "changed"),
    [
        # Docstrings, comments and line numbers leave digests alone.
        (BASE, '"""Another word."""\n\n\ndef base(x):\n    """Return the argument."""\n    return x\n', set()),
        (BASE, '"""Base."""\n\n\n# Comment.\n\n\ndef base(x):\n    """Return x."""\n    return x  # as it is\n', set()),
        (BASE, "def base(x):\n    return x\n", set()),
        # Code changes those of its module and of its importers.
        (BASE, "def base(x):\n    return x + 0.0\n", {"kernels.common.base"} | IMPORTERS),
        ("kernels/sweep/user.py", SOURCES["kernels/sweep/user.py"].replace("base(x)\n", "base(x) + 1\n"), IMPORTERS),
    ],
)
def test_digests_follow_the_code_of_a_module_and_of_what_it_imports(tmp_path, path, text, changed):
    before = digests_of(tmp_path, SOURCES)
    after = digests_of(tmp_path, SOURCES | {path: text})
    assert {name for name in before if before[name] != after[name]} == changed


def test_digests_are_the_same_wherever_sources_lie_and_where_they_cannot_be_kept_or_are_damaged(tmp_path):
    kept = digests_of(tmp_path, SOURCES)
    assert digests_of(tmp_path / "there", SOURCES) == kept
    (tmp_path / "a file").write_text("")
    assert source_digests(tmp_path, tmp_path / "a file" / "kept") == kept
    (state,) = (tmp_path / "kept").glob("*.json")
    wrong = [json.dumps(kept | {"kernels.common.base": value}) for value in (3, "/x")]
    for damaged in ("{", "{}", "[]", "null", *wrong):
        state.write_text(damaged)
        assert source_digests(tmp_path, tmp_path / "kept") == kept


def use_kernel(cache: Path, version: str = numba.__version__) -> tuple[int, str]:
    """Call a kernel in a new process; how often its machine code was read from disk, and what was warned of."""
    code, printed, told = run_python("-c", USE, version, env=os.environ | {"NUMBA_CACHE_DIR": str(cache)})
    assert code == 0, told
    value, hits = printed.split()
    assert value == VALUE
    return int(hits), told


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """A folder with the machine code of the kernel, which is read from a copy of the folder as well."""
    folder = tmp_path_factory.mktemp("made")
    assert use_kernel(folder / "cache") == (0, "")
    shutil.copytree(folder / "cache", folder / "copy")
    assert use_kernel(folder / "copy") == (1, "")
    return folder / "cache"


@pytest.fixture
def cache(made, tmp_path):
    """A folder of this test with the machine code of the kernel."""
    return Path(shutil.copytree(made, tmp_path / "cache"))


@compiled
def test_machine_code_is_compiled_anew_once_damaged_and_left_alone_by_other_versions_of_numba(cache):
    for file in cache.rglob("*.nbc"):
        content = bytearray(file.read_bytes())
        content[len(content) // 2] ^= 1
        file.write_bytes(content)
    assert use_kernel(cache) == (0, "")
    assert use_kernel(cache, "0.0.0") == (0, "")
    assert use_kernel(cache) == (1, "")


@compiled
def test_a_folder_that_cannot_be_written_is_done_without(tmp_path):
    (tmp_path / "a file").write_text("")
    assert use_kernel(tmp_path / "a file")[0] == 0
    assert os.listdir(tmp_path) == ["a file"]


@compiled
def test_of_processes_that_lack_the_same_kernel_one_compiles_it(tmp_path):
    with ThreadPoolExecutor() as pool:
        hits = [hit for hit, _ in pool.map(use_kernel, [tmp_path / "cache"] * 3)]
    assert sorted(hits) == [0, 1, 1]


def test_two_processes_that_compile_two_signatures_at_once_never_mix_them_up(tmp_path):
    one, other, later = (_CacheFile(str(tmp_path), "kernel", "stamp") for _ in range(3))
    save_data = one._save_data

    def interrupted(name, data):
        other._load_index = dict  # read before the first process wrote it
        other.save("second signature", "second code")
        save_data(name, data)

    one._save_data = interrupted
    one.save("first signature", "first code")
    assert later.load("first signature") in ("first code", None)
    assert later.load("second signature") in ("second code", None)


FIRST_PING = """
import sys
import numpy as np
from insonify.scene import load_scene
from insonify.simulation import prepare
prepare(load_scene("default")).intensity(np.arange(1))
print(*({"numba.np.arraymath", "scipy.linalg"} & set(sys.modules)))
"""


@compiled
def test_finished_code_is_loaded_without_what_compiles_it():
    # The first process may compile what no test has compiled before.
    assert output_of("-c", FIRST_PING) == [] or output_of("-c", FIRST_PING) == []


class Poison:
    """What leaves a trace when it is unpickled."""

    def __init__(self, trace: Path) -> None:
        self.trace = trace

    def __reduce__(self) -> tuple[object, ...]:
        return Path.touch, (self.trace,)


@owned
def test_the_folder_is_made_for_this_user_alone_and_not_used_where_others_may_write_to_it(cache):
    folder = cache / "insonify" / "kernels"
    assert folder.stat().st_mode & 0o777 == 0o700
    for place in (folder, folder.parent, cache):
        place.chmod(0o777)
        with pytest.warns(CacheWarning, match=f"other users may write to {re.escape(str(place))};"):
            assert not is_private(folder)
        place.chmod(0o700)
    assert is_private(folder)
    cache.chmod(0o777)
    hits, warned = use_kernel(cache)
    assert hits == 0
    assert warned.count("neither read") == 1


@owned
@pytest.mark.skipif(not hasattr(os, "getuid") or os.getuid() != 0, reason="only root gives folders away")
@pytest.mark.parametrize("place", ["insonify/kernels", ""])
def test_a_folder_of_another_user_is_not_used_even_by_root(tmp_path, place):
    folder = tmp_path / "insonify" / "kernels"
    folder.mkdir(parents=True)
    os.chown(tmp_path / place, 12345, 12345)
    with pytest.warns(CacheWarning, match=f"{re.escape(str(tmp_path / place))} belongs to another user"):
        assert not is_private(folder)


@owned
def test_nothing_is_kept_below_the_current_folder_where_the_user_has_no_home(tmp_path, monkeypatch):
    monkeypatch.delenv("NUMBA_CACHE_DIR", raising=False)
    monkeypatch.setattr(platformdirs, "user_cache_dir", lambda name: f"~/.cache/{name}")
    monkeypatch.chdir(tmp_path)
    with pytest.warns(CacheWarning, match="this user has no home folder"):
        assert not is_private(cache_folder())
    assert not list(tmp_path.iterdir())


@owned
@pytest.mark.parametrize("suffix", [".nbi", ".nbc"])
def test_neither_an_index_nor_code_that_is_not_what_its_name_says_is_unpickled(cache, suffix):
    poison = Poison(cache / "trace")
    index = pickle.dumps(numba.__version__) + pickle.dumps(("", poison))
    for file in cache.rglob(f"*{suffix}"):
        file.write_bytes(index if suffix == ".nbi" else pickle.dumps(poison))
    assert use_kernel(cache) == (0, "")
    assert not (cache / "trace").exists()
