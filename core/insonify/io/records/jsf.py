"""Recordings in EdgeTech's JSF: messages of sonar data (80) of a side-scan subsystem.

Offsets and units of fields: EdgeTech, JSF Data File Description, 0023492 rev. M (2024).
"""

from collections.abc import Iterator
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.arrays import Booleans, Bytes, Dataset, Singles
from insonify.io.file_access import FileFault
from insonify.io.formats import FileFormat
from insonify.io.records import recording

MARKER, SONAR_DATA = 0x1601, 80
SIDE_SCAN = (20, 21, 22)  # subsystems: low, high and very high frequency
ENVELOPE, ANALYTIC = 0, 1  # data formats: one and two 16-bit integers a sample
MORE_BITS, FRACTIONS = 0x0A, 0x0B  # protocol versions from which samples have 20 bits and intervals a fraction
MOST_SKIPPED = 2**20  # samples between transmission and recording
MINUTE_OF_ARC = 1.0 / 60e4  # degrees, of positions in units of 2
METRES = {1: 1e-3, 3: 0.1, 4: 0.01}  # of positions in other units
MINUTES = 2
ANGLE = 180.0 / 32768.0  # degrees, of pitch and roll
POSITION, HEADING, ATTITUDE, ALTITUDE, DEPTH = 0, 3, 5, 6, 9  # bits of validity


def _layout(size: int, fields: dict[str, tuple[str, int]]) -> np.dtype[Any]:
    """Layout of a header of so many bytes, from the type and the offset of each field."""
    types, offsets = zip(*fields.values())
    return np.dtype({"names": list(fields), "formats": list(types), "offsets": list(offsets), "itemsize": size})


MESSAGE = _layout(16, {
    "marker": ("<u2", 0), "version": ("u1", 2), "type": ("<u2", 4), "subsystem": ("u1", 7), "channel": ("u1", 8),
    "size": ("<u4", 12),
})  # fmt: skip
TRACE = _layout(240, {
    "time": ("<i4", 0), "skipped": ("<u4", 4), "ping": ("<u4", 8), "more": ("<u2", 16), "fraction": ("<u2", 18),
    "validity": ("<u2", 30), "format": ("<i2", 34), "x": ("<i4", 80), "y": ("<i4", 84), "units": ("<i2", 88),
    "samples": ("<u2", 114), "interval": ("<u4", 116), "start": ("<u2", 126), "end": ("<u2", 128),
    "depth": ("<i4", 136), "altitude": ("<i4", 144), "speed": ("<f4", 148), "weight": ("<i2", 168),
    "heading": ("<u2", 172), "pitch": ("<i2", 174), "roll": ("<i2", 176), "milliseconds": ("<u4", 200),
})  # fmt: skip


class _Trace(NamedTuple):
    """One side of one ping of one subsystem."""

    subsystem: int
    row: int  # 0 port, 1 starboard
    header: Any  # record of TRACE
    frequency: float  # Hz
    side: recording.SideEchoes


def read_jsf(path: str | Path, frequency: float | None = None) -> Dataset:
    """Read a side-scan recording of EdgeTech."""
    # Samples are envelopes, or magnitudes of analytic signals, scaled by their weights; ``intensity`` is their square.
    path = Path(path)
    traces = list(_traces(path, np.fromfile(path, dtype=np.uint8)))
    if not traces:
        raise FileFault("holds no side-scan pings", "give a recording of subsystem 20, 21 or 22")
    frequencies = {trace.subsystem: trace.frequency for trace in reversed(traces)}
    band, attributes = recording.choose_band(dict(sorted(frequencies.items())), frequency)
    sides: dict[int, dict[int, recording.SideEchoes]] = {}
    headers: dict[int, Any] = {}
    for trace in traces:
        if trace.subsystem == band:
            sides.setdefault(int(trace.header["ping"]), {})[trace.row] = trace.side
            headers.setdefault(int(trace.header["ping"]), trace.header)
    last = next(reversed(sides))
    if len(sides[last]) < len(next(iter(sides.values()))):  # the recording ends between port and starboard
        del sides[last], headers[last]
    track = _track(np.array(list(headers.values()), dtype=TRACE))
    track.attributes.update(attributes)
    return recording.assemble(path, list(sides.values()), track)


def _traces(path: Path, content: Bytes) -> Iterator[_Trace]:
    """Yield the side-scan traces, message by message."""
    at, whole = 0, 0
    while at < content.size:
        start = content[at : at + MESSAGE.itemsize]
        message = start.view(MESSAGE)[0] if start.size == MESSAGE.itemsize else None
        if message is not None and message["marker"] != MARKER:
            raise FileFault(f"holds no JSF message at byte {at}", "copy or export it again")
        if message is None or at + MESSAGE.itemsize + int(message["size"]) > content.size:
            recording.warn_of_cut(path, at, whole)
            return
        body = content[at + MESSAGE.itemsize : at + MESSAGE.itemsize + int(message["size"])]
        if message["type"] == SONAR_DATA and message["subsystem"] in SIDE_SCAN and message["channel"] in (0, 1):
            whole += 1
            yield _trace(message, body)
        at += MESSAGE.itemsize + body.size


