"""Summary of a scene for the fitted laws: lengths and numbers known without building the bed."""

from __future__ import annotations

import math
from typing import NamedTuple

from insonify.acoustics.beam_patterns import is_patterned
from insonify.acoustics.water import speed_at_sonar
from insonify.scene import Scene
from insonify.scene.beams import Sounding

NEAR_GAUSSIAN = math.sqrt(math.log(2.0) / 6.0)  # half width at half power, over the aperture of equal variance


class SceneSummary(NamedTuple):
    """Lengths and properties of a scene on which the fitted laws depend, in metres and radians."""

    altitude: float  # above the mean bed
    reach: float  # greatest slant range
    bins: int  # per side
    spacing: float  # between nodes of the relief
    half_width: float  # of the beam's main lobe, rad; 0 for a knife
    light: bool  # whether the law is that of light
    beam: str  # kind of the beam
    half_power: float  # sine of the half width at half power of a Gaussian, or of an array in the far field; else 0
    aperture: float  # of an array; else 0
    squint: float  # sine of the angle
    shaded: bool  # whether the vertical beam is not uniform
    pattern: str  # kind of the beam, or "squinting" for a fan read from a table
    aslant: float  # sine of twice the angle between track and grid of the relief: oblique planes cut cells smaller

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
        """Width of the main lobe at the last bin."""
        return 2.0 * self.reach * math.sin(self.half_width)

    def half_power_at(self, r: float) -> float:
        """Sine of the half width at half power at slant range r, over that of half the main lobe; 0 for a top-hat.

        In its near field an array covers its own length, which a Gaussian of the same variance represents.
        """
        if self.half_power == 0.0:
            return 0.0
        return math.hypot(self.half_power, NEAR_GAUSSIAN * self.aperture / r) / math.sin(self.half_width)


def summarise_scene(scene: Scene) -> SceneSummary:
    """Summarise a scene by the lengths and properties on which the fitted laws depend.

    Raises
    ------
    SceneError
        If a cast cannot be read.
    """
    beam = scene.sonar.beam
    sounding = Sounding(speed_at_sonar(scene), scene.sonar.frequency, scene.sonar.range)
    patterned = beam.has_width and beam.top_hat and is_patterned(scene)
    return SceneSummary(
        altitude=abs(scene.altitude),  # negative where a measured bed lies above the sonar
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
