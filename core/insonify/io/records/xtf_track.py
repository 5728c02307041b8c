"""Time and navigation from the headers of XTF pings, whose fields may be zero, repeated or in other conventions."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

DAY = 86400.0  # s
DEGREES = 3  # of NavUnits; others are metres
EARTH = 6_378_137.0, 6.694380e-3  # semi-major axis in m and squared eccentricity of WGS 84
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


def _positions(
    header: Any, headers: list[Any], times: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Positions in metres east and north of the first fix."""
    x = _told(headers, "SensorXcoordinate", "ShipXcoordinate", unknown=np.inf)
    y = _told(headers, "SensorYcoordinate", "ShipYcoordinate", unknown=np.inf)
    limit = 180.0 if header.NavUnits == DEGREES else FARTHEST
    fixed = ((x != 0.0) | (y != 0.0)) & (np.abs(x) <= limit) & (np.abs(y) <= limit)
    if not fixed.any():
        speed = _told(headers, "SensorSpeed", "ShipSpeed") * KNOT
        run = np.concatenate([[0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]) * np.diff(times))])
        return np.zeros_like(run), run
    first = int(np.argmax(fixed))
    east, north = np.where(fixed, x, x[first]) - x[first], np.where(fixed, y, y[first]) - y[first]
    if header.NavUnits == DEGREES:
        per_degree = _metres_per_degree(y[first])
        east, north = east * per_degree[0], north * per_degree[1]
    # Fixes repeat because they are rarer than pings; positions between them are interpolated.
    moved = fixed.copy()
    moved[1:] &= (x[1:] != x[:-1]) | (y[1:] != y[:-1])
    moved[first] = True
    return _filled(east, moved, times), _filled(north, moved, times)


def _metres_per_degree(latitude: float) -> tuple[float, float]:
    """Length of a degree of longitude and of latitude on the ellipsoid, by its radii of curvature there."""
    axis, e2 = EARTH
    bent = 1.0 - e2 * np.sin(np.radians(latitude)) ** 2
    meridian, normal = axis * (1.0 - e2) / bent**1.5, axis / np.sqrt(bent)
    return np.radians(normal * np.cos(np.radians(latitude))), np.radians(meridian)


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
