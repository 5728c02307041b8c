"""Schedulers of dask.distributed that run jobs: workers on this machine, or an existing cluster.

Installed packages add a kind by an entry point of the group ``insonify.schedulers``.
"""

import json
import logging
import os
import sys
import time
import warnings
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, ExitStack, contextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from insonify.compiler.build import Build, own_build, stated_build
from insonify.cores import VARIABLE, most_threads
from insonify.errors import SceneError, is_count
from insonify.io.atomic import unfinished_folder
from insonify.io.object_store import in_store
from insonify.operating_system import interrupts_blocked
from insonify.plugins import announced, loaded

RECORD = "build.json"  # beside the flags of the jobs
SILENCE, REMINDER = 10.0, 60.0  # s without a worker until the first sentence, and between it and the next one
GROUP = "insonify.schedulers"
PATIENCE = 10.0  # s, until a scheduler answers
SAFE_PATH = "PYTHONSAFEPATH"
UNSEEN = "localhost:0"  # of pages that no other machine can open and that are empty, at any free port
LIBRARIES = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")


class Workers:
    """Workers that calculate alike, and their threads by address; others are named once and get no job."""

    def __init__(self, client: Any, flags: Path, scheduler: str) -> None:
        self.threads: dict[str, int] = {}
        self._client, self._flags, self._scheduler = client, flags, scheduler
        self._builds: dict[str, Build | None] = {}
        self._expected = read_build(flags)
        self._since, self._reminded = time.monotonic(), 0.0

    def count(self) -> None:
        """Look who is there, and let those who are new state their build."""
        present = self._client.nthreads()
        if new := sorted(present.keys() - self._builds.keys()):
            stated = self._client.run(stated_build, workers=new, on_error="return")
            for address in new:
                build = self._builds[address] = _as_build(stated.get(address))
                if fault := self._fault(build):
                    _say(f"--scheduler {self._scheduler}: {address} gets no jobs: {fault}")
        alike = (address for address, build in self._builds.items() if build is not None and build == self._expected)
        self.threads = {address: present[address] for address in alike if address in present}
        self._remind(len(present))

    def _fault(self, build: Build | None) -> str:
        """Return why a worker gets no job; empty if it gets some. The first one of the versions here sets the build."""
        if build is None:
            return "it does not state its version of insonify; install the same version there as here"
        here = own_build()._replace(system=build.system, processor=build.processor)
        if self._expected is None and build == here:
            self._expected = claim_build(self._flags, build)
        if difference := (self._expected or here).difference(build):
            return f"it has {difference}, so its files would not be identical bit for bit; use identical workers"
        return ""

    def _remind(self, present: int) -> None:
        """Say that nobody works, after a while and then every minute."""
        now = time.monotonic()
        if self.threads:
            self._since, self._reminded = now, 0.0
        elif now - self._since > SILENCE and now - self._reminded > REMINDER:
            self._reminded = now
            left = f"none of {present} workers suits the remaining jobs" if present else "no worker is connected"
            _say(f"--scheduler {self._scheduler}: {left}; start workers, or interrupt and resume later")


def claim_build(flags: Path, build: Build) -> Build:
    """Record the build that files of a folder are to be made with; return it, or the build of an earlier driver."""
    final = flags / RECORD
    if in_store(final):
        if (first := read_build(flags)) is None:
            final.write_bytes(json.dumps(build._asdict()).encode())
        return first or build
    flags.mkdir(parents=True, exist_ok=True)
    with unfinished_folder(final) as folder:
        written = folder / RECORD
        written.write_text(json.dumps(build._asdict()), encoding="utf-8", newline="")
        try:
            os.link(written, final)  # fails where there is one
        except OSError:
            if first := read_build(flags):
                return first
            written.replace(final)  # the disk has no links
    return build


def read_build(flags: Path) -> Build | None:
    """Return the build that files of a folder were made with; None before there are any."""
    try:
        return _as_build(json.loads((flags / RECORD).read_text(encoding="utf-8")))
    except (OSError, ValueError):
        return None


def _as_build(stated: Any) -> Build | None:
    """Return a build from its texts; None for an error, or for what another version states."""
    return Build(**stated) if isinstance(stated, dict) and stated.keys() == set(Build._fields) else None


def _say(sentence: str) -> None:
    sys.stderr.write(f"insonify: {sentence}\n")


