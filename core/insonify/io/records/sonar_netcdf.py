"""Records in the groups of SONAR-netCDF4, the convention of ICES for sonar data, as far as these fit a side-scan sonar.

Macaulay & Peña (eds.), The SONAR-netCDF4 convention for sonar data, version 2.0; docs/howto/sonar-netcdf4.md.
"""

import tomllib
from collections.abc import Iterable
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any

import numpy as np

from insonify.io.file_access import disk_errors, one_at_a_time
from insonify.io.record_block import RecordBlock
from insonify.io.record_schema import CHANNELS
from insonify.io.records.survey_log import LoggedPing, SurveyLog, log_record

PING, BEAM, TRANSMIT = ("ping_time",), ("ping_time", "beam"), ("ping_time", "tx_beam")
TIME = {
    "axis": "T", "calendar": "gregorian", "standard_name": "time", "units": "nanoseconds since 1970-01-01 00:00:00Z",
}  # fmt: skip
ENUMS = {  # type of a variable, and its values
    "beam_stabilisation": ("beam_stabilisation_t", {"not_stabilised": 0, "stabilised": 1}),
    "beam_type": ("beam_t", {"single": 0, "split_aperture_angles": 1}),
    "transmit_type": ("transmit_t", {"CW": 0, "LFM": 1, "HFM": 2}),
}
FUNCTIONS = {"receive_only": 0, "transmit_only": 1, "monostatic": 3}
DEGREE, NORTH, EAST = "arc_degree", "degrees_north", "degrees_east"
SENSORS = {
    "Position": (
        ("latitude", "y", NORTH), ("longitude", "x", EAST), ("heading", "heading", "degree"),
        ("speed_over_ground", "speed", "m/s"),
    ),
    "Attitude": (
        ("heading", "heading", NORTH), ("pitch", "pitch", DEGREE), ("roll", "roll", DEGREE),
        ("vertical_offset", "height", "m"),
    ),
}  # fmt: skip
UNKNOWN = np.nan


