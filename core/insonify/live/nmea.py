"""Sentences of NMEA 0183: what receivers tell about a towfish, and the fixes of a ship that are read.

Sentences and fields: NMEA 0183 version 4.10, as E. S. Raymond, "NMEA Revealed", 2023, lists them.
"""

import math
from functools import reduce
from operator import xor
from typing import NamedTuple

from insonify.live.outputs import LivePing

KNOT, FOOT, FATHOM = 1852.0 / 3600.0, 0.3048, 1.8288  # m/s, m, m


class Fix(NamedTuple):
    """Place and motion of a ship; NaN where its sentences do not tell."""

    time: float = math.nan  # s of the day, UTC
    longitude: float = math.nan
    latitude: float = math.nan
    course: float = math.nan  # degrees clockwise from north, over ground
    speed: float = math.nan  # m/s over ground
    heading: float = math.nan  # degrees clockwise from true north


def write_sentence(*fields: str) -> str:
    """Join fields to a sentence with its checksum."""
    body = ",".join(fields)
    return f"${body}*{_checksum(body):02X}\r\n"


def describe_ping(live: LivePing) -> list[str]:
    """Sentences about a ping: date and time, place, motion over ground, heading, and depth beneath the towfish."""
    ping, knots = live.header, live.header.speed / KNOT
    clock = f"{ping.time:%H%M%S}.{ping.time.microsecond // 10_000:02}"
    below, feet, fathoms = (
        "" if math.isnan(ping.altitude) else f"{ping.altitude / unit:.1f}" for unit in (1, FOOT, FATHOM)
    )
    place = (*_angle(ping.y, 2, "NS"), *_angle(ping.x, 3, "EW"))
    sentences = (
        ("GPZDA", clock, f"{ping.time:%d,%m,%Y}", "00", "00"),
        ("GPGGA", clock, *place, "1", "08", "1.0", "0.0", "M", "0.0", "M", "", ""),
        ("GPVTG", f"{live.course % 360.0:.2f}", "T", "", "M", f"{knots:.2f}", "N", f"{3.6 * ping.speed:.2f}", "K", "A"),
        ("HEHDT", f"{ping.heading % 360.0:.2f}", "T"),
        ("SDDPT", below, f"{ping.depth:.1f}", ""),
        ("SDDBT", feet, "f", below, "M", fathoms, "F"),
    )
    return [write_sentence(*fields) for fields in sentences]


def encode_nmea(live: LivePing) -> bytes:
    """Encode the sentences about a ping."""
    return "".join(describe_ping(live)).encode("ascii")


class FixReader:
    """Gathers the fixes of a ship from GGA, RMC, VTG and HDT; ``refused`` counts damaged sentences."""

    def __init__(self) -> None:
        self.refused, self._last = 0, Fix()

    def read(self, line: str) -> Fix | None:
        """Read a line; return a fix if it gives a place."""
        body, star, checksum = line.strip().partition("*")
        try:
            if not body.startswith("$") or (star and int(checksum[:2], 16) != _checksum(body[1:])):
                raise ValueError(line)
            return self._take(*body[3:].split(","))
        except (ValueError, IndexError):
            self.refused += 1
            return None

    def _take(self, kind: str, *fields: str) -> Fix | None:
        """Take the fields of a sentence over."""
        course, knots = {"RMC": (fields[6:8])[::-1], "VTG": fields[0:5:4]}.get(kind, ("", ""))
        if kind == "HDT":
            self._last = self._last._replace(heading=_finite(fields[0]))
        if course and knots:
            self._last = self._last._replace(course=_finite(course), speed=KNOT * _finite(knots))
        if (kind == "GGA" and fields[5] != "0") or (kind == "RMC" and fields[1] == "A"):
            clock, place = fields[0], fields[1:5] if kind == "GGA" else fields[2:6]
            latitude, longitude = _degrees(place[0], 2, place[1], "NS"), _degrees(place[2], 3, place[3], "EW")
            time = 3600 * int(clock[:2]) + 60 * int(clock[2:4]) + _finite(clock[4:])
            self._last = self._last._replace(time=time, longitude=longitude, latitude=latitude)
            return self._last
        return None


def _checksum(body: str) -> int:
    return reduce(xor, body.encode("ascii", errors="replace"), 0)


def _angle(degrees: float, digits: int, letters: str) -> tuple[str, str]:
    """Degrees and minutes as sentences have them, with the letter of the hemisphere."""
    # In whole millionths, so that no minute is rounded up to 60.
    whole, minutes = divmod(round(abs(degrees) * 60e6), 60_000_000)
    return f"{whole:0{digits}d}{minutes / 1e6:09.6f}", letters[degrees < 0.0]


def _degrees(text: str, digits: int, letter: str, letters: str) -> float:
    return (int(text[:digits]) + _finite(text[digits:]) / 60.0) * (1.0, -1.0)[letters.index(letter)]


def _finite(text: str) -> float:
    if not math.isfinite(value := float(text)):
        raise ValueError(text)
    return value
