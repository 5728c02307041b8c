"""Recordings in the eXtended Triton Format (XTF) of real side-scan sonars.

pyxtf defines the layout of the packets. Packets are walked here, because the loop of pyxtf relies on an index beside
the file (a pickle), on lengths that may be zero, and on the order of channels.
"""

import contextlib
import ctypes
from collections.abc import Iterator
from datetime import datetime
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.arrays import Bytes, Dataset, Floats
from insonify.io.file_access import FileFault
from insonify.io.formats import FileFormat, WriteOption
from insonify.io.records import recording
from insonify.io.records.xtf_writer import DEGREES, KNOT, PROGRAM, SAMPLE_TYPES, counts, write_xtf

SIDES = {1: 0, 2: 1}  # TypeOfChannel -> row: port, starboard
SONAR_PACKET, MAGIC, FORMAT = 0, 0xFACE, 123
BLOCK = 1024  # bytes of a file header; one more block for every six further channels
SAMPLES = {2: "<u4", 3: "<u2", 5: "<f4", 8: "u1"}  # by SampleFormat
BY_BYTES = {1: "u1", 2: "<u2", 4: "<u4"}  # by BytesPerSample, where SampleFormat is 0
GROUND_RANGE = 2  # of CorrectionFlags
WIDEST_BEAM = 60.0  # degrees, of a side-scan sonar
GREATEST = 1e7  # of frequencies, in Hz or kHz


class _Ping(NamedTuple):
    header: Any  # pyxtf.XTFPingHeader
    bands: dict[int, dict[int, recording.SideEchoes]]  # port and starboard of each frequency
    frequencies: dict[int, float]  # of the bands, as the ping has them


def read_xtf(path: str | Path, frequency: float | None = None) -> Dataset:
    """Read a side-scan recording."""
    # Samples are amplitudes: their standard deviation in uniform patches of a raw recording is half their mean, as for
    # the envelope of fully developed speckle (0.523); an intensity would have a ratio of 1. ``intensity`` is the square
    # of the samples, in the units of the recorder.
    path = Path(path)
    if path.stat().st_size < BLOCK:
        raise FileFault(f"has {path.stat().st_size} bytes, less than the header of an XTF file", "copy it again")
    content = np.memmap(path, dtype=np.uint8, mode="r")
    if content[0] != FORMAT:
        raise FileFault("is not an XTF file (its first byte is not 123)", "give a recording in XTF")
    from pyxtf import XTFFileHeader  # its import is not needed by other commands

    header = XTFFileHeader.from_buffer_copy(content[:BLOCK])
    pings = list(_pings(path, content, header))
    if not pings:
        raise FileFault("holds no side-scan pings", "give a recording with port or starboard channels")
    band, attributes = recording.choose_band(_frequencies(header, pings), frequency)
    pings = [ping for ping in pings if band in ping.bands]
    track = _track(header, [ping.header for ping in pings])
    track.attributes.update(attributes)
    if width := _declared(header, band, "HorizBeamAngle", WIDEST_BEAM):
        track.attributes["beam_width"] = width
    return recording.assemble(path, [ping.bands[band] for ping in pings], track)


