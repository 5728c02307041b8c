"""Records as side-scan recordings in the eXtended Triton Format (XTF), in the conventions that its readers share.

The structures are those of pyxtf. Where the format leaves a choice, the fields follow what pyxtf, auvlib, MBES-lib
(OpenSidescan) and SidescanTools take from them:

- Samples are amplitudes, port far to near, starboard near to far. The top bit of integers of 16 and 32 bits stays
  clear, because auvlib reads them as signed. ``Weight`` is 0, because auvlib shifts samples by it in a way of its own.
- ``SoundVelocity`` is half the sound speed, as the format defines it (round trip, 750 m/s by default), and
  ``SecondsPerPing`` is the listening time, so that their product is the slant range, which SidescanTools computes.
- Positions are longitude and latitude, never 0, which stands for no fix.
- Dates are valid, because pyxtf and auvlib sort by them.
"""

import ctypes
import math
from collections.abc import Iterable, Mapping
from datetime import timedelta
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from insonify.arrays import Singles
from insonify.io.georeference import find_georeference
from insonify.io.record_block import RecordBlock
from insonify.io.record_schema import RECORD_ERROR
from insonify.io.records.survey_log import LoggedPing, count_exponent, log_record

PROGRAM = b"insonify"
KNOT = 1852.0 / 3600.0  # m/s
ALIGNMENT = 64  # bytes, to a multiple of which packets are padded
DEGREES, METRES = 3, 0  # of NavUnits
SLANT_RANGE = 1  # of CorrectionFlags
MADE_UP, ERROR = " (place made up)", ", error {:.2g} %"
NOTE = 63  # letters of a note
# Vertical beam, in degrees, where the record has none: from the horizontal to nadir.
TILT, OPENING = 45.0, 90.0


class SampleType(NamedTuple):
    """How samples are stored."""

    code: int  # ``SampleFormat`` of the channel
    dtype: str  # little-endian type of NumPy
    bits: int  # significant bits of an integer; 0 of a float


SAMPLE_TYPES = {
    "16": SampleType(3, "<u2", 15),
    "8": SampleType(8, "u1", 8),
    "32": SampleType(2, "<u4", 31),
    "float": SampleType(5, "<f4", 0),
}


def counts(dtype: np.dtype[Any]) -> float:
    """Return the number of values of an unsigned integer, which span an amplitude of ``VoltScale``; 1 for floats."""
    return 2.0 ** (8 * dtype.itemsize) if dtype.kind == "u" else 1.0


def write_xtf(path: str | Path, blocks: Iterable[RecordBlock], bits: str = "16") -> None:
    """Write a record as a side-scan recording."""
    kind = SAMPLE_TYPES[bits]
    with log_record(path, blocks) as log, Path(path).open("wb") as file:
        unit = math.ldexp(1.0, count_exponent(log.loudest, kind.bits)) if kind.bits else 1.0
        file.write(encode_header(log.attributes, kind, unit))
        for ping, sides in log.pings():
            file.write(encode_ping(ping, sides, kind, unit))


