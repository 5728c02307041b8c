"""Lines through many points, for painters."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from PySide6.QtGui import QPolygonF
from shiboken6 import VoidPtr

POINT = 16  # bytes of a QPointF, two doubles
wrap_memory: Any = VoidPtr  # its types leave out that it makes a writable buffer of an object


def make_polyline(x: NDArray[np.floating], y: NDArray[np.floating]) -> QPolygonF:
    """Line through points, whose coordinates are copied at once: an object for each point takes far longer."""
    line = QPolygonF()
    line.resize(x.size)
    if x.size:
        memory = wrap_memory(line.data(), POINT * x.size, True)
        np.frombuffer(memory, dtype=np.float64).reshape(x.size, 2)[:] = np.stack((x, y), axis=1)
    return line
