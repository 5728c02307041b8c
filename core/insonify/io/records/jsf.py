"""Recordings in EdgeTech's JSF: messages of sonar data (80) of a side-scan subsystem."""

import math
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from insonify.arrays import Booleans, Dataset, Floats
from insonify.io.file_access import FileFault, open_regular
from insonify.io.formats import FileFormat
from insonify.io.records import recording
from insonify.io.records.jsf_writer import (
    ALTITUDE,
    ANGLE,
    ATTITUDE,
    DEPTH,
    HEADING,
    MARKER,
    MESSAGE,
    MINUTE_OF_ARC,
    MINUTES,
    MOST_WEIGHT,
    POSITION,
    SIDE_SCAN,
    SONAR_DATA,
    TRACE,
    write_jsf,
)

ENVELOPE, ANALYTIC = 0, 1  # data formats: one and two 16-bit integers a sample
MORE_BITS, FRACTIONS = 0x0A, 0x0B  # protocol versions from which samples have 20 bits and intervals a fraction
LEAST_STEP = 8.0  # units of position between two fixes that count
MOST_SKIPPED = 2**20  # samples between transmission and recording
METRES = {1: 1e-3, 3: 0.1, 4: 0.01}  # of positions in other units

# Fields of the headers of pings that are kept.
KEPT = np.dtype([(name, TRACE[name]) for name in (
    "time", "ping", "validity", "x", "y", "units", "depth", "altitude", "heading", "pitch", "roll", "milliseconds"
)])  # fmt: skip


class _Band:
    """Side-scan messages of one subsystem, each one side of one ping."""

    def __init__(self, frequency: float, sound_speed: float) -> None:
        self.frequency, self.sound_speed = frequency, sound_speed  # Hz and m/s, of the first
        self.index, self.headers = recording.EchoIndex(), bytearray()


def read_jsf(path: str | Path, frequency: float | None = None) -> Dataset:
    """Read a side-scan recording of EdgeTech."""
    # Samples are envelopes, or magnitudes of analytic signals, scaled by their weights; ``intensity`` is their square.
    path = Path(path)
    formats: dict[recording.SideFormat, int] = {}
    with open_regular(path) as file:
        bands = _read_messages(path, file, formats)
    if not bands:
        raise FileFault("holds no side-scan pings", "give a recording of subsystem 20, 21 or 22")
    number, attributes = recording.choose_band({name: bands[name].frequency for name in sorted(bands)}, frequency)
    band = bands[number]
    headers = np.frombuffer(band.headers, dtype=KEPT)
    del bands
    numbers, stamps = headers["ping"].astype(np.int64), 86_400_000 * headers["time"].astype(np.int64)
    begins, sides = recording.join_sides(band.index.columns(), numbers, stamps + headers["milliseconds"])
    track = _track(path, headers[begins])
    track.attributes.update(attributes)
    return recording.assemble(path, formats, sides, track, band.sound_speed)


def _read_messages(path: Path, file: BinaryIO, formats: dict[recording.SideFormat, int]) -> dict[int, _Band]:
    """Read the headers of all messages, and note where the echoes of each side-scan subsystem are."""
    bands: dict[int, _Band] = {}
    size, at, whole = file.seek(0, 2), 0, 0
    while at < size:
        file.seek(at)
        start = file.read(MESSAGE.itemsize)
        message = np.frombuffer(start, dtype=MESSAGE)[0] if len(start) == MESSAGE.itemsize else None
        if message is not None and message["marker"] != MARKER:
            raise FileFault(f"holds no JSF message at byte {at}", "copy or export it again")
        if message is None or at + MESSAGE.itemsize + int(message["size"]) > size:
            recording.warn_of_cut(path, at, whole)
            return bands
        at += MESSAGE.itemsize
        length = int(message["size"])
        if message["type"] == SONAR_DATA and message["subsystem"] in SIDE_SCAN and message["channel"] in (0, 1):
            whole += 1
            if length < TRACE.itemsize:
                raise FileFault("has a ping too short for its header", "export it again")
            header = np.frombuffer(file.read(TRACE.itemsize), dtype=TRACE)[0]
            form, reach, frequency, speed = _side_format(message, header, length - TRACE.itemsize)
            if form.unchecked:
                recording.check_amplitudes(int(header["ping"]), form, file.read(form.stored))
            band = bands.setdefault(int(message["subsystem"]), _Band(frequency, speed))
            number = formats.setdefault(form, len(formats))
            band.index.add({int(message["channel"]): recording.Side(at + TRACE.itemsize, number, reach)})
            band.headers += np.array([header], dtype=TRACE)[list(KEPT.names or ())].astype(KEPT).tobytes()
        at += length
    return bands


