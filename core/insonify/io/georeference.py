"""Place of a record on Earth: its own x and y, map coordinates, longitude and latitude."""

from collections.abc import Mapping
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np

from insonify.arrays import Floats
from insonify.errors import SceneError

DEGREES = "EPSG:4326"  # longitude and latitude on WGS 84
UTM_NORTH, UTM_SOUTH = 32600, 32700  # EPSG codes of the zones of WGS 84, less the number of the zone
LATITUDES_OF_UTM = (-80.0, 84.0)


class Georeference(NamedTuple):
    """Where the x and y of a record lie."""

    crs: str  # coordinate reference system of the map, as PROJ takes it; empty if it is not known
    origin: tuple[float, float]  # (float, float) easting and northing of (0, 0) on that map, in metres

    def attributes(self) -> dict[str, Any]:
        """Return the attributes that describe the place in a record."""
        origin = {"origin_x": float(self.origin[0]), "origin_y": float(self.origin[1])}
        return {"crs": self.crs} | origin if self.crs else origin


def find_georeference(attributes: Mapping[Any, Any]) -> Georeference | None:
    """Return the place of a record by its attributes; None if they have none."""
    if "origin_x" not in attributes or "origin_y" not in attributes:
        return None
    return Georeference(str(attributes.get("crs", "")), (float(attributes["origin_x"]), float(attributes["origin_y"])))


def local_georeference(longitude: float, latitude: float) -> Georeference:
    """Return a map true to scale about a place: x runs east and y north from it (transverse Mercator)."""
    return Georeference(f"+proj=tmerc +lat_0={latitude!r} +lon_0={longitude!r} +ellps=WGS84 +units=m", (0.0, 0.0))


def utm_zone(longitude: float, latitude: float) -> str:
    """Return the EPSG code of the 6° zone of the Universal Transverse Mercator grid (WGS 84) that contains a place."""
    south, north = LATITUDES_OF_UTM
    if not south <= latitude <= north:
        raise SceneError(f"latitude {latitude:.4g}° is beyond the zones of UTM; choose another map")
    zone = int((longitude + 180.0) // 6.0) % 60 + 1
    return f"EPSG:{(UTM_NORTH if latitude >= 0.0 else UTM_SOUTH) + zone}"


def to_degrees(place: Georeference, x: Floats, y: Floats) -> tuple[Floats, Floats]:
    """Return longitude and latitude on WGS 84."""
    return project(place.crs, DEGREES, x + place.origin[0], y + place.origin[1])


def from_degrees(place: Georeference, longitude: Floats, latitude: Floats) -> tuple[Floats, Floats]:
    """Return the record's x and y, in metres, of longitudes and latitudes; the inverse of `to_degrees`."""
    easting, northing = project(DEGREES, place.crs, longitude, latitude)
    return easting - place.origin[0], northing - place.origin[1]


def project(source: str, target: str, x: Floats, y: Floats) -> tuple[Floats, Floats]:
    """Transform coordinates from one reference system to another; x is the easting or the longitude."""
    found = _transformer(source, target).transform(x, y)
    return np.asarray(found[0], dtype=np.float64), np.asarray(found[1], dtype=np.float64)


def convergence(place: Georeference) -> float:
    """Return the bearing of the map's north at the record's origin, in degrees clockwise from true north."""
    from pyproj import Geod  # lazy: a tenth of a second to import, and only files with a place need it

    step = 10.0  # m, over which a degree's rounding does not matter
    longitude, latitude = to_degrees(place, np.zeros(2), np.array([0.0, step]))
    bearing, _, _ = Geod(ellps="WGS84").inv(longitude[0], latitude[0], longitude[1], latitude[1])
    return float(bearing)


@lru_cache(maxsize=16)
def _transformer(source: str, target: str) -> Any:
    from pyproj import Transformer  # lazy, as above
    from pyproj.exceptions import ProjError

    systems = _system(source), _system(target)
    try:
        return Transformer.from_crs(*systems, always_xy=True)
    except ProjError:
        raise SceneError(
            f"crs {source!r} cannot be transformed to {target!r}; give one on Earth such as 'EPSG:32631'"
        ) from None


@lru_cache(maxsize=16)
def _system(crs: str) -> Any:
    from pyproj import CRS  # lazy, as above
    from pyproj.exceptions import CRSError

    try:
        return CRS.from_user_input(crs)
    except CRSError:
        raise SceneError(
            f"crs {crs!r} is not a coordinate reference system known to PROJ; give one such as 'EPSG:32631'"
        ) from None
