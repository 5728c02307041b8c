"""What `other_systems` imitates, as modules of this checkout find it; run by `tests/core/test_other_systems.py`."""

import os
import signal
import sys
from contextlib import nullcontext
from pathlib import Path

import pytest

from insonify.io.isolation import run_isolated

WINDOWS = os.environ.get("INSONIFY_SYSTEM", "windows") == "windows"
POSIX = ("fork", "killpg", "getuid", "sysconf", "register_at_fork", "O_NONBLOCK")
NAMES = ("a:b", "who?", "con.txt", "Lpt1", "end.", "end ", "x" * 250)


def platform_of(path):
    return sys.platform


def test_names_and_modules_are_missing_and_child_processes_are_of_the_same_system():
    assert (sys.platform, os.name) == (("win32", "nt") if WINDOWS else ("darwin", "posix"))
    assert run_isolated(platform_of, __file__) == sys.platform
    assert not hasattr(os, "sched_getaffinity")
    assert {hasattr(os, name) for name in POSIX} == {not WINDOWS}
    assert hasattr(signal, "SIGKILL") == hasattr(signal, "pthread_sigmask") == (not WINDOWS)
    with pytest.raises(FileNotFoundError):
        Path("/proc/self/status").read_text(encoding="ascii")
    with pytest.raises(ModuleNotFoundError) if WINDOWS else nullcontext():
        import resource

    assert WINDOWS or resource.RLIMIT_DATA


def test_what_a_test_sets_is_taken_back(monkeypatch):
    before = sys.path
    with monkeypatch.context() as patched:
        patched.setattr(sys, "path", [])
        patched.setattr(os, "sched_getaffinity", lambda process: set(), raising=False)
        assert (sys.path, os.sched_getaffinity(0)) == ([], set())
    assert sys.path is before
    assert not hasattr(os, "sched_getaffinity")


@pytest.mark.parametrize("name", NAMES)
def test_names_are_refused(name, tmp_path):
    """On Windows; elsewhere all of them are names."""
    path, plain = tmp_path / name, tmp_path / "plain"
    plain.touch()
    for make in (path.touch, path.mkdir, lambda: plain.rename(path)):
        if WINDOWS:
            with pytest.raises(OSError, match=r"does not allow|characters"):
                make()
        else:
            make()
            path.rmdir() if path.is_dir() else path.unlink()


def test_the_case_of_letters_does_not_count(tmp_path):
    (tmp_path / "Name").touch()
    (tmp_path / "Name").touch()
    with pytest.raises(FileExistsError):
        (tmp_path / "name").touch()


@pytest.mark.skipif(not WINDOWS, reason="other systems rename open files")
def test_an_open_file_stays(tmp_path):
    one, other = tmp_path / "one", tmp_path / "other"
    one.touch()
    with other.open("w", encoding="utf-8"):
        for change in (lambda: one.replace(other), lambda: other.rename(tmp_path / "new"), other.unlink):
            with pytest.raises(PermissionError):
                change()
    one.replace(other)
    folder = tmp_path / "folder"
    folder.mkdir()
    with (folder / "file").open("w", encoding="utf-8"), pytest.raises(PermissionError):
        folder.rename(tmp_path / "renamed")
