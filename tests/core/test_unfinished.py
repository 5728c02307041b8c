"""Files that a writer did not finish: removed on request, recognised after a kill, kept where they are another's."""

import errno
import os
import signal
import subprocess
import sys
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from unittest.mock import Mock

import pytest

from commands import wait_until
from insonify import operating_system
from insonify.errors import FileWarning
from insonify.io import atomic
from insonify.io.atomic import clear_ended, is_leased, replacing, unfinished_folder

WRITE = """
import os, sys, time
from pathlib import Path
if len(sys.argv) > 2:
    os.getpid = lambda: int(sys.argv[2])
from insonify.io.atomic import replacing
with replacing(Path(sys.argv[1])) as beside:
    if beside.suffix == ".zarr":
        beside.mkdir()
        beside = beside / "zarr.json"
    beside.write_text("half")
    print("writing", flush=True)
    sys.stdin.readline()
"""


def write_new(path) -> None:
    """Write a file in this process."""
    with replacing(path) as beside:
        beside.write_text("new")


def writer(path, *words: str, before: tuple[str, ...] = (), **options) -> subprocess.Popen:
    """Start a process that writes a file until it gets a line; returns while it writes."""
    pipes = dict.fromkeys(("stdin", "stdout", "stderr"), subprocess.PIPE)
    process = subprocess.Popen([*before, sys.executable, "-c", WRITE, str(path), *words], **pipes, **options)
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
    usual = signal.signal(number, default)
    with pytest.raises((SystemExit, KeyboardInterrupt)), replacing(path):
        signal.raise_signal(number)
    assert signal.signal(number, usual) is default
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
    write_new(path)
    assert list(tmp_path.iterdir()) == [path]
    assert path.read_text() == "new"


def test_what_is_left_of_other_files_stays(tmp_path):
    for name in ("record.npz", "record2.nc", "other.nc"):
        end(writer(tmp_path / name), signal.SIGKILL)
    write_new(tmp_path / "record.nc")
    assert len(list(tmp_path.iterdir())) == 4


SWAP = """
import os, signal, sys
from pathlib import Path
from insonify.io.atomic import replacing
final = Path(sys.argv[1])
rename = Path.replace
def replace(self, target):
    if self.name == "new.zarr" and sys.argv[2] == "False":
        os.kill(os.getpid(), signal.SIGKILL)
    rename(self, target)
    if self.name == "new.zarr":
        os.kill(os.getpid(), signal.SIGKILL)
Path.replace = replace
with replacing(final) as beside:
    beside.mkdir()
"""


@pytest.mark.parametrize("complete", [False, True])
def test_a_folder_that_was_being_replaced_is_put_back(tmp_path, complete):
    final = tmp_path / "record.zarr"
    final.mkdir()
    (final / "old").touch()
    killed = subprocess.run([sys.executable, "-c", SWAP, str(final), str(complete)], check=False)
    assert killed.returncode == -signal.SIGKILL
    assert final.exists() == complete
    with pytest.raises(KeyboardInterrupt), replacing(final):
        raise KeyboardInterrupt
    assert [file.name for file in sorted(tmp_path.rglob("*"))] == ["record.zarr", *(() if complete else ("old",))]


def test_another_writer_is_told_of_and_the_last_to_finish_wins(tmp_path):
    path = tmp_path / "record.nc"
    other = writer(path)
    told = rf"record\.nc: process {other.pid} is writing it as well; the last to finish"
    with pytest.warns(FileWarning, match=told):
        write_new(path)
    assert path.read_text() == "new"
    end(other, signal.SIGTERM)
    assert path.read_text() == "new"
    assert list(tmp_path.iterdir()) == [path]


NAMESPACE = ("unshare", "--pid", "--fork", "--kill-child")


@pytest.mark.parametrize("elsewhere", ["number", "namespace"])
def test_a_writer_in_another_container_goes_on(tmp_path, elsewhere):
    """Its number is that of no process here."""
    path = tmp_path / "record.nc"
    if elsewhere == "number":
        other = writer(path, "999999999")
    elif subprocess.run([*NAMESPACE, "true"], capture_output=True, check=False).returncode:
        pytest.skip("a namespace of processes is made by root alone")
    else:
        other = writer(path, before=NAMESPACE)
    clear_ended(tmp_path)
    number = 999999999 if elsewhere == "number" else 1
    with pytest.warns(FileWarning, match=f"process {number} is writing it as well"), replacing(path) as beside:
        beside.write_text("mine")
    _, complaint = other.communicate(b"\n", timeout=120)
    assert (other.returncode, complaint) == (0, b"")
    assert path.read_text() == "half"
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.filterwarnings("ignore::insonify.errors.FileWarning")
def test_two_writers_of_one_host_and_number_have_a_folder_each(tmp_path):
    path = tmp_path / "record.nc"
    with unfinished_folder(path) as one, unfinished_folder(path) as other:
        assert one != other
        assert is_leased(one)
        assert is_leased(other)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("foreign", ["kernel", "locks"])
