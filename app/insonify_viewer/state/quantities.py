"""Numbers as text with units, and as positions of sliders."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence

# By the unit of a value: what else people write, and its factor.
UNITS = {
    "m": {"mm": 1e-3, "cm": 1e-2, "dm": 0.1, "km": 1e3, "ft": 0.3048, "nmi": 1852.0},
    "s": {"ns": 1e-9, "µs": 1e-6, "us": 1e-6, "ms": 1e-3, "µ": 1e-6, "u": 1e-6, "m": 1e-3, "min": 60.0},
    "Hz": {"kHz": 1e3, "MHz": 1e6, "mHz": 1e-3, "k": 1e3, "M": 1e6, "m": 1e-3, "µ": 1e-6, "u": 1e-6},
    "°": {"deg": 1.0, "degrees": 1.0, "rad": math.degrees(1.0), "mrad": math.degrees(1e-3)},
    "m/s": {"kn": 1852.0 / 3600.0, "kt": 1852.0 / 3600.0, "km/h": 1.0 / 3.6, "km/s": 1e3},
    "dB/km": {"dB/m": 1e3},
    "°C": {"C": 1.0},
}
QUANTITY = re.compile(r"(?P<number>[-+]?(?:\d+[.,]?\d*|[.,]\d+)(?:[eE][-+]?\d+)?)\s*(?P<unit>\D*)")
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


def parse_quantity(text: str, unit: str, like: str = "") -> float | None:
    """Read a number with a unit that people write, or without one."""
    parts = QUANTITY.fullmatch(text.strip().replace("−", "-"))
    if parts is None:
        return None
    number, written = parts["number"].replace(",", "."), parts["unit"]
    if not written and "e" not in number.lower():
        shown = QUANTITY.fullmatch(like.strip())
        written = shown["unit"] if shown else ""
    scale = _scale(written, unit)
    value = math.nan if scale is None else float(number) * scale
    return value if math.isfinite(value) else None


def _scale(written: str, unit: str) -> float | None:
    """Factor from a written unit to the unit of a value; None for an unknown one."""
    if written in ("", unit):
        return 1.0
    scales = UNITS.get(unit, {})
    if written in scales:
        return scales[written]
    alike = {scale for name, scale in scales.items() if name.lower() == written.lower()}
    return alike.pop() if len(alike) == 1 else None


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
