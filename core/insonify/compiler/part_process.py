"""A second process that compiles while this one does: llvmlite admits one thread of a process at a time.

While a kernel is typed and lowered here, the second process compiles the separate kernels that it calls, whole, and
leaves their machine code on disk. Where a kernel calls none, it links and optimises parts in the order in which they
are lowered, and answers with bitcode. If it cannot be started or ends early, all of that is done here.
"""

from __future__ import annotations

import contextlib
import pickle
import sys
import threading
from collections.abc import Callable, Sequence
from typing import Any

from insonify.compiler.worker_pipe import start_worker
from insonify.cores import VARIABLE, default_threads

WORKER = "insonify.compiler.part_worker"
_running: list[PartProcess] = []
_asked: dict[bytes, PartProcess] = {}
_alive: set[PartProcess] = set()


class PartProcess:
    """The second process, for the time that one kernel is compiled and the separate kernels that it calls."""

    def __init__(self) -> None:
        self.unsaved: list[Callable[[], None]] = []
        self._asked: set[int] = set()
        self._sent: dict[Any, int] = {}  # keys of other libraries that it knows
        self._linked: dict[int, bytes] = {}
        self._kernels: set[bytes] = set()  # that it has been asked for and not compiled yet
        self._ended = False
        self._arrived = threading.Condition()
        self._process = start_worker(WORKER, **{VARIABLE: "1"})
        _alive.add(self)
        self._reader = threading.Thread(target=self._read, name="insonify-parts", daemon=True)
        self._reader.start()

    @property
    def compiles(self) -> bool:
        """Whether it compiles separate kernels, and has no time for parts."""
        return bool(self._kernels)

    def compile(self, name: bytes) -> None:
        """Ask for a separate kernel, by its name for `separate.find_address`."""
        self._kernels.add(name)
        self._send(name)

    def wait_for(self, name: bytes) -> None:
        """Wait until a separate kernel is compiled, or the process has ended."""
        with self._arrived:
            self._arrived.wait_for(lambda: name not in self._kernels or self._ended)

    def link(self, key: int, name: str, sources: Sequence[Any], libraries: Sequence[Any], optimised: bool) -> None:
        """Ask for a part."""
        keys = [self._key_of(library) for library in libraries]
        self._asked.add(key)
        self._send((key, name, [tuple(source) for source in sources], keys, optimised))

    def _key_of(self, library: Any) -> int:
        """Key of a library in the second process, which is sent those that it has not linked."""
        key: int | None = getattr(library, "key", None)
        if key in self._asked:
            return key
        if library not in self._sent:
            self._sent[library] = -1 - len(self._sent)
            self._send((self._sent[library], bytes(library._get_module_for_linking().as_bitcode())))
        return self._sent[library]

    def bitcode_of(self, key: int) -> bytes | None:
        """Wait for a part; None if the process has ended without it."""
        with self._arrived:
            self._arrived.wait_for(lambda: key in self._linked or self._ended)
            return self._linked.pop(key, None)

    def close(self) -> None:
        """Save all parts, and end the process, unless it still compiles; if it has ended early, no part is linked."""
        for save in self.unsaved:
            if not self._ended:
                save()
        self._send(None)  # it ends when it has done all
        if not self._kernels:
            self.stop()

    def stop(self) -> None:
        """End the process now; what it has not done is done here when it is needed."""
        self._process.kill()
        self._reader.join()

    @property
    def _stdin(self) -> Any:
        return self._process.stdin

    def _send(self, message: tuple[Any, ...] | bytes | None) -> None:
        with contextlib.suppress(OSError, ValueError):  # it has ended: `_read` notices
            pickle.dump(message, self._stdin)
            self._stdin.flush()

    def _read(self) -> None:
        """Collect answers until the process ends; on a thread of its own, so that neither process waits to write."""
        assert self._process.stdout is not None
        with self._process.stdout as answers, contextlib.suppress(Exception):
            while True:
                answer = pickle.load(answers)
                with self._arrived:
                    if isinstance(answer, bytes):
                        self._kernels.remove(answer)
                    else:
                        self._linked.update([answer])
                    self._arrived.notify_all()
        with self._arrived:
            self._ended = True
            self._kernels.clear()
            self._arrived.notify_all()
        with contextlib.suppress(OSError):
            self._stdin.close()
        self._process.wait()
        _alive.discard(self)


def running_process() -> PartProcess | None:
    """Return the second process, if one is running."""
    return _running[-1] if _running else None


def start_process() -> None:
    """Start a second process, if there is a second core for it."""
    with contextlib.suppress(OSError):
        if default_threads() > 1 and sys.executable:
            _running.append(PartProcess())


def end_process() -> None:
    """End the second process, if one is running."""
    if _running:
        _running.pop().close()


def stop_processes() -> None:
    """End all second processes now, those too that still compile a kernel that nobody waits for."""
    for process in tuple(_alive):
        process.stop()


def ask_for_kernel(name: bytes) -> None:
    """Let the second process compile a separate kernel, if it is running."""
    if _running and name not in _asked:
        _asked[name] = _running[-1]
        _running[-1].compile(name)


def wait_for_kernel(name: bytes) -> None:
    """Wait for a separate kernel, if the second process has been asked for it."""
    process = _asked.get(name)
    if process is not None:
        process.wait_for(name)
