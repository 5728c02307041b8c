"""Numbers as text with the units that people write."""

import math
import re

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
COMPASS = ("T", "°T")  # of an angle clockwise from north
QUANTITY = re.compile(r"(?P<number>[-+]?(?:\d+[.,]?\d*|[.,]\d+)(?:[eE][-+]?\d+)?)\s*(?P<unit>\D*)")


def parse_quantity(text: str, unit: str, like: str = "") -> float | None:
    """Read a number with a unit that people write, or without one."""
    parts = QUANTITY.fullmatch(text.strip().replace("−", "-"))
    if parts is None:
        return None
    number, written = parts["number"].replace(",", "."), parts["unit"]
    if not written and "e" not in number.lower():
        shown = QUANTITY.fullmatch(like.strip())
        written = shown["unit"] if shown else ""
    if unit == "°" and written.upper() in COMPASS:
        turned = 90.0 - float(number)  # headings run the other way round, from east
        return turned + 360.0 * math.ceil((-180.0 - turned) / 360.0) if math.isfinite(turned) else None
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
