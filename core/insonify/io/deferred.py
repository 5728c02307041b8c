"""Variables of a Dataset with values that are computed, or read from a file, on first use."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from xarray.backends import BackendArray
from xarray.core import indexing

from insonify.arrays import Integers

DEFERRED = "deferred"  # key of a variable's encoding
Read = Callable[[Integers], NDArray[Any]]  # the values of some pings, which lie along an axis of theirs


class _Deferred(BackendArray):
    """Array that is read ping by ping."""

    def __init__(self, shape: tuple[int, ...], dtype: str, axis: int, read: Read) -> None:
        self.shape, self.dtype, self._axis, self._read = shape, np.dtype(dtype), axis, read

    def __getitem__(self, key: indexing.ExplicitIndexer) -> Any:
        support = indexing.IndexingSupport.OUTER
        return indexing.explicit_indexing_adapter(key, self.shape, support, self._select)

    def _select(self, key: tuple[Any, ...]) -> NDArray[Any]:
        wanted, pings = key[self._axis], self.shape[self._axis]
        single = np.ndim(wanted) == 0 and not isinstance(wanted, slice)
        numbers = np.arange(*wanted.indices(pings)) if isinstance(wanted, slice) else np.atleast_1d(wanted) % pings
        found = self._read(numbers)
        for axis in reversed(range(found.ndim)):  # from the last, because a number removes its axis
            some = (0 if single else slice(None)) if axis == self._axis else key[axis]
            found = found[(slice(None),) * axis + (some,)]
        return found


def defer(dims: Sequence[str], shape: tuple[int, ...], dtype: str, read: Read, attributes: Any) -> xr.Variable:
    """Return a variable along ``ping_time`` that reads its values on demand."""
    array = _Deferred(shape, dtype, list(dims).index("ping_time"), read)
    return xr.Variable(dims, indexing.LazilyIndexedArray(array), attributes, {DEFERRED: True}, fastpath=True)
