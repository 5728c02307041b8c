"""Pings shared among the threads of one pool: kernels release the GIL, and results do not depend on the threads."""

import threading
from collections import deque
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor, wait
from contextlib import contextmanager
from contextvars import ContextVar
from functools import cache, partial
from typing import Generic, TypeVar, cast

from insonify.cores import default_threads, most_threads
from insonify.errors import SceneError
from insonify.operating_system import call_after_fork

Result = TypeVar("Result")
Made = TypeVar("Made")
SMALLEST = 8  # pings worth handing to a thread, for most kernels

_END = object()
_limit: ContextVar[int | None] = ContextVar("threads", default=None)


class PerThread(threading.local, Generic[Made]):
    """One object for each thread that uses it, such as the work space of a kernel."""

    def __init__(self, make: Callable[[], Made]) -> None:
        # A `threading.local` is initialised in every thread that touches it.
        self.own = make()


@contextmanager
def limited_threads(threads: int | None) -> Iterator[None]:
    """Limit the threads that work on what is called within the block; None leaves the limit as it is."""
    if threads is not None and threads < 1:
        raise SceneError(f"threads: {threads} is too few; give at least 1")
    token = _limit.set(_limit.get() if threads is None else threads)
    try:
        yield
    finally:
        _limit.reset(token)


def count_threads(threads: int | None = None) -> int:
    """Return the number of threads that work at a time, which the argument, `limited_threads` and the process limit."""
    limits = [number for number in (threads, _limit.get()) if number is not None]
    return min(*limits, most_threads()) if limits else default_threads()


def in_parallel(
    block: Callable[[int, int], Result], count: int, threads: int | None = None, least: int = SMALLEST
) -> list[Result]:
    """Call ``block(first, last)`` over [0, count) in shares, on several threads."""
    # The calling thread takes part. The others come from one pool of the process, however many callers it has; a share
    # may call `in_parallel` itself and is helped by those that are free.
    workers = min(count_threads(threads), max(count // least, 1))
    shares = [(0, count)] if workers == 1 else list(_shares(count, workers, least))
    return _work_off([partial(block, *share) for share in shares], workers) if count > 0 else []


def _shares(count: int, workers: int, least: int) -> Iterator[tuple[int, int]]:
    """Split [0, count) into shares of two thirds of what each worker has left: long ones, then shorter ones."""
    # Each share costs a call of a kernel, some 40 µs, and the last ones keep a busy core, or pings that cross targets,
    # from making the others wait.
    first = 0
    while first < count:
        last = min(first + max(least, 2 * (count - first) // (3 * workers)), count)
        yield first, last
        first = last


def _work_off(tasks: list[Callable[[], Result]], workers: int) -> list[Result]:
    """Results of tasks that this thread and some of the pool take one after the other."""
    if workers == 1:
        return [task() for task in tasks]
    found: dict[int, Result] = {}
    waiting = iter(enumerate(tasks))  # the GIL makes its steps atomic

    def work() -> None:
        try:
            for number, task in waiting:
                found[number] = task()
        except BaseException:
            deque(waiting, maxlen=0)  # the others end with the tasks that they are at
            raise

    helpers: list[Future[None]] = [_pool().submit(work) for _ in range(workers - 1)]
    try:
        work()
    finally:
        # Helpers that have not begun, because the pool is busy, are not waited for.
        begun = [helper for helper in helpers if not helper.cancel()]
        wait(begun)
    for helper in begun:
        helper.result()
    return [found[number] for number in range(len(tasks))]


def one_ahead(items: Iterator[Result]) -> Iterator[Result]:
    """Yield items; the next one is made on another thread while the caller works on the last."""
    # A caller that is interrupted while it waits does not wait for the item, which may take long.
    maker = ThreadPoolExecutor(1, thread_name_prefix="one ahead")
    in_time = True
    try:
        waiting = maker.submit(_next, items)
        while (item := waiting.result()) is not _END:
            waiting = maker.submit(_next, items)
            yield cast("Result", item)
            del item  # the caller has done with it
    except (KeyboardInterrupt, SystemExit):
        in_time = False
        raise
    finally:
        maker.shutdown(wait=in_time, cancel_futures=not in_time)


def _next(items: Iterator[Result]) -> object:
    return next(items, _END)


@cache
def _pool() -> ThreadPoolExecutor:
    """Threads of this process beside the one that calls; they begin when first needed."""
    return ThreadPoolExecutor(max(most_threads() - 1, 1), thread_name_prefix="in parallel")


call_after_fork(_pool.cache_clear)
