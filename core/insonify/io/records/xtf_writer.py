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
import tempfile
from collections.abc import Iterable, Iterator, Mapping
from datetime import datetime, timedelta
from pathlib import Path
from typing import IO, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.arrays import Floats, Singles
from insonify.io.georeference import Georeference, convergence, find_georeference, to_degrees
from insonify.io.record_block import RecordBlock
from insonify.io.record_schema import PLATFORM, RECORD_ERROR

PROGRAM = b"insonify"
ALONG_TRACK, ALONG_RANGE = ("ping_time", *PLATFORM), ("slant_range", "travel_time")
KNOT = 1852.0 / 3600.0  # m/s
ALIGNMENT = 64  # bytes, to a multiple of which packets are padded
DEGREES, METRES = 3, 0  # of NavUnits
SLANT_RANGE = 1  # of CorrectionFlags
# A record without a place is put into the sea north of Mallorca, on the central meridian of a UTM zone.
NOWHERE = Georeference("+proj=tmerc +lat_0=40 +lon_0=3 +ellps=WGS84 +units=m", (0.0, 0.0))
MADE_UP, ERROR = " (place made up)", ", error {:.2g} %"
NOTE = 63  # letters of a note
NO_DATE = "2000-01-01T00:00:00"
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


class _Survey(NamedTuple):
    """A whole record without its echoes."""

    attributes: Mapping[str, Any]
    times: Floats  # (pings,) s
    platform: dict[str, Floats]  # (pings,) each, by the names of PLATFORM
    slant_range: float  # m, of the far edge of the last bin
    duration: float  # s, two-way, to that edge
    bins: int
    loudest: float  # greatest amplitude


def counts(dtype: np.dtype[Any]) -> float:
    """Return the number of values of an unsigned integer, which span an amplitude of ``VoltScale``; 1 for floats."""
    return 2.0 ** (8 * dtype.itemsize) if dtype.kind == "u" else 1.0


def write_xtf(path: str | Path, blocks: Iterable[RecordBlock], bits: str = "16") -> None:
    """Write a record as a side-scan recording."""
    # Amplitudes go through a temporary file beside the recording, because the scale of integers follows from the
    # greatest. Memory does not grow with the echoes.
    kind = SAMPLE_TYPES[bits]
    with tempfile.TemporaryFile(dir=Path(path).parent) as spool, Path(path).open("wb") as file:
        survey = _spool(blocks, spool)
        unit = _unit(survey.loudest, kind)
        file.write(bytes(_file_header(survey, kind, unit)))
        spool.seek(0)
        for header in _ping_headers(survey):
            sides = np.fromfile(spool, dtype=np.float32, count=2 * survey.bins).reshape(2, survey.bins)
            file.write(_packet(header, survey, sides, kind, unit))


def _spool(blocks: Iterable[RecordBlock], spool: IO[bytes]) -> _Survey:
    """Store the amplitudes of all pings one after another; return their navigation."""
    parts: list[dict[str, NDArray[Any]]] = []
    attributes: Mapping[str, Any] = {}
    loudest = 0.0
    for block in blocks:
        variables = block.variables
        amplitude = np.sqrt(variables["intensity"].along("ping_time", "channel", "range_sample"))
        np.ascontiguousarray(amplitude, dtype=np.float32).tofile(spool)
        loudest = max(loudest, float(amplitude.max()))
        parts.append({name: variables[name].values for name in (*ALONG_TRACK, *ALONG_RANGE) if name in variables})
        attributes = block.attributes  # the last has the error of the whole record
    first = parts[0]
    edge = float(first["slant_range"][-1] + first["slant_range"][0])  # the first centre is half a bin from 0
    duration = edge * float(first["travel_time"][-1] / first["slant_range"][-1])
    times = np.concatenate([part["ping_time"] for part in parts])
    unknown = np.full(times.size, np.nan)
    columns = {name: np.concatenate([part[name] for part in parts]) if name in first else unknown for name in PLATFORM}
    return _Survey(attributes, times, columns, edge, duration, first["slant_range"].size, loudest)


def _unit(loudest: float, kind: SampleType) -> float:
    """Amplitude of one count: the smallest power of two that holds the greatest amplitude; 1 for floats."""
    if kind.bits == 0 or not loudest > 0.0:
        return 1.0
    _, exponent = math.frexp(loudest)
    unit = math.ldexp(1.0, exponent - kind.bits)
    return unit if round(loudest / unit) < 2**kind.bits else 2.0 * unit