@dataclass(frozen=True)
class SchedulerKind:
    """Kind of scheduler."""

    prefix: str  # beginning of the option's text, such as ``local``, up to its ``:``
    form: str  # form of the whole text, for help and errors
    # Takes the text after the prefix and its ``:``, and returns a context manager that yields a ``Client``.
    connect: Callable[[str], AbstractContextManager[Any]]


def find_schedulers() -> dict[str, SchedulerKind]:
    """Return the kinds by their prefixes: kinds of this module, and kinds that installed packages announce."""
    others = loaded(announced(GROUP), lambda kind: (kind.prefix, kind))
    return {kind.prefix: kind for kind in KINDS} | dict(others)


def choose_scheduler(text: str) -> tuple[SchedulerKind, str]:
    """Find the kind of scheduler that a text names, and the rest of the text."""
    prefix, _, rest = text.partition(":")
    known = find_schedulers()
    if prefix not in known:
        forms = " or ".join(kind.form for kind in known.values())
        raise SceneError(f"--scheduler {text}: {prefix!r} is not a kind of scheduler; write {forms}")
    return known[prefix], rest


@contextmanager
def connected(text: str) -> Iterator[Any]:
    """Yield a client of the scheduler that a text names."""
    kind, rest = choose_scheduler(text)
    try:
        import distributed  # lazy: an optional extra
    except ImportError:
        raise SceneError(
            "surveys and data sets need dask.distributed, which is not installed; run: pip install 'insonify[surveys]'"
        ) from None
    with distributed.utils.silence_logging_cmgr(logging.CRITICAL), kind.connect(rest) as client:
        yield client


@contextmanager
def _connect_to(protocol: str, rest: str) -> Iterator[Any]:
    """Connect to a scheduler by its address without the protocol."""
    from distributed import Client

    address = f"{protocol}:{rest}"
    try:
        client = Client(address, timeout=PATIENCE, set_as_default=False)
    except (OSError, ValueError) as error:
        raise SceneError(
            f"--scheduler {address}: no scheduler answers there ({error}); start one with 'dask scheduler', or "
            "leave the option out"
        ) from None
    with client:
        yield client


def share_cores(text: str) -> tuple[int, int]:
    """Return the number of workers and the threads of each; their product is at most the number of usable cores."""
    cores = most_threads()
    if text and not (is_count(text) and int(text) > 0):
        raise SceneError(f"--scheduler local:{text}: {text!r} is not a number of workers; give a whole number from 1")
    workers = int(text) if text else cores
    if workers > cores:
        raise SceneError(
            f"--scheduler local:{text}: {workers} workers are more than the {cores} cores that may be used; give at "
            f"most local:{cores}, or set {VARIABLE}"
        )
    return workers, cores // workers


@contextmanager
def _safe_path() -> Iterator[None]:
    """Let the tracker of resources, the workers and what they start import nothing from the current folder."""
    before = os.environ.get(SAFE_PATH)
    os.environ[SAFE_PATH] = "1"
    try:
        yield
    finally:
        os.environ.pop(SAFE_PATH)
        if before is not None:
            os.environ[SAFE_PATH] = before


@contextmanager
def _start_workers(text: str) -> Iterator[Any]:
    """Start workers on this machine, and end them after the block."""
    workers, threads = share_cores(text)
    import dask
    from distributed import Client, LocalCluster

    settings = {
        "distributed.admin.log-length": 0,
        "distributed.worker.profile.enabled": False,
        "distributed.scheduler.http.routes": [],
        "distributed.worker.http.routes": [],
    }
    with _safe_path(), dask.config.set(settings), warnings.catch_warnings(), ExitStack() as stack:
        # Warnings of slow disks and busy ports need no action of the user.
        warnings.filterwarnings("ignore", module="distributed")
        warnings.filterwarnings("ignore", message="Creating scratch directories")  # of contextlib, by its level
        with interrupts_blocked():
            cluster = LocalCluster(
                n_workers=workers,
                threads_per_worker=1,
                dashboard_address=UNSEEN,
                scheduler_kwargs={"dashboard": False},
                silence_logs=logging.CRITICAL,
                env=dict.fromkeys((VARIABLE, *LIBRARIES), str(threads)),
            )
            client = stack.enter_context(Client(stack.enter_context(cluster), set_as_default=False))
        yield client


KINDS = (
    SchedulerKind("tcp", "tcp://HOST:PORT", partial(_connect_to, "tcp")),
    SchedulerKind("tls", "tls://HOST:PORT", partial(_connect_to, "tls")),
    SchedulerKind("local", "local:N", _start_workers),
)
