"""Speed of sound in sea water from its temperature, salinity and depth."""

from collections.abc import Callable, Iterator

import numpy as np
from numpy.typing import ArrayLike

from insonify.arrays import Floats
from insonify.scene.base import describe_excess

# A scene has no place on Earth: pressure is that at middle latitudes, salt composition that of the open ocean.
LATITUDE = 45.0


def paper(temperature: ArrayLike, salinity: ArrayLike, depth: ArrayLike) -> Floats:
    """Sound speed by the formula of the paper, section 2, which misprints 0.055 t² as 0.55 t²."""
    t, s, d = _floats(temperature, salinity, depth)
    return np.asarray(1449.0 + 4.6 * t - 0.055 * t**2 + 0.0003 * t**3 + (1.39 - 0.012 * t) * (s - 35.0) + d / 61.0)


def mackenzie(temperature: ArrayLike, salinity: ArrayLike, depth: ArrayLike) -> Floats:
    """Sound speed by Mackenzie, J. Acoust. Soc. Am. 70 (1981), 807; arguments as in `paper`."""
    t, s, d = _floats(temperature, salinity, depth)
    by_temperature = 1448.96 + 4.591 * t - 5.304e-2 * t**2 + 2.374e-4 * t**3
    by_depth = 1.630e-2 * d + 1.675e-7 * d**2 - 7.139e-13 * t * d**3
    return np.asarray(by_temperature + by_depth + (1.340 - 1.025e-2 * t) * (s - 35.0))


def teos10(temperature: ArrayLike, salinity: ArrayLike, depth: ArrayLike) -> Floats:
    """Sound speed by TEOS-10, the equation of state of sea water, exact form; arguments as in `paper`."""
    import gsw  # lazy: takes 0.2 s, which only scenes with hydrography need

    t, s, d = _floats(temperature, salinity, depth)
    pressure = gsw.p_from_z(-d, LATITUDE)
    return np.asarray(gsw.sound_speed_t_exact(gsw.SA_from_SP(s, pressure, 0.0, 0.0), t, pressure), dtype=np.float64)


def _floats(*values: ArrayLike) -> tuple[Floats, ...]:
    return tuple(np.asarray(value, dtype=np.float64) for value in values)


EQUATIONS: dict[str, Callable[[ArrayLike, ArrayLike, ArrayLike], Floats]] = {
    "paper": paper,
    "mackenzie": mackenzie,
    "teos10": teos10,
}
# Name of each equation, and the ranges of temperature (°C), salinity and depth (m) for which it was derived.
RANGES = {
    "paper": ("the paper's equation", (0.0, 35.0), (0.0, 45.0), (0.0, 1000.0)),
    "mackenzie": ("Mackenzie's equation", (2.0, 30.0), (25.0, 40.0), (0.0, 8000.0)),
    "teos10": ("TEOS-10", (-6.0, 40.0), (0.0, 42.0), (0.0, 10000.0)),
}


def describe_range(equation: str, *values: ArrayLike) -> Iterator[str]:
    """Describe in a sentence each of temperature, salinity and depth that leaves the range of an equation."""
    formula, *ranges = RANGES[equation]
    for name, unit, value, valid in zip(("temperature", "salinity", "depth"), (" °C", "", " m"), values, ranges):
        yield from describe_excess(name, float(np.min(value)), float(np.max(value)), unit, valid, formula)
