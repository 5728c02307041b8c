"""Where bins of a simulated record and of a recording lie."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from insonify.io.georeference import Georeference, find_georeference, to_degrees
from insonify_viewer.record.marked_point import locate_mark
from insonify_viewer.state.session import Mark

if TYPE_CHECKING:
    from insonify.simulation import Simulation
    from insonify_viewer.record.comparison.recording import Recording


class Location(NamedTuple):
    """Place of a bin on a level bed."""

    mark: Mark  # the bin
    slant_range: float  # of the bin's centre, in metres
    ground_range: float | None  # in metres; None in the water column
    # (float, float) its x and y in metres; None in the water column, or where there is no bed.
    place: tuple[float, float] | None
    altitude: float  # of the sonar above the bed, in metres; NaN where it is not known
    heading: float  # of the sonar, radians counter-clockwise from +x; NaN where it is not known


def locate_simulated(simulation: Simulation, mark: Mark) -> Location:
    """Locate a bin of a simulated record."""
    slant, ground, position = locate_mark(simulation, mark)
    pose = simulation.poses(np.array([mark.ping], dtype=np.int64))
    altitude = float(pose.z[0] - simulation.ground.height_at_once(pose.x, pose.y)[0])
    place = None if position is None else position[:2]
    return Location(mark, slant, ground, place, altitude, float(pose.heading[0]))


def locate_recorded(recording: Recording, mark: Mark) -> Location:
    """Locate a bin of a recording, athwart of its heading."""
    slant, altitude = recording.slant_range_of(mark.bin), float(recording.altitude[mark.ping])
    heading = math.radians(recording.value("heading", mark.ping))
    if not slant >= altitude:
        return Location(mark, slant, None, None, altitude, heading)
    ground = math.sqrt(slant**2 - altitude**2)
    left = ground if mark.side == 0 else -ground
    x = recording.value("x", mark.ping) - left * math.sin(heading)
    y = recording.value("y", mark.ping) + left * math.cos(heading)
    known = math.isfinite(x) and math.isfinite(y)
    return Location(mark, slant, ground, (x, y) if known else None, altitude, heading)


def degrees_of(georeference: Georeference | None, place: tuple[float, float] | None) -> tuple[float, float] | None:
    """Longitude and latitude of a place in metres; None where the map is not known."""
    if georeference is None or not georeference.crs or place is None:
        return None
    longitude, latitude = to_degrees(georeference, *(np.array([value]) for value in place))
    return float(longitude[0]), float(latitude[0])


def georeference_of(recording: Recording) -> Georeference | None:
    """Place of a recording on Earth."""
    return find_georeference(recording.dataset.attrs)
