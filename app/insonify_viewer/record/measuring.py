"""Distance between two bins of a record, and the height of a target from its shadow between them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from insonify.io.georeference import Georeference, to_degrees
from insonify_viewer.core_types import Simulation
from insonify_viewer.record.comparison.recording import Recording, compass_heading
from insonify_viewer.record.marked_point import locate_mark
from insonify_viewer.state.inspection import Mark


@dataclass(frozen=True)
class Measurement:
    """What a line across a record measures."""

    slant: float  # difference of the slant ranges, in metres
    # Horizontal distances in metres: between the ends, along the heading at the first and athwart it; None where
    # an end has no known place.
    straight: float | None
    along: float | None
    across: float | None
    heading: float  # of the sonar at the first end, degrees by the compass; NaN where it is not known
    pings: int  # pings between the ends
    # Height in metres of a target whose shadow the line spans; None unless both ends lie on one side and the line
    # runs across the track.
    height: float | None
    round_height: float | None  # the same of a round body that rests on the bed; None with ``height``

    @property
    def words(self) -> str:
        """The measurement in up to three lines, with the kind of distance."""
        if self.straight is None:
            first = f"slant range {self.slant:.2f} m, {self.pings} pings"
        else:
            way = f"{self.along:.2f} m along the heading of {self.heading:.0f}°, {self.across:.2f} m across it"
            first = f"{self.straight:.2f} m on the bed: {way}"
        lines = [first, f"slant range {self.slant:.2f} m"] if self.straight is not None else [first]
        if self.height is not None:
            lines.append(f"as a shadow: target {self.height:.2f} m high, {self.round_height:.2f} m if round")
        return "\n".join(lines)


def measure(first: Location, last: Location) -> Measurement:
    """Measure between two bins of a record."""
    slant, pings = abs(last.slant_range - first.slant_range), abs(last.mark.ping - first.mark.ping)
    straight = along = across = None
    if first.place is not None and last.place is not None and math.isfinite(first.heading):
        dx, dy = (b - a for a, b in zip(first.place, last.place))
        cos, sin = math.cos(first.heading), math.sin(first.heading)
        straight, along, across = math.hypot(dx, dy), abs(dx * cos + dy * sin), abs(dy * cos - dx * sin)
    heading = compass_heading(math.degrees(first.heading))
    return Measurement(slant, straight, along, across, heading, pings, *_heights(first, last, along))


def shadow_height(altitude: float, slant_range: float, shadow: float) -> float:
    """Height of a target from its shadow on a level bed, h = A L / (R + L), by similar triangles."""
    return altitude * shadow / (slant_range + shadow)


def round_shadow_height(altitude: float, slant_range: float, shadow: float) -> float:
    """Height of a round body that rests on a level bed, from its shadow across its axis."""
    # The last ray touches the body below its top. The first hidden point of the bed lies in front of the body, where a
    # ray touches it from below; the bed heard up to there covers the beginning of the shadow. The two tangents from
    # the sonar to the circle are equal, and so are those from each end on the bed. With the ground ranges G and F of
    # the ends they give h = A (1 - (R + G) / (R + L + F)). With slant ranges alone in the bracket it is
    # `shadow_height`.
    near, far = (slant + math.sqrt(slant**2 - altitude**2) for slant in (slant_range, slant_range + shadow))
    return altitude * (1.0 - near / far)  # derived from equal tangents


def _heights(first: Location, last: Location, along: float | None) -> tuple[float, float] | tuple[None, None]:
    """Height of a target from the shadow that the line spans, and height if the target is round."""
    near, far = sorted((first.slant_range, last.slant_range))
    altitude = last.altitude if last.slant_range == far else first.altitude
    if first.mark.side != last.mark.side or not 0.0 < altitude < far or near == far:
        return None, None
    if along is not None and along > far - near:
        return None, None
    round_one = round_shadow_height(altitude, max(near, altitude), far - max(near, altitude))
    return shadow_height(altitude, near, far - near), round_one


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
