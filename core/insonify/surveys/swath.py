"""Swath of a record on the map: lines of the pings, and their echoes at every ground range."""

import math
from collections.abc import Iterator, Sequence
from functools import cached_property, lru_cache, partial
from typing import Any, NamedTuple

import numpy as np

from insonify.arrays import Dataset, Floats, Reals, Singles
from insonify.display.normalisation import MedianCurve, normalise
from insonify.display.sheet import find_median_curve
from insonify.io.georeference import Georeference, find_georeference, project, utm_zone
from insonify.io.record_schema import read_echoes, split_record
from insonify.io.records import read_record
from insonify.io.records.bottom_track import BOTTOM_TRACK, find_altitude, track_bottom
from insonify.scene import SceneError
from insonify.surveys import ALTITUDES

BLOCK = 2**19  # echoes that are laid at a time
SIDEWAYS = (90.0, -90.0)  # degrees from the heading to port and starboard


class Swath(NamedTuple):
    """Successive pings of a record as lines on the map, from below the sonar to the farthest ground range."""

    nadir: Floats  # (pings, 2) easting and northing below the sonar, in metres
    ends: Floats  # (pings, 2, 2) of the far ends of both sides, port first
    reach: float  # ground range of the far ends, in metres
    altitude: Floats  # (pings,) in metres
    amplitude: Singles  # (pings, 2, bins) relative to the median of the record at that slant range
    bin_length: float  # in metres of slant range

    @property
    def spacing(self) -> float:
        """Median distance between successive pings, in metres; 0 of a single ping."""
        return _median_step(self.nadir)

    @property
    def corners(self) -> Floats:
        """Lower left and upper right corner of the rectangle that holds the swath, (2, 2)."""
        return _rectangle(self.nadir, self.ends)

    def blocks(self, low: Reals, high: Reals) -> Iterator[tuple["Swath", int]]:
        """Yield the pings, and their number."""
        yield self, self.altitude.size


class RecordSwath:
    """The swath of a record on the map, laid some pings at a time."""

    def __init__(self, name: str, record: Dataset, crs: str, altitude: str = ALTITUDES[0]) -> None:
        self._name, self._record, self._crs = name, record, crs
        self.altitude = _altitudes(name, record, altitude)
        self.bin_length = 2.0 * float(record["slant_range"].values[0])
        farthest, lowest = record.sizes["range_sample"] * self.bin_length, float(self.altitude.min())
        if not lowest < farthest:
            raise SceneError(
                f"{name}: ends at a slant range of {farthest:g} m, before the bed {lowest:g} m beneath; leave it out"
            )
        self.reach = math.sqrt(farthest**2 - lowest**2)
        self._bearing = np.radians(_headings(record))
        self._pings = list(split_record(record, together=BLOCK))
        nadir, self._corners = np.empty((self.altitude.size, 2)), []
        for some in self._pings:
            places = self._lay(_with_next(some))
            self._corners.append(_rectangle(*places))
            nadir[some] = places[0][: some.stop - some.start]
        self.spacing = _median_step(nadir)
        least, most = np.array(self._corners).swapaxes(0, 1)
        self.corners = np.stack([least.min(axis=0), most.max(axis=0)])

    @cached_property
    def _curve(self) -> MedianCurve:
        return find_median_curve(self._record, self.altitude)

    def blocks(self, low: Reals, high: Reals) -> Iterator[tuple[Swath, int]]:
        """Yield the pings that reach into a rectangle: blocks, each with the ping behind it, and the number without."""
        for some, (least, most) in zip(self._pings, self._corners):
            if (most >= low).all() and (least <= high).all():
                extended = _with_next(some)
                altitude = self.altitude[extended]
                amplitude = normalise(read_echoes(self._record, extended), self._curve.at(altitude)[:, None])
                places = self._lay(extended)
                yield Swath(*places, self.reach, altitude, amplitude, self.bin_length), some.stop - some.start

    def _lay(self, some: slice) -> tuple[Floats, Floats]:
        """Places below the sonar, and far ends of both sides, of some pings on the map."""
        x, y = (self._record[f"platform_{axis}"].values[some] for axis in "xy")
        bearing, reach, place = self._bearing[some], self.reach, find_georeference(self._record.attrs)
        turns = np.radians(SIDEWAYS)
        far = [(x + reach * np.cos(bearing + turn), y + reach * np.sin(bearing + turn)) for turn in turns]
        nadir, *ends = (put_on_map(self._name, place, self._crs, *points) for points in ((x, y), *far))
        return nadir, np.stack(ends, axis=1)