def _trace(message: Any, body: Bytes) -> _Trace:
    """Scale the samples of a message and determine their slant range."""
    if body.size < TRACE.itemsize:
        raise FileFault("has a ping too short for its header", "export it again")
    header = body[: TRACE.itemsize].view(TRACE)[0]
    high = int(header["more"]) if message["version"] >= MORE_BITS else 0
    envelope = _envelope(header, int(header["samples"]) + 65536 * (high >> 8 & 0xF), body[TRACE.itemsize :])
    skipped = int(header["skipped"])
    fraction = int(header["fraction"] & 0xFF) / 256.0 if message["version"] >= FRACTIONS else 0.0
    step = 1e-9 * (int(header["interval"]) + fraction)
    speed = recording.plausible_speed(float(header["speed"]))
    if skipped > MOST_SKIPPED or not 0.0 < step * (skipped + envelope.size) < 100.0:
        raise FileFault(f"has no sampling interval of ping {header['ping']}", "export it again")
    # Samples of the time between transmission and recording are silent.
    amplitude = np.concatenate([np.zeros(skipped, dtype=np.float32), envelope])
    recording.check_amplitude(int(header["ping"]), amplitude)
    swept = int(header["start"]) + (high & 0xF) * 65536 + int(header["end"]) + (high >> 4 & 0xF) * 65536
    side = recording.SideEchoes(amplitude, 0.5 * speed * step * amplitude.size, speed)
    return _Trace(int(message["subsystem"]), int(message["channel"]), header, 5.0 * swept, side)


def _envelope(header: Any, count: int, body: Bytes) -> Singles:
    """Return the amplitudes of a message."""
    kind = int(header["format"])
    if kind not in (ENVELOPE, ANALYTIC):
        raise FileFault(
            f"has data of format {kind} in ping {header['ping']}, which is not an envelope",
            "export it as envelope or as XTF",
        )
    values = (1 + (kind == ANALYTIC)) * count
    if count == 0 or 2 * values > body.size:
        raise FileFault(f"has a ping with less than the {count} samples it announces", "export it again")
    samples = body[: 2 * values].view("<i2").astype(np.float64)
    magnitude = np.abs(samples) if kind == ENVELOPE else np.hypot(samples[::2], samples[1::2])
    return np.ldexp(magnitude, -int(np.clip(header["weight"], -40, 40))).astype(np.float32)


def _track(headers: NDArray[Any]) -> recording.RecordedTrack:
    """Navigation of the pings, and time and place of the first one where they are recorded."""
    clock = headers["milliseconds"].astype(np.float64) / 1e3
    whole = headers["time"].astype(np.float64)
    # Seconds since 1970 and milliseconds of the day belong together where they give the same second.
    times = whole + np.where(np.abs(whole % recording.DAY - clock) < 1.5, clock - whole % recording.DAY, 0.0)
    fixes = _fixes(headers)
    x, y = fixes.positions(times) or (np.zeros_like(times), np.zeros_like(times))
    attitude, depth, altitude = _valid(headers, ATTITUDE), headers["depth"] / 1e3, headers["altitude"] / 1e3
    columns = (
        x, y, recording.fill_gaps(depth, _valid(headers, DEPTH) & (depth > 0.0)),
        recording.fill_gaps(altitude, _valid(headers, ALTITUDE) & (altitude > 0.0)),
        recording.heading_from_compass(headers["heading"] / 100.0, _valid(headers, HEADING)),
        recording.fill_gaps(ANGLE * headers["pitch"], attitude), recording.fill_gaps(ANGLE * headers["roll"], attitude),
    )  # fmt: skip
    start = datetime.fromtimestamp(times[0], tz=UTC).replace(tzinfo=None).isoformat()
    attributes = {"time_coverage_start": start} | (fixes.place.attributes() if fixes.place else {})
    return recording.RecordedTrack(times - times[0], columns, attributes)


def _fixes(headers: NDArray[Any]) -> recording.Fixes:
    """Positions of the pings, in the units of most of them."""
    units, number = np.unique(headers["units"], return_counts=True)
    unit = int(units[np.argmax(number)])
    scale = MINUTE_OF_ARC if unit == MINUTES else METRES.get(unit, 0.0)
    known = _valid(headers, POSITION) & (headers["units"] == unit)
    x, y = (np.where(known, scale * headers[axis], 0.0) for axis in ("x", "y"))
    return recording.Fixes(x, y, unit == MINUTES)


def _valid(headers: NDArray[Any], bit: int) -> Booleans:
    """Which pings have a quantity; all of them if no ping declares anything."""
    declared = headers["validity"]
    return (declared >> bit & 1).astype(bool) if declared.any() else np.ones(declared.shape, dtype=bool)


JSF = FileFormat("EdgeTech JSF", (".jsf",), read_jsf, selects=("frequency",))