def _file_header(survey: _Survey, kind: SampleType, unit: float) -> Any:
    from pyxtf import XTFFileHeader  # its import is not needed by other commands

    header = XTFFileHeader()
    header.RecordingProgramName, header.RecordingProgramVersion = PROGRAM, b"1"
    header.SonarName = PROGRAM
    place, title = find_georeference(survey.attributes), str(survey.attributes.get("title", ""))
    error = float(survey.attributes.get(RECORD_ERROR, math.nan))
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
        info.Frequency = float(survey.attributes.get("frequency", 0.0)) / 1e3
        info.HorizBeamAngle = float(survey.attributes.get("beam_width", 0.0))
        info.TiltAngle = float(survey.attributes.get("vertical_beam_tilt", TILT))
        info.BeamWidth = float(survey.attributes.get("vertical_beam_width", OPENING))
    return header


def _ping_headers(survey: _Survey) -> Iterator[Any]:
    """Yield the header of every ping: time, navigation, attitude and sound speed."""
    from pyxtf import XTFPingHeader

    columns = _navigation(survey)
    start = datetime.fromisoformat(str(survey.attributes.get("time_coverage_start", NO_DATE)))
    for number, time in enumerate(survey.times):
        header = XTFPingHeader()
        header.NumChansToFollow, header.PingNumber = 2, number
        _set_time(header, start + timedelta(seconds=round(float(time), 2)))
        for name, column in columns.items():
            setattr(header, name, column[number])
        header.ComputedSoundVelocity = 2.0 * survey.slant_range / survey.duration
        header.SoundVelocity = survey.slant_range / survey.duration
        yield header


def _set_time(header: Any, time: datetime) -> None:
    """Set the time of a ping and of its fix, which resolve 10 ms."""
    hundredths = time.microsecond // 10_000
    header.Year, header.Month, header.Day = time.year, time.month, time.day
    header.JulianDay = time.timetuple().tm_yday
    header.Hour, header.Minute, header.Second, header.HSeconds = time.hour, time.minute, time.second, hundredths
    header.FixTimeHour, header.FixTimeMinute, header.FixTimeSecond = time.hour, time.minute, time.second
    header.FixTimeHsecond = hundredths


def _navigation(survey: _Survey) -> dict[str, Floats]:
    """Return the fields of navigation by their names in a ping header; 0 where the record has none."""
    platform, place = survey.platform, find_georeference(survey.attributes) or NOWHERE
    x, y = platform["platform_x"], platform["platform_y"]
    if place.crs:
        east, north = to_degrees(place, x, y)
        bearing = 90.0 - platform["platform_heading"] + convergence(place)
    else:
        east, north = x + place.origin[0], y + place.origin[1]
        bearing = 90.0 - platform["platform_heading"]
    # North is 360°, because 0 stands for no compass.
    bearing = 360.0 - np.mod(-bearing, 360.0)
    times, speed = survey.times, np.zeros_like(x)  # 0 where the times do not increase
    if times.size > 1 and (np.diff(times) > 0.0).all():
        speed = np.hypot(np.gradient(x, times), np.gradient(y, times)) / KNOT
    return {
        name: np.nan_to_num(column)
        for name, column in {
            "SensorXcoordinate": east, "ShipXcoordinate": east, "SensorYcoordinate": north, "ShipYcoordinate": north,
            "SensorHeading": bearing, "ShipGyro": bearing, "SensorSpeed": speed, "ShipSpeed": speed,
            "SensorPitch": platform["platform_pitch"], "SensorRoll": platform["platform_roll"],
            "SensorDepth": platform["platform_depth"], "SensorPrimaryAltitude": platform["platform_altitude"],
        }.items()
    }  # fmt: skip


def _packet(header: Any, survey: _Survey, sides: Singles, kind: SampleType, unit: float) -> bytes:
    """Return a ping with both channels, padded with zeros."""
    body = b""
    for number, amplitude in enumerate(sides):
        stored = amplitude if kind.bits == 0 else np.rint(amplitude.astype(np.float64) / unit)
        ordered = stored[::-1] if number == 0 else stored
        body += bytes(_channel_header(number, header, survey)) + ordered.astype(kind.dtype).tobytes()
    size = ctypes.sizeof(header) + len(body)
    header.NumBytesThisRecord = math.ceil(size / ALIGNMENT) * ALIGNMENT
    return bytes(header) + body + bytes(header.NumBytesThisRecord - size)


def _channel_header(number: int, ping: Any, survey: _Survey) -> Any:
    from pyxtf import XTFPingChanHeader

    header = XTFPingChanHeader()
    header.ChannelNumber, header.NumSamples = number, survey.bins
    header.SlantRange = survey.slant_range
    header.GroundRange = math.sqrt(max(survey.slant_range**2 - ping.SensorPrimaryAltitude**2, 0.0))
    header.TimeDuration = header.SecondsPerPing = survey.duration
    header.Frequency = round(float(survey.attributes.get("frequency", 0.0)) / 1e3)
    return header
