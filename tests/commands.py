"""The command in tests: run where it must be refused, and other programs in a Python of their own."""

import os
import subprocess
import sys
import time
from collections.abc import Callable
from typing import Any

import pytest

from insonify.cli import main

PATIENCE = 300.0  # s, that only a fault takes longer than, however busy the cores are
LONG = 3600.0  # s, that nothing may wait for


def refused(capsys: pytest.CaptureFixture[str], *words: str) -> str:
    """Run a command that must be refused; return its one line."""
    try:
        code: object = main(words)
    except SystemExit as leaving:
        code = leaving.code
    written = capsys.readouterr()
    assert code == 2
    assert written.out == ""
    assert written.err.count("\n") == 1
    assert written.err.startswith("insonify")
    return written.err


def run_python(*words: str, **options: Any) -> tuple[int, str, str]:
    """Run Python in a process of its own; return its exit code and what it wrote to both streams."""
    done = subprocess.run([sys.executable, *words], capture_output=True, text=True, check=False, **options)
    return done.returncode, done.stdout, done.stderr


def output_of(*words: str, **environment: str) -> list[str]:
    """Run Python in a process of its own, with more environment variables; return the words that it writes."""
    command = [sys.executable, *words]
    done = subprocess.run(command, env=os.environ | environment, capture_output=True, check=True, text=True)
    return done.stdout.split()


def wait_until(condition: Callable[[], bool]) -> None:
    """Wait until a condition holds, which takes no longer than `PATIENCE`."""
    limit = time.monotonic() + PATIENCE
    while not condition():
        assert time.monotonic() < limit
        time.sleep(0.005)
