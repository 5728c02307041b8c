"""The cache of kernels' machine code: what names it, and what happens to damaged files and unwritable folders."""

import json
import os
from pathlib import Path

import numba
import pytest

from commands import output_of
from insonify.compiler.cache import _CacheFile
from insonify.compiler.digests import source_digests

SOURCES = {
    "kernels/common/base.py": '"""Base."""\n\n\ndef base(x):\n    """Return x."""\n    return x\n',
    "kernels/sweep/user.py": "from insonify.kernels.common.base import base\n\n\ndef user(x):\n    return base(x)\n",
    "kernels/sweep/indirect.py": "from insonify.kernels.sweep import user\n\n\ndef far(x):\n    return user.user(x)\n",
    "kernels/rays/other.py": "import math\n\n\ndef other(x):\n    return math.sqrt(x)\n",
}
IMPORTERS = {"kernels.common.base", "kernels.sweep.user", "kernels.sweep.indirect"}

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
compiled = pytest.mark.skipif(bool(numba.config.DISABLE_JIT), reason="nothing is compiled")
VALUE = "6457827717110365317"  # first output of Vigna's reference implementation from that state


def digests_of(folder: Path, sources: dict[str, str]) -> dict[str, str]:
    for path, text in sources.items():
        (folder / path).parent.mkdir(parents=True, exist_ok=True)
        (folder / path).write_text(text)
    return source_digests(folder, folder / "kept")


@pytest.mark.parametrize(
    "text",
    [
        '"""Another word."""\n\n\ndef base(x):\n    """Return the argument."""\n    return x\n',
        '"""Base."""\n\n\n# A comment.\n\n\ndef base(x):\n    """Return x."""\n    return x  # as it is\n',
        "def base(x):\n    return x\n",
    ],
)
def test_docstrings_comments_and_line_numbers_leave_digests_alone(tmp_path: Path, text: str) -> None:
    assert digests_of(tmp_path, SOURCES) == digests_of(tmp_path, SOURCES | {"kernels/common/base.py": text})


def test_a_change_of_code_changes_digests_of_the_module_and_of_its_importers_only(tmp_path: Path) -> None:
    before = digests_of(tmp_path, SOURCES)
    after = digests_of(tmp_path, SOURCES | {"kernels/common/base.py": "def base(x):\n    return x + 0.0\n"})
    assert {name for name in before if before[name] != after[name]} == IMPORTERS


def test_a_change_of_an_importer_leaves_what_it_imports_alone(tmp_path: Path) -> None:
    before = digests_of(tmp_path, SOURCES)
    changed = SOURCES["kernels/sweep/user.py"].replace("base(x)\n", "base(x) + 1\n")
    after = digests_of(tmp_path, SOURCES | {"kernels/sweep/user.py": changed})
    assert {name for name in before if before[name] != after[name]} == {"kernels.sweep.user", "kernels.sweep.indirect"}


def test_digests_do_not_depend_on_where_the_sources_lie(tmp_path: Path) -> None:
    assert digests_of(tmp_path / "here", SOURCES) == digests_of(tmp_path / "there", SOURCES)


def test_digests_that_cannot_be_kept_are_computed_all_the_same(tmp_path: Path) -> None:
    kept = digests_of(tmp_path, SOURCES)
    (tmp_path / "a file").write_text("")
    assert source_digests(tmp_path, tmp_path / "a file" / "kept") == kept


def test_damaged_digests_are_computed_anew(tmp_path: Path) -> None:
    kept = digests_of(tmp_path, SOURCES)
    (state,) = (tmp_path / "kept").glob("*.json")
    others = [
        "{",
        "{}",
        "[]",
        "null",
        json.dumps(kept | {"kernels.common.base": 3}),
        json.dumps(kept | {"kernels.common.base": "/x"}),
    ]
    for damaged in others:
        state.write_text(damaged)
        assert source_digests(tmp_path, tmp_path / "kept") == kept


def use_kernel(cache: Path, version: str = numba.__version__) -> tuple[str, int]:
    """Return what the kernel gives in a new process, and how often its machine code was read from disk."""
    value, hits = output_of("-c", USE, version, NUMBA_CACHE_DIR=str(cache))
    return value, int(hits)


def damage_whole(content: bytes) -> bytes:
    return b"damaged"


def damage_a_bit(content: bytes) -> bytes:
    middle = len(content) // 2
    return content[:middle] + bytes([content[middle] ^ 1]) + content[middle + 1 :]


@compiled
def test_machine_code_is_read_from_disk_and_compiled_anew_once_damaged(tmp_path: Path) -> None:
    assert use_kernel(tmp_path) == (VALUE, 0)
    for files, damage in (("*.nb[ci]", damage_whole), ("*.nbc", damage_a_bit)):
        assert use_kernel(tmp_path) == (VALUE, 1)
        for file in tmp_path.rglob(files):
            file.write_bytes(damage(file.read_bytes()))
        assert use_kernel(tmp_path) == (VALUE, 0)
    assert use_kernel(tmp_path) == (VALUE, 1)


@compiled
def test_versions_of_numba_leave_the_machine_code_of_others_alone(tmp_path: Path) -> None:
    assert use_kernel(tmp_path) == (VALUE, 0)
    assert use_kernel(tmp_path, "0.0.0") == (VALUE, 0)
    assert use_kernel(tmp_path) == (VALUE, 1)
    assert use_kernel(tmp_path, "0.0.0") == (VALUE, 1)


@compiled
def test_a_folder_that_cannot_be_written_is_done_without(tmp_path: Path) -> None:
    (tmp_path / "a file").write_text("")
    assert use_kernel(tmp_path / "a file") == (VALUE, 0)
    assert os.listdir(tmp_path) == ["a file"]


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
def test_finished_code_is_loaded_without_what_compiles_it() -> None:
    output_of("-c", FIRST_PING)  # compiles what no test has compiled before
    assert output_of("-c", FIRST_PING) == []