def _with_next(some: slice) -> slice:
    return slice(some.start, some.stop + 1)


def _median_step(nadir: Floats) -> float:
    steps = np.hypot(*np.diff(nadir, axis=0).T)
    return float(np.median(steps)) if steps.size else 0.0


def _rectangle(nadir: Floats, ends: Floats) -> Floats:
    points = np.concatenate([nadir, ends.reshape(-1, 2)])
    return np.stack([points.min(axis=0), points.max(axis=0)])


class StoredSwaths(Sequence[RecordSwath]):
    """Swaths of records on one map, read on demand; only the last record stays in memory.

    The map is as given by ``crs``, or else the UTM zone of the first record's first ping.
    """

    def __init__(
        self, paths: Sequence[str], crs: str | None = None, altitude: str = ALTITUDES[0], frequency: float | None = None
    ) -> None:
        self._paths, self._altitude = paths, altitude
        self._swath = lru_cache(maxsize=1)(self._lay)
        self._read = lru_cache(maxsize=1)(partial(read_record, frequency=frequency))
        first = self._read(paths[0])
        self._place, self.crs = find_georeference(first.attrs), crs or ""
        if crs is not None and self._place is None:
            raise SceneError(f"{paths[0]}: has no geographic position, so that --crs does not apply; leave it out")
        if crs is None and self._place is not None and self._place.crs:
            longitude, latitude = first["platform_longitude"].values[0], first["platform_latitude"].values[0]
            self.crs = utm_zone(float(longitude), float(latitude))

    def __len__(self) -> int:
        return len(self._paths)

    def __getitem__(self, number: Any) -> Any:
        return self._swath(self._paths[number])

    def _lay(self, path: str) -> RecordSwath:
        return RecordSwath(path, self._read(path), self.crs, self._altitude)

    def on_map(self, points: Sequence[tuple[float, float]]) -> Floats:
        """Map points of the scene of the first record to the map of the swaths, (n, 2)."""
        x, y = np.array(points, dtype=np.float64).T
        return put_on_map(self._paths[0], self._place, self.crs, x, y)


def _altitudes(name: str, record: Dataset, altitude: str) -> Floats:
    if altitude == ALTITUDES[0]:
        found = find_altitude(record)
    elif BOTTOM_TRACK in record:
        found = record[BOTTOM_TRACK].values
    else:
        found = track_bottom(record.variables["intensity"], 2.0 * float(record["slant_range"].values[0]))
    if not np.isfinite(found).all():
        raise SceneError(f"{name}: has neither an altitude nor a first echo of the bed; leave it out of the mosaic")
    return found


def _headings(record: Dataset) -> Floats:
    """Headings in degrees counter-clockwise from +x; the course over ground without a compass."""
    heading = record["platform_heading"].values
    if np.isfinite(heading).all():
        return heading
    x, y = record["platform_x"].values, record["platform_y"].values
    steps = (np.gradient(x), np.gradient(y)) if x.size > 1 else (np.ones(1), np.zeros(1))
    return np.where(np.isfinite(heading), heading, np.degrees(np.arctan2(steps[1], steps[0])))


def put_on_map(name: str, place: Georeference | None, crs: str, x: Floats, y: Floats) -> Floats:
    """Transform positions of a record to the map."""
    if place is None:
        if crs:
            raise SceneError(f"{name}: has no geographic position, unlike other records; make a separate mosaic of it")
        return np.stack([x, y], axis=1)
    x, y = x + place.origin[0], y + place.origin[1]
    if place.crs and not crs:
        raise SceneError(f"{name}: has coordinates in {place.crs}, other records have none; give theirs with --crs")
    return np.stack(project(place.crs, crs, x, y) if place.crs else (x, y), axis=1)
