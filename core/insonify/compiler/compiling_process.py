"""A process that compiles kernels for this one, which then loads their machine code from disk.

What Numba and LLVM make of a kernel stays in memory until their process ends, a hundred megabytes of a few kernels, and
they hold the interpreter's lock for long. A window therefore lets another process compile, which ends when it has had
nothing to do for a while.
"""

from __future__ import annotations

import contextlib
import pickle
import sys
import threading
from collections.abc import Iterator
from typing import Any

from insonify.compiler.part_process import stop_processes
from insonify.compiler.progress import tell_watchers
from insonify.compiler.worker_pipe import start_worker

WORKER = "insonify.compiler.compiling_worker"
TRIES = 2  # a process may end for want of work just when it is asked


class CompilationStoppedError(RuntimeError):
    """The process that should compile a kernel has been ended, because nobody needs it any more."""


class CompilingProcess:
    """A process that compiles one kernel after the other."""

    def __init__(self) -> None:
        self.ended = self._stopped = False
        self._asked: set[bytes] = set()
        self._arrived = threading.Condition()
        self._process = start_worker(WORKER)
        self._reader = threading.Thread(target=self._read, name="compiling process", daemon=True)
        self._reader.start()

    def compile(self, name: bytes) -> bool:
        """Wait until a kernel is compiled and its machine code on disk, as far as that is possible."""
        with self._arrived:
            if name not in self._asked:
                self._asked.add(name)
                with contextlib.suppress(OSError, ValueError):  # it has ended: `_read` notices
                    pickle.dump(name, self._stdin)
                    self._stdin.flush()
            self._arrived.wait_for(lambda: name not in self._asked or self.ended)
            if self._stopped:
                raise CompilationStoppedError("the window that needed a kernel has been closed")
            return name not in self._asked

    def stop(self) -> None:
        """End the process now, whatever it compiles."""
        self._stopped = True
        self._process.kill()
        self._reader.join()

    @property
    def _stdin(self) -> Any:
        return self._process.stdin

    def _read(self) -> None:
        """Take answers, names of kernels that are compiled, and pass on how far it is, until the process ends."""
        assert self._process.stdout is not None
        with self._process.stdout as answers, contextlib.suppress(Exception):
            while True:
                answer = pickle.load(answers)
                if not isinstance(answer, bytes):
                    tell_watchers(answer)
                    continue
                with self._arrived:
                    self._asked.discard(answer)
                    self._arrived.notify_all()
        tell_watchers(None)
        with self._arrived:
            self.ended = True
            self._arrived.notify_all()
        with contextlib.suppress(OSError):
            self._stdin.close()
        self._process.wait()


class _Elsewhere:
    """The process that compiles at present, and whether one is wanted."""

    def __init__(self) -> None:
        self.wanted = False
        self.process: CompilingProcess | None = None
        self.lock = threading.Lock()

    def running(self) -> CompilingProcess | None:
        """Return the process, started if there is none; None if none is wanted or it cannot be started."""
        with self.lock, contextlib.suppress(OSError):
            if self.wanted and sys.executable and (self.process is None or self.process.ended):
                self.process = CompilingProcess()
            return self.process
        return None

    def stop(self) -> None:
        """End the process, and start no other."""
        with self.lock:
            self.wanted = False
            process, self.process = self.process, None
        if process is not None:
            process.stop()


_elsewhere = _Elsewhere()


@contextlib.contextmanager
def compiled_elsewhere() -> Iterator[None]:
    """Let another process compile the kernels that are called until the block ends.

    Threads that then still wait for a kernel get a `CompilationStoppedError`.
    """
    _elsewhere.wanted = True
    try:
        yield
    finally:
        _elsewhere.stop()
        stop_processes()  # of kernels that had to be compiled here


def is_compiled_elsewhere() -> bool:
    """Whether kernels are to be compiled by another process."""
    return _elsewhere.wanted


def compile_elsewhere(name: bytes) -> None:
    """Let the other process compile a kernel, and wait; if it cannot be started or ends early, nothing is done."""
    for _ in range(TRIES):
        process = _elsewhere.running()
        if process is None or process.compile(name):
            return
