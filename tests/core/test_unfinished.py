"""Files that a writer did not finish: removed on request, recognised after a kill, kept where they are another's."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading

import pytest

from insonify.errors import FileWarning
from insonify.io import atomic
from insonify.io.atomic import FORMER, replacing, temporary_path

WRITE = """
import sys, time
from pathlib import Path
from insonify.io.atomic import replacing
with replacing(Path(sys.argv[1])) as beside:
    if beside.suffix == ".zarr":
        beside.mkdir()
        beside = beside / "zarr.json"
    beside.write_text("half")
    print("writing", flush=True)
    time.sleep(600)
"""


def writer(path, **options) -> subprocess.Popen:
    """Start a process that writes a file and does not finish; returns while it writes."""
    process = subprocess.Popen(
        [sys.executable, "-c", WRITE, str(path)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, **options
    )
    assert process.stdout.readline() == b"writing\n"
    return process


def end(process: subprocess.Popen, number: int) -> int:
    process.send_signal(number)
    process.communicate(timeout=120)
    return process.returncode


@pytest.mark.parametrize("name", ["SIGTERM", "SIGHUP", "SIGQUIT", "SIGINT"])
def test_a_request_to_end_leaves_the_old_file_and_nothing_else(tmp_path, name):
    path = tmp_path / "record.nc"
    path.write_text("old")
    number = getattr(signal, name)
    # A test run in the background of a shell ignores some of them, and its children would too.
    default = signal.default_int_handler if name == "SIGINT" else signal.SIG_DFL
    code = end(writer(path, preexec_fn=lambda: signal.signal(number, default)), number)
    assert code == (-signal.SIGINT if name == "SIGINT" else 128 + getattr(signal, name))
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]


SWALLOW = """
import os, signal, sys, time
from pathlib import Path
from insonify.io.atomic import replacing
with replacing(Path(sys.argv[1])) as beside:
    beside.write_text("half")
    try:
        os.kill(os.getpid(), signal.SIGTERM)
        time.sleep(600)
    except:
        pass
    time.sleep(600)
"""


def test_a_request_that_a_library_swallows_is_repeated(tmp_path):
    path = tmp_path / "record.nc"
    done = subprocess.run([sys.executable, "-c", SWALLOW, str(path)], timeout=120, check=False)
    assert done.returncode == 128 + signal.SIGTERM
    assert list(tmp_path.iterdir()) == []


def test_a_request_that_is_ignored_stays_ignored(tmp_path):
    process = writer(tmp_path / "record.nc", preexec_fn=lambda: signal.signal(signal.SIGHUP, signal.SIG_IGN))
    process.send_signal(signal.SIGHUP)
    with pytest.raises(subprocess.TimeoutExpired):
        process.wait(0.3)
    end(process, signal.SIGTERM)


@pytest.mark.parametrize("name", ["record.nc", "record.zarr", "r" * 250 + ".nc", "a.b.c.npz", "é ü [x] *.nc"])
def test_what_a_kill_leaves_says_what_it_is_and_goes_with_the_next_write(tmp_path, name):
    path = tmp_path / name
    assert end(writer(path), signal.SIGKILL) == -signal.SIGKILL
    (left,) = tmp_path.iterdir()
    assert left.name.startswith(f".{path.stem[:200]}")
    assert ".unfinished-" in left.name
    assert left.suffix == path.suffix
    with replacing(path) as beside:
        beside.write_text("new")
    assert list(tmp_path.iterdir()) == [path]
    assert path.read_text() == "new"


def test_what_is_left_of_other_files_stays(tmp_path):
    for name in ("record.npz", "record2.nc", "other.nc"):
        end(writer(tmp_path / name), signal.SIGKILL)
    with replacing(tmp_path / "record.nc") as beside:
        beside.write_text("new")
    assert len(list(tmp_path.iterdir())) == 4


@pytest.mark.parametrize("complete", [False, True])
def test_a_folder_that_was_being_replaced_is_put_back(tmp_path, complete):
    final = tmp_path / "record.zarr"
    former = temporary_path(final, FORMER)
    dead = subprocess.Popen([sys.executable, "-c", ""])
    dead.wait()
    former = former.with_name(former.name.replace(f"-{os.getpid()}-", f"-{dead.pid}-"))
    former.mkdir()
    (former / "old").touch()
    if complete:
        final.mkdir()
    with pytest.raises(KeyboardInterrupt), replacing(final):
        raise KeyboardInterrupt
    assert [file.name for file in sorted(tmp_path.rglob("*"))] == ["record.zarr", *(() if complete else ("old",))]


def test_another_writer_is_told_of_and_the_last_to_finish_wins(tmp_path):
    path = tmp_path / "record.nc"
    other = writer(path)
    with (
        pytest.warns(FileWarning, match=rf"record\.nc: process {other.pid} is writing it as well; the last to finish"),
        replacing(path) as beside,
    ):
        beside.write_text("mine")
    assert path.read_text() == "mine"
    end(other, signal.SIGTERM)
    assert path.read_text() == "mine"
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize("foreign", ["host", "user"])
def test_what_others_left_is_told_of_and_kept(tmp_path, monkeypatch, foreign):
    path = tmp_path / "record.nc"
    end(writer(path), signal.SIGKILL)
    (left,) = tmp_path.iterdir()
    if foreign == "host":
        monkeypatch.setattr(atomic.platform, "node", lambda: "another")
    else:
        monkeypatch.setattr(atomic.os, "getuid", lambda: left.stat().st_uid + 1)
    with (
        pytest.warns(FileWarning, match=r"beside it was left by another user or machine; remove it if it is stale"),
        replacing(path) as beside,
    ):
        beside.write_text("new")
    assert left.exists()
    assert path.read_text() == "new"


@pytest.mark.filterwarnings("ignore::insonify.errors.FileWarning")
def test_threads_that_write_one_file_have_a_temporary_file_each(tmp_path):
    path, meeting = tmp_path / "record.nc", threading.Barrier(4)

    def write(text: str) -> None:
        with replacing(path) as beside:
            beside.write_text(text)
            meeting.wait()

    threads = [threading.Thread(target=write, args=(str(number) * 1000,)) for number in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert path.read_text() in {str(number) * 1000 for number in range(4)}
    assert list(tmp_path.iterdir()) == [path]


def test_a_name_that_is_too_long_is_refused_before_the_work(tmp_path):
    with pytest.raises(OSError, match="File name too long"), replacing(tmp_path / ("x" * 300 + ".nc")):
        pytest.fail("the work has begun")
    with replacing(tmp_path / ("x" * 252 + ".nc")) as beside:
        beside.write_text("new")
    assert len(list(tmp_path.iterdir())) == 1
