"""Messages of EdgeTech's JSF: their layouts, and the encoding of pings for files and streams.

Offsets and units of fields: EdgeTech, JSF Data File Description, 0023492 rev. M (2024).
"""

import math
from collections.abc import Iterable
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any

import numpy as np

from insonify.arrays import Singles
from insonify.io.georeference import find_georeference
from insonify.io.record_block import RecordBlock
from insonify.io.records.survey_log import LoggedPing, count_exponent, log_record

MARKER, VERSION = 0x1601, 0x11  # of the protocol; centimetres came with it
SONAR_DATA, NMEA, ATTITUDE_DATA = 80, 2002, 2020
SIDE_SCAN, PARSED = (20, 21, 22), 101  # subsystems: low, high and very high frequency; sensors
BITS, MOST_WEIGHT = 15, 64  # of samples, the highest of which is the sign
MINUTE_OF_ARC = 1.0 / 60e4  # degrees, of positions in units of 2
MINUTES, CENTIMETRES = 2, 4
ANGLE = 180.0 / 32768.0  # degrees, of pitch and roll
KNOT = 1852.0 / 3600.0  # m/s
POSITION, SPEED, HEADING, ATTITUDE, ALTITUDE, DEPTH, NOTE, SOUND_SPEED = 0, 2, 3, 5, 6, 9, 10, 14  # bits of validity
MADE_UP = b"place made up"


def _layout(size: int, fields: dict[str, tuple[Any, int]]) -> np.dtype[Any]:
    """Layout of a header of so many bytes, from the type and the offset of each field."""
    types, offsets = zip(*fields.values())
    return np.dtype({"names": list(fields), "formats": list(types), "offsets": list(offsets), "itemsize": size})


MESSAGE = _layout(16, {
    "marker": ("<u2", 0), "version": ("u1", 2), "type": ("<u2", 4), "command": ("u1", 6), "subsystem": ("u1", 7),
    "channel": ("u1", 8), "size": ("<u4", 12),
})  # fmt: skip
TRACE = _layout(240, {
    "time": ("<i4", 0), "skipped": ("<u4", 4), "ping": ("<u4", 8), "more": ("<u2", 16), "fraction": ("<u2", 18),
    "finer": ("<u2", 20), "code": ("<i2", 28), "validity": ("<u2", 30), "format": ("<i2", 34), "x": ("<i4", 80),
    "y": ("<i4", 84), "units": ("<i2", 88), "note": ("S24", 90), "samples": ("<u2", 114), "interval": ("<u4", 116),
    "start": ("<u2", 126), "end": ("<u2", 128), "depth": ("<i4", 136), "rate": ("<u2", 140), "altitude": ("<i4", 144),
    "speed": ("<f4", 148), "mixer": ("<f4", 152), "date": (("<i2", 5), 156), "basis": ("<i2", 166),
    "weight": ("<i2", 168), "pulses": ("<i2", 170), "heading": ("<u2", 172), "pitch": ("<i2", 174),
    "roll": ("<i2", 176), "fix_clock": (("<i2", 3), 186), "knots": ("<i2", 194), "fix_date": (("<i2", 2), 196),
    "milliseconds": ("<u4", 200), "packet": ("<u2", 220),
})  # fmt: skip
SENSOR = _layout(44, {
    "time": ("<i4", 0), "milliseconds": ("<i4", 4), "pitch": ("<i2", 24), "roll": ("<i2", 26), "heading": ("<u2", 34),
    "validity": ("<i4", 36),
})  # fmt: skip


def write_jsf(path: str | Path, blocks: Iterable[RecordBlock]) -> None:
    """Write a record as a side-scan recording."""
    # All pings have one weight, because some programs ignore it.
    with log_record(path, blocks) as log, Path(path).open("wb") as file:
        weight, note = -count_exponent(log.loudest, BITS), b"" if find_georeference(log.attributes) else MADE_UP
        for ping, sides in log.pings():
            file.write(encode_attitude(ping) + encode_ping(ping, sides, weight, note=note))


def encode_ping(
    ping: LoggedPing, sides: Singles, weight: int | None = None, *, subsystem: int = 20, note: bytes = b""
) -> bytes:
    """Encode a ping as two messages of sonar data (80), port and starboard.

    Parameters
    ----------
    ping
        Its header.
    sides
        Amplitudes near to far, (2, bins), port first.
    weight
        Samples are amplitudes times 2 to the power of this; what exceeds 16 bits is clipped. None: the greatest with
        which the ping fits.
    subsystem
        20, 21 or 22: low, high or very high frequency.
    note
        Up to 24 letters in ASCII.

    Returns
    -------
    bytes
        The messages as files and topsides have them.
    """
    weight = min(-count_exponent(float(sides.max()), BITS) if weight is None else weight, MOST_WEIGHT)
    body = _trace(ping, sides.shape[1], weight, note)
    stored = np.rint(np.ldexp(sides.astype(np.float64), weight)).clip(0, 2**BITS - 1).astype("<i2")
    return b"".join(_message(SONAR_DATA, body + row.tobytes(), subsystem, side) for side, row in enumerate(stored))