def _side_format(message: Any, header: Any, stored: int) -> tuple[recording.SideFormat, float, float, float]:
    """Determine the format of the samples of a message, slant range, carrier frequency and sound speed."""
    kind, numbers = int(header["format"]), 1 + (header["format"] == ANALYTIC)
    if kind not in (ENVELOPE, ANALYTIC):
        raise FileFault(
            f"has data of format {kind} in ping {header['ping']}, which is not an envelope",
            "export it as envelope or as XTF",
        )
    high = int(header["more"]) if message["version"] >= MORE_BITS else 0
    count = int(header["samples"]) + 65536 * (high >> 8 & 0xF)
    if count == 0 or 2 * numbers * count > stored:
        raise FileFault(f"has a ping with less than the {count} samples it announces", "export it again")
    fraction = int(header["fraction"] & 0xFF) / 256.0 if message["version"] >= FRACTIONS else 0.0
    step = 1e-9 * (int(header["interval"]) + fraction)
    speed = recording.plausible_speed(float(header["speed"]))
    # Samples of the time between transmission and recording are silent.
    skipped = int(header["skipped"])
    if skipped > MOST_SKIPPED or not 0.0 < step * (skipped + count) < 100.0:
        raise FileFault(f"has no sampling interval of ping {header['ping']}", "export it again")
    scale = math.ldexp(1.0, -int(np.clip(header["weight"], -40, MOST_WEIGHT)))
    swept = int(header["start"]) + (high & 0xF) * 65536 + int(header["end"]) + (high >> 4 & 0xF) * 65536
    form = recording.SideFormat("<i2", numbers, count, skipped, False, scale)
    return form, 0.5 * speed * step * form.samples, 5.0 * swept, speed


def _track(path: Path, headers: NDArray[Any]) -> recording.RecordedTrack:
    """Navigation of the pings, and time and place of the first one where they are recorded."""
    clock = headers["milliseconds"].astype(np.float64) / 1e3
    whole = headers["time"].astype(np.float64)
    # Seconds since 1970 and milliseconds of the day belong together where they give the same second.
    times = whole + np.where(np.abs(whole % recording.DAY - clock) < 1.5, clock - whole % recording.DAY, 0.0)
    start = datetime.fromtimestamp(times[0], tz=UTC).replace(tzinfo=None).isoformat()
    times = recording.spread_ticks(path, times)
    fixes = _fixes(path, headers, times)
    x, y = fixes.positions(times) or (np.zeros_like(times), np.zeros_like(times))
    attitude, depth, altitude = _valid(headers, ATTITUDE), headers["depth"] / 1e3, headers["altitude"] / 1e3
    columns = (
        x, y, recording.fill_gaps(depth, _valid(headers, DEPTH) & (depth > 0.0)),
        recording.fill_gaps(altitude, _valid(headers, ALTITUDE) & (altitude > 0.0)),
        recording.heading_from_compass(headers["heading"] / 100.0, _valid(headers, HEADING)),
        recording.fill_gaps(ANGLE * headers["pitch"], attitude), recording.fill_gaps(ANGLE * headers["roll"], attitude),
    )  # fmt: skip
    attributes = {"time_coverage_start": start} | (fixes.place.attributes() if fixes.place else {})
    return recording.RecordedTrack(times, columns, attributes)


def _fixes(path: Path, headers: NDArray[Any], times: Floats) -> recording.Fixes:
    """Positions of the pings, in the units of most of them."""
    units, number = np.unique(headers["units"], return_counts=True)
    unit = int(units[np.argmax(number)])
    known = _apart(headers, _valid(headers, POSITION) & (headers["units"] == unit))
    declared, degrees = (
        recording.Fixes(
            np.where(known, scale * headers["x"], 0.0), np.where(known, scale * headers["y"], 0.0), is_degrees
        )
        for scale, is_degrees in ((METRES.get(unit, 0.0), False), (MINUTE_OF_ARC, True))
    )
    return degrees if unit == MINUTES else recording.settle_units(path, declared, degrees, times, np.zeros(1))


def _apart(headers: NDArray[Any], known: Booleans) -> Booleans:
    """Which of some fixes are far enough from the one before that rounding does not lengthen the way; the last too."""
    # A unit is 0.2 m where a ping advances by as much: the steps of rounded fixes zigzag, and add up to too much.
    kept, places = np.zeros_like(known), np.flatnonzero(known)
    last = (math.inf, math.inf)
    for place, x, y in zip(places.tolist(), headers["x"][places].tolist(), headers["y"][places].tolist()):
        if math.hypot(x - last[0], y - last[1]) >= LEAST_STEP:
            kept[place], last = True, (x, y)
    kept[places[-1:]] = True
    return kept


def _valid(headers: NDArray[Any], bit: int) -> Booleans:
    """Which pings have a quantity; all of them if no ping declares anything."""
    declared = headers["validity"]
    return (declared >> bit & 1).astype(bool) if declared.any() else np.ones(declared.shape, dtype=bool)


JSF = FileFormat("EdgeTech JSF", (".jsf",), read_jsf, write_jsf, selects=("frequency",), of_blocks=True)
