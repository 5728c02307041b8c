"""Positions of recordings: fixes may be missing, repeated, in degrees or in metres."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.io.georeference import Georeference, from_degrees, local_georeference

Column = NDArray[np.float64]
FARTHEST = 1e8  # m, of any map's coordinates
DAY = 86400.0  # s


class Fixes(NamedTuple):
    """Positions as a recording has them."""

    # (pings,) longitude and latitude in degrees, or easting and northing in metres; both 0 or not finite without
    # a fix.
    x: Column
    y: Column
    degrees: bool

    @property
    def known(self) -> NDArray[np.bool_]:
        """Which pings have a fix: not zero, and within the map."""
        widest, highest = (180.0, 90.0) if self.degrees else (FARTHEST, FARTHEST)
        inside = (np.abs(self.x) <= widest) & (np.abs(self.y) <= highest)
        return ((self.x != 0.0) | (self.y != 0.0)) & inside

    @property
    def place(self) -> Georeference | None:
        """Place of the first fix; None without any. Metres have no map."""
        known = self.known
        if not known.any():
            return None
        first = float(self.x[np.argmax(known)]), float(self.y[np.argmax(known)])
        return local_georeference(*first) if self.degrees else Georeference("", first)

    def positions(self, times: Column) -> tuple[Column, Column] | None:
        """Metres east and north of the first fix at every ping; None without any.

        Fixes repeat because they are rarer than pings; positions between them are interpolated over time.
        """
        place, moved = self.place, self.known
        if place is None:
            return None
        first = int(np.argmax(moved))
        moved[1:] &= (self.x[1:] != self.x[:-1]) | (self.y[1:] != self.y[:-1])
        moved[first] = True
        east, north = np.zeros_like(self.x), np.zeros_like(self.y)
        if self.degrees:
            east[moved], north[moved] = from_degrees(place, self.x[moved], self.y[moved])
        else:
            east[moved], north[moved] = self.x[moved] - place.origin[0], self.y[moved] - place.origin[1]
        return fill_gaps(east, moved, times), fill_gaps(north, moved, times)


def fill_gaps(values: Column, known: NDArray[np.bool_], at: Column | None = None) -> Column:
    """Interpolate values that are not known; NaN where none is."""
    if not known.any():
        return np.full(values.shape, np.nan)
    at = np.arange(values.size, dtype=np.float64) if at is None else at
    return np.interp(at, at[known], values[known])


def heading_from_compass(compass: Column, known: NDArray[np.bool_]) -> Column:
    """Return headings counter-clockwise from east, within 180° of it, from bearings clockwise from north; degrees."""
    heading = 90.0 - np.degrees(np.unwrap(np.radians(fill_gaps(compass, known))))
    return (heading + 180.0) % 360.0 - 180.0