def _pings(path: Path, content: Bytes, header: Any) -> Iterator[_Ping]:
    """Yield the pings with a side-scan channel, packet by packet."""
    from pyxtf import XTFPacketStart, XTFPingHeader

    kinds = ("SonarChannels", "BathymetryChannels", "SnippetChannels", "EchoStrengthChannels", "InterferometryChannels")
    channels = sum(int(getattr(header, f"NumberOf{kind}")) for kind in (*kinds, "ForwardLookArrays"))
    at = BLOCK * max(1, -(-channels // 6))  # the header is as long as these need
    smallest, whole = ctypes.sizeof(XTFPacketStart), 0
    while at < content.size:
        start = content[at : at + smallest]
        if not start.any() and not content[at:].any():
            return  # padding
        packet = XTFPacketStart.from_buffer_copy(start) if start.size == smallest else None
        if packet is not None and (packet.MagicNumber != MAGIC or packet.NumBytesThisRecord < smallest):
            raise FileFault(f"holds no XTF packet at byte {at}", "copy or export it again")
        if packet is None or at + packet.NumBytesThisRecord > content.size:
            recording.warn_of_cut(path, at, whole)
            return
        body = content[at : at + packet.NumBytesThisRecord]
        if packet.HeaderType == SONAR_PACKET:
            if body.size < ctypes.sizeof(XTFPingHeader):
                raise FileFault(f"has a ping too short for its header at byte {at}", "export it again")
            ping = XTFPingHeader.from_buffer_copy(body[: ctypes.sizeof(XTFPingHeader)])
            found = _read_ping(header, ping, body[ctypes.sizeof(XTFPingHeader) :])
            if found.bands:
                whole += 1
                yield found
        at += packet.NumBytesThisRecord


def _read_ping(header: Any, ping: Any, body: Bytes) -> _Ping:
    """Read the port and starboard channels of a ping."""
    from pyxtf import XTFPingChanHeader

    size, at, known = ctypes.sizeof(XTFPingChanHeader), 0, _bands(header)
    found = _Ping(ping, {}, {})
    for _ in range(ping.NumChansToFollow):
        if at + size > body.size:
            raise FileFault(f"declares more channels than ping {ping.PingNumber} has", "export it again")
        channel = XTFPingChanHeader.from_buffer_copy(body[at : at + size])
        number = channel.ChannelNumber % len(header.ChanInfo)
        info = header.ChanInfo[number]
        samples, length = _samples(info, channel, body[at + size :])
        at += size + length
        if number in known and samples.size:
            row, band = SIDES[info.TypeOfChannel], known[number]
            near_to_far = samples[::-1] if row == 0 else samples
            # The ``VoltScale`` of other recorders is often not the amplitude of one count.
            own = header.RecordingProgramName == PROGRAM
            unit = float(info.VoltScale) / counts(samples.dtype) if own else 1.0
            side = _side(ping, (info, channel), near_to_far, unit)
            found.bands.setdefault(band, {}).setdefault(row, side)
            found.frequencies[band] = float(channel.Frequency)
    return found


def _samples(info: Any, channel: Any, body: Bytes) -> tuple[NDArray[Any], int]:
    """Return the samples of a channel in stored order, and their length in bytes."""
    kind = SAMPLES.get(info.SampleFormat) if info.SampleFormat else BY_BYTES.get(info.BytesPerSample)
    if kind is None:
        raise FileFault(
            f"has samples of format {info.SampleFormat} and {info.BytesPerSample} bytes, which is not read here",
            "export it with integers or IEEE floats",
        )
    count = int(channel.NumSamples or info.Reserved)  # the field that old files use
    length = count * np.dtype(kind).itemsize
    if length > body.size:
        raise FileFault(f"has a ping with less than the {count} samples it announces", "export it again")
    return body[:length].view(kind), length


def _side(ping: Any, headers: tuple[Any, Any], samples: NDArray[Any], unit: float) -> recording.SideEchoes:
    """Scale the samples of a channel and determine their slant range."""
    info, channel = headers
    if info.CorrectionFlags == GROUND_RANGE:
        raise FileFault("is corrected to ground range", "export it in slant range")
    # A weight N means that the samples were multiplied by 2^N.
    scaled = np.abs(samples.astype(np.float64)) * unit
    amplitude = np.ldexp(scaled, -int(np.clip(channel.Weight, -40, 40))).astype(np.float32)
    recording.check_amplitude(ping.PingNumber, amplitude)
    reach, lasts = float(channel.SlantRange), float(channel.TimeDuration)
    given = float(ping.SoundVelocity)
    given = 2.0 * given if 650.0 <= given <= 850.0 else given  # one-way, as half the speed
    known = 2.0 * reach / lasts if reach > 0.0 and lasts > 0.0 else given
    speed = recording.plausible_speed(known, given)
    reach = reach if reach > 0.0 else speed * lasts / 2.0
    if not 0.0 < reach < 1e5:
        raise FileFault(f"has no slant range of ping {ping.PingNumber}", "export it with SlantRange set")
    return recording.SideEchoes(amplitude, reach, speed)


def _track(header: Any, headers: list[Any]) -> recording.RecordedTrack:
    """Navigation of the pings, and time and place of the first one where they are recorded."""
    # Positions of the fish, or of the ship where those are all zero.
    x = _first_of(headers, "SensorXcoordinate", "ShipXcoordinate", unknown=np.inf)
    y = _first_of(headers, "SensorYcoordinate", "ShipYcoordinate", unknown=np.inf)
    fixes, times, first = recording.Fixes(x, y, header.NavUnits == DEGREES), _seconds(headers), headers[0]
    attributes: dict[str, Any] = {} if fixes.place is None else fixes.place.attributes()
    clock = first.Hour, first.Minute, first.Second, 10_000 * first.HSeconds
    with contextlib.suppress(ValueError):  # a date that the calendar does not have
        attributes = {
            "time_coverage_start": datetime(first.Year, first.Month, first.Day, *clock).isoformat()
        } | attributes
    return recording.RecordedTrack(times, _platform_columns(headers, times, fixes), attributes)


def _seconds(headers: list[Any]) -> Floats:
    """Seconds from the first ping to each, by the time of day, because dates are often wrong."""
    # The clock resolves 10 ms; a recording without a clock gets one ping a second.
    clock = (
        3600.0 * _column(headers, "Hour")
        + 60.0 * _column(headers, "Minute")
        + _column(headers, "Second")
        + 0.01 * _column(headers, "HSeconds")
    )
    if not np.ptp(clock) > 0.0:
        return np.arange(len(headers), dtype=np.float64)
    return np.unwrap(clock, period=recording.DAY) - clock[0]


def _platform_columns(headers: list[Any], times: Floats, fixes: recording.Fixes) -> tuple[Floats, ...]:
    """Position, depth, altitude and attitude of the sonar at every ping."""
    names = ("SensorXcoordinate", "SensorYcoordinate", "SensorHeading", "SensorPitch", "SensorRoll", "SensorDepth")
    recorded = np.any([_column(headers, name) != 0.0 for name in (*names, "ShipGyro", "SensorPrimaryAltitude")], axis=0)
    depth = _column(headers, "SensorDepth")
    height = _first_of(headers, "SensorPrimaryAltitude", "SensorAuxAltitude")
    compass = _first_of(headers, "SensorHeading", "ShipGyro")
    pitch, roll = _column(headers, "SensorPitch"), _column(headers, "SensorRoll")
    # Without a fix the positions are along +y, by the recorded speed.
    speed = _first_of(headers, "SensorSpeed", "ShipSpeed") * KNOT
    run = np.concatenate([[0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]) * np.diff(times))])
    x, y = fixes.positions(times) or (np.zeros_like(run), run)
    return (
        x, y, recording.fill_gaps(depth, depth > 0.0), recording.fill_gaps(height, height > 0.0),
        recording.heading_from_compass(compass, recorded & (compass != 0.0)),
        recording.fill_gaps(pitch, recorded), recording.fill_gaps(roll, recorded),
    )  # fmt: skip


