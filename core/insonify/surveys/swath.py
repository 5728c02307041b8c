"""Swath of a record on the map: lines of the pings, and their echoes at every ground range."""

import math
from collections.abc import Iterable, Iterator, Sequence
from functools import lru_cache, partial
from typing import NamedTuple

import numpy as np

from insonify.arrays import Dataset, Floats, Singles
from insonify.display.normalisation import normalise
from insonify.display.sheet import compute_median_curve
from insonify.io.georeference import Georeference, find_georeference, project, utm_zone
from insonify.io.records import read_record
from insonify.io.records.bottom_track import BOTTOM_TRACK, find_altitude, track_bottom
from insonify.scene import SceneError
from insonify.surveys import ALTITUDES

SIDEWAYS = (90.0, -90.0)  # degrees from the heading to port and starboard


class Swath(NamedTuple):
    """The pings of a record as lines on the map, from below the sonar to the farthest ground range."""

    nadir: Floats  # (pings, 2) easting and northing below the sonar, in metres
    ends: Floats  # (pings, 2, 2) of the far ends of both sides, port first
    reach: float  # ground range of the far ends, in metres
    altitude: Floats  # (pings,) in metres
    amplitude: Singles  # (pings, 2, bins) relative to the median of the record at that slant range
    bin_length: float  # in metres of slant range

    @property
    def spacing(self) -> float:
        """Median distance between successive pings, in metres; 0 of a single ping."""
        steps = np.hypot(*np.diff(self.nadir, axis=0).T)
        return float(np.median(steps)) if steps.size else 0.0

    @property
    def corners(self) -> Floats:
        """Lower left and upper right corner of the rectangle that holds the swath, (2, 2)."""
        points = np.concatenate([self.nadir, self.ends.reshape(-1, 2)])
        return np.stack([points.min(axis=0), points.max(axis=0)])


class StoredSwaths(Iterable[Swath]):
    """Swaths of records on one map, read in every pass; only the last record stays in memory.

    The map is as given by ``crs``, or else the UTM zone of the first record's first ping.
    """

    def __init__(
        self, paths: Sequence[str], crs: str | None = None, altitude: str = ALTITUDES[0], frequency: float | None = None
    ) -> None:
        self._paths, self._altitude = paths, altitude
        self._read = lru_cache(maxsize=1)(partial(read_record, frequency=frequency))
        first = self._read(paths[0])
        self._place, self.crs = find_georeference(first.attrs), crs or ""
        if crs is not None and self._place is None:
            raise SceneError(f"{paths[0]}: has no geographic position, so that --crs does not apply; leave it out")
        if crs is None and self._place is not None and self._place.crs:
            longitude, latitude = first["platform_longitude"].values[0], first["platform_latitude"].values[0]
            self.crs = utm_zone(float(longitude), float(latitude))

    def __iter__(self) -> Iterator[Swath]:
        return (lay_swath(path, self._read(path), self.crs, self._altitude) for path in self._paths)

    def on_map(self, points: Sequence[tuple[float, float]]) -> Floats:
        """Map points of the scene of the first record to the map of the swaths, (n, 2)."""
        x, y = np.array(points, dtype=np.float64).T
        return put_on_map(self._paths[0], self._place, self.crs, x, y)


def lay_swath(name: str, record: Dataset, crs: str, altitude: str = ALTITUDES[0]) -> Swath:
    """Lay the swath of a record on the map."""
    heights = _altitudes(name, record, altitude)
    record = record.assign(platform_altitude=("ping_time", heights))
    bin_length = 2.0 * float(record["slant_range"].values[0])
    farthest = record.sizes["range_sample"] * bin_length
    if not heights.min() < farthest:
        raise SceneError(
            f"{name}: ends at a slant range of {farthest:g} m, before the bed {heights.min():g} m beneath; leave it out"
        )
    reach = math.sqrt(farthest**2 - float(heights.min()) ** 2)
    x, y = record["platform_x"].values, record["platform_y"].values
    bearing = np.radians(_headings(record))
    ends = [(x + reach * np.cos(bearing + turn), y + reach * np.sin(bearing + turn)) for turn in np.radians(SIDEWAYS)]
    amplitude = normalise(
        record["intensity"].transpose("ping_time", "channel", "range_sample").values, compute_median_curve(record)
    )
    mapped = [put_on_map(name, find_georeference(record.attrs), crs, *place) for place in ((x, y), *ends)]
    return Swath(mapped[0], np.stack(mapped[1:], axis=1), reach, heights, amplitude, bin_length)


def _altitudes(name: str, record: Dataset, altitude: str) -> Floats:
    if altitude == ALTITUDES[0]:
        found = find_altitude(record)
    elif BOTTOM_TRACK in record:
        found = record[BOTTOM_TRACK].values
    else:
        found = track_bottom(record["intensity"].values, 2.0 * float(record["slant_range"].values[0]))
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
