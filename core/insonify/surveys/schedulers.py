"""Schedulers of dask.distributed that run jobs: workers on this machine, or an existing cluster.

Installed packages add a kind by an entry point of the group ``insonify.schedulers``.
"""

import logging
import os
import warnings
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, ExitStack, contextmanager
from dataclasses import dataclass
from functools import partial
from typing import Any

from insonify.cores import VARIABLE, most_threads
from insonify.errors import SceneError
from insonify.operating_system import interrupts_blocked
from insonify.plugins import announced

GROUP = "insonify.schedulers"
PATIENCE = 10.0  # s, until a scheduler answers
SAFE_PATH = "PYTHONSAFEPATH"
UNSEEN = "localhost:0"  # of pages that no other machine can open and that are empty, at any free port
LIBRARIES = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")


@dataclass(frozen=True)
class SchedulerKind:
    """Kind of scheduler."""

    prefix: str  # beginning of the option's text, such as ``local``, up to its ``:``
    form: str  # form of the whole text, for help and errors
    # Takes the text after the prefix and its ``:``, and returns a context manager that yields a ``Client``.
    connect: Callable[[str], AbstractContextManager[Any]]


def find_schedulers() -> dict[str, SchedulerKind]:
    """Return the kinds by their prefixes: those of this module and those that installed packages announce."""
    return {kind.prefix: kind for kind in (*KINDS, *(entry.load() for entry in announced(GROUP)))}


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
    """Return the number of workers and the threads of each, whose product is the number of usable cores."""
    cores = most_threads()
    if text and not (text.isdecimal() and int(text) > 0):
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
    with ExitStack() as stack:
        stack.enter_context(_safe_path())
        stack.enter_context(dask.config.set(settings))
        stack.enter_context(warnings.catch_warnings())
        # Warnings of slow disks and busy ports need no action of the user.
        warnings.filterwarnings("ignore", module="distributed")
        with interrupts_blocked():
            cluster = LocalCluster(
                n_workers=workers,
                threads_per_worker=1,
                dashboard_address=UNSEEN,
                scheduler_kwargs={"dashboard": False},
                silence_logs=logging.CRITICAL,
                env={VARIABLE: str(threads), **dict.fromkeys(LIBRARIES, str(threads))},
            )
            stack.enter_context(cluster)
            client = stack.enter_context(Client(cluster, set_as_default=False))
        yield client


KINDS = (
    SchedulerKind("tcp", "tcp://HOST:PORT", partial(_connect_to, "tcp")),
    SchedulerKind("tls", "tls://HOST:PORT", partial(_connect_to, "tls")),
    SchedulerKind("local", "local:N", _start_workers),
)
