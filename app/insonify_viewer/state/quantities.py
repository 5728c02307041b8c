"""Numbers as text with units, and as positions of sliders."""

import math
from collections.abc import Sequence

PREFIXED = ("s", "Hz")
LONGEST_UNIT = 5


def format_quantity(value: float, unit: str) -> str:
    """Write a value with its unit and at most four digits: ``400 kHz``, ``0.1 ms``, ``12.5 m``."""
    if unit in PREFIXED and value != 0.0:
        for prefix, scale in (("M", 1e6), ("k", 1e3), ("", 1.0), ("m", 1e-3), ("µ", 1e-6)):
            if abs(value) >= 0.1 * scale and (abs(value) >= scale or prefix in ("", "m", "µ")):
                return f"{value / scale:.4g} {prefix}{unit}"
    number = f"{value:.0f}" if abs(value) >= 1000.0 and value == round(value) else f"{value:.4g}"
    if unit == "°":
        return f"{number}°"
    return f"{number} {unit}" if unit and len(unit) <= LONGEST_UNIT else number


def format_duration(seconds: float) -> str:
    """Write a duration with three digits: ``245 µs``, ``1.29 ms``."""
    return f"{1e6 * seconds:.3g} µs" if seconds < 9.995e-4 else f"{1e3 * seconds:.3g} ms"


def format_time_left(seconds: float) -> str:
    """Write a time to wait as one whole number: ``40 s``, ``3 min``, ``2 h``."""
    if seconds < 100.0:
        return f"{max(seconds, 1.0):.0f} s"
    return f"{seconds / 60.0:.0f} min" if seconds < 5400.0 else f"{seconds / 3600.0:.0f} h"


def slider_position(value: float, ends: tuple[float, float], *, log: bool) -> float:
    """Position of a value on a slider, from 0 to 1."""
    low, high = ends
    inside = min(max(value, low), high)
    return math.log(inside / low) / math.log(high / low) if log else (inside - low) / (high - low)


def slider_value(part: float, ends: tuple[float, float], *, log: bool, integer: bool) -> float:
    """Value at a position of a slider, rounded to few digits."""
    low, high = ends
    value = low * (high / low) ** part if log else low + part * (high - low)
    if integer:
        return float(round(value))
    # A thousandth of the slider, as a power of ten.
    step = abs(value) / 200.0 if log else (high - low) / 1000.0
    digits = -math.floor(math.log10(step)) if step > 0.0 else 3
    return min(max(round(value, digits), low), high)


def nearest_within(distances: Sequence[float], reach: float) -> int | None:
    """Position of the least distance, if it is within reach."""
    nearest = min(range(len(distances)), key=distances.__getitem__, default=None)
    return nearest if nearest is not None and distances[nearest] <= reach else None


def format_share(share: float) -> str:
    """Write a share in percent, with two digits."""
    return f"{float(f'{100.0 * share:.2g}'):g} %"
