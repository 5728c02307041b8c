"""Rotation matrix of a body from its heading, pitch and roll."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray


def exact_cos(degrees: float) -> float:
    """Cosine that is exactly 0 or ±1 on the axes, so that bodies aligned with the grid remain aligned."""
    quarter = degrees / 90.0
    return (1.0, 0.0, -1.0, 0.0)[int(quarter) % 4] if quarter == int(quarter) else math.cos(math.radians(degrees))


def rotation_matrix(heading: float, pitch: float, roll: float) -> NDArray[np.float64]:
    """Rotate a body by its heading about z, then by its pitch and its roll, each about its own rotated axes."""
    (ch, sh), (cp, sp), (cr, sr) = ((exact_cos(a), exact_cos(a - 90.0)) for a in (heading, pitch, roll))
    about_z = np.array([[ch, -sh, 0.0], [sh, ch, 0.0], [0.0, 0.0, 1.0]])
    bow_up = np.array([[cp, 0.0, -sp], [0.0, 1.0, 0.0], [sp, 0.0, cp]])
    port_up = np.array([[1.0, 0.0, 0.0], [0.0, cr, -sr], [0.0, sr, cr]])
    return about_z @ bow_up @ port_up
