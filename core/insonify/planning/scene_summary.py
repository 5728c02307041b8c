"""Summary of a scene for the fitted laws: lengths and numbers known without building the bed."""

from __future__ import annotations

import math
from typing import NamedTuple

from insonify.acoustics.beam_patterns import is_patterned
from insonify.acoustics.water import speed_at_sonar
from insonify.scene import Scene
from insonify.scene.beams import Sounding

NEAR_GAUSSIAN = math.sqrt(math.log(2.0) / 6.0)  # half power of that, over the length of what is heard


class SceneSummary(NamedTuple):
    """Lengths in metres."""

    altitude: float  # above the mean bed
    reach: float  # slant range
    bins: int  # per side
    spacing: float  # of the relief's nodes
    half_width: float  # of the beam's main lobe, rad; 0 for a knife
    light: bool  # whether the law is that of light
    beam: str  # its kind
    half_power: float  # sine at which a Gaussian's sensitivity, or an array's far off, is down to a half; else 0
    aperture: float  # of an array; else 0
    squint: float  # sine
    shaded: bool  # whether it hears some grazing angles better than others
    pattern: str  # kind of the beam, or "squinting" for a fan that does
    aslant: float  # sine of twice the angle between the track and the relief's grid: cells are cut the smaller

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

    def half_power_at(self, r: float) -> float:
        """Sine at which a beam hears half as much as on its axis, over that of half its main lobe; 0 of a top-hat.

        Nearer than its far field an array hears what lies before it, as evenly as a Gaussian of the same variance.
        """
        if self.half_power == 0.0:
            return 0.0
        return math.hypot(self.half_power, NEAR_GAUSSIAN * self.aperture / r) / math.sin(self.half_width)


def summarise_scene(scene: Scene) -> SceneSummary:
    """Take the lengths of a scene.

    Raises
    ------
    SceneError
        If a cast cannot be read.
    """
    beam = scene.sonar.beam
    sounding = Sounding(speed_at_sonar(scene), scene.sonar.frequency, scene.sonar.range)
    patterned = beam.has_width and beam.top_hat and is_patterned(scene)
    return SceneSummary(
        altitude=abs(scene.altitude),  # over a measured bed it may be of either sign
        reach=scene.sonar.range,
        bins=scene.sonar.bins,
        spacing=scene.seabed.spacing,
        half_width=beam.half_width(sounding),
        light=scene.sonar.law == "light",
        beam=beam.error_law,
        half_power=beam.half_power(sounding),
        aperture=beam.aperture,
        squint=math.sin(math.radians(beam.axis)),
        shaded=scene.sonar.vertical.shades,
        pattern="squinting" if patterned else beam.error_law,
        aslant=abs(math.sin(math.radians(2.0 * scene.track.heading))),
    )