def _column(headers: list[Any], name: str, unknown: float = 0.0) -> Floats:
    values = np.array([getattr(header, name) for header in headers], dtype=np.float64)
    return np.where(np.isfinite(values), values, unknown)


def _first_of(headers: list[Any], *names: str, unknown: float = 0.0) -> Floats:
    """First of several columns that is not all zero."""
    columns = [_column(headers, name, unknown) for name in names]
    return next((column for column in columns if column.any()), columns[0])


def _bands(header: Any) -> dict[int, int]:
    """Return the frequency that side-scan channels belong to, counted from 0, by the order of ports and starboards."""
    kinds = [SIDES.get(info.TypeOfChannel) for info in header.ChanInfo]
    return {number: kinds[:number].count(kind) for number, kind in enumerate(kinds) if kind is not None}


def _declared(header: Any, band: int, field: str, most: float) -> float:
    """First plausible value of a field in the channels of a band, above 0 and up to a bound; 0 without any."""
    values = [float(getattr(header.ChanInfo[number], field)) for number, each in _bands(header).items() if each == band]
    return next((value for value in values if 0.0 < value <= most), 0.0)


def _frequencies(header: Any, pings: list[_Ping]) -> dict[int, float]:
    """Return the carrier frequencies of the bands that have pings, in Hz; 0 where the file lacks one."""
    # Files have it in kHz, in the header or in the pings.
    found: dict[int, float] = {}
    for band in sorted({band for ping in pings for band in ping.bands}):
        of_pings = next(ping.frequencies[band] for ping in pings if band in ping.frequencies)
        frequency = _declared(header, band, "Frequency", GREATEST) or (of_pings if 0.0 < of_pings <= GREATEST else 0.0)
        found[band] = 1e3 * frequency if frequency < 1e4 else frequency
    return found


XTF = FileFormat(
    "eXtended Triton Format",
    (".xtf",),
    read_xtf,
    write_xtf,
    selects=("frequency",),
    options=(WriteOption("bits", tuple(SAMPLE_TYPES), "size of a sample of XTF"),),
    of_blocks=True,
)
