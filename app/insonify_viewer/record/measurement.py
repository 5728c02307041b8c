"""Distance between two bins of a record, and the height of a target whose shadow lies between them."""

from __future__ import annotations

import math
from dataclasses import dataclass

from insonify_viewer.record.location import Location


@dataclass(frozen=True)
class Measurement:
    """What a line across a record measures."""

    slant: float  # difference of the slant ranges, in metres
    # Horizontal distances in metres: between the ends, along the heading at the first and athwart it; None where
    # an end has no known place.
    straight: float | None
    along: float | None
    across: float | None
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
            first = f"{self.straight:.2f} m on the bed: {self.along:.2f} m along, {self.across:.2f} m across"
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
    return Measurement(slant, straight, along, across, pings, *_heights(first, last, along))


def shadow_height(altitude: float, slant_range: float, shadow: float) -> float:
    """Height of a target from its shadow on a level bed, h = A L / (R + L), by similar triangles."""
    return altitude * shadow / (slant_range + shadow)


def round_shadow_height(altitude: float, slant_range: float, shadow: float) -> float:
    """Height of a round body that rests on a level bed, from its shadow across its axis.

    The last ray touches the body below its top. The first hidden point of the bed lies in front of the body, where a
    ray touches it from below; the bed heard up to there covers the beginning of the shadow. The two tangents from the
    sonar to the circle are equal, and so are those from each end on the bed. With the ground ranges G and F of the ends
    they give h = A (1 - (R + G) / (R + L + F)). With slant ranges alone in the bracket it is `shadow_height`.
    """
    near, far = (slant + math.sqrt(slant**2 - altitude**2) for slant in (slant_range, slant_range + shadow))
    return altitude * (1.0 - near / far)  # derived from equal tangents


def _heights(first: Location, last: Location, along: float | None) -> tuple[float, float] | tuple[None, None]:
    """Height of a target whose shadow the line spans, and height if it is round."""
    near, far = sorted((first.slant_range, last.slant_range))
    altitude = last.altitude if last.slant_range == far else first.altitude
    if first.mark.side != last.mark.side or not 0.0 < altitude < far or near == far:
        return None, None
    if along is not None and along > far - near:
        return None, None
    round_one = round_shadow_height(altitude, max(near, altitude), far - max(near, altitude))
    return shadow_height(altitude, near, far - near), round_one
