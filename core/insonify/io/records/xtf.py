"""Recordings in the eXtended Triton Format (XTF) of real side-scan sonars.

pyxtf defines the layout of the packets. Packets are walked here, because the loop of pyxtf relies on an index beside
the file (a pickle), on lengths that may be zero, and on the order of channels.
"""

from __future__ import annotations

import ctypes
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.io.formats import FileFormat, WriteOption
from insonify.io.record_schema import ACROSS, coordinates, labels, platform
from insonify.io.records.files import RECORDS
from insonify.io.records.xtf_track import find_place, platform_columns, seconds, start_time
from insonify.io.records.xtf_writer import PROGRAM, SAMPLE_TYPES, counts, write_xtf

if TYPE_CHECKING:
    import xarray as xr

SIDES = {1: 0, 2: 1}  # TypeOfChannel -> row: port, starboard
SONAR_PACKET, MAGIC, FORMAT = 0, 0xFACE, 123
BLOCK = 1024  # bytes of a file header; one more block for every six further channels
SAMPLES = {2: "<u4", 3: "<u2", 5: "<f4", 8: "u1"}  # by SampleFormat
BY_BYTES = {1: "u1", 2: "<u2", 4: "<u4"}  # by BytesPerSample, where SampleFormat is 0
GROUND_RANGE = 2  # of CorrectionFlags
DEFAULT_SPEED = 1500.0  # m/s, where the file has no plausible one
WIDEST = 8  # bins per sample of the longest ping; a corrupt range gives more


class _Channel(NamedTuple):
    """Echoes of one side of one ping."""

    amplitude: NDArray[np.float32]  # (samples,) near to far
    slant_range: float  # m, of its last edge
    sound_speed: float  # m/s, as the sonar took it


class _Ping(NamedTuple):
    header: Any  # pyxtf.XTFPingHeader
    sides: dict[int, _Channel]


def read_xtf(path: str | Path) -> xr.Dataset:
    """Read a side-scan recording.

    Samples are amplitudes: their standard deviation in uniform patches of a raw recording is half their mean, as for
    the envelope of fully developed speckle (0.523); an intensity would have a ratio of 1. ``intensity`` is the square
    of the samples, in the units of the recorder.

    Parameters
    ----------
    path : str or Path
        An ``.xtf`` file.

    Returns
    -------
    Dataset
        As `simulate` makes it: dimensions (channel, ping_time, range_sample), ``intensity``, ``platform_*``. Intensity
        is 0 where a ping was not recorded; platform variables that the file lacks are NaN; x and y are metres east and
        north of the first fix.

    Raises
    ------
    SceneError
        One sentence with what is wrong with the file and the remedy.
    """
    path = Path(path)
    content = _content(path)
    from pyxtf import XTFFileHeader  # its import is not needed by other commands

    header = XTFFileHeader.from_buffer_copy(content[:BLOCK])
    pings = list(_pings(path, content, header))
    if not pings:
        raise RECORDS.refusal(path, "holds no side-scan pings", "give a recording with port or starboard channels")
    return _dataset(path, header, pings)


def _content(path: Path) -> NDArray[np.uint8]:
    """Map the content of a file that begins like an XTF file."""
    if not path.is_file():
        raise RECORDS.refusal(
            path, "does not exist" if not path.exists() else "is no file", "give the path of a recording"
        )
    if path.stat().st_size < BLOCK:
        raise RECORDS.refusal(
            path, f"has {path.stat().st_size} bytes, less than the header of an XTF file", "copy it again"
        )
    content = np.memmap(path, dtype=np.uint8, mode="r")
    if content[0] != FORMAT:
        raise RECORDS.refusal(path, "is not an XTF file (its first byte is not 123)", "give a recording in XTF")
    return content


