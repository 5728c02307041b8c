"""How long the first ping takes, from the command on; run with `pytest -m bench -s tests/bench/test_start.py`."""

from __future__ import annotations

import subprocess
import sys
from statistics import median
from time import monotonic

import pytest

pytestmark = pytest.mark.bench
FIRST_PING = """
import time
from insonify.__main__ import load
load()  # all that the command loads before it knows what is wanted
import numpy as np
from insonify.scene import load_scene
from insonify.simulation import prepare
prepare(load_scene("default")).intensity(np.arange(1))
print(time.monotonic())
"""


def test_from_the_command_to_the_first_ping(capsys: pytest.CaptureFixture[str]) -> None:
    pinged, ended = [], []
    for _ in range(8):
        start = monotonic()
        done = subprocess.run([sys.executable, "-c", FIRST_PING], check=True, capture_output=True, text=True)
        pinged.append(float(done.stdout) - start)
        ended.append(monotonic() - start)
    with capsys.disabled():
        # The first may still compile.
        sys.stdout.write(
            f"\nfrom the command to the first ping: {median(pinged[1:]):.2f} s (best {min(pinged):.2f} s), "
            f"to its end: {median(ended[1:]):.2f} s (best {min(ended):.2f} s)"
        )
