"""Faults of the machine: full disks, two writers, no home, locked caches, odd clocks; what is promised of each."""

import errno
import os
import subprocess
import sys
import time
from pathlib import Path
from unittest.mock import Mock

import numpy as np
import pytest

from commands import run_python
from insonify import cli
from insonify.io.records import read_record
from small_sets import contents

SMALL = ("pipe-span", "--set", "track.pings=6", "--set", "sonar.bins=2000")
OUTPUTS = [".npz", ".nc", ".zarr", ".xtf", ".png"]


def render(path: Path, *more: str) -> int:
    return cli.main(["render", *SMALL, *more, "-o", str(path)])


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A record of each format."""
    folder = tmp_path_factory.mktemp("whole")
    for suffix in OUTPUTS:
        assert render(folder / f"record{suffix}", "--threads", "2") == 0
    return folder


# Every format at one go, in a process of its own; prints exit codes.
EACH = """
import sys
from insonify.__main__ import main
source, *paths = sys.argv[1:]
codes = []
for path in paths:
    sys.argv[1:] = ["mosaic" if path.endswith(".tif") else "render", source, "-o", path]
    codes.append(main())
print(codes)
"""
LIMITED = "import resource; resource.setrlimit(resource.RLIMIT_FSIZE, (4000, resource.RLIM_INFINITY))\n"


def test_a_file_that_may_not_grow_leaves_the_old_ones(tmp_path, whole):
    for suffix in OUTPUTS[:2]:
        (tmp_path / f"record{suffix}").write_text("old")
    paths = [str(tmp_path / f"record{suffix}") for suffix in OUTPUTS]
    # Bytecode cut short would stay and break imports; that of the process that reads files is complete after one file.
    read_record(whole / "record.nc")
    environment = os.environ | {"PYTHONDONTWRITEBYTECODE": "1"}
    _, codes, told = run_python("-c", LIMITED + EACH, str(whole / "record.nc"), *paths, env=environment)
    assert codes.splitlines()[-1] == str([2] * len(OUTPUTS)), told
    for line, path in zip(told.splitlines(), paths, strict=True):
        assert line.startswith(f"insonify: {path}: ")
        assert line.endswith("; check the path, its permissions and the disk")
    assert sorted(file.name for file in tmp_path.iterdir()) == ["record.nc", "record.npz"]
    assert {file.read_text() for file in tmp_path.iterdir()} == {"old"}


@pytest.fixture
def small_disk(tmp_path: Path):
    """A disk of 8 kB, where the tests may mount one."""
    disk = tmp_path / "disk"
    disk.mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", "size=8k", "none", str(disk)]
    if sys.platform != "linux" or subprocess.run(mount, capture_output=True, check=False).returncode != 0:
        pytest.skip("no disk can be mounted here")
    yield disk
    # HDF5 keeps a file open that it could not write to its end.
    subprocess.run(["umount", "--lazy", str(disk)], check=True)


@pytest.mark.parametrize("suffix", OUTPUTS)
def test_a_full_disk_leaves_the_old_file(small_disk, whole, suffix, capsys):
    path = small_disk / f"record{suffix}"
    path.mkdir() if suffix == ".zarr" else path.write_text("old")
    before = contents(path)
    assert cli.main(["render", str(whole / "record.nc"), "-o", str(path)]) == 2
    told = capsys.readouterr().err
    assert told == f"insonify: {path}: No space left on device; check the path, its permissions and the disk\n"
    assert contents(path) == before
    assert [file.name for file in small_disk.iterdir()] == [path.name]


@pytest.mark.parametrize("suffix", OUTPUTS)
def test_a_repeated_command_writes_the_same_bits(tmp_path, whole, suffix, monkeypatch):
    monkeypatch.setattr(time, "time", lambda: 0.0)  # a clock in the past
    assert render(tmp_path / f"record{suffix}", "--threads", "1") == 0
    assert contents(tmp_path / f"record{suffix}") == contents(whole / f"record{suffix}")


@pytest.mark.parametrize("words", ["render", "compare whole/record.nc", "mosaic whole/record.nc", "light", "relief"])
def test_nothing_that_a_command_reads_is_written_over(tmp_path, whole, words, capsys, monkeypatch):
    """A record by its name or by a link; a file that the scene names."""
    suffix = {"render": ".xtf", "mosaic": ".tif"}.get(words.split()[0], ".png")
    path = tmp_path / f"read{suffix}"
    path.write_text("as it was")
    (tmp_path / "whole").symlink_to(whole)
    scene = 'seabed.material = { kind = "image", path = "read.png", of = ["silt", "rock"] }\n'
    (tmp_path / "scene.toml").write_text(scene)
    os.link(path, tmp_path / f"same{suffix}")
    monkeypatch.chdir(tmp_path)
    read = "scene.toml" if words in ("light", "relief") else path.name
    assert cli.main([*words.split(), read, "-o", f"same{suffix}"]) == 2
    assert capsys.readouterr().err.endswith("is also an input of this command; give another name\n")
    assert path.read_text() == "as it was"


@pytest.mark.parametrize("suffix", OUTPUTS)
@pytest.mark.parametrize("target", ["scene.toml", "loop"])
def test_a_link_is_followed_only_to_a_file_of_its_own_kind(tmp_path, capsys, suffix, target):
    (tmp_path / "scene.toml").write_text("seed = 1\n")
    link = tmp_path / f"record{suffix}"
    link.symlink_to(link.name if target == "loop" else target)
    assert cli.main(["render", str(tmp_path / "scene.toml"), "-o", str(link)]) == 2
    assert f"which is no {suffix}; give another name\n" in capsys.readouterr().err
    assert (tmp_path / "scene.toml").read_text() == "seed = 1\n"
    assert link.is_symlink()


@pytest.mark.skipif(sys.platform != "linux", reason="names are text there")
def test_names_that_are_no_text_are_written_or_refused_and_read(tmp_path, whole):
    paths = [tmp_path / f"\udcff{suffix}" for suffix in (*OUTPUTS, ".tif")]
    written = [path for path in paths if path.suffix not in (".nc", ".tif")]
    options = {"env": {"PYTHONIOENCODING": "utf-8:strict"}, "encoding": "utf-8"}
    _, printed, refused = run_python("-c", EACH, str(whole / "record.nc"), *map(str, paths), **options)
    *told, codes = printed.splitlines()
    assert codes == str([0 if path in written else 2 for path in paths]), refused
    assert len(told) == len(written)
    assert all(r"\udcff" in line for line in told)
    for line, suffix in zip(refused.splitlines(), (".nc", ".tif"), strict=True):
        assert rf"\udcff{suffix}" in line
        assert "needs a path in UTF-8; check the path" in line
    assert set(tmp_path.iterdir()) == set(written)
    recording = tmp_path / "\udcff.xtf"
    for suffix in (".nc", ".png"):
        assert cli.main(["render", str(recording), "-o", str(tmp_path / f"record{suffix}")]) == 0
    assert read_record(recording).title == "\ufffd.xtf"


def test_trouble_of_the_disk_and_of_long_names_is_called_by_its_name(tmp_path, capsys, monkeypatch):
    for name in ("x" * 300 + ".nc", "x" * 300 + ".png", "é" * 150 + ".npz"):
        assert render(tmp_path / name) == 2
        told = capsys.readouterr().err
        assert "File name too long; check the path" in told
        assert told.count("\n") == 1
        assert list(tmp_path.iterdir()) == []
    path = tmp_path / "record.npz"
    path.write_text("old")
    for trouble in (errno.EROFS, errno.EDQUOT, errno.EACCES, errno.EIO):
        error = OSError(trouble, os.strerror(trouble), "a temporary file")
        monkeypatch.setattr(Path, "replace", Mock(side_effect=error))
        assert render(path) == 2
        expected = f"insonify: {path}: {os.strerror(trouble)}; check the path, its permissions and the disk\n"
        assert capsys.readouterr().err == expected
        assert path.read_text() == "old"
        assert list(tmp_path.iterdir()) == [path]


PLACES = {
    "no home": {},
    "a home that is not there": {"HOME": "/nonexistent", "XDG_CACHE_HOME": "/nonexistent/cache"},
    "a home that is a device": {"HOME": "/dev/null", "XDG_CACHE_HOME": "/dev/null"},
    "a cache that cannot be written": {"HOME": "/proc", "XDG_CACHE_HOME": "/proc/self"},
}


@pytest.mark.parametrize("place", PLACES)
def test_a_command_needs_no_home(tmp_path, place):
    words = ["-m", "insonify", "relief", "figure-2a", "-o", str(tmp_path / "bed.png")]
    assert run_python(*words, env=PLACES[place])[::2] == (0, "")
    assert (tmp_path / "bed.png").is_file()


@pytest.mark.parametrize(
    ("environment", "options"),
    [
        ({"LC_ALL": "C.UTF-8"}, ("-W", "error", "-O")),
        ({"LC_ALL": "C", "PYTHONCOERCECLOCALE": "0", "PYTHONUTF8": "0"}, ("-X", "dev")),
    ],
    ids=["warnings are errors, no assertions", "ASCII, development mode"],
)
def test_a_command_is_the_same_in_any_interpreter_and_language(tmp_path, whole, environment, options):
    path = tmp_path / "Lübeck ☃.npz"
    words = [*options, "-m", "insonify", "render", str(whole / "record.nc"), "-o", str(path)]
    assert run_python(*words, env=os.environ | environment, encoding="utf-8")[::2] == (0, "")
    np.testing.assert_array_equal(read_record(path).intensity, read_record(whole / "record.npz").intensity)
