"""Sentences of NMEA 0183: what a survey's receivers send about a towfish, and the fixes of a ship that are read.

Sentences and fields: NMEA 0183 version 4.10, as E. S. Raymond, "NMEA Revealed", 2023, lists them.
"""

import math
from functools import reduce
from operator import xor
from typing import NamedTuple

from insonify.live.ping import LivePing

KNOT, FOOT, FATHOM = 1852.0 / 3600.0, 0.3048, 1.8288  # m/s, m, m


class Fix(NamedTuple):
    """Place and motion of a ship; NaN where its sentences do not tell."""

    time: float  # s of the day, UTC
    longitude: float
    latitude: float
    course: float = math.nan  # degrees clockwise from north, over ground
    speed: float = math.nan  # m/s over ground
    heading: float = math.nan  # degrees clockwise from true north


def write_sentence(*fields: str) -> str:
    """Join fields to a sentence with its checksum."""
    body = ",".join(fields)
    return f"${body}*{_checksum(body):02X}\r\n"


def describe_ping(live: LivePing) -> list[str]:
    """Sentences about a ping: date and time, place, motion over ground, heading, and depth beneath the towfish."""
    ping = live.header
    hundredths = ping.time.microsecond // 10_000
    clock, date = f"{ping.time:%H%M%S}.{hundredths:02}", f"{ping.time:%d,%m,%Y}"
    place = (*_angle(ping.y, 2, "NS"), *_angle(ping.x, 3, "EW"))
    below = f"{ping.altitude:.1f}" if math.isfinite(ping.altitude) else ""
    feet, fathoms = (f"{ping.altitude / unit:.1f}" if below else "" for unit in (FOOT, FATHOM))
    knots, kilometres = f"{ping.speed / KNOT:.2f}", f"{3.6 * ping.speed:.2f}"
    sentences = (
        ("GPZDA", clock, date, "00", "00"),
        ("GPGGA", clock, *place, "1", "08", "1.0", "0.0", "M", "0.0", "M", "", ""),
        ("GPVTG", f"{live.course % 360.0:.2f}", "T", "", "M", knots, "N", kilometres, "K", "A"),
        ("HEHDT", f"{ping.heading % 360.0:.2f}", "T"),
        ("SDDPT", below, f"{ping.depth:.1f}", ""),
        ("SDDBT", feet, "f", below, "M", fathoms, "F"),
    )
    return [write_sentence(*fields) for fields in sentences]


def encode_nmea(live: LivePing) -> bytes:
    """Encode the sentences about a ping."""
    return "".join(describe_ping(live)).encode("ascii")


class FixReader:
    """Gathers the fixes of a ship from its sentences; damaged and other ones are passed over and counted."""

    def __init__(self) -> None:
        self.refused = 0
        self._last = Fix(math.nan, math.nan, math.nan)

    def read(self, line: str) -> Fix | None:
        """Read a line; return a fix if it gives a place."""
        body, star, checksum = line.strip().partition("*")
        fields = body[1:].split(",")
        known = {"GGA": self._gga, "RMC": self._rmc, "VTG": self._vtg, "HDT": self._hdt}.get(fields[0][2:])
        try:
            if not body.startswith("$") or (star and int(checksum[:2], 16) != _checksum(body[1:])):
                raise ValueError(line)
            return None if known is None else known(fields)
        except (ValueError, IndexError):
            self.refused += 1
            return None

    def _gga(self, fields: list[str]) -> Fix | None:
        return self._at(fields[1], fields[2:6]) if fields[6] != "0" else None

    def _rmc(self, fields: list[str]) -> Fix | None:
        if fields[2] != "A":
            return None
        self._move(fields[8], fields[7])
        return self._at(fields[1], fields[3:7])

    def _vtg(self, fields: list[str]) -> None:
        self._move(fields[1], fields[5])

    def _hdt(self, fields: list[str]) -> None:
        self._last = self._last._replace(heading=_finite(fields[1]))

    def _move(self, course: str, knots: str) -> None:
        if course and knots:
            self._last = self._last._replace(course=_finite(course), speed=KNOT * _finite(knots))

    def _at(self, clock: str, place: list[str]) -> Fix:
        time = 3600 * int(clock[:2]) + 60 * int(clock[2:4]) + _finite(clock[4:])
        latitude, longitude = _degrees(place[0], 2, place[1], "NS"), _degrees(place[2], 3, place[3], "EW")
        self._last = self._last._replace(time=time, longitude=longitude, latitude=latitude)
        return self._last


def _checksum(body: str) -> int:
    return reduce(xor, body.encode("ascii", errors="replace"), 0)


def _angle(degrees: float, digits: int, letters: str) -> tuple[str, str]:
    """Degrees and minutes as sentences have them, with the letter of the hemisphere."""
    units = round(abs(degrees) * 60e6)  # micro-minutes: a minute is never rounded up to 60
    whole, minutes = divmod(units, 60_000_000)
    return f"{whole:0{digits}d}{minutes / 1e6:09.6f}", letters[degrees < 0.0]


def _degrees(text: str, digits: int, letter: str, letters: str) -> float:
    degrees = int(text[:digits]) + _finite(text[digits:]) / 60.0
    return degrees * (1.0, -1.0)[letters.index(letter)] if letter else math.nan


def _finite(text: str) -> float:
    value = float(text)
    if not math.isfinite(value):
        raise ValueError(text)
    return value
