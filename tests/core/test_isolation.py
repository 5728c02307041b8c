"""Readers in a process of their own: what they return, and what becomes of crashes, loops and allocations."""

import itertools
import multiprocessing
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from unittest.mock import Mock

import numpy as np
import pytest

from insonify import child_process
from insonify.errors import SceneError
from insonify.io import isolation
from insonify.io.file_access import FileFault
from insonify.io.isolation import run_isolated


def give(path: str) -> dict[str, object]:
    return {"path": path, "process": os.getpid(), "rows": np.arange(12.0).reshape(3, 4), "none": np.zeros((0, 2))}


def import_common(path: str) -> list[str]:
    return [str(import_module(name).__file__) for name in HOSTILE]


def crash(path: str) -> None:
    os.abort()


def loop(path: str) -> None:
    while True:
        pass


def chatter(path: str) -> int:
    os.write(1, b"on standard output")
    os.write(2, b"on standard error")
    print("and so on")  # noqa: T201
    return 3


def allocate(path: str) -> int:
    return len(np.ones(2**28))  # 2 GB


def refuse(path: str) -> None:
    raise SceneError("it is refused; mend it")


def find_fault(path: str) -> None:
    raise FileFault("is odd", "even it")


def fail(path: str) -> None:
    raise KeyError("a name")


HOSTILE = ("json", "pickle", "queue", "threading")
WITH_THIS_MODULE = os.environ | {"PYTHONPATH": str(Path(__file__).parent)}


@pytest.fixture
def file(tmp_path: Path) -> str:
    (tmp_path / "file").write_bytes(b"content")
    return str(tmp_path / "file")


def test_what_a_reader_returns_comes_back_and_nothing_that_it_prints_reaches_the_terminal(file, monkeypatch, capfd):
    assert run_isolated(chatter, file) == 3
    assert capfd.readouterr() == ("", "")
    monkeypatch.chdir(Path(file).parent)
    found = run_isolated(give, "file")
    assert found["path"] == file
    assert found["process"] != os.getpid()
    np.testing.assert_array_equal(found["rows"], np.arange(12.0).reshape(3, 4))
    assert found["none"].shape == (0, 2)
    found["rows"][0] = 1.0  # the caller's own


def test_modules_of_the_current_folder_are_not_imported(file, monkeypatch):
    folder = Path(file).parent
    for name in HOSTILE:
        (folder / f"{name}.py").write_text("raise SystemExit")
    isolation.stop()
    monkeypatch.chdir(folder)
    monkeypatch.setenv("PYTHONPATH", ".")
    monkeypatch.setattr(sys, "path", ["", str(folder), *sys.path])
    assert not any(Path(found).is_relative_to(folder) for found in run_isolated(import_common, file))


def doze(path: str) -> int:
    time.sleep(1.5)
    return 4


def test_a_reader_that_loops_or_waits_is_ended_but_time_stands_still_while_it_waits_for_a_processor(file, monkeypatch):
    assert run_isolated(chatter, file) == 3  # the process has started
    for reader, longest in ((loop, 1.0), (doze, 0.5)):
        began = time.perf_counter()
        with monkeypatch.context() as patched:
            patched.setattr(isolation, "LONGEST", longest)
            with pytest.raises(FileFault, match="takes longer than 1 s to read"):
                run_isolated(reader, file)
        took = time.perf_counter() - began
        assert took < longest * child_process.STARVED + 4.0  # where others keep the processors busy
        assert run_isolated(chatter, file) == 3  # another process, which may take long to start
    monkeypatch.setattr(isolation, "LONGEST", 0.5)
    monkeypatch.setattr(child_process, "STARVED", 60.0)
    monkeypatch.setattr(child_process, "processor_time", lambda process: (7.0, True))
    assert run_isolated(doze, file) == 4
    monkeypatch.setattr(child_process, "STARVED", 2.0)
    with pytest.raises(FileFault, match="takes longer than"):
        run_isolated(doze, file)


def keep_busy(path: str) -> None:
    """Loop in C, where no thread of Python gets a turn."""
    print(os.getpid(), file=open(f"{path}.process", "w"), flush=True)  # noqa: SIM115
    sum(itertools.repeat(0))


