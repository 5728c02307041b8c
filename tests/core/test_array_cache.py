"""Arrays that are kept, in bounds."""

import gc
from concurrent.futures import ThreadPoolExecutor
from dataclasses import make_dataclass
from threading import Barrier
from time import sleep

import numpy as np
import pytest

from insonify.array_cache import ArrayCache

KB = 1024
Pair = make_dataclass("Pair", ("values", "number"))


def test_the_least_recently_used_arrays_are_dropped() -> None:
    cache, made = ArrayCache(3 * KB), []

    def array(number: int) -> np.ndarray:
        made.append(number)
        return np.full(KB, number, np.uint8)

    kept = cache.keep(array)
    for number in (1, 2, 3, 1, 4, 1, 2):
        assert kept(number)[0] == number
    assert made == [1, 2, 3, 4, 2], "2 was the oldest when 4 came"
    assert cache.bytes == 3 * KB


def test_functions_share_the_bound_and_not_their_results_which_go_with_them() -> None:
    cache = ArrayCache(4 * KB)
    one, other = (cache.keep(lambda n, v=value: np.full(n, v, np.uint8)) for value in (1, 2))
    assert (one(KB)[0], other(KB)[0], one(KB)[0]) == (1, 2, 1)
    assert cache.bytes == 2 * KB
    del one
    gc.collect()
    other(2 * KB)
    assert cache.bytes == 3 * KB
    large = cache.keep(lambda n: np.zeros(n, np.uint8))
    assert large(16 * KB) is large(16 * KB)  # larger than the bound, and kept alone
    assert cache.bytes == 16 * KB


def test_a_cleared_store_makes_its_arrays_again() -> None:
    cache, made = ArrayCache(1000), []

    @cache.keep
    def ones(count: int) -> np.ndarray:
        made.append(count)
        return np.ones(count)

    for _ in range(2):
        ones(4)
    cache.clear()
    assert cache.bytes == 0
    assert (ones(4) == 1.0).all()
    assert (made, cache.bytes) == ([4, 4], 32)


def test_threads_agree_on_what_is_kept_and_share_what_they_ask_for_at_once() -> None:
    cache, made, begun = ArrayCache(8 * KB), [], Barrier(4)
    kept = cache.keep(lambda n: np.full(KB, n, np.uint8))

    @cache.keep
    def slow(number: int) -> np.ndarray:
        made.append(number)
        sleep(0.05)
        return np.full(KB, number, np.uint8)

    def ask(_: int) -> int:
        begun.wait()
        return int(slow(7)[0])

    with ThreadPoolExecutor(4) as threads:
        assert list(threads.map(lambda n: int(kept(n % 20)[0]), range(400))) == [n % 20 for n in range(400)]
        assert cache.bytes == 8 * KB
        assert list(threads.map(ask, range(4))) == [7] * 4
    assert made == [7]


def test_an_error_is_not_kept_and_arrays_inside_tuples_and_dataclasses_count() -> None:
    cache, asked = ArrayCache(KB), []

    @cache.keep
    def fails_once() -> tuple[object, ...]:
        asked.append(1)
        if len(asked) == 1:
            raise ValueError("once")
        return np.zeros(2, np.uint8), [Pair(np.zeros(3, np.uint8), 1.0)], "name"

    with pytest.raises(ValueError, match="once"):
        fails_once()
    assert len(fails_once()) == 3
    assert cache.bytes == 5
