"""Messages between a process and one that compiles for it: pickled, on the standard input and output of the latter."""

from __future__ import annotations

import os
import pickle
import queue
import subprocess
import sys
import threading
from typing import Any


def start_worker(module: str, **environment: str) -> subprocess.Popen[bytes]:
    """Start a process that runs a module and finds the modules that this one finds."""
    kept = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    return subprocess.Popen(
        [sys.executable, "-m", module], stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL,
        env=kept | {"PYTHONPATH": os.pathsep.join(path for path in sys.path if path)} | environment,
    )  # fmt: skip


def take_requests() -> queue.SimpleQueue[Any]:
    """Return a queue of what this worker is asked for; the process ends with the one that asks."""
    asked: queue.SimpleQueue[Any] = queue.SimpleQueue()
    threading.Thread(target=_read, args=(asked,), daemon=True).start()
    return asked


def send_answer(answer: Any) -> None:
    """Answer from this worker."""
    pickle.dump(answer, sys.stdout.buffer)
    sys.stdout.buffer.flush()


def _read(asked: queue.SimpleQueue[Any]) -> None:
    """Take all that is asked for at once, so that the other process does not wait; leave when it has ended."""
    try:
        while True:
            asked.put(pickle.load(sys.stdin.buffer))
    except EOFError:
        os._exit(0)
