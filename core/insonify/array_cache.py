"""Results that are kept for the next call: in one store of bounded size for the whole process, or the latest few."""

import weakref
from collections import OrderedDict, deque
from collections.abc import Callable, Hashable
from dataclasses import fields, is_dataclass
from functools import wraps
from threading import Lock
from typing import Any, ParamSpec, TypeVar

import numpy as np

Arguments = ParamSpec("Arguments")
Result = TypeVar("Result")
LATEST = 4  # results that are kept, with their arguments
Kept = TypeVar("Kept")
LIMIT = 96 * 2**20  # bytes; endless ground takes twice as long with 80 MiB


def remember_latest(function: Callable[Arguments, Result]) -> Callable[Arguments, Result]:
    """Keep the latest results of a function of positional arguments, such as arrays, that are not written to."""
    known: deque[tuple[tuple[object, ...], Result]] = deque(maxlen=LATEST)

    @wraps(function)
    def remembered(*arguments: Arguments.args, **_: Arguments.kwargs) -> Result:
        for others, result in tuple(known):
            if all(one is other for one, other in zip(arguments, others)):
                return result
        result = function(*arguments, **_)
        known.append((arguments, result))
        return result

    return remembered


class ArrayCache:
    """Results of functions (arrays, tuples, dataclasses of arrays); the least recently used are dropped first."""

    def __init__(self, limit: int) -> None:
        self.limit = limit
        self._results: OrderedDict[Hashable, tuple[Any, int]] = OrderedDict()  # with their bytes
        self.bytes = 0  # of all arrays that are kept
        self._lock = Lock()
        self._making: dict[Hashable, Lock] = {}  # locked by the thread that makes a result; others wait for it
        self._tokens: weakref.WeakKeyDictionary[Callable[..., Any], object] = weakref.WeakKeyDictionary()
        self._dead: deque[object] = deque()  # tokens of functions that are gone

    def keep(self, function: Callable[Arguments, Kept]) -> Callable[Arguments, Kept]:
        """Return a function of hashable arguments that keeps its results, which must not be written to."""
        # The results go with the function that is returned. Those of a declaration hold for a ``version`` of its file.
        token = object()

        @wraps(function)
        def kept(*given: Arguments.args, **named: Arguments.kwargs) -> Kept:
            key = (token, given, _versions(given), tuple(sorted(named.items())))
            with self._lock:
                if key in self._results:
                    return self._newest(key)
                making = self._making.setdefault(key, Lock())
            with making:
                with self._lock:
                    if key in self._results:  # another thread has made it meanwhile
                        return self._newest(key)
                return self._make(key, lambda: function(*given, **named))

        weakref.finalize(kept, self._drop, token)
        self._tokens[kept] = token
        return kept

    def find(self, function: Callable[..., Kept], *given: Hashable) -> Kept | None:
        """Return the result of a function that `keep` returned, if it is kept; it is not made."""
        key = self._tokens.get(function), given, _versions(given), ()
        with self._lock:
            return self._newest(key) if key in self._results else None

    def clear(self) -> None:
        """Drop all results; they are made again when needed."""
        with self._lock:
            self._results.clear()
            self.bytes = 0

    def _newest(self, key: Hashable) -> Any:
        """Return a result that is kept, as the most recently used from now on."""
        self._results.move_to_end(key)
        return self._results[key][0]

    def _make(self, key: Hashable, make: Callable[[], Kept]) -> Kept:
        """Make and keep a result."""
        try:
            made = make()
            with self._lock:
                self._drop_dead()
                if key not in self._results:  # a thread that began before the store was cleared may have made it
                    size = _bytes_of(made)
                    self._results[key] = made, size
                    self.bytes += size
                while self.bytes > self.limit and len(self._results) > 1:
                    self.bytes -= self._results.popitem(last=False)[1][1]
            return made
        finally:
            with self._lock:
                self._making.pop(key, None)

    def _drop(self, token: object) -> None:
        """Drop the results of a function that is gone, now or with the next result."""
        # A finalizer runs wherever memory is allocated, even while this thread holds the lock.
        self._dead.append(token)
        if self._lock.acquire(blocking=False):
            try:
                self._drop_dead()
            finally:
                self._lock.release()

    def _drop_dead(self) -> None:
        while self._dead:
            token = self._dead.popleft()
            for key in [key for key in self._results if key[0] is token]:  # type: ignore[index]
                self.bytes -= self._results.pop(key)[1]


def _versions(given: tuple[Any, ...]) -> tuple[Any, ...]:
    return tuple(getattr(one, "version", None) for one in given)


def _bytes_of(value: Any) -> int:
    """Bytes of the arrays of a result."""
    if isinstance(value, np.ndarray):
        return value.nbytes
    if is_dataclass(value):
        value = [getattr(value, field.name) for field in fields(value)]
    return sum(_bytes_of(part) for part in value) if isinstance(value, list | tuple) else 0


ARRAYS = ArrayCache(LIMIT)
keep_arrays = ARRAYS.keep
