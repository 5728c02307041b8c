"""Types of arrays by their numbers, and of records; the shape of an array stands with what holds or returns it."""

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from xarray import Dataset as Dataset
else:
    Dataset = Any  # xarray takes longer to import than most of what mentions its type

Floats = NDArray[np.float64]
Singles = NDArray[np.float32]  # single precision
Reals = NDArray[np.floating]  # of either precision
Complexes = NDArray[np.complex128]
Integers = NDArray[np.int64]
Bytes = NDArray[np.uint8]
Booleans = NDArray[np.bool_]
Echoes = Any  # (2, pings, bins) intensities: an array, or what gives one by slices of pings
