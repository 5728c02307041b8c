"""Running of jobs on a scheduler: few are on their way at a time, and only their names and counts come back."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator, Sequence
from typing import Any, NamedTuple

from insonify.errors import SceneError
from insonify.surveys.engine.jobs import Outcome, Work, clear_unfinished, finish
from insonify.surveys.schedulers import connected

AHEAD = 3  # jobs on their way for each thread of a worker: what one does meanwhile hides the way to the driver
PATIENCE = 60.0  # s, until there is a worker
RECOUNT = 5.0  # s, after which the workers are counted again


class Failure(NamedTuple):
    """A job that could not be done."""

    name: str
    reason: str


class Tally(NamedTuple):
    """What became of the jobs of a run."""

    done: int
    made: int  # images, records
    failures: tuple[Failure, ...]


Progress = Callable[[Outcome | Failure], None]


def run_jobs(work: Work, names: Sequence[str], scheduler: str, progress: Progress) -> Tally:
    """Do jobs on a scheduler's workers.

    A job whose worker ends is done by another one, up to three times. A job that cannot be done stops no other; a file
    that cannot be written stops them all.
    """
    done, made, failures = 0, 0, []
    try:
        with connected(scheduler) as client:
            _warm_up(client, work, scheduler)
            for ended in _outcomes(client, work, iter(names)):
                progress(ended)
                if isinstance(ended, Failure):
                    failures.append(ended)
                else:
                    done, made = done + 1, made + ended.made
    finally:
        clear_unfinished(work.folder)
    return Tally(done, made, tuple(failures))


def _warm_up(client: Any, work: Work, scheduler: str) -> None:
    """Let one worker of each machine compile the kernels; the others read them from the machine's cache."""
    try:
        client.wait_for_workers(1, timeout=PATIENCE)
    except TimeoutError:
        raise SceneError(
            f"--scheduler {scheduler}: no worker has come within {PATIENCE:g} s; start some, with 'dask worker'"
        ) from None
    machines = {address.rpartition(":")[0]: address for address in client.nthreads()}
    warm = [client.submit(work.warm_up, workers=[one], pure=False) for one in machines.values()]
    client.gather(warm, errors="skip")  # a scene that cannot be made is told of by its job


def _outcomes(client: Any, work: Work, names: Iterator[str]) -> Iterator[Outcome | Failure]:
    """Outcomes of jobs as they end; as many are on their way as keep the workers busy."""
    from distributed import as_completed

    waiting, counted, most = as_completed(loop=client.loop), -math.inf, 0
    named: dict[str, str] = {}
    while True:
        if time.monotonic() - counted > RECOUNT:
            counted, most = time.monotonic(), AHEAD * max(sum(client.nthreads().values()), 1)
        while len(named) < most and (name := next(names, None)) is not None:
            future = client.submit(finish, work, name, pure=False)
            named[future.key] = name
            waiting.add(future)
        if not named:
            return
        ended = next(waiting)
        yield _outcome(ended, named.pop(ended.key))


def _outcome(future: Any, name: str) -> Outcome | Failure:
    """Outcome of a job that has ended; raises what stops all jobs."""
    error = future.exception()
    if error is None:
        outcome: Outcome = future.result()
        return outcome
    if isinstance(error, SceneError):
        return Failure(name, str(error))
    if isinstance(error, ImportError) or "deserializ" in str(error):
        raise SceneError(
            f"--scheduler: a worker cannot read its jobs ({type(error).__name__}); install the same versions of "
            "insonify, Python and dask there as here"
        )
    if isinstance(error, (OSError, MemoryError)) or type(error).__name__ != "KilledWorker":
        raise error
    return Failure(name, "its worker ended four times in a row, perhaps for want of memory; give fewer workers")


def tell_failures(failures: Sequence[Failure], total: int) -> str:
    """Tell in one sentence that some jobs could not be done."""
    first = min(failures)
    number = int(first.name.partition("-")[0])
    return f"{len(failures)} of {total} jobs could not be done, the others are done; job {number}: {first.reason}"
