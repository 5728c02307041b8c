"""How a record is laid out as a Dataset: names, units and meanings, for simulations and recordings alike."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

CHANNELS = ("port", "starboard")
ACROSS = ("channel", "ping_time", "range_sample")
PLATFORM = {
    "platform_x": ("m", "position along x"),
    "platform_y": ("m", "position along y"),
    "platform_depth": ("m", "depth below the surface"),
    "platform_altitude": ("m", "height above the bed beneath"),
    "platform_heading": ("degree", "heading, counter-clockwise from +x"),
    "platform_pitch": ("degree", "pitch, bow up"),
    "platform_roll": ("degree", "roll, port up"),
}


def coordinates(times: NDArray[np.float64], slant_range: NDArray[np.floating], sound_speed: float) -> dict[str, Any]:
    """Return a record's coordinates.

    Parameters
    ----------
    times : (pings,) float64
        Seconds since the first ping.
    slant_range : (bins,) float64
        Of the bins' centres, in metres.
    sound_speed : float
        By which time was turned into range, in m/s.

    Returns
    -------
    dict
        By name, as a Dataset takes them.
    """
    travel_time = 2.0 * slant_range / sound_speed
    return {
        "channel": list(CHANNELS),
        "ping_time": ("ping_time", times, labels("s", "time since the first ping")),
        "slant_range": ("range_sample", slant_range, labels("m", "one-way slant range of the bin's centre")),
        "travel_time": ("range_sample", travel_time, labels("s", "two-way travel time")),
    }


def platform(columns: Iterable[NDArray[np.float64]]) -> dict[str, Any]:
    """Return the variables that tell where the sonar was.

    Parameters
    ----------
    columns : iterable of (pings,) float64
        In the order and the units of ``PLATFORM``.

    Returns
    -------
    dict
        By name, as a Dataset takes them.
    """
    return {name: ("ping_time", column, labels(*told)) for (name, told), column in zip(PLATFORM.items(), columns)}


def labels(unit: str, text: str) -> dict[str, str]:
    """Return the attributes of a variable."""
    return {"units": unit, "long_name": text}
