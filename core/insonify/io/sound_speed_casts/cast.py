"""What a cast holds."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from insonify.errors import SceneError

Values = NDArray[np.float64]
# Columns of a file by name: depth (m) and any of time (s), sound_speed (m/s), temperature (°C), salinity (practical).
# NaN where a row has no value.
Columns = dict[str, Values]


@dataclass(frozen=True, eq=False)
class Cast:
    """A measured cast; it has a speed, or temperature and salinity, or all three.

    Attributes
    ----------
    depth : (n,) float64
        Metres, increasing; at least two.
    sound_speed : (n,) float64 or None
        m/s.
    temperature : (n,) float64 or None
        °C, ITS-90.
    salinity : (n,) float64 or None
        Practical salinity.
    """

    depth: Values
    sound_speed: Values | None
    temperature: Values | None
    salinity: Values | None


def refusal(path: str, fault: str, remedy: str) -> SceneError:
    """Make the one sentence that refuses a file."""
    return SceneError(f"water.path: {path!r} {fault}; {remedy}")
