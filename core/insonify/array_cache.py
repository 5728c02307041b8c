"""Arrays that are kept for the next call, in one store of bounded size for the whole process."""

from __future__ import annotations

import weakref
from collections import OrderedDict, deque
from collections.abc import Callable, Hashable
from functools import wraps
from threading import Lock
from typing import Any, ParamSpec, TypeVar

from numpy.typing import NDArray

Arguments = ParamSpec("Arguments")
Kept = TypeVar("Kept", bound=NDArray[Any])
LIMIT = 640 * 2**20  # bytes; a window of endless ground takes half a gigabyte of tiles, and far longer with fewer


class ArrayCache:
    """Results of functions, the least recently used dropped first.

    Parameters
    ----------
    limit : int
        Greatest number of bytes of all arrays together. The newest array is kept even if it alone is larger.
    """

    def __init__(self, limit: int) -> None:
        self.limit = limit
        self._arrays: OrderedDict[Hashable, NDArray[Any]] = OrderedDict()
        self._bytes = 0
        self._lock = Lock()
        self._dead: deque[object] = deque()  # tokens of functions that are gone

    @property
    def bytes(self) -> int:
        """Bytes of all arrays that are kept."""
        return self._bytes

    def keep(self, function: Callable[Arguments, Kept]) -> Callable[Arguments, Kept]:
        """Return a function that keeps its results, which must not be written to.

        Arguments must be hashable. The results go with the function that is returned.
        """
        token = object()

        @wraps(function)
        def kept(*given: Arguments.args, **named: Arguments.kwargs) -> Kept:
            key = (token, given, tuple(sorted(named.items())))
            with self._lock:
                if key in self._arrays:
                    self._arrays.move_to_end(key)
                    return self._arrays[key]  # type: ignore[return-value]
            made = function(*given, **named)
            with self._lock:
                self._put(key, made)
            return made

        # A finalizer may run wherever memory is allocated, even while this thread holds the lock: it only takes a note.
        weakref.finalize(kept, self._dead.append, token)
        return kept

    def clear(self) -> None:
        """Drop all arrays; they are made again when they are asked for."""
        with self._lock:
            self._arrays.clear()
            self._bytes = 0

    def _put(self, key: Hashable, array: NDArray[Any]) -> None:
        while self._dead:
            self._forget(self._dead.popleft())
        if key in self._arrays:  # another thread made it meanwhile
            return
        self._arrays[key] = array
        self._bytes += array.nbytes
        while self._bytes > self.limit and len(self._arrays) > 1:
            self._bytes -= self._arrays.popitem(last=False)[1].nbytes

    def _forget(self, token: object) -> None:
        """Drop the results of a function."""
        for key in [key for key in self._arrays if key[0] is token]:  # type: ignore[index]
            self._bytes -= self._arrays.pop(key).nbytes


ARRAYS = ArrayCache(LIMIT)
keep_arrays = ARRAYS.keep
