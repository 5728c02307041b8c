"""Types of arrays by their numbers; the shape of an array stands with what holds or returns it."""

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Singles = NDArray[np.float32]  # single precision
Reals = NDArray[np.floating]  # of either precision
Complexes = NDArray[np.complex128]
Integers = NDArray[np.int64]
Bytes = NDArray[np.uint8]
Booleans = NDArray[np.bool_]
