"""How long the first ping takes, from the command on, with kernels compiled before and with none.

Run with `pytest -m bench -s tests/bench/test_start.py`.
"""

import os
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


def test_from_the_command_to_the_first_ping(say):
    pinged, ended = [], []
    for _ in range(8):
        start = monotonic()
        done = subprocess.run([sys.executable, "-c", FIRST_PING], check=True, capture_output=True, text=True)
        pinged.append(float(done.stdout) - start)
        ended.append(monotonic() - start)
    # The first may still compile.
    say(
        f"from the command to the first ping: {median(pinged[1:]):.2f} s (best {min(pinged):.2f} s), "
        f"to its end: {median(ended[1:]):.2f} s (best {min(ended):.2f} s)"
    )


FIRST_RECORD = """
import os, sys, time
if hasattr(os, "sched_setaffinity"):
    os.sched_setaffinity(0, sorted(os.sched_getaffinity(0))[:2])
from numba.core import event
from insonify.__main__ import main
start = time.process_time()
with event.install_listener("numba:compile", event.RecordingListener()) as compiled:
    sys.argv = ["insonify", "render", "default", "-o", os.environ["PICTURE"]]
    main()
print(sum(entry.is_start for _, entry in compiled.buffer), time.process_time() - start)
"""


def test_first_record_from_an_empty_cache(tmp_path, say):
    environment = {name: value for name, value in os.environ.items() if name != "NUMBA_CACHE_DIR"}
    environment |= {"XDG_CACHE_HOME": str(tmp_path), "PICTURE": str(tmp_path / "first.png")}
    start = monotonic()
    command = [sys.executable, "-c", FIRST_RECORD]
    done = subprocess.run(command, env=environment, check=True, capture_output=True, text=True)
    functions, seconds = done.stdout.splitlines()[-1].split()
    say(
        f"first record from an empty cache on two cores: {monotonic() - start:.1f} s, "
        f"{float(seconds):.1f} s of processor time, {functions} functions compiled"
    )
