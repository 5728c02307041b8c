"""Recordings in the eXtended Triton Format (XTF) of real side-scan sonars.

pyxtf defines the layout of the packets. Packets are walked here, because the loop of pyxtf relies on an index beside
the file (a pickle), on lengths that may be zero, and on the order of channels.
"""

import contextlib
import ctypes
import math
from array import array
from dataclasses import dataclass, field
from datetime import datetime
from functools import partial
from pathlib import Path
from typing import Any, BinaryIO, NamedTuple

import numpy as np

from insonify.arrays import Dataset, Floats
from insonify.io.file_access import FileFault, open_regular
from insonify.io.formats import FileFormat, WriteOption
from insonify.io.records import recording
from insonify.io.records.xtf_writer import DEGREES, KNOT, PROGRAM, SAMPLE_TYPES, counts, write_xtf

ROW_OF_CHANNEL = {1: 0, 2: 1}  # TypeOfChannel -> row: port, starboard
SONAR_PACKET, MAGIC, FORMAT = 0, 0xFACE, 123
BLOCK = 1024  # bytes of a file header; one more block for every six further channels
SAMPLE_DTYPES = {2: "<u4", 3: "<u2", 5: "<f4", 8: "u1"}  # by SampleFormat
BY_BYTES = {1: "u1", 2: "<u2", 4: "<u4"}  # by BytesPerSample, where SampleFormat is 0
GROUND_RANGE = 2  # of CorrectionFlags
CLOCK = ("Hour", "Minute", "Second", "HSeconds")
# Fields of the headers of pings that are kept, with their types.
FIELDS = {
    "Year": "<u2", "Month": "u1", "Day": "u1", **dict.fromkeys(CLOCK, "u1"), "PingNumber": "<u4",
    **{f"{of}{axis}coordinate": "<f8" for of in ("Sensor", "Ship") for axis in "XY"},
    **dict.fromkeys(("SensorHeading", "ShipGyro", "SensorPitch", "SensorRoll", "SensorDepth"), "<f4"),
    **dict.fromkeys(("SensorPrimaryAltitude", "SensorAuxAltitude", "SensorSpeed", "ShipSpeed"), "<f4"),
}  # fmt: skip
MANY = 1000  # kinds of channels that are remembered
PART = 2**20  # bytes that are read or converted at a time
WIDEST_BEAM = 60.0  # degrees, of a side-scan sonar
GREATEST = 1e7  # of frequencies, in Hz or kHz


@dataclass
class _Band:
    """Side-scan channels of one frequency."""

    frequency: float  # as the first ping has it
    sound_speed: float  # m/s, as the sonar assumed it for the first ping
    index: recording.EchoIndex = field(default_factory=recording.EchoIndex)
    packets: "array[int]" = field(default_factory=lambda: array("i"))  # numbers of those with its channels


def read_xtf(path: str | Path, frequency: float | None = None) -> Dataset:
    """Read a side-scan recording."""
    # Samples are amplitudes: their standard deviation in uniform patches of a raw recording is half their mean, as for
    # the envelope of fully developed speckle (0.523); an intensity would have a ratio of 1. ``intensity`` is the square
    # of the samples, in the units of the recorder.
    path = Path(path)
    if path.stat().st_size < BLOCK:
        raise FileFault(f"has {path.stat().st_size} bytes, less than the header of an XTF file", "copy it again")
    from pyxtf import XTFFileHeader  # its import is not needed by other commands

    with open_regular(path) as file:
        content = file.read(BLOCK)
        if content[0] != FORMAT:
            raise FileFault("is not an XTF file (its first byte is not 123)", "give a recording in XTF")
        header = XTFFileHeader.from_buffer_copy(content)
        reader = _Reader(path, file, header)
        reader.read()
    if not reader.bands:
        raise FileFault("holds no side-scan pings", "give a recording with port or starboard channels")
    number, attributes = recording.choose_band(_frequencies(header, reader.bands), frequency)
    band, formats, columns = reader.bands[number], list(reader.formats), reader.columns()
    packets = np.frombuffer(band.packets, dtype=np.int32)
    reader.bands.clear()
    stamps = np.zeros(packets.size, dtype=np.int64)
    for name, hundredths in zip(CLOCK, (360_000, 6_000, 100, 1)):
        stamps += hundredths * columns[name][packets].astype(np.int64)
    begins, sides = recording.join_sides(band.index.columns(), columns.pop("PingNumber")[packets], stamps)
    if begins.size < columns["Hour"].size:
        for name, column in columns.items():  # one by one, so that the memory of each is free before the next
            columns[name] = column[packets[begins]]
    del packets, stamps, begins
    track = _track(path, header, columns)
    track.attributes.update(attributes)
    if width := _declared(header, number, "HorizBeamAngle", WIDEST_BEAM):
        track.attributes["beam_width"] = width
    return recording.assemble(path, formats, sides, track, band.sound_speed)