def encode_attitude(ping: LoggedPing) -> bytes:
    """Encode pitch, roll and heading of a ping as a message of an attitude sensor (2020)."""
    body = np.zeros((), SENSOR)
    body["time"], _, body["milliseconds"] = _clock(ping.time)
    known = _fill(
        body, {"pitch": ping.pitch / ANGLE, "roll": ping.roll / ANGLE, "heading": 100.0 * ping.heading % 36e3}
    )
    body["validity"] = sum(known[name] << bit for name, bit in (("pitch", 6), ("roll", 7), ("heading", 9)))
    return _message(ATTITUDE_DATA, body.tobytes(), PARSED)


def encode_nmea(time: datetime, sentence: str) -> bytes:
    """Encode a sentence of NMEA 0183, received at a time in UTC, as a message (2002)."""
    seconds, _, milliseconds = _clock(time)
    body = np.array([seconds, milliseconds, 1], "<i4").tobytes()  # 1: of the sonar
    return _message(NMEA, body + sentence.encode("ascii"), PARSED)


def _message(kind: int, body: bytes, subsystem: int, channel: int = 0) -> bytes:
    header = np.zeros((), MESSAGE)
    for name, value in (
        ("marker", MARKER), ("version", VERSION), ("type", kind), ("command", 2), ("subsystem", subsystem),
        ("channel", channel), ("size", len(body)),
    ):  # fmt: skip
        header[name] = value
    return header.tobytes() + body


def _clock(time: datetime) -> tuple[int, datetime, int]:
    """Seconds since 1970, the time to the millisecond, and milliseconds of the second."""
    rounded = time.replace(tzinfo=UTC) + timedelta(microseconds=500)
    return int(rounded.timestamp()), rounded, rounded.microsecond // 1000


def _orientation(ping: LoggedPing) -> dict[str, float]:
    heading = 100.0 * (round(ping.heading, 2) % 360.0)
    return {"heading": heading, "pitch": ping.pitch / ANGLE, "roll": ping.roll / ANGLE}


def _fill(header: Any, values: dict[str, float]) -> dict[str, bool]:
    """Set the fields of a header that are known, rounded and clipped to their integers; return which are."""
    known = {name: math.isfinite(value) for name, value in values.items()}
    for name, value in values.items():
        if known[name]:
            limits = np.iinfo(header.dtype[name])
            header[name] = min(max(round(value), limits.min), limits.max)
    return known


def _trace(ping: LoggedPing, bins: int, weight: int, note: bytes) -> bytes:
    """Header of the samples of one side."""
    header = np.zeros((), TRACE)
    seconds, time, milliseconds = _clock(ping.time)
    day, clock = time.timetuple().tm_yday, (time.hour, time.minute, time.second)
    interval = round(256e9 * ping.duration / bins)  # in 1/256 ns
    frequency = min(round(ping.frequency / 10.0), 2**20 - 1)
    knots = round(100.0 * ping.speed / KNOT) if math.isfinite(ping.speed) else 0
    for name, value in {
        "time": seconds, "ping": ping.number, "more": frequency >> 16 | frequency >> 16 << 4 | bins >> 16 << 8,
        "fraction": interval & 0xFF, "finer": knots % 10, "code": 1, "note": note, "samples": bins & 0xFFFF,
        "units": MINUTES if ping.degrees else CENTIMETRES, "interval": interval >> 8, "start": frequency & 0xFFFF,
        "end": frequency & 0xFFFF, "rate": round(bins / ping.duration) & 0xFFFF,
        "speed": 2.0 * ping.slant_range / ping.duration, "mixer": ping.frequency, "date": (time.year, day, *clock),
        "basis": 3, "weight": weight, "pulses": 1, "fix_clock": clock, "knots": knots // 10,
        "fix_date": (day, time.year), "packet": 1,
        "milliseconds": 1000 * (3600 * time.hour + 60 * time.minute + time.second) + milliseconds,
    }.items():  # fmt: skip
        header[name] = value
    scale = 1.0 / MINUTE_OF_ARC if ping.degrees else 100.0
    place = {"x": scale * ping.x, "y": scale * ping.y, "depth": 1e3 * ping.depth, "altitude": 1e3 * ping.altitude}
    known = _fill(header, place | _orientation(ping))
    valid = (
        (POSITION, known["x"] and known["y"]), (SPEED, math.isfinite(ping.speed)), (HEADING, known["heading"]),
        (ATTITUDE, known["pitch"] and known["roll"]), (ALTITUDE, known["altitude"]), (DEPTH, known["depth"]),
        (NOTE, bool(note)), (SOUND_SPEED, True),
    )  # fmt: skip
    header["validity"] = sum(is_valid << bit for bit, is_valid in valid)
    return header.tobytes()
