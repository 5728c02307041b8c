"""Progress of commands: lines for a program that started them, a bar on a terminal, nothing otherwise."""

import contextlib
import json
import os
import pty
import re
import signal
import subprocess
import sys
import termios
import time
from pathlib import Path
from typing import Any

import pytest

from commands import LONG, PATIENCE, run_python
from insonify.progress import VARIABLE, report_progress, report_waiting


def lines_of(text: str) -> list[dict[str, Any]]:
    return [json.loads(line) for line in text.splitlines() if line.startswith("{")]


def test_lines_begin_with_nothing_end_with_all_and_never_go_back(monkeypatch, capsys) -> None:
    monkeypatch.setenv(VARIABLE, "lines")
    with report_progress("tracing", 5, "ping") as progress:
        for _ in range(5):
            progress.advance(1)
    lines = lines_of(capsys.readouterr().err)
    assert lines[0] == {"doing": "tracing", "done": 0.0, "total": 5, "unit": "ping"}
    assert lines[-1]["done"] == 5
    with report_progress("measuring", 1.0) as progress:
        progress.reach(0.7)
        progress.reach(0.4)
        progress.say("drawing")
    last = lines_of(capsys.readouterr().err)[-1]
    assert last == {"doing": "drawing", "done": 0.7, "total": 1.0, "unit": ""}
    with report_waiting("simulating"):
        pass
    assert lines_of(capsys.readouterr().err) == [{"doing": "simulating", "done": 0.0, "total": 1.0, "unit": ""}]
    monkeypatch.delenv(VARIABLE)  # nobody looks
    with report_progress("tracing", 2, "ping") as progress:
        progress.advance(2)
    assert capsys.readouterr().err == ""


def test_a_command_tells_the_program_that_started_it(tmp_path: Path) -> None:
    """The whole command: every ping is counted, and the record is the same as without."""
    words = ["-m", "insonify", "render", "figure-4a", "--set", "track.pings=96", "-o"]
    code, _, told = run_python(*words, str(tmp_path / "told.npz"), env=os.environ | {VARIABLE: "lines"})
    assert code == 0
    counted = [line for line in lines_of(told) if line["unit"] == "ping"]
    assert counted[-1]["done"] == counted[-1]["total"] == 96
    assert run_python(*words, str(tmp_path / "silent.npz"))[2] == ""
    assert (tmp_path / "told.npz").read_bytes() == (tmp_path / "silent.npz").read_bytes()


def on_a_terminal(code: str) -> str:
    """Return what a program writes to a terminal of 80 columns."""
    controller, terminal = pty.openpty()
    termios.tcsetwinsize(controller, (24, 80))
    with subprocess.Popen([sys.executable, "-c", code], stdout=terminal, stderr=terminal) as program:
        os.close(terminal)
        written = b""
        with contextlib.suppress(OSError):  # the terminal is closed at the other end
            while more := os.read(controller, 4096):
                written += more
    os.close(controller)
    assert program.returncode == 0
    return written.decode()


WAIT = "import time; from insonify.progress import report_waiting\nwith report_waiting(): time.sleep({})"


def test_a_terminal_is_told_what_takes_long_and_for_how_long() -> None:
    assert on_a_terminal(WAIT.format(0.1)) == ""
    began = time.time()
    told = on_a_terminal(WAIT.format(4.2))
    seconds = [int(found) for found in re.findall(r"preparing the bed and the plan: 00:(\d\d)", told)]
    assert len(set(seconds)) > 1
    assert seconds == sorted(seconds)
    assert 1 <= seconds[0] < seconds[-1] <= time.time() - began
    assert told.rpartition(f"00:{seconds[-1]:02d}")[2].strip() == ""  # it is wiped out


# A command whose bed takes an hour in C, on another thread; it says when that has begun.
HOUR = f"""
import sys, time
import insonify.__main__ as process, insonify.simulation
def blocks(*arguments, **options):
    print("begun", flush=True)
    time.sleep({LONG})
    yield
insonify.simulation.simulate_record_blocks = blocks
sys.argv = ["insonify", "render", "default", "-o", sys.argv[1]]
process.run()
"""


@pytest.mark.parametrize("name", ["SIGINT", "SIGTERM"])
def test_what_takes_long_can_be_stopped(tmp_path: Path, name: str) -> None:
    number = getattr(signal, name)
    path = tmp_path / "record.nc"
    path.write_text("old")
    default = signal.default_int_handler if name == "SIGINT" else signal.SIG_DFL
    with subprocess.Popen(
        [sys.executable, "-c", HOUR, str(path)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
        preexec_fn=lambda: signal.signal(number, default),
    ) as command:  # fmt: skip
        assert command.stdout is not None
        assert command.stdout.readline() == "begun\n"
        time.sleep(0.5)  # it waits
        command.send_signal(number)
        told = command.communicate(timeout=PATIENCE)[1]
    assert (command.returncode, path.read_text()) == (128 + number, "old")
    assert told == ("insonify: interrupted; no file was touched\n" if name == "SIGINT" else "")
    assert list(tmp_path.iterdir()) == [path]
