"""What hides bed that would echo in one pixel: targets, and crests of the bed itself."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from insonify.explanation.pixel_parts import PixelParts
from insonify.tracers.echo_parts import BEHIND_BED, HEARD, EchoParts

Points = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Obstruction:
    """What hides a part of the bed that would echo in the pixel."""

    hider: str  # ``pipe 1``, or ``crest of the bed``
    target: int  # index of the declared target, -1 for the bed
    place: Points  # (3,) crest of the bed, or middle of the bed that a target hides, in local coordinates, m
    ground_range: float  # of that place, m
    share: float  # of what the pixel would echo if nothing hid anything
    echo: float  # mean echo that the hidden bed would add, in the units of the parts
    places: Points  # (n, 2, 3) the hidden bed
    rays: tuple[Points, ...]  # from the sonar to the hidden bed, through what hides it

    @property
    def faces_away(self) -> bool:
        """Whether the hidden bed is a slope that faces away from the sonar and would return nothing anyway."""
        return not self.echo > 0.0


def find_obstructions(pixel: PixelParts) -> tuple[Obstruction, ...]:
    """Find what hides bed that would echo in a pixel."""
    parts = pixel.parts
    hidden = parts.take(parts.state != HEARD)
    whole = float(parts.value.sum())
    hiders = np.where(hidden.state == BEHIND_BED, -1, hidden.hider)
    found = [_obstruction(pixel, hidden.take(hiders == who), int(who), whole) for who in np.unique(hiders)]
    return tuple(sorted(found, key=lambda each: -each.share))


def _obstruction(pixel: PixelParts, parts: EchoParts, who: int, whole: float) -> Obstruction:
    echo = float(parts.value.sum())
    loudest = int(np.argmax(parts.value))
    place = parts.crest[loudest] if who < 0 else parts.middle[loudest]
    return Obstruction(
        hider=pixel.name(who) if who >= 0 else "crest of the bed",
        target=who,
        place=pixel.sonar.to_world(float(parts.azimuth[loudest]), place[None])[0],
        ground_range=float(place[0]),
        share=echo / whole if whole > 0.0 else 0.0,
        echo=echo,
        places=pixel.segments(parts),
        rays=pixel.rays(parts),
    )
