"""A scene as the laws see it: a few lengths and numbers, told without building anything."""

from __future__ import annotations

import math
from typing import NamedTuple

from insonify.scene import Scene
from insonify.sound.beams import main_lobe
from insonify.sound.water import speed_at_sonar


class View(NamedTuple):
    """Lengths in metres."""

    altitude: float  # above the mean bed
    reach: float  # slant range
    bins: int  # per side
    spacing: float  # of the relief's nodes
    half_width: float  # of the beam's main lobe, rad; 0 for a knife
    light: bool  # whether the law is that of light
    beam: str  # its kind

    @property
    def bin_length(self) -> float:
        """Slant range of one bin."""
        return self.reach / self.bins

    @property
    def ground(self) -> float:
        """Ground range of the last bin over a level bed."""
        return math.sqrt(max(self.reach**2 - self.altitude**2, 0.0))

    @property
    def width(self) -> float:
        """Of the main lobe at the last bin."""
        return 2.0 * self.reach * math.sin(self.half_width)


def look_at(scene: Scene) -> View:
    """Take the lengths of a scene.

    Raises
    ------
    SceneError
        If a cast cannot be read.
    """
    return View(
        altitude=abs(scene.altitude),  # over a measured bed it may be of either sign
        reach=scene.sonar.range,
        bins=scene.sonar.bins,
        spacing=scene.seabed.spacing,
        half_width=main_lobe(scene.sonar, speed_at_sonar(scene)),
        light=scene.sonar.law == "light",
        beam=scene.sonar.beam.kind,
    )
