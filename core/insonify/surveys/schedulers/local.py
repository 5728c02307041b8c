"""Workers on this machine."""

from __future__ import annotations

import logging
import signal
import warnings
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from multiprocessing import resource_tracker
from typing import Any

from insonify.cores import VARIABLE, most_threads
from insonify.errors import SceneError
from insonify.surveys.schedulers import SchedulerKind

UNSEEN = "localhost:0"  # a dashboard that no other machine can open, at any free port
LIBRARIES = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")


def share_cores(text: str) -> tuple[int, int]:
    """Return the number of workers and the threads of each, whose product is the number of usable cores."""
    cores = most_threads()
    if text and not (text.isdecimal() and int(text) > 0):
        raise SceneError(f"--scheduler local:{text}: {text!r} is no number of workers; give a whole number from 1")
    workers = int(text) if text else cores
    if workers > cores:
        raise SceneError(
            f"--scheduler local:{text}: {workers} workers are more than the {cores} cores that may be used; give at "
            f"most local:{cores}, or set {VARIABLE}"
        )
    return workers, cores // workers


@contextmanager
def _interrupts_held() -> Iterator[None]:
    """Hold interrupts back meanwhile; threads and processes that are started within never get any.

    A terminal sends Ctrl-C to the driver and to the workers, and it is for the driver to end them.
    """
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    # Its start would let interrupts through again; it is started with the first process otherwise.
    resource_tracker.ensure_running()
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


@contextmanager
def connect(text: str) -> Iterator[Any]:
    """Start workers, and end them after the block."""
    workers, threads = share_cores(text)
    import dask
    from distributed import Client, LocalCluster

    settings = {"distributed.admin.log-length": 0, "distributed.worker.profile.enabled": False}
    with ExitStack() as stack:
        stack.enter_context(dask.config.set(settings))
        stack.enter_context(warnings.catch_warnings())
        warnings.filterwarnings(
            "ignore", module="distributed"
        )  # of slow disks and busy ports: nothing for a user to do
        with _interrupts_held():
            cluster = LocalCluster(
                n_workers=workers,
                threads_per_worker=1,
                dashboard_address=UNSEEN,
                worker_dashboard_address=UNSEEN,
                silence_logs=logging.CRITICAL,
                env={VARIABLE: str(threads), **dict.fromkeys(LIBRARIES, str(threads))},
            )
            stack.enter_context(cluster)
            client = stack.enter_context(Client(cluster, set_as_default=False))
        yield client


LOCAL = SchedulerKind("local", "local:N", connect)
