"""Distances across the picture of a record: slant range, slant range behind the first echo, or ground range."""

import math
from typing import NamedTuple

import numpy as np

from insonify.arrays import Floats

SLANT, BED, GROUND = "slant", "bed", "ground"  # kinds of distance
NAMES = {SLANT: "slant range", BED: "slant range behind the first echo", GROUND: "ground range"}


class RangeAxis(NamedTuple):
    """Distance from the inner edge of one side of a picture, and the range bins that lie there."""

    # ``slant`` for slant range r; ``bed`` for r − h, the slant range behind the first echo of a level bed at the
    # altitude h; ``ground`` for sqrt(r² − h²), its ground range.
    kind: str
    bins: int  # range bins of a side
    bin_length: float  # slant range of a bin, in metres
    reach: float  # distance of the outer edge, in metres

    @property
    def shows_water(self) -> bool:
        """Whether the water column is part of the picture."""
        return self.kind == SLANT

    def bins_at(self, distance: Floats, altitude: Floats) -> Floats:
        """Position in bins, from 0 at the sonar to ``bins``, of distances under a sonar at altitudes."""
        # An altitude below 0, as in damaged recordings, gives no bin before the first.
        if self.kind == GROUND:
            slant = np.hypot(distance, altitude)
        else:
            slant = distance + (altitude if self.kind == BED else 0.0)
        return np.asarray(np.clip(slant / self.bin_length, 0.0, self.bins))

    def distance_of(self, position: Floats, altitude: Floats) -> Floats:
        """Distance of a position in bins; NaN in the water column where the picture leaves it out."""
        slant = np.asarray(position) * self.bin_length
        if self.kind == SLANT:
            return np.asarray(slant + 0.0 * altitude)
        with np.errstate(invalid="ignore"):
            behind = slant - altitude if self.kind == BED else np.sqrt(slant**2 - np.square(altitude))
        return np.asarray(np.where(behind >= 0.0, behind, np.nan))


def choose_kind(*, ground_range: bool, water_column: bool) -> str:
    """Kind of distance of a picture in ground range, or with or without its water column."""
    return GROUND if ground_range else SLANT if water_column else BED


def make_range_axis(kind: str, bins: int, bin_length: float, lowest: float) -> RangeAxis | None:
    """Make an axis that ends at the farthest distance that the ping at the lowest altitude receives."""
    end = bins * bin_length
    if kind == SLANT:
        return RangeAxis(kind, bins, bin_length, end)
    if not lowest < end:
        return None
    # A sonar below the level of the bed may receive echoes of it from as far as at its own height.
    reach = end - lowest if kind == BED else math.sqrt(end**2 - max(lowest, 0.0) ** 2)
    return RangeAxis(kind, bins, bin_length, reach)