class _Reader:
    """Reads the headers of a file packet by packet, and notes where the echoes of its pings are."""

    def __init__(self, path: Path, file: BinaryIO, header: Any) -> None:
        from pyxtf import XTFPacketStart, XTFPingChanHeader, XTFPingHeader

        self.bands: dict[int, _Band] = {}
        self.formats: dict[recording.SideFormat, int] = {}
        self._path, self._file, self._header = path, file, header
        self._start, self._ping, self._channel = XTFPacketStart, XTFPingHeader, XTFPingChanHeader
        self._size = file.seek(0, 2)
        self._known = _bands(header)
        self._kept: dict[tuple[Any, ...], _Channel] = {}  # by the fields that they follow from
        self._columns = {name: bytearray() for name in FIELDS}
        self._pending = bytearray()  # headers of packets that are not in the columns yet
        offsets = [getattr(XTFPingHeader, name).offset for name in FIELDS]
        self._layout = np.dtype({
            "names": list(FIELDS), "formats": list(FIELDS.values()), "offsets": offsets,
            "itemsize": ctypes.sizeof(XTFPingHeader),
        })  # fmt: skip

    def columns(self) -> dict[str, Any]:
        """Hand over the fields of the headers of all packets with side-scan channels, (packets,) each."""
        self._flush()
        given, self._columns = self._columns, {}
        return {name: np.frombuffer(column, dtype=FIELDS[name]) for name, column in given.items()}

    def read(self) -> None:
        """Read all packets."""
        kinds = ("Sonar", "Bathymetry", "Snippet", "EchoStrength", "Interferometry")
        names = [*(f"NumberOf{kind}Channels" for kind in kinds), "NumberOfForwardLookArrays"]
        channels = sum(int(getattr(self._header, name)) for name in names)
        at = BLOCK * max(1, -(-channels // 6))  # the header is as long as these need
        smallest, whole = ctypes.sizeof(self._start), 0
        while at < self._size:
            start = self._take(at, smallest)
            if not any(start) and self._is_padding(at):
                return
            packet = self._start.from_buffer_copy(start) if len(start) == smallest else None
            if packet is not None and (packet.MagicNumber != MAGIC or packet.NumBytesThisRecord < smallest):
                raise FileFault(f"holds no XTF packet at byte {at}", "copy or export it again")
            if packet is None or at + packet.NumBytesThisRecord > self._size:
                recording.warn_of_cut(self._path, at, whole)
                return
            if packet.HeaderType == SONAR_PACKET:
                whole += self._read_ping(at, at + packet.NumBytesThisRecord, whole)
            at += packet.NumBytesThisRecord

    def _take(self, at: int, size: int) -> bytes:
        self._file.seek(at)
        return self._file.read(size)

    def _is_padding(self, at: int) -> bool:
        """Whether the rest of the file is zeros."""
        self._file.seek(at)
        return not any(map(any, iter(partial(self._file.read, PART), b"")))

    def _flush(self) -> None:
        headers = np.frombuffer(bytes(self._pending), dtype=self._layout)
        for name, column in self._columns.items():
            column.extend(headers[name].tobytes())
        self._pending.clear()

    def _read_ping(self, at: int, end: int, number: int) -> bool:
        """Note the port and starboard channels of a packet; return whether it has any."""
        size = ctypes.sizeof(self._ping)
        if end - at < size:
            raise FileFault(f"has a ping too short for its header at byte {at}", "export it again")
        content = self._take(at, size)
        ping = self._ping.from_buffer_copy(content)
        found: dict[int, dict[int, recording.Side]] = {}
        at += size
        size = ctypes.sizeof(self._channel)
        for _ in range(ping.NumChansToFollow):
            if at + size > end:
                raise FileFault(f"declares more channels than ping {ping.PingNumber} has", "export it again")
            channel = self._channel.from_buffer_copy(self._take(at, size))
            at += size
            place = channel.ChannelNumber % len(self._header.ChanInfo)
            info = self._header.ChanInfo[place]
            kind, count = _samples(info, channel)
            length = count * np.dtype(kind).itemsize
            if at + length > end:
                raise FileFault(f"has a ping with less than the {count} samples it announces", "export it again")
            if place in self._known and count:
                band = self._known[place]
                one = self._channel_of(ping, place, channel)
                if one.unchecked is not None:
                    recording.check_amplitudes(ping.PingNumber, one.unchecked, self._take(at, length))
                if band not in self.bands:
                    self.bands[band] = _Band(float(channel.Frequency), one.sound_speed)
                side = recording.Side(at, one.format, one.slant_range)
                found.setdefault(band, {}).setdefault(ROW_OF_CHANNEL[info.TypeOfChannel], side)
            at += length
        for band, sides in found.items():
            self.bands[band].index.add(sides)
            self.bands[band].packets.append(number)
        if found:
            self._pending += content
            if len(self._pending) > PART:
                self._flush()
        return bool(found)

    def _channel_of(self, ping: Any, place: int, channel: Any) -> "_Channel":
        """Return what the headers of a channel give; the same fields give the same."""
        fields = channel.NumSamples, channel.SlantRange, channel.TimeDuration, channel.Weight, ping.SoundVelocity
        found = self._kept.get((place, *fields))
        if found is None:
            form, slant_range, speed = _side_format(self._header, place, ping, channel)
            number = self.formats.setdefault(form, len(self.formats))
            found = _Channel(number, slant_range, speed, form if form.unchecked else None)
            if len(self._kept) > MANY:
                self._kept.clear()
            self._kept[place, *fields] = found
        return found


class _Channel(NamedTuple):
    """What the headers of a channel give."""

    format: int  # number of the format of its samples
    slant_range: float  # m, of the last edge
    sound_speed: float  # m/s
    unchecked: recording.SideFormat | None  # the format, if its numbers have to be checked


def _samples(info: Any, channel: Any) -> tuple[str, int]:
    """Return the type and the number of the samples of a channel."""
    kind = SAMPLE_DTYPES.get(info.SampleFormat) if info.SampleFormat else BY_BYTES.get(info.BytesPerSample)
    if kind is None:
        raise FileFault(
            f"has samples of format {info.SampleFormat} and {info.BytesPerSample} bytes, which is not read here",
            "export it with integers or IEEE floats",
        )
    return kind, int(channel.NumSamples or info.Reserved)  # the field that old files use


def _side_format(header: Any, place: int, ping: Any, channel: Any) -> tuple[recording.SideFormat, float, float]:
    """Determine the format of the samples of a channel, their slant range, and the sound speed."""
    info = header.ChanInfo[place]
    if info.CorrectionFlags == GROUND_RANGE:
        raise FileFault("is corrected to ground range", "export it in slant range")
    kind, count = _samples(info, channel)
    # The ``VoltScale`` of other recorders is often not the amplitude of one count.
    unit = float(info.VoltScale) / counts(np.dtype(kind)) if header.RecordingProgramName == PROGRAM else 1.0
    # A weight N means that the samples were multiplied by 2^N.
    scale = math.ldexp(unit, -min(max(channel.Weight, -40), 40))
    reach, lasts = float(channel.SlantRange), float(channel.TimeDuration)
    given = float(ping.SoundVelocity)
    given = 2.0 * given if 650.0 <= given <= 850.0 else given  # one-way, as half the speed
    known = 2.0 * reach / lasts if reach > 0.0 and lasts > 0.0 else given
    speed = recording.plausible_speed(known, given)
    reach = reach if reach > 0.0 else speed * lasts / 2.0
    if not 0.0 < reach < 1e5:
        raise FileFault(f"has no slant range of ping {ping.PingNumber}", "export it with SlantRange set")
    return recording.SideFormat(kind, 1, count, 0, ROW_OF_CHANNEL[info.TypeOfChannel] == 0, scale), reach, speed


def _track(path: Path, header: Any, columns: dict[str, Any]) -> recording.RecordedTrack:
    """Navigation of the pings, and time and place of the first one where they are recorded; columns are used up."""
    first = {name: int(columns[name][0]) for name in ("Year", "Month", "Day", *CLOCK)}
    times = _seconds(path, columns)
    recorded = np.zeros(times.size, dtype=np.bool_)
    names = ("SensorXcoordinate", "SensorYcoordinate", "SensorHeading", "SensorPitch", "SensorRoll", "SensorDepth")
    for name in (*names, "ShipGyro", "SensorPrimaryAltitude"):
        recorded |= columns[name] != 0.0
    # Positions of the fish, or of the ship where those are all zero.
    x, y = (_first_of(columns, f"Sensor{axis}coordinate", f"Ship{axis}coordinate", unknown=np.inf) for axis in "XY")
    declared, other = (recording.Fixes(x, y, (header.NavUnits == DEGREES) is same) for same in (True, False))
    speed = _first_of(columns, "SensorSpeed", "ShipSpeed") * KNOT
    fixes = recording.settle_units(path, declared, other, times, speed)
    positions, place = fixes.positions(times), fixes.place
    del x, y, declared, other, fixes
    # Without a fix the positions are along +y, by the recorded speed.
    run = np.concatenate([[0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]) * np.diff(times))])
    if positions is not None:
        recording.check_advance(path, *positions, float(run[-1]))
    x, y = positions or (np.zeros_like(run), run)
    del speed, run
    attributes: dict[str, Any] = {} if place is None else place.attributes()
    with contextlib.suppress(ValueError):  # a date that the calendar does not have
        year, month, day, hour, minute, second, hundredths = first.values()
        start = datetime(year, month, day, hour, minute, second, 10_000 * hundredths)
        attributes = {"time_coverage_start": start.isoformat()} | attributes
    depth = _column(columns, "SensorDepth")
    height = _first_of(columns, "SensorPrimaryAltitude", "SensorAuxAltitude")
    compass = _first_of(columns, "SensorHeading", "ShipGyro")
    pitch, roll = _column(columns, "SensorPitch"), _column(columns, "SensorRoll")
    platform = (
        x, y, recording.fill_gaps(depth, depth > 0.0), recording.fill_gaps(height, height > 0.0),
        recording.heading_from_compass(compass, recorded & (compass != 0.0)),
        recording.fill_gaps(pitch, recorded), recording.fill_gaps(roll, recorded),
    )  # fmt: skip
    return recording.RecordedTrack(times, platform, attributes)