def _pings(path: Path, content: NDArray[np.uint8], header: Any) -> Iterator[_Ping]:
    """Yield the pings with a side-scan channel, packet by packet."""
    from pyxtf import XTFPacketStart, XTFPingHeader

    at = BLOCK * max(1, -(-_channels(header) // 6))
    smallest = ctypes.sizeof(XTFPacketStart)
    while at < content.size:
        start = content[at : at + smallest]
        if not start.any() and not content[at:].any():
            return  # padding
        packet = XTFPacketStart.from_buffer_copy(start) if start.size == smallest else None
        if packet is not None and (packet.MagicNumber != MAGIC or packet.NumBytesThisRecord < smallest):
            raise RECORDS.refusal(path, f"holds no XTF packet at byte {at}", "copy or export it again")
        if packet is None or at + packet.NumBytesThisRecord > content.size:
            raise RECORDS.refusal(path, f"ends within the packet at byte {at}", "copy or export it again")
        body = content[at : at + packet.NumBytesThisRecord]
        if packet.HeaderType == SONAR_PACKET:
            if body.size < ctypes.sizeof(XTFPingHeader):
                raise RECORDS.refusal(path, f"has a ping too short for its header at byte {at}", "export it again")
            ping = XTFPingHeader.from_buffer_copy(body[: ctypes.sizeof(XTFPingHeader)])
            sides = _sides(path, header, ping, body[ctypes.sizeof(XTFPingHeader) :])
            if sides:
                yield _Ping(ping, sides)
        at += packet.NumBytesThisRecord


def _channels(header: Any) -> int:
    """Count the channels of all kinds, which determine the length of the header."""
    kinds = ("Sonar", "Bathymetry", "Snippet", "EchoStrength", "Interferometry")
    arrays = int(header.NumberOfForwardLookArrays)
    return arrays + sum(int(getattr(header, f"NumberOf{kind}Channels")) for kind in kinds)


def _sides(path: Path, header: Any, ping: Any, body: NDArray[np.uint8]) -> dict[int, _Channel]:
    """Read the first port and the first starboard channel of a ping, not those of a second frequency."""
    from pyxtf import XTFPingChanHeader

    size, at = ctypes.sizeof(XTFPingChanHeader), 0
    sides: dict[int, _Channel] = {}
    for _ in range(ping.NumChansToFollow):
        if at + size > body.size:
            raise RECORDS.refusal(path, f"declares more channels than ping {ping.PingNumber} has", "export it again")
        channel = XTFPingChanHeader.from_buffer_copy(body[at : at + size])
        info = header.ChanInfo[channel.ChannelNumber % len(header.ChanInfo)]
        samples, length = _samples(path, info, channel, body[at + size :])
        at += size + length
        side = SIDES.get(info.TypeOfChannel)
        if side is not None and side not in sides and samples.size:
            if info.CorrectionFlags == GROUND_RANGE:
                raise RECORDS.refusal(path, "is corrected to ground range", "export it in slant range")
            near_to_far = samples[::-1] if side == 0 else samples
            sides[side] = _channel(path, ping, channel, near_to_far, _unit(header, info, samples.dtype))
    return sides


def _samples(path: Path, info: Any, channel: Any, body: NDArray[np.uint8]) -> tuple[NDArray[Any], int]:
    """Return the samples of a channel in stored order, and their length in bytes."""
    kind = SAMPLES.get(info.SampleFormat) if info.SampleFormat else BY_BYTES.get(info.BytesPerSample)
    if kind is None:
        raise RECORDS.refusal(
            path,
            f"has samples of format {info.SampleFormat} and {info.BytesPerSample} bytes, which is not read here",
            "export it with integers or IEEE floats",
        )
    count = int(channel.NumSamples or info.Reserved)  # the field that old files use
    length = count * np.dtype(kind).itemsize
    if length > body.size:
        raise RECORDS.refusal(path, f"has a ping with less than the {count} samples it announces", "export it again")
    return body[:length].view(kind), length


def _unit(header: Any, info: Any, dtype: np.dtype[Any]) -> float:
    """Amplitude of one count; that of other recorders, whose ``VoltScale`` is often a mere habit, counts as 1."""
    return float(info.VoltScale) / counts(dtype) if header.RecordingProgramName == PROGRAM else 1.0


def _channel(path: Path, ping: Any, channel: Any, samples: NDArray[Any], unit: float) -> _Channel:
    """Scale the samples of a channel and determine their slant range."""
    # A weight N means that the samples were multiplied by 2^N.
    scaled = np.abs(samples.astype(np.float64)) * unit
    amplitude = np.ldexp(scaled, -int(np.clip(channel.Weight, -40, 40))).astype(np.float32)
    if not (np.isfinite(amplitude).all() and amplitude.max() < 1e18):  # its square must fit a float32
        raise RECORDS.refusal(path, f"has samples in ping {ping.PingNumber} that are no echoes", "export it again")
    reach, lasts = float(channel.SlantRange), float(channel.TimeDuration)
    given = float(ping.SoundVelocity)
    given = 2.0 * given if 650.0 <= given <= 850.0 else given  # one-way, as half the speed
    known = 2.0 * reach / lasts if reach > 0.0 and lasts > 0.0 else given
    speed = next((speed for speed in (known, given) if 1300.0 <= speed <= 1700.0), DEFAULT_SPEED)
    reach = reach if reach > 0.0 else speed * lasts / 2.0
    if not 0.0 < reach < 1e5:
        raise RECORDS.refusal(path, f"has no slant range of ping {ping.PingNumber}", "export it with SlantRange set")
    return _Channel(amplitude, reach, speed)


def _dataset(path: Path, header: Any, pings: list[_Ping]) -> xr.Dataset:
    """Record of the pings on a common grid of slant range, with the median bin length."""
    import xarray as xr  # slow to import, and no other command needs it at its start

    channels = [side for ping in pings for side in ping.sides.values()]
    bin_length = sorted(side.slant_range / side.amplitude.size for side in channels)[len(channels) // 2]
    bins = max(round(side.slant_range / bin_length) for side in channels)
    most = max(side.amplitude.size for side in channels)
    if bins > WIDEST * most:
        raise RECORDS.refusal(
            path, f"has slant ranges up to {bins * bin_length:.3g} m in bins of {bin_length:.3g} m", "export it again"
        )
    amplitude = np.zeros((2, len(pings), bins), dtype=np.float32)
    for number, ping in enumerate(pings):
        for side, channel in ping.sides.items():
            _lay(amplitude[side, number], channel, bin_length)
    headers = [ping.header for ping in pings]
    times = seconds(headers)
    columns = platform_columns(header, headers, times)
    slant_range = (np.arange(bins) + 0.5) * bin_length
    return xr.Dataset(
        {"intensity": (ACROSS, amplitude**2, labels("1", "square of the samples"))},
        coordinates(times, slant_range, channels[0].sound_speed),
        {"title": path.name, "frequency": _frequency(header)} | _time_and_place(header, headers),
    ).assign(platform(columns))


def _time_and_place(header: Any, headers: list[Any]) -> dict[str, Any]:
    """Attributes of when and where the recording begins, as far as it tells."""
    start, place = start_time(headers[0]), find_place(header, headers)
    told = {} if start is None else {"time_coverage_start": start}
    return told | ({} if place is None else place.attributes())


def _lay(row: NDArray[np.float32], channel: _Channel, bin_length: float) -> None:
    """Store a channel in its row; one of another bin length is interpolated."""
    samples, step = channel.amplitude, channel.slant_range / channel.amplitude.size
    if abs(channel.slant_range - samples.size * bin_length) < 0.5 * bin_length:
        row[: samples.size] = samples[: row.size]
        return
    count = min(round(channel.slant_range / bin_length), row.size)
    row[:count] = np.interp((np.arange(count) + 0.5) * bin_length, (np.arange(samples.size) + 0.5) * step, samples)


def _frequency(header: Any) -> float:
    """Carrier frequency of the first side-scan channel in Hz, 0 if the file lacks it; files have it in kHz."""
    given = (float(info.Frequency) for info in header.ChanInfo if info.TypeOfChannel in SIDES)
    frequency = next(given, 0.0)
    return 1e3 * frequency if 0.0 < frequency < 1e4 else frequency


XTF = FileFormat(
    "eXtended Triton Format",
    (".xtf",),
    read_xtf,
    write_xtf,
    (WriteOption("bits", tuple(SAMPLE_TYPES), "size of a sample of XTF"),),
)
