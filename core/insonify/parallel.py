"""Pings shared among threads: kernels release the GIL, and results do not depend on the number of threads."""

from __future__ import annotations

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import TypeVar

Result = TypeVar("Result")
SMALLEST = 8  # pings worth handing to a thread


def in_parallel(block: Callable[[int, int], Result], count: int, threads: int | None = None) -> list[Result]:
    """Call ``block(first, last)`` over [0, count) in shares, on several threads.

    Parameters
    ----------
    block : callable
        Works on pings first to last - 1 and touches nothing that another share touches.
    count : int
        Number of pings.
    threads : int, optional
        All cores when left out.

    Returns
    -------
    list
        What the calls returned, in order of the pings.
    """
    workers = threads or os.cpu_count() or 1
    # Several shares a worker: one that meets targets, or a busy core, does not keep the others waiting.
    size = max(SMALLEST, -(-count // (4 * workers))) if workers > 1 else max(count, 1)
    shares = [(first, min(first + size, count)) for first in range(0, count, size)]
    if workers == 1 or len(shares) < 2:
        return [block(*share) for share in shares]
    with ThreadPoolExecutor(workers) as pool:
        return list(pool.map(lambda share: block(*share), shares))
