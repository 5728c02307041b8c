"""Schema of a record as a Dataset: names, units and meanings, for simulations and recordings alike."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from insonify.arrays import Dataset, Floats, Integers, Reals, Singles
from insonify.io.georeference import Georeference, to_degrees

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

GEOGRAPHIC = {
    "platform_longitude": {"units": "degrees_east", "standard_name": "longitude", "long_name": "longitude on WGS 84"},
    "platform_latitude": {"units": "degrees_north", "standard_name": "latitude", "long_name": "latitude on WGS 84"},
}
BLOCK_ECHOES = 2**20  # echoes of a block of pings
TARGET = "target"  # dimension of the variables of targets
BOUNDS = ("first_ping", "last_ping", "first_bin", "last_bin")
BOX = (TARGET, "channel", "bound")
TARGET_TRUTH = {
    "echo_box": (BOX, "1", "first and last ping and bin, from 0, of the target's direct echo; -1 without one"),
    "shadow_box": (
        BOX,
        "1",
        "first and last ping and bin in which it hides at least half the bed's echo; -1 without any",
    ),
    "target_box": (BOX, "1", "first and last ping and bin of its direct echo and its shadow; -1 without either"),
    "shadow_length": (BOX[:2], "m", "slant range from the first to the last bin of the longest shadow of a ping"),
    "target_strength": (BOX[:1], "dB", "target strength re 1 m2 within the beam, of the ping with the strongest echo"),
}
ERRORS = {
    "error": (ACROSS[:2], "1", "estimated error of the ping's side, share of its record"),
    "bin_error": (ACROSS, "1", "estimated error of the bin's mean intensity"),
}
RECORD_ERROR = "record_error"  # attribute: root of the mean square of the estimated errors of all pings
CONVENTIONS = {"Conventions": "CF-1.10"}


def coordinates(times: Floats, slant_range: Reals, sound_speed: float) -> dict[str, Any]:
    """Return a record's coordinates."""
    travel_time = 2.0 * slant_range / sound_speed
    return {
        "channel": list(CHANNELS),
        "ping_time": ("ping_time", times, describe("s", "time since the first ping")),
        "slant_range": ("range_sample", slant_range, describe("m", "one-way slant range of the bin's centre")),
        "travel_time": ("range_sample", travel_time, describe("s", "two-way travel time")),
    }


def platform(columns: Iterable[Floats], place: Georeference | None = None) -> dict[str, Any]:
    """Return the variables of the sonar's position and attitude."""
    found = {name: ("ping_time", column, describe(*text)) for (name, text), column in zip(PLATFORM.items(), columns)}
    if place is not None and place.crs:
        degrees = to_degrees(place, found["platform_x"][1], found["platform_y"][1])
        found |= {name: ("ping_time", column, text) for (name, text), column in zip(GEOGRAPHIC.items(), degrees)}
    return found


def describe(unit: str, text: str) -> dict[str, str]:
    """Return the attributes of a variable."""
    return {"units": unit, "long_name": text}


def join_blocks(blocks: Sequence[Dataset]) -> Dataset:
    """Join successive blocks of pings into one record."""
    # Variables of targets cover all pings so far and are taken from the last block, as are attributes. What else does
    # not change with time is taken from the first.
    import xarray as xr  # slow to import, and a preview in the viewer needs none of it

    if len(blocks) == 1:
        return blocks[0]
    joined = xr.concat(
        blocks, dim="ping_time", data_vars="minimal", coords="minimal", compat="override", combine_attrs="override"
    )
    whole = {name: blocks[-1][name] for name in TARGET_TRUTH if name in joined}
    return joined.assign(whole).assign_attrs(blocks[-1].attrs)


def split_record(record: Dataset, multiple: int = 1, together: int | None = None) -> Iterator[slice]:
    """Yield the pings of a record in blocks that fit in memory, each but the last a multiple of some pings."""
    pings, echoes = record.sizes["ping_time"], len(CHANNELS) * record.sizes["range_sample"]
    block = multiple * max((together or BLOCK_ECHOES) // (multiple * echoes), 1)
    return (slice(first, min(first + block, pings)) for first in range(0, pings, block))


def read_echoes(record: Dataset, pings: slice | Integers) -> Singles:
    """Intensities of some pings, (n, 2, bins); port first."""
    return np.moveaxis(np.asarray(record.variables["intensity"][:, pings]), 0, 1)


def echo_variable(intensity: Singles) -> dict[str, Any]:
    """Return the variable that holds the echoes."""
    text = describe("1", "echo intensity, linear, before display gain")
    return {"intensity": (ACROSS, np.moveaxis(intensity, 1, 0), text)}


def error_variables(columns: Mapping[str, NDArray[Any]]) -> dict[str, Any]:
    """Return the variables of estimated errors that are among columns of pings, (pings, 2, ..)."""
    return {
        name: (dims, np.moveaxis(columns[name], 1, 0), describe(*text))
        for name, (dims, *text) in ERRORS.items()
        if name in columns
    }


def target_variables(columns: Mapping[str, NDArray[Any]], targets: Sequence[str]) -> dict[str, Any]:
    """Return the variables that describe the echo and shadow of each target."""
    found = {name: (dims, columns[name], describe(*text)) for name, (dims, *text) in TARGET_TRUTH.items()}
    return {TARGET: list(targets), BOX[2]: list(BOUNDS)} | found
