"""A second process that links and optimises parts of a kernel while this one types and lowers those that follow.

Half of the time of compilation is LLVM's, and llvmlite admits one thread at a time to it: a second thread would wait.
The second process is asked for parts in the order in which they are lowered, and answers with bitcode. If it cannot be
started or ends early, its parts are linked here.
"""

from __future__ import annotations

import contextlib
import os
import pickle
import subprocess
import sys
import threading
from collections.abc import Callable, Sequence
from typing import Any

from insonify.cores import default_threads

WORKER = "insonify.kernels.common.part_worker"
_running: list[PartProcess] = []


class PartProcess:
    """The second process, for the time that one kernel is compiled.

    Attributes
    ----------
    unsaved : list of callables
        Write parts to disk, once all are linked.
    """

    def __init__(self) -> None:
        self.unsaved: list[Callable[[], None]] = []
        self._asked: set[int] = set()
        self._sent: dict[Any, int] = {}  # keys of other libraries that it knows
        self._linked: dict[int, bytes] = {}
        self._ended = False
        self._arrived = threading.Condition()
        environment = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
        self._process = subprocess.Popen(
            [sys.executable, "-m", WORKER], stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL,
            env=environment | {"PYTHONPATH": os.pathsep.join(path for path in sys.path if path)},
        )  # fmt: skip
        self._reader = threading.Thread(target=self._read, name="insonify-parts", daemon=True)
        self._reader.start()

    def link(self, key: int, name: str, sources: Sequence[Any], libraries: Sequence[Any], optimised: bool) -> None:
        """Ask for a part.

        Parameters
        ----------
        key : int
            By which `bitcode_of` returns it.
        name, sources, optimised
            As in `part_library.link_part`.
        libraries : sequence of CodeLibrary
            What it calls.
        """
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
        """Save all parts, and end the process; if it has ended early, the rest is not linked for that alone."""
        for save in self.unsaved:
            if not self._ended:
                save()
        with contextlib.suppress(OSError):
            self._stdin.close()
        self._process.kill()
        self._process.wait()
        self._reader.join()

    @property
    def _stdin(self) -> Any:
        return self._process.stdin

    def _send(self, message: tuple[Any, ...]) -> None:
        with contextlib.suppress(OSError):  # it has ended: `_read` notices
            pickle.dump(message, self._stdin)
            self._stdin.flush()

    def _read(self) -> None:
        """Collect answers until the process ends; on a thread of its own, so that neither process waits to write."""
        assert self._process.stdout is not None
        with self._process.stdout as answers, contextlib.suppress(Exception):
            while True:
                key, bitcode = pickle.load(answers)
                with self._arrived:
                    self._linked[key] = bitcode
                    self._arrived.notify_all()
        with self._arrived:
            self._ended = True
            self._arrived.notify_all()


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