@pytest.mark.skipif(not hasattr(signal, "setitimer"), reason="the system has no such timer")
def test_a_loop_ends_when_the_program_is_killed(file):
    lines = (
        "import sys; from insonify.io import isolation; from test_isolation import keep_busy\n"
        "isolation.LONGEST = -4.5 / isolation.STARVED  # less than no time, but for the grace\n"
        "isolation.ChildProcess.receive_within = lambda self, seconds: self.receive()\n"
        "isolation.run_isolated(keep_busy, sys.argv[1])"
    )
    with subprocess.Popen([sys.executable, "-c", lines, file], env=WITH_THIS_MODULE) as program:
        told = Path(f"{file}.process")
        wait_until(lambda: told.exists() and told.read_text().endswith("\n"))
        program.kill()
    wait_until(lambda: not Path(f"/proc/{int(told.read_text())}").exists())


def wait_until(condition: Callable[[], bool]) -> None:
    limit = time.monotonic() + 120.0
    while not condition():
        assert time.monotonic() < limit
        time.sleep(0.02)


limited = pytest.mark.skipif(not Path("/proc/self/status").exists(), reason="the system has no limit for memory")


@pytest.mark.parametrize(
    ("reader", "error", "words"),
    [
        (crash, FileFault, "the library that reads it fails"),
        pytest.param(allocate, RuntimeError, "does not fit in memory", marks=limited),  # by the size of the file
        (refuse, SceneError, "^it is refused; mend it$"),
        (find_fault, FileFault, r"^is odd; even it$"),  # with its remedy
        (fail, RuntimeError, "a name"),
    ],
)
def test_a_fault_comes_back_and_the_next_file_is_read(file, reader, error, words):
    with pytest.raises(error, match=words):
        run_isolated(reader, file)
    assert run_isolated(chatter, file) == 3


def test_a_process_that_is_interrupted_or_killed_is_started_anew(file, monkeypatch):
    run_isolated(chatter, file)
    process = isolation._child
    with monkeypatch.context() as patched:
        patched.setattr(child_process, "_exactly", Mock(side_effect=KeyboardInterrupt))
        with pytest.raises(KeyboardInterrupt):
            run_isolated(give, file)
    assert process.process.poll() is not None
    assert run_isolated(chatter, file) == 3
    for is_usable in (child_process.ChildProcess.is_usable, lambda _: True):  # before it is asked, or while it is
        isolation._child.process.kill()
        isolation._child.process.wait()
        monkeypatch.setattr(child_process.ChildProcess, "is_usable", is_usable)
        assert run_isolated(chatter, file) == 3


def ask(file: str, answers: object) -> None:
    answers.put(run_isolated(give, file)["process"])


@pytest.mark.filterwarnings("ignore:.*multi-threaded.*:DeprecationWarning")
@pytest.mark.parametrize("method", ["fork", "spawn"])
def test_other_processes_have_one_of_their_own(file, method):
    mine = run_isolated(give, file)["process"]
    context = multiprocessing.get_context(method)
    answers = context.SimpleQueue()
    child = context.Process(target=ask, args=(file, answers))
    child.start()
    theirs = answers.get()
    child.join()
    assert child.exitcode == 0
    assert theirs != mine
    assert run_isolated(give, file)["process"] == mine


def test_an_idle_process_ends_and_a_program_that_ends_leaves_none(file):
    lines = "from insonify.io import isolation; isolation.IDLE = 0.2; isolation.main()"
    with subprocess.Popen([sys.executable, "-c", lines], stdin=subprocess.PIPE, stdout=subprocess.PIPE) as idle:
        assert idle.wait(timeout=120) == 0
    lines = (
        "import sys; from insonify.io.isolation import run_isolated; from test_isolation import give\n"
        "print(run_isolated(give, sys.argv[1])['process'])"
    )
    command = [sys.executable, "-W", "error", "-c", lines, file]
    done = subprocess.run(command, capture_output=True, text=True, check=True, env=WITH_THIS_MODULE)
    assert done.stderr == ""
    assert not Path(f"/proc/{int(done.stdout)}").exists()
