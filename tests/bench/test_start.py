"""How long the first ping takes, from the command on; run with `pytest -m bench -s tests/bench/test_start.py`."""

from __future__ import annotations

import subprocess
import sys
from statistics import median
from time import perf_counter

import pytest

pytestmark = pytest.mark.bench
FIRST_PING = """
import numpy as np
from insonify.cli import main  # all that the command loads before it knows what is wanted
from insonify.scene import load_scene
from insonify.simulate import prepare
prepare(load_scene("default")).intensity(np.arange(1))
"""


def test_from_the_command_to_the_first_ping(capsys: pytest.CaptureFixture[str]) -> None:
    taken = []
    for _ in range(8):
        start = perf_counter()
        subprocess.run([sys.executable, "-c", FIRST_PING], check=True)
        taken.append(perf_counter() - start)
    with capsys.disabled():
        # The first may still compile.
        sys.stdout.write(f"\nfrom the command to the first ping: {median(taken[1:]):.2f} s (best {min(taken):.2f} s)")
