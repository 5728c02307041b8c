"""Progress of commands: lines for a program that started them, a bar on a terminal, nothing otherwise."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from insonify.progress import VARIABLE, report_progress


def lines_of(text: str) -> list[dict[str, Any]]:
    return [json.loads(line) for line in text.splitlines() if line.startswith("{")]


def test_lines_begin_with_nothing_and_end_with_all(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv(VARIABLE, "lines")
    with report_progress("tracing", 5, "ping") as progress:
        for _ in range(5):
            progress.advance(1)
    lines = lines_of(capsys.readouterr().err)
    assert lines[0] == {"doing": "tracing", "done": 0.0, "total": 5, "unit": "ping"}
    assert lines[-1]["done"] == 5


def test_progress_never_goes_back(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setenv(VARIABLE, "lines")
    with report_progress("measuring", 1.0) as progress:
        progress.reach(0.7)
        progress.reach(0.4)
        progress.say("drawing")
    last = lines_of(capsys.readouterr().err)[-1]
    assert last == {"doing": "drawing", "done": 0.7, "total": 1.0, "unit": ""}


def test_nothing_is_said_where_nobody_looks(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.delenv(VARIABLE, raising=False)
    with report_progress("tracing", 2, "ping") as progress:
        progress.advance(2)
    assert capsys.readouterr().err == ""


def test_a_command_tells_the_program_that_started_it(tmp_path: Path) -> None:
    """The whole command: every ping is counted, and the record is the same as without."""
    run = [sys.executable, "-m", "insonify", "render", "figure-4a", "--set", "track.pings=96"]
    told = subprocess.run(
        [*run, "-o", tmp_path / "told.npz"], env=os.environ | {VARIABLE: "lines"}, capture_output=True, text=True
    )
    assert told.returncode == 0
    counted = [line for line in lines_of(told.stderr) if line["unit"] == "ping"]
    assert counted[-1]["done"] == counted[-1]["total"] == 96
    silent = subprocess.run([*run, "-o", tmp_path / "silent.npz"], capture_output=True, text=True)
    assert silent.stderr == ""
    assert (tmp_path / "told.npz").read_bytes() == (tmp_path / "silent.npz").read_bytes()
