"""Time and navigation from the headers of XTF pings, where fields may be zero, repeated or in other conventions."""

from __future__ import annotations

from datetime import datetime
from typing import Any

import numpy as np
from numpy.typing import NDArray

from insonify.io.records.fixes import DAY, Fixes, fill_gaps, heading_from_compass

DEGREES = 3  # of NavUnits; others are metres
KNOT = 1852.0 / 3600.0  # m/s


def seconds(headers: list[Any]) -> NDArray[np.float64]:
    """Return the times of pings since the first, from the time of day, because dates are often wrong.

    The clock resolves 10 ms; a recording without a clock gets one ping a second.
    """
    clock = (
        3600.0 * _column(headers, "Hour")
        + 60.0 * _column(headers, "Minute")
        + _column(headers, "Second")
        + 0.01 * _column(headers, "HSeconds")
    )
    if not np.ptp(clock) > 0.0:
        return np.arange(len(headers), dtype=np.float64)
    return np.unwrap(clock, period=DAY) - clock[0]


def start_time(header: Any) -> str | None:
    """Return the date and time of the first ping as ISO 8601 text; None if its date is none."""
    date = int(header.Year), int(header.Month), int(header.Day)
    clock = int(header.Hour), int(header.Minute), int(header.Second), 10_000 * int(header.HSeconds)
    try:
        return datetime(*date, *clock).isoformat()
    except ValueError:
        return None


def platform_columns(header: Any, headers: list[Any], times: NDArray[np.float64]) -> tuple[NDArray[np.float64], ...]:
    """Position, depth, altitude and attitude of the sonar at every ping."""
    names = ("SensorXcoordinate", "SensorYcoordinate", "SensorHeading", "SensorPitch", "SensorRoll", "SensorDepth")
    recorded = np.any([_column(headers, name) != 0.0 for name in (*names, "ShipGyro", "SensorPrimaryAltitude")], axis=0)
    depth, height = (
        _first_of(headers, "SensorDepth"),
        _first_of(headers, "SensorPrimaryAltitude", "SensorAuxAltitude"),
    )
    compass = _first_of(headers, "SensorHeading", "ShipGyro")
    pitch, roll = _column(headers, "SensorPitch"), _column(headers, "SensorRoll")
    x, y = fixes(header, headers).positions(times) or _dead_reckoning(headers, times)
    return (
        x, y, fill_gaps(depth, depth > 0.0), fill_gaps(height, height > 0.0),
        heading_from_compass(compass, recorded & (compass != 0.0)),
        fill_gaps(pitch, recorded), fill_gaps(roll, recorded),
    )  # fmt: skip


def fixes(header: Any, headers: list[Any]) -> Fixes:
    """Return the positions of the fish, or of the ship where those are all zero."""
    x = _first_of(headers, "SensorXcoordinate", "ShipXcoordinate", unknown=np.inf)
    y = _first_of(headers, "SensorYcoordinate", "ShipYcoordinate", unknown=np.inf)
    return Fixes(x, y, header.NavUnits == DEGREES)


def _dead_reckoning(headers: list[Any], times: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Positions along +y from the recorded speed, of a recording without a fix."""
    speed = _first_of(headers, "SensorSpeed", "ShipSpeed") * KNOT
    run = np.concatenate([[0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]) * np.diff(times))])
    return np.zeros_like(run), run


def _column(headers: list[Any], name: str, unknown: float = 0.0) -> NDArray[np.float64]:
    values = np.array([getattr(header, name) for header in headers], dtype=np.float64)
    return np.where(np.isfinite(values), values, unknown)


def _first_of(headers: list[Any], *names: str, unknown: float = 0.0) -> NDArray[np.float64]:
    """Return the first of several columns that is not all zero."""
    columns = [_column(headers, name, unknown) for name in names]
    return next((column for column in columns if column.any()), columns[0])
