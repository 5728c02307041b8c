"""Time and navigation from the headers of XTF pings, whose fields may be zero, repeated or in other conventions."""

from __future__ import annotations

from datetime import datetime
from typing import Any

import numpy as np
from numpy.typing import NDArray

from insonify.io.georeference import Georeference, from_degrees, local_georeference

DAY = 86400.0  # s
DEGREES = 3  # of NavUnits; others are metres
FARTHEST = 1e8  # m, of any map's coordinates
KNOT = 1852.0 / 3600.0  # m/s


def seconds(headers: list[Any]) -> NDArray[np.float64]:
    """Return the times of pings since the first, from the time of day, because dates are often wrong.

    The clock resolves 10 ms; a recording without a clock gets one ping a second.

    Parameters
    ----------
    headers : list of pyxtf.XTFPingHeader

    Returns
    -------
    (n,) float64
        Seconds, continued over midnight.
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
    """Return the date and time of the first ping as ISO 8601 text; None if its date is none.

    Parameters
    ----------
    header : pyxtf.XTFPingHeader
    """
    date = int(header.Year), int(header.Month), int(header.Day)
    clock = int(header.Hour), int(header.Minute), int(header.Second), 10_000 * int(header.HSeconds)
    try:
        return datetime(*date, *clock).isoformat()
    except ValueError:
        return None


def platform_columns(header: Any, headers: list[Any], times: NDArray[np.float64]) -> tuple[NDArray[np.float64], ...]:
    """Position, depth, altitude and attitude of the sonar at every ping.

    Parameters
    ----------
    header : pyxtf.XTFFileHeader
        For the units of positions.
    headers : list of pyxtf.XTFPingHeader
        Of the n pings.
    times : (n,) float64
        From `seconds`.

    Returns
    -------
    tuple of (n,) float64
        In the order and units of `insonify.io.record_schema.PLATFORM`, x and y from the first fix. Pings without
        telemetry are interpolated; quantities that no ping has are NaN; a track without positions runs along +y at the
        recorded speed.
    """
    names = ("SensorXcoordinate", "SensorYcoordinate", "SensorHeading", "SensorPitch", "SensorRoll", "SensorDepth")
    told = np.any([_column(headers, name) != 0.0 for name in (*names, "ShipGyro", "SensorPrimaryAltitude")], axis=0)
    depth, height = _told(headers, "SensorDepth"), _told(headers, "SensorPrimaryAltitude", "SensorAuxAltitude")
    compass = _told(headers, "SensorHeading", "ShipGyro")
    pitch, roll = _column(headers, "SensorPitch"), _column(headers, "SensorRoll")
    x, y = _positions(header, headers, times)
    heading = 90.0 - np.degrees(np.unwrap(np.radians(_filled(compass, told & (compass != 0.0)))))
    return (
        x, y, _filled(depth, depth > 0.0), _filled(height, height > 0.0),
        (heading + 180.0) % 360.0 - 180.0, _filled(pitch, told), _filled(roll, told),
    )  # fmt: skip


def find_place(header: Any, headers: list[Any]) -> Georeference | None:
    """Return the place of the first fix, which is (0, 0) of the record; None if the recording has no fix.

    The coordinate reference system of positions in metres is not told by the format.

    Parameters
    ----------
    header : pyxtf.XTFFileHeader
        For the units of positions.
    headers : list of pyxtf.XTFPingHeader
        Of the pings.
    """
    x, y, fixed = _fixes(header, headers)
    if not fixed.any():
        return None
    first = float(x[np.argmax(fixed)]), float(y[np.argmax(fixed)])
    return local_georeference(*first) if header.NavUnits == DEGREES else Georeference("", first)


def _positions(
    header: Any, headers: list[Any], times: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Positions in metres east and north of the first fix."""
    place = find_place(header, headers)
    x, y, fixed = _fixes(header, headers)
    if place is None:
        speed = _told(headers, "SensorSpeed", "ShipSpeed") * KNOT
        run = np.concatenate([[0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]) * np.diff(times))])
        return np.zeros_like(run), run
    # Fixes repeat because they are rarer than pings; positions between them are interpolated.
    moved = fixed.copy()
    moved[1:] &= (x[1:] != x[:-1]) | (y[1:] != y[:-1])
    moved[np.argmax(fixed)] = True
    east, north = np.zeros_like(x), np.zeros_like(y)
    if place.crs:
        east[moved], north[moved] = from_degrees(place, x[moved], y[moved])
    else:
        east[moved], north[moved] = x[moved] - place.origin[0], y[moved] - place.origin[1]
    return _filled(east, moved, times), _filled(north, moved, times)


def _fixes(header: Any, headers: list[Any]) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.bool_]]:
    """Positions as the file has them, and which of them are fixes: not zero and within the map."""
    x = _told(headers, "SensorXcoordinate", "ShipXcoordinate", unknown=np.inf)
    y = _told(headers, "SensorYcoordinate", "ShipYcoordinate", unknown=np.inf)
    widest, highest = (180.0, 90.0) if header.NavUnits == DEGREES else (FARTHEST, FARTHEST)
    return x, y, ((x != 0.0) | (y != 0.0)) & (np.abs(x) <= widest) & (np.abs(y) <= highest)


def _column(headers: list[Any], name: str, unknown: float = 0.0) -> NDArray[np.float64]:
    values = np.array([getattr(header, name) for header in headers], dtype=np.float64)
    return np.where(np.isfinite(values), values, unknown)


def _told(headers: list[Any], *names: str, unknown: float = 0.0) -> NDArray[np.float64]:
    """Return the first of several columns that is not all zero."""
    columns = [_column(headers, name, unknown) for name in names]
    return next((column for column in columns if column.any()), columns[0])


def _filled(
    values: NDArray[np.float64], known: NDArray[np.bool_], at: NDArray[np.float64] | None = None
) -> NDArray[np.float64]:
    """Interpolate values that are not known; NaN where none is."""
    if not known.any():
        return np.full(values.shape, np.nan)
    at = np.arange(values.size, dtype=np.float64) if at is None else at
    return np.interp(at, at[known], values[known])
