"""A record as survey programs log it: clock, navigation and samples of every ping, in the fields XTF and JSF share."""

import math
import tempfile
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from datetime import datetime, timedelta
from pathlib import Path
from typing import IO, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.arrays import Floats, Singles
from insonify.io.georeference import Georeference, convergence, find_georeference, to_degrees
from insonify.io.record_block import RecordBlock
from insonify.io.record_schema import PLATFORM

ALONG_TRACK, ALONG_RANGE = ("ping_time", *PLATFORM), ("slant_range", "travel_time")
# A record without a place is put into the sea north of Mallorca, on the central meridian of a UTM zone.
NOWHERE = Georeference("+proj=tmerc +lat_0=40 +lon_0=3 +ellps=WGS84 +units=m", (0.0, 0.0))
NO_DATE = "2000-01-01T00:00:00"


class LoggedPing(NamedTuple):
    """Header of a ping in a survey log; NaN where the record does not have a quantity."""

    number: int
    time: datetime  # UTC
    x: float  # longitude or easting
    y: float  # latitude or northing
    degrees: bool  # whether x and y are longitude and latitude on WGS 84, rather than metres
    heading: float  # degrees clockwise from north, above 0 and up to 360
    pitch: float  # degrees, bow up
    roll: float  # degrees, port up
    depth: float  # m
    altitude: float  # m
    speed: float  # m/s over ground
    slant_range: float  # m, of the far edge of the last bin
    duration: float  # s, two-way, to that edge
    frequency: float  # Hz; 0 if unknown


class SurveyLog(NamedTuple):
    """A whole record, its amplitudes in a temporary file."""

    attributes: Mapping[str, Any]
    times: Floats  # (pings,) s
    platform: dict[str, Floats]  # (pings,) each, by the names of PLATFORM
    slant_range: float  # m, of the far edge of the last bin
    duration: float  # s, two-way, to that edge
    bins: int
    loudest: float  # greatest amplitude
    spool: IO[bytes]

    def pings(self) -> Iterator[tuple[LoggedPing, Singles]]:
        """Yield every ping with its amplitudes, (2, bins), port first, near to far."""
        self.spool.seek(0)
        start = datetime.fromisoformat(str(self.attributes.get("time_coverage_start", NO_DATE)))
        place = find_georeference(self.attributes) or NOWHERE
        x, y = self.platform["platform_x"], self.platform["platform_y"]
        bearing = 90.0 - self.platform["platform_heading"] + (convergence(place) if place.crs else 0.0)
        speed = np.zeros_like(x)  # 0 where the times do not increase
        if self.times.size > 1 and (np.diff(self.times) > 0.0).all():
            speed = np.hypot(np.gradient(x, self.times), np.gradient(y, self.times))
        columns = (
            *(to_degrees(place, x, y) if place.crs else (x + place.origin[0], y + place.origin[1])),
            360.0 - np.mod(-bearing, 360.0), *(self.platform[f"platform_{name}"] for name in ("pitch", "roll")),
            self.platform["platform_depth"], self.platform["platform_altitude"], speed,
        )  # fmt: skip
        frequency = float(self.attributes.get("frequency", 0.0))
        for number, (seconds, east, north, *rest) in enumerate(
            zip(self.times.tolist(), *map(np.ndarray.tolist, columns))
        ):
            sides = np.fromfile(self.spool, dtype=np.float32, count=2 * self.bins).reshape(2, self.bins)
            time = start + timedelta(seconds=seconds)
            known = number, time, east, north, bool(place.crs), *rest, self.slant_range, self.duration, frequency
            yield LoggedPing(*known), sides


@contextmanager
def log_record(path: str | Path, blocks: Iterable[RecordBlock]) -> Iterator[SurveyLog]:
    """Store the amplitudes of a record one ping after another beside a file that is to hold them."""
    # The scale of integers follows from the greatest amplitude. Memory does not grow with the echoes.
    parts: list[dict[str, NDArray[Any]]] = []
    attributes: Mapping[str, Any] = {}
    loudest = 0.0
    with tempfile.TemporaryFile(dir=Path(path).parent) as spool:
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
        columns = {
            name: np.concatenate([part[name] for part in parts]) if name in first else unknown for name in PLATFORM
        }
        yield SurveyLog(attributes, times, columns, edge, duration, first["slant_range"].size, loudest, spool)


def count_exponent(loudest: float, bits: int) -> int:
    """Binary exponent of the amplitude of one count: the smallest with which the greatest amplitude fits some bits."""
    if not loudest > 0.0:
        return 0
    exponent = math.frexp(loudest)[1] - bits
    return exponent if round(math.ldexp(loudest, -exponent)) < 2**bits else exponent + 1