def _seconds(path: Path, columns: dict[str, Any]) -> Floats:
    """Seconds from the first ping to each, by the time of day, because dates are often wrong."""
    clock = np.zeros(columns["Hour"].size, dtype=np.float64)
    for name, unit in zip(CLOCK, (3600.0, 60.0, 1.0, 0.01)):
        clock += unit * columns.pop(name)
    return recording.spread_ticks(path, np.unwrap(clock, period=recording.DAY))


def _column(columns: dict[str, Any], name: str, unknown: float = 0.0) -> Floats:
    """Take a column out of the others."""
    values = columns.pop(name).astype(np.float64)
    values[~np.isfinite(values)] = unknown
    return values


def _first_of(columns: dict[str, Any], *names: str, unknown: float = 0.0) -> Floats:
    """Take several columns out of the others; return the first of them that is not all zero."""
    found = _column(columns, names[0], unknown)
    for name in names[1:]:
        found = found if found.any() else _column(columns, name, unknown)
        columns.pop(name, None)
    return found


def _bands(header: Any) -> dict[int, int]:
    """Return the frequency that side-scan channels belong to, counted from 0, by the order of ports and starboards."""
    kinds = [ROW_OF_CHANNEL.get(info.TypeOfChannel) for info in header.ChanInfo]
    return {number: kinds[:number].count(kind) for number, kind in enumerate(kinds) if kind is not None}


def _declared(header: Any, band: int, field: str, most: float) -> float:
    """First plausible value of a field in the channels of a band, above 0 and up to a bound; 0 without any."""
    values = [float(getattr(header.ChanInfo[number], field)) for number, each in _bands(header).items() if each == band]
    return next((value for value in values if 0.0 < value <= most), 0.0)


def _frequencies(header: Any, bands: dict[int, _Band]) -> dict[int, float]:
    """Return the carrier frequencies of the bands that have pings, in Hz; 0 where the file lacks one."""
    # Files have it in kHz, in the header or in the pings.
    found: dict[int, float] = {}
    for band, each in sorted(bands.items()):
        of_pings = each.frequency if 0.0 < each.frequency <= GREATEST else 0.0
        frequency = _declared(header, band, "Frequency", GREATEST) or of_pings
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
