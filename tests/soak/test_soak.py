"""The window used at random for two minutes: no exception, no message of Qt or OpenGL, no thread left."""

import subprocess
import sys
from pathlib import Path

import pytest

MINUTES = "2"


@pytest.mark.soak
@pytest.mark.parametrize("seed", ["1", "2"])
def test_a_window_used_at_random_keeps_in_order(seed):
    command = [sys.executable, "-X", "faulthandler", "-m", "soak", MINUTES, seed]
    done = subprocess.run(command, cwd=Path(__file__).parents[1], capture_output=True, text=True, timeout=900)
    print(done.stdout)  # noqa: T201
    assert done.returncode == 0, done.stdout + done.stderr