def test_where_locks_prove_nothing_a_file_is_kept_until_its_writer_is_silent(tmp_path, monkeypatch, foreign):
    path = tmp_path / "record.nc"
    if foreign == "locks":
        monkeypatch.setattr(atomic, "lock_file", lambda *words, **options: None)
    end(writer(path), signal.SIGKILL)
    (left,) = tmp_path.iterdir()
    if foreign == "kernel":
        monkeypatch.setattr(atomic, "kernel", lambda: "another")
    monkeypatch.setattr(atomic.platform, "node", lambda: "ashore")
    with pytest.warns(FileWarning, match=r"process \d+ of \w+ is writing it as well"):
        write_new(path)
    assert left.exists()
    assert path.read_text() == "new"
    long_ago = time.time() - atomic.SILENT - 1.0
    os.utime(left / atomic.LEASE, (long_ago, long_ago))
    clear_ended(tmp_path)
    assert list(tmp_path.iterdir()) == [path]


def test_a_writer_at_work_renews_its_lease(tmp_path, monkeypatch):
    monkeypatch.setattr(atomic, "BEAT", 0.02)
    monkeypatch.setattr(atomic, "lock_file", lambda *words, **options: None)
    with unfinished_folder(tmp_path / "record.nc") as folder:
        os.utime(folder / atomic.LEASE, (0.0, 0.0))
        wait_until(lambda: is_leased(folder))


def test_a_disk_without_locks_is_none_that_refuses(tmp_path, monkeypatch):
    refused = OSError(errno.ENOLCK, os.strerror(errno.ENOLCK))
    monkeypatch.setattr(operating_system.fcntl, "flock", Mock(side_effect=refused))
    with unfinished_folder(tmp_path / "record.nc") as folder:
        assert (folder / atomic.LEASE).read_text() == atomic.UNLOCKED
        assert is_leased(folder)


@pytest.mark.parametrize("age", [0.0, 2.0 * atomic.SILENT])
def test_a_file_that_an_earlier_version_left_goes_when_it_is_old(tmp_path, age):
    left = tmp_path / ".record.unfinished-host-123-0.nc"
    left.write_text("half")
    os.utime(left, (time.time() - age,) * 2)
    clear_ended(tmp_path)
    assert left.exists() == (age == 0.0)


def test_what_another_user_left_is_told_of_and_kept(tmp_path, monkeypatch):
    path = tmp_path / "record.nc"
    end(writer(path), signal.SIGKILL)
    (left,) = tmp_path.iterdir()
    monkeypatch.setattr(atomic.os, "getuid", lambda: left.stat().st_uid + 1)
    with pytest.warns(FileWarning, match=r"beside it was left by another user; remove it if it is stale"):
        write_new(path)
    assert left.exists()
    assert path.read_text() == "new"


@pytest.mark.filterwarnings("ignore::insonify.errors.FileWarning")
def test_threads_that_write_one_file_have_a_temporary_file_each(tmp_path):
    path, meeting = tmp_path / "record.nc", threading.Barrier(4)

    def write(text: str) -> None:
        with replacing(path) as beside:
            beside.write_text(text)
            meeting.wait()

    texts = [str(number) * 1000 for number in range(4)]
    with ThreadPoolExecutor(4) as pool:
        list(pool.map(write, texts))
    assert path.read_text() in texts
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize(("mode", "owner", "followed"), [
    (0o1777, 1234, False), (0o777, 1234, False), (0o755, 1234, True), (0o1777, 0, True), (0o1777, 4321, True),
])  # fmt: skip
def test_a_link_of_a_stranger_in_a_shared_folder_is_not_followed(tmp_path, mode, owner, followed):
    if os.getuid():
        pytest.skip("links are given to others by root alone")
    shared, mine = tmp_path / "shared", tmp_path / "mine.nc"
    shared.mkdir()
    mine.write_text("old")
    links = shared / "first.nc", shared / "record.nc"
    links[0].symlink_to(mine)
    links[1].symlink_to("first.nc")
    os.lchown(links[0], owner, owner)
    os.chown(shared, 4321, 4321)
    shared.chmod(mode)
    if followed:
        write_new(links[1])
    else:
        with pytest.raises(PermissionError, match="link that another user has put into a shared folder") as refusal:
            write_new(links[1])
        assert refusal.value.filename == str(links[1])
    assert mine.read_text() == ("new" if followed else "old")
    assert sorted(shared.iterdir()) == [*links]
    links[0].unlink()
    links[0].symlink_to("record.nc")
    with pytest.raises(OSError, match="symbolic links"):
        write_new(links[0])


def test_a_pipe_in_place_of_a_lease_holds_nobody_up(tmp_path):
    left = tmp_path / ".record.unfinished-host-1-2.nc"
    left.mkdir()
    os.mkfifo(left / atomic.LEASE)
    with pytest.warns(FileWarning, match="is writing it as well"):
        write_new(tmp_path / "record.nc")
    assert (tmp_path / "record.nc").read_text() == "new"


def test_a_name_that_is_too_long_is_refused_before_the_work(tmp_path):
    with pytest.raises(OSError, match="File name too long"), replacing(tmp_path / ("x" * 300 + ".nc")):
        pytest.fail("the work has begun")
    write_new(tmp_path / ("x" * 252 + ".nc"))
    assert len(list(tmp_path.iterdir())) == 1
