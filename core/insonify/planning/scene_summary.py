"""A scene as the laws see it: a few lengths and numbers, told without building anything."""

from __future__ import annotations

import math
from typing import NamedTuple

from insonify.acoustics.beam_patterns import is_patterned, main_lobe
from insonify.acoustics.water import speed_at_sonar
from insonify.scene import Scene
from insonify.scene.beams.fan import FanBeam
from insonify.scene.beams.gaussian import GaussianBeam
from insonify.scene.beams.knife import KnifeBeam
from insonify.scene.beams.line_array import LineArray
from insonify.scene.vertical_beams.uniform import UniformVerticalBeam

# Width at half power of a line array's far field, in wavelengths over its length, one way and there and back.
HALF_POWER = {
    "uniform": (0.886, 0.638),
    "cosine": (1.189, 0.851),
    "hamming": (1.304, 0.929),
    "taylor": (1.125, 0.804),
}
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
    squint = 0.0 if isinstance(beam, KnifeBeam) else math.sin(math.radians(beam.squint))  # type: ignore[attr-defined]
    return SceneSummary(
        altitude=abs(scene.altitude),  # over a measured bed it may be of either sign
        reach=scene.sonar.range,
        bins=scene.sonar.bins,
        spacing=scene.seabed.spacing,
        half_width=main_lobe(scene.sonar, speed_at_sonar(scene)),
        light=scene.sonar.law == "light",
        beam=scene.sonar.beam.kind,
        half_power=_half_power(scene),
        aperture=beam.length if isinstance(beam, LineArray) else 0.0,
        squint=squint,
        shaded=not isinstance(scene.sonar.vertical, UniformVerticalBeam),
        pattern="squinting" if isinstance(beam, FanBeam) and is_patterned(scene) else beam.kind,
        aslant=abs(math.sin(math.radians(2.0 * scene.track.heading))),
    )


def _half_power(scene: Scene) -> float:
    """Sine at which a beam that is no top-hat hears half as much as on its axis, there and back, far off."""
    beam = scene.sonar.beam
    if isinstance(beam, LineArray):
        width = HALF_POWER[beam.taper][beam.two_way]
        return 0.5 * width * speed_at_sonar(scene) / scene.sonar.frequency / beam.length
    if isinstance(beam, GaussianBeam):
        return math.sin(math.radians(beam.width) / 2.0) / math.sqrt(2.0 if beam.two_way else 1.0)
    return 0.0