def encode_header(attributes: Mapping[str, Any], kind: SampleType, unit: float) -> bytes:
    """Encode the header of a file, from the attributes of a record; ``kind`` and ``unit`` are those of its pings."""
    from pyxtf import XTFFileHeader  # its import is not needed by other commands

    header = XTFFileHeader()
    header.RecordingProgramName, header.RecordingProgramVersion = PROGRAM, b"1"
    header.SonarName = PROGRAM
    place, title = find_georeference(attributes), str(attributes.get("title", ""))
    error = float(attributes.get(RECORD_ERROR, math.nan))
    notes = ("" if place else MADE_UP) + ("" if math.isnan(error) else ERROR.format(100.0 * error))
    note = f"{title[: NOTE - len(notes)]}{notes}"
    header.NoteString = note.encode("ascii", "replace")
    header.NavUnits = METRES if place is not None and not place.crs else DEGREES
    header.NumberOfSonarChannels = 2
    for number, (name, side) in enumerate(((b"PORT", 1), (b"STARBOARD", 2))):
        info = header.ChanInfo[number]
        info.ChannelName, info.TypeOfChannel, info.SubChannelNumber = name, side, number
        info.CorrectionFlags, info.UniPolar, info.BeamsPerArray = SLANT_RANGE, 1, 1
        info.SampleFormat, info.BytesPerSample = kind.code, np.dtype(kind.dtype).itemsize
        info.VoltScale = unit * counts(np.dtype(kind.dtype))
        info.Frequency = float(attributes.get("frequency", 0.0)) / 1e3
        info.HorizBeamAngle = float(attributes.get("beam_width", 0.0))
        info.TiltAngle = float(attributes.get("vertical_beam_tilt", TILT))
        info.BeamWidth = float(attributes.get("vertical_beam_width", OPENING))
    return bytes(header)


def encode_ping(ping: LoggedPing, sides: Singles, kind: SampleType, unit: float) -> bytes:
    """Encode a ping as one packet.

    Parameters
    ----------
    ping
        Its header.
    sides
        Amplitudes near to far, (2, bins), port first.
    kind
        How samples are stored.
    unit
        Amplitude of one count; 1 for floats.
    """
    from pyxtf import XTFPingChanHeader, XTFPingHeader  # their import is not needed by other commands

    header = XTFPingHeader()
    header.NumChansToFollow, header.PingNumber = 2, ping.number
    _set_time(header, ping)
    for name, value in {
        "SensorXcoordinate": ping.x, "ShipXcoordinate": ping.x, "SensorYcoordinate": ping.y, "ShipYcoordinate": ping.y,
        "SensorHeading": ping.heading, "ShipGyro": ping.heading, "SensorSpeed": ping.speed / KNOT,
        "ShipSpeed": ping.speed / KNOT, "SensorPitch": ping.pitch, "SensorRoll": ping.roll, "SensorDepth": ping.depth,
        "SensorPrimaryAltitude": ping.altitude,
    }.items():  # fmt: skip
        setattr(header, name, 0.0 if math.isnan(value) else value)  # 0 stands for what is not known
    header.ComputedSoundVelocity = 2.0 * ping.slant_range / ping.duration
    header.SoundVelocity = ping.slant_range / ping.duration
    body = b""
    for number, amplitude in enumerate(sides):
        channel = XTFPingChanHeader()
        channel.ChannelNumber, channel.NumSamples = number, amplitude.size
        channel.SlantRange = ping.slant_range
        channel.GroundRange = math.sqrt(max(ping.slant_range**2 - header.SensorPrimaryAltitude**2, 0.0))
        channel.TimeDuration = channel.SecondsPerPing = ping.duration
        channel.Frequency = round(ping.frequency / 1e3)
        stored = amplitude if kind.bits == 0 else np.rint(amplitude.astype(np.float64) / unit)
        body += bytes(channel) + stored[:: 1 if number else -1].astype(kind.dtype).tobytes()
    size = ctypes.sizeof(header) + len(body)
    header.NumBytesThisRecord = math.ceil(size / ALIGNMENT) * ALIGNMENT
    return bytes(header) + body + bytes(header.NumBytesThisRecord - size)


def _set_time(header: Any, ping: LoggedPing) -> None:
    """Set the time of a ping and of its fix, which resolve 10 ms."""
    time = ping.time + timedelta(milliseconds=5)
    hundredths = time.microsecond // 10_000
    header.Year, header.Month, header.Day = time.year, time.month, time.day
    header.JulianDay = time.timetuple().tm_yday
    header.Hour, header.Minute, header.Second, header.HSeconds = time.hour, time.minute, time.second, hundredths
    header.FixTimeHour, header.FixTimeMinute, header.FixTimeSecond = time.hour, time.minute, time.second
    header.FixTimeHsecond = hundredths
