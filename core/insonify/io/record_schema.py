"""Schema of a record as a Dataset: names, units and meanings, for simulations and recordings alike."""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from insonify.arrays import Dataset, Floats, Reals, Singles
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
CONVENTIONS = {"Conventions": "CF-1.10"}


def coordinates(times: Floats, slant_range: Reals, sound_speed: float) -> dict[str, Any]:
    """Return a record's coordinates."""
    travel_time = 2.0 * slant_range / sound_speed
    return {
        "channel": list(CHANNELS),
        "ping_time": ("ping_time", times, labels("s", "time since the first ping")),
        "slant_range": ("range_sample", slant_range, labels("m", "one-way slant range of the bin's centre")),
        "travel_time": ("range_sample", travel_time, labels("s", "two-way travel time")),
    }


def platform(columns: Iterable[Floats], place: Georeference | None = None) -> dict[str, Any]:
    """Return the variables of the sonar's position and attitude."""
    found = {name: ("ping_time", column, labels(*text)) for (name, text), column in zip(PLATFORM.items(), columns)}
    if place is not None and place.crs:
        degrees = to_degrees(place, found["platform_x"][1], found["platform_y"][1])
        found |= {name: ("ping_time", column, text) for (name, text), column in zip(GEOGRAPHIC.items(), degrees)}
    return found


def labels(unit: str, text: str) -> dict[str, str]:
    """Return the attributes of a variable."""
    return {"units": unit, "long_name": text}


def join_blocks(blocks: Sequence[Dataset]) -> Dataset:
    """Join successive blocks of pings into one record."""
    # Variables of targets cover all pings so far and are taken from the last block. What else does not change with time
    # is taken from the first.
    import xarray as xr  # slow to import, and a preview in the viewer needs none of it

    if len(blocks) == 1:
        return blocks[0]
    joined = xr.concat(
        blocks, dim="ping_time", data_vars="minimal", coords="minimal", compat="override", combine_attrs="override"
    )
    return joined.assign({name: blocks[-1][name] for name in TARGET_TRUTH if name in joined})


def echo_variable(intensity: Singles) -> dict[str, Any]:
    """Return the variable that holds the echoes."""
    attributes = labels("1", "echo intensity, linear, before display gain")
    return {"intensity": (ACROSS, np.moveaxis(intensity, 1, 0), attributes)}


def label_variables(
    columns: Mapping[str, NDArray[Any]],
    targets: Sequence[str],
    materials: Sequence[str],
    paths: Sequence[str],
    volumes: Sequence[str],
) -> dict[str, Any]:
    """Return the variables that label each range bin, with the names of their numbers."""
    bodies, things = dict(enumerate(targets)), dict(enumerate(["nothing", *materials], -1))
    attributes = {
        "target_id": _flags("greatest contributor of the bin", {-2: "nothing", -1: "bed"} | bodies),
        "material": _flags("material of that contributor", things),
        "shadow": labels("1", "share of the bed's direct echo that targets hide, weighted by the beam"),
        "shadow_id": _flags("target that hides most of it", {-2: "nothing"} | bodies),
        "ground_range": labels("m", "ground range of that contributor's strongest piece"),
        "incidence": labels("degree", "incidence on that piece, from its normal"),
        "path": _flags("propagation path of the sound", dict(enumerate(["none", *paths], -1))),
        "caustic": {"long_name": "whether the sound passes near a caustic, with its level limited by wave theory"},
    }
    if volumes:
        text = "volume of the water column with a greater mean echo than that contributor"
        attributes["volume_id"] = _flags(text, {-2: "nothing"} | dict(enumerate(volumes)))
    attributes = {name: each for name, each in attributes.items() if name in columns}
    for name, each in attributes.items():
        if "flag_values" in each:
            each["flag_values"] = each["flag_values"].astype(columns[name].dtype)
    return {name: (ACROSS, np.moveaxis(columns[name], 1, 0), each) for name, each in attributes.items()}


def target_variables(columns: Mapping[str, NDArray[Any]], targets: Sequence[str]) -> dict[str, Any]:
    """Return the variables that describe the echo and shadow of each target."""
    found = {name: (dims, columns[name], labels(*text)) for name, (dims, *text) in TARGET_TRUTH.items()}
    return {TARGET: list(targets), BOX[2]: list(BOUNDS)} | found


def _flags(text: str, meanings: Mapping[int, str]) -> dict[str, Any]:
    """Name the values of a variable by the CF conventions."""
    values = np.array(list(meanings))
    return {"long_name": text, "flag_values": values, "flag_meanings": " ".join(meanings.values())}