def write_sonar_netcdf(path: str | Path, blocks: Iterable[RecordBlock]) -> None:
    """Write a record in the groups of the convention."""
    import netCDF4  # slow to import, and no other command needs it at its start

    with log_record(path, blocks) as log, one_at_a_time(), disk_errors(), netCDF4.Dataset(path, "w") as file:
        beams = file.createGroup("Sonar/Beam_group1")
        for name, size in (("ping_time", None), ("beam", 2), ("tx_beam", 2)):
            beams.createDimension(name, size)
        samples = beams.createVariable("backscatter_r", beams.createVLType(np.float32, "sample_t"), BEAM)
        samples.setncatts({"long_name": "Raw backscatter measurements (real part)", "units": "1"})
        pings = []
        for number, (ping, sides) in enumerate(log.pings()):
            samples[number, 0], samples[number, 1] = np.square(sides)
            pings.append(ping)
        columns = {name: np.array(values) for name, values in zip(LoggedPing._fields, zip(*pings))}
        first = datetime(1970, 1, 1)
        columns["time"] = np.array([(ping.time - first) // timedelta(microseconds=1) * 1000 for ping in pings])
        columns["height"] = -columns["depth"]
        columns["sound_speed"] = 2.0 * columns["slant_range"] / columns["duration"]
        for name in ("x", "y"):  # metres of no map have no place in the convention
            columns[name] = np.where(columns["degrees"], columns[name], UNKNOWN)
        _write_file(file, columns, log)
        _write_platform(file, columns)
        _write_beams(file["Sonar"], beams, columns, log)


def _put(
    group: Any, name: str, dims: tuple[str, ...], values: Any, units: str = "", kind: Any = "f4", **text: str
) -> None:
    """Write a variable; its values are repeated along the dimensions that they lack at the end."""
    variable = group.createVariable(name, kind, dims)
    variable.setncatts({"long_name": name.replace("_", " ")} | ({"units": units} if units else {}) | text)
    values = np.asarray(values, dtype=object if kind is str else None)
    shape = tuple(len(group.dimensions[each]) for each in dims)
    variable[...] = np.broadcast_to(values.reshape(values.shape + (1,) * (len(dims) - values.ndim)), shape)


def _write_file(file: Any, columns: dict[str, Any], log: SurveyLog) -> None:
    """Write what describes the file, and the groups Environment, Provenance and Vendor_specific."""
    known, now = log.attributes, datetime.now(UTC).isoformat(timespec="seconds")
    file.setncatts({
        "Conventions": "CF-1.7, SONAR-netCDF4-2.0, ACDD-1.3", "date_created": now, "keywords": "side-scan sonar",
        "sonar_convention_authority": "ICES", "sonar_convention_name": "SONAR-netCDF4",
        "sonar_convention_version": "2.0", "title": str(known.get("title", "")), "summary": "",
    })  # fmt: skip
    group = file.createGroup("Environment")
    group.createDimension("frequency", 1)
    _put(group, "frequency", ("frequency",), known.get("frequency", 0.0), "Hz", standard_name="sound_frequency")
    _put(group, "absorption_indicative", ("frequency",), UNKNOWN, "dB/m")
    _put(group, "sound_speed_indicative", (), columns["sound_speed"][0], "m/s")
    program = {"conversion_software_name": "insonify", "conversion_software_version": str(known.get("version", ""))}
    file.createGroup("Provenance").setncatts(program | {"conversion_time": now})
    own = file.createGroup("Vendor_specific")
    own.setncatts({name: value for name, value in known.items() if name not in ("title", "version")})
    own.createDimension("ping_time", log.times.size)
    for name in ("platform_x", "platform_y", "platform_altitude"):
        _put(own, name, PING, log.platform[name], "m", "f8")


def _write_platform(file: Any, columns: dict[str, Any]) -> None:
    """Write the group Platform, with one sensor of position and one of attitude, at the sonar."""
    platform = file.createGroup("Platform")
    platform.setncatts({"platform_name": "towfish", "platform_type": "towed unmanned submersible"})
    for dimension, names in (("transducer", CHANNELS), ("position", ("sonar",)), ("MRU", ("sonar",))):
        platform.createDimension(dimension, len(names))
        _put(platform, f"{dimension}_ids", (dimension,), names, kind=str)
        for axis in "xyz":
            _put(platform, f"{dimension}_offset_{axis}", (dimension,), 0.0, "m")
            if dimension != "position":
                _put(platform, f"{dimension}_rotation_{axis}", (dimension,), 0.0, DEGREE)
    kinds = platform.createEnumType(np.int8, "transducer_type_t", FUNCTIONS)
    _put(platform, "transducer_function", ("transducer",), FUNCTIONS["monostatic"], kind=kinds)
    _put(platform, "water_level", (), 0.0, "m")
    for place, rows in SENSORS.items():
        group = file.createGroup(f"Platform/{place}/sonar")
        group.createDimension("time", columns["time"].size)
        _put(group, "time", ("time",), columns["time"], kind="u8", **TIME)
        for name, column, units in rows:
            _put(group, name, ("time",), columns[column], units, "f8" if place == "Position" else "f4")


def _write_beams(sonar: Any, beams: Any, columns: dict[str, Any], log: SurveyLog) -> None:
    """Write the group Sonar, with the beams to port and starboard in one group of beams."""
    sonar.setncatts({
        "sonar_manufacturer": "insonify", "sonar_model": "simulated side-scan sonar", "sonar_software_name": "insonify",
        "sonar_software_version": str(log.attributes.get("version", "")), "sonar_type": "side-scan sonar",
    })  # fmt: skip
    beams.setncatts({"beam_mode": "vertical", "preferred_MRU": 0, "preferred_position": 0})
    given, step = log.attributes, log.duration / log.bins
    width, opening = (float(given.get(name, UNKNOWN)) for name in ("beam_width", "vertical_beam_width"))
    pulse = tomllib.loads(str(given.get("scene", ""))).get("sonar", {}).get("pulse", {})
    spread = 0.5 * pulse.get("bandwidth", 0.0)
    # A rotation about the axis ahead, by the right hand, turns nadir to port.
    down = 90.0 - float(given.get("vertical_beam_tilt", 45.0))
    aside, sides = (np.tile(each, (log.times.size, 1)) for each in ((down, -down), (0, 1)))
    _put(beams, "beam", BEAM[1:], CHANNELS, kind=str)
    _put(beams, "ping_time", PING, columns["time"], kind="u8", **TIME)
    for name, dims, value in (
        ("beam_stabilisation", PING, 0), ("beam_type", (), 0), ("transmit_type", TRANSMIT, int(spread > 0.0)),
    ):  # fmt: skip
        _put(beams, name, dims, value, kind=sonar.createEnumType(np.int8, *ENUMS[name]))
    _put(beams, "non_quantitative_processing", PING, 0, kind="i2", flag_meanings="no_non_quantitative_processing")
    _put(beams, "sample_count", BEAM, log.bins, "1", "i4")
    _put(beams, "transmit_beam_index", BEAM, sides, "1", "i4")
    _put(beams, "receive_transducer_index", BEAM[1:], (0, 1), "1", "i4")
    for name, dims, values, units in (
        ("beamwidth_receive_major", BEAM, width, DEGREE), ("beamwidth_receive_minor", BEAM, opening, DEGREE),
        ("beamwidth_transmit_major", TRANSMIT, width, DEGREE), ("beamwidth_transmit_minor", TRANSMIT, opening, DEGREE),
        ("rx_beam_rotation_phi", BEAM, aside, DEGREE), ("tx_beam_rotation_phi", TRANSMIT, aside, DEGREE),
        ("rx_beam_rotation_theta", BEAM, 0.0, DEGREE), ("tx_beam_rotation_theta", TRANSMIT, 0.0, DEGREE),
        ("rx_beam_rotation_psi", BEAM, 0.0, DEGREE), ("tx_beam_rotation_psi", TRANSMIT, 0.0, DEGREE),
        ("equivalent_beam_angle", BEAM, UNKNOWN, "sr"), ("blanking_interval", BEAM, 0.0, "s"),
        ("sample_interval", PING, step, "s"), ("sample_time_offset", TRANSMIT, -0.5 * step, "s"),
        ("transmit_duration_nominal", TRANSMIT, pulse.get("duration", UNKNOWN), "s"),
        ("transmit_frequency_start", TRANSMIT, columns["frequency"] - spread, "Hz"),
        ("transmit_frequency_stop", TRANSMIT, columns["frequency"] + spread, "Hz"),
        ("sound_speed_at_transducer", PING, columns["sound_speed"], "m/s"),
        ("platform_heading", PING, columns["heading"], NORTH), ("platform_pitch", PING, columns["pitch"], DEGREE),
        ("platform_roll", PING, columns["roll"], DEGREE), ("tx_transducer_depth", PING, columns["depth"], "m"),
        ("platform_vertical_offset", PING, columns["height"], "m"),
    ):  # fmt: skip
        _put(beams, name, dims, values, units)
    for name, column, units in (("platform_latitude", "y", NORTH), ("platform_longitude", "x", EAST)):
        _put(beams, name, PING, columns[column], units, "f8")
