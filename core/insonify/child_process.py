"""Child processes that answer requests: their start, messages, limit of time, and their end.

A child runs a function `main` of one module, which calls `serve`. Requests and answers are pickled. Modules of the
current folder are never imported: a file named json.py beside somebody's data is not part of this program.
"""

import contextlib
import os
import pickle
import queue
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from insonify.operating_system import processor_time

# The search path is given whole; and what a child imports is compiled once for all later ones.
LEFT_OUT = {"PYTHONPATH", "PYTHONDONTWRITEBYTECODE"}
CHILD = "--child"  # first word with which the program as a folder without Python becomes a child (app/frozen)
START = "import sys; sys.path[:] = sys.argv[2:]; __import__(sys.argv[1], fromlist=['main']).main()"
STARVED = 6.0  # times as long an answer may take while other programs occupy the processors
PIPE = 2**20  # bytes of a pipe, where the system lets it be chosen
LENGTH = 8  # bytes of every length in a message


class ChildProcess:
    """A process that answers requests; it ends with this one."""

    def __init__(self, module: str, **environment: str) -> None:
        self.owner = os.getpid()
        inherited = {name: value for name, value in os.environ.items() if name not in LEFT_OUT}
        run = [CHILD, module] if _is_frozen() else ["-P", "-c", START, module, *_search_path()]
        self.process = subprocess.Popen(
            [sys.executable, *run],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            pipesize=PIPE,
            env=inherited | environment,
        )

    def send(self, request: Any) -> None:
        """Send a request; raises OSError if the process has ended."""
        _write(self.process.stdin, request)

    def receive(self) -> Any:
        """Wait for an answer; raises EOFError if the process ends without it."""
        return _read(self.process.stdout)

    def receive_within(self, seconds: float) -> Any:
        """Wait for an answer; after so much processor time the process is killed, and TimeoutError raised."""
        answered, late = threading.Event(), threading.Event()
        threading.Thread(target=self._kill_after, args=(seconds, answered, late), daemon=True).start()
        try:
            return self.receive()
        except (OSError, EOFError):
            if late.is_set():
                raise TimeoutError from None
            raise
        finally:
            answered.set()

    def _kill_after(self, seconds: float, answered: threading.Event, late: threading.Event) -> None:
        """Kill the process after a time without an answer; time in which it waits for a processor does not count."""
        before, _ = processor_time(self.process.pid)
        left, end = seconds, time.monotonic() + STARVED * seconds
        while not answered.wait(left):
            taken, runs = processor_time(self.process.pid)
            left = min(seconds - (taken - before), end - time.monotonic()) if runs else 0.0
            if left <= 0.0:
                late.set()
                self.process.kill()
                return

    def is_usable(self) -> bool:
        """Whether the process runs and belongs to this one, which may have been forked."""
        return self.owner == os.getpid() and self.process.poll() is None

    def stop(self) -> None:
        """End the process now."""
        if self.owner == os.getpid():
            self.process.kill()
            self.process.wait()
            for stream in filter(None, (self.process.stdin, self.process.stdout)):
                with contextlib.suppress(OSError):  # of what was not sent
                    stream.close()

    def __del__(self) -> None:
        """End the process with the last reference to it, as when the package is imported again."""
        if hasattr(self, "process"):
            self.stop()


def own_command(*words: str) -> list[str]:
    """Return the command that runs this program in a process of its own, with words as from a shell."""
    return [sys.executable, *words] if _is_frozen() else [sys.executable, "-P", "-m", "insonify", *words]


def _is_frozen() -> bool:
    """Whether the program runs from a folder without Python, where its executable is not an interpreter."""
    return bool(getattr(sys, "frozen", False))


def _search_path() -> list[str]:
    """Where modules are found, without the current folder; it comes last if it holds this package."""
    own, here = str(Path(__file__).parents[1]), os.path.realpath(os.curdir)
    return [path for path in sys.path if path and os.path.realpath(path) != here] + [own]


def serve(answer: Callable[[Any, Callable[[Any], None]], None], idle: float) -> None:
    """Answer requests in a child by ``answer``, which must not raise, until ``idle`` seconds pass without one."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # an interrupt reaches the parent too, which ends this process
    requests: queue.SimpleQueue[Any] = queue.SimpleQueue()
    threading.Thread(target=_take_requests, args=(requests,), daemon=True).start()
    with os.fdopen(os.dup(1), "wb") as answers, contextlib.suppress(queue.Empty, BrokenPipeError):
        os.dup2(2, 1)  # libraries may print
        while (request := requests.get(timeout=idle)) is not None:
            answer(request, lambda value: _write(answers, value))


def _take_requests(requests: queue.SimpleQueue[Any]) -> None:
    """Read requests at once, so that the parent need not wait; end the process with the parent."""
    # Without a buffer, which the interpreter would wait for when it ends.
    try:
        with open(0, "rb", buffering=0, closefd=False) as sent:
            while True:
                requests.put(_read(sent))
    finally:  # whatever ended it: the parent would wait for an answer
        os._exit(0)


def _write(stream: Any, value: Any) -> None:
    """Write a message as lengths and pieces; arrays are sent without a copy."""
    buffers: list[pickle.PickleBuffer] = []
    head = pickle.dumps(value, protocol=5, buffer_callback=buffers.append)
    pieces = [memoryview(head), *(buffer.raw() for buffer in buffers)]
    stream.write(len(pieces).to_bytes(LENGTH, "little"))
    for piece in pieces:
        stream.write(piece.nbytes.to_bytes(LENGTH, "little"))
        stream.write(piece)
    stream.flush()


def _read(stream: Any) -> Any:
    """Read a message, which this package's own code has written in another process."""
    count = int.from_bytes(_exactly(stream, LENGTH), "little")
    pieces = [_exactly(stream, int.from_bytes(_exactly(stream, LENGTH), "little")) for _ in range(count)]
    return pickle.loads(pieces[0], buffers=pieces[1:])


def _exactly(stream: Any, count: int) -> bytearray:
    content = bytearray(count)
    view, at = memoryview(content), 0
    while at < count:
        got = stream.readinto(view[at:])
        if not got:
            raise EOFError
        at += got
    return content
