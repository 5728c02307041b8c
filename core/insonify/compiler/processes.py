"""A child process that compiles kernels, which this process then loads from disk.

A window lets it compile all kernels (`compiled_elsewhere`). Numba and LLVM keep a hundred megabytes for a few kernels
until their process ends, and they block other threads of Python for long. If the process cannot be started or ends
early, kernels are compiled here.
"""

import contextlib
import sys
import threading
from collections.abc import Iterator

from insonify.child_process import ChildProcess
from insonify.compiler.cache_folder import cache_folder
from insonify.compiler.progress import report_progress

WORKER = "insonify.compiler.worker"
TRIES = 2  # an idle process may end just when it gets a request


class CompilationStoppedError(RuntimeError):
    """The process that should compile a kernel has been ended, because its kernels are no longer needed."""


class CompilingProcess:
    """A process that compiles kernels one after the other: by their names (`dispatch.name_code`), or by a function."""

    def __init__(self) -> None:
        self.ended = self.stopped = False
        self.pending: set[bytes | str] = set()  # requested and not compiled yet
        self._changed = threading.Condition()
        self._child = ChildProcess(WORKER)
        self._reader = threading.Thread(target=self._read, name="compiling process", daemon=True)
        self._reader.start()

    def request(self, name: bytes | str) -> None:
        """Request a kernel, or the call of a function ``module:name``, unless that has been done."""
        with self._changed:
            if name not in self.pending:
                self.pending.add(name)
                with contextlib.suppress(OSError, ValueError):  # it has ended: `_read` notices
                    self._child.send(name)

    def wait(self, name: bytes) -> bool:
        """Wait until a kernel is compiled; false if the process has ended without it."""
        with self._changed:
            self._changed.wait_for(lambda: name not in self.pending or self.ended)
            return name not in self.pending

    def stop(self) -> None:
        """End the process now, whatever it compiles."""
        self.stopped = True
        self._child.process.kill()
        self._reader.join()

    def _read(self) -> None:
        """Take names of compiled kernels and reports of progress until the process ends."""
        with contextlib.suppress(Exception):
            while True:
                answer = self._child.receive()
                if isinstance(answer, (bytes, str)):
                    with self._changed:
                        self.pending.discard(answer)
                        self._changed.notify_all()
                else:
                    report_progress(answer)
        report_progress(None)
        with self._changed:
            self.ended = True
            self._changed.notify_all()
        self._child.stop()


class _Elsewhere:
    """The process that compiles all kernels of this one, and whether one is wanted."""

    def __init__(self) -> None:
        self.wanted = False
        self.process: CompilingProcess | None = None
        self.lock = threading.Lock()

    def compile(self, name: bytes) -> None:
        """Wait until the process has compiled a kernel; if it cannot be started or ends early, nothing is done."""
        for _ in range(TRIES):
            process = self.running()
            if process is None:
                return
            process.request(name)
            if process.wait(name):
                return
            if process.stopped:
                raise CompilationStoppedError("the window that needed a kernel has been closed")

    def running(self) -> CompilingProcess | None:
        """Return the process, which is started if it is wanted and can be."""
        with self.lock, contextlib.suppress(OSError):
            if self.wanted and sys.executable and (self.process is None or self.process.ended):
                self.process = CompilingProcess()
            return self.process
        return None

    def stop(self) -> None:
        """End the process, and start no other."""
        with self.lock:
            process, self.wanted, self.process = self.process, False, None
        if process is not None:
            process.stop()


elsewhere = _Elsewhere()


@contextlib.contextmanager
def compiled_elsewhere(first: str = "") -> Iterator[None]:
    """Let another process compile the kernels that are called until the block ends.

    While no kernel at all is on disk, it begins at once with those that a function ``module:name`` compiles.
    """
    # Threads that then still wait for a kernel get a `CompilationStoppedError`.
    elsewhere.wanted = True
    if first and not cache_folder().exists() and (process := elsewhere.running()) is not None:
        process.request(first)
    try:
        yield
    finally:
        elsewhere.stop()
