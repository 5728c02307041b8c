"""Horizontal beams: their base classes, and those without sidelobes.

Directions are given as s, the sine of their angle from the plane across the towfish; sensitivities are two-way
energies, 1 on the axis in the far field.
"""

import math
from abc import abstractmethod
from typing import ClassVar, NamedTuple

import numpy as np

from insonify.arrays import Floats
from insonify.scene.base import Family, Kind, parameter

BEAMS = Family("beams", "insonify.scene.sonar.beams")
PATTERN_COLUMNS = 2049  # of a table of sensitivities
FAINT = 1e-6  # sensitivity at which a bell-shaped beam ends
EDGE = 0.02  # sensitivity at which its main lobe ends


class BeamConditions(NamedTuple):
    """Conditions on which a beam depends besides its own fields."""

    sound_speed: float  # m/s
    frequency: float  # Hz
    range: float  # slant range, m

    @property
    def wavelength(self) -> float:
        """Wavelength of the sound, in metres."""
        return self.sound_speed / self.frequency


class BeamTable(NamedTuple):
    """Sensitivity of a beam by slant range and direction."""

    first_range: float  # slant range of the first row, in metres
    extent: Floats  # (rows,) half of the span of each row, as sine
    energy: Floats  # (rows, PATTERN_COLUMNS)
    per_octave: float = 1.0  # rows per doubling of slant range


class BeamKind(Kind):
    """Sensitivity of the sonar along the track.

    A kind declares the half width of its main lobe, its extent and its response. A beam that depends on range
    overrides `tabulate` and `at_range`, and one whose waves have phases of their own `phases` and `coherence`.

    Attributes
    ----------
    top_hat : bool
        Whether the sensitivity is uniform within the half width and zero beyond.
    has_width : bool
        Whether the beam is sensitive beside the plane across the towfish.
    by_frequency : bool
        Whether it depends on the frequency.
    caption : str
        Name of the beam for captions, with its fields and ``{ways}`` in braces.
    """

    family = BEAMS
    top_hat: ClassVar[bool] = False
    has_width: ClassVar[bool] = True
    by_frequency: ClassVar[bool] = False
    caption: ClassVar[str] = "{kind}"

    @property
    def words(self) -> str:
        """Name of the beam for captions."""
        named = self.caption.format(ways="two-way" if self.passes == 2 else "one-way", **dict(self))
        return f"{named}, squint {self.axis:g}°" if self.axis else named

    @property
    def axis(self) -> float:
        """Angle of the beam's axis towards the bow, in degrees."""
        return getattr(self, "squint", 0.0)

    @property
    def passes(self) -> int:
        """Number of passes of sound through the beam pattern: 2 two-way, 1 one-way."""
        return 2 if getattr(self, "two_way", True) else 1

    @abstractmethod
    def half_width(self, conditions: BeamConditions) -> float:
        """Half of the span of the main lobe, in radians."""

    def extent(self, conditions: BeamConditions) -> float:
        """Sine beyond which the sensitivity is 0."""
        return max(math.sin(self.half_width(conditions)), 1e-9)  # a knife has no width, but a row must have a span

    def response(self, s: Floats, conditions: BeamConditions) -> Floats:
        """Sensitivity by direction about the axis."""
        return np.ones(s.shape)

    def tabulate(self, conditions: BeamConditions) -> BeamTable:
        """Tabulate the sensitivity; a beam that is the same at every range has one row."""
        extent = self.extent(conditions)
        s = np.linspace(-extent, extent, PATTERN_COLUMNS)
        return BeamTable(1.0, np.array([extent]), self.response(s, conditions)[None, :])

    def at_range(self, conditions: BeamConditions) -> BeamTable:
        """Tabulate the sensitivity at the range of the conditions alone, in one row."""
        return self.tabulate(conditions)

    def phases(self, conditions: BeamConditions) -> Floats | None:
        """Phases in turns of waves there and back over those from the beam's middle, for the table of `tabulate`.

        None where waves to all directions have the phase of those from the middle, as far from an array.
        """
        return None

    def coherence(self, spacing: float, conditions: BeamConditions) -> Floats | None:
        """Correlations of bed echoes 0, 1, 2 ... times a spacing in metres apart along the track, to the last above 0.

        None for a beam without phases of its own: the correlation then is the transform of the sensitivity.
        """
        return None


class AimedBeam(BeamKind):
    """A beam that can be turned towards the bow."""

    squint: float = parameter(
        0.0,
        "angle by which the beam is turned towards the bow",
        "°",
        ge=-45.0,
        le=45.0,
        slider=(-10.0, 10.0),
        rare=True,
    )


class GaussianBeam(AimedBeam, kind="gaussian", rank=30):
    """A bell-shaped beam without sidelobes."""

    caption = "gaussian {width:g}° {ways}"
    width: float = parameter(
        1.0, "one-way full beamwidth to -3 dB", "°", ge=1e-3, le=60.0, slider=(0.1, 10.0), log=True
    )
    two_way: bool = parameter(
        True, "whether the pattern applies to transmission and reception, or only once", rare=True
    )

    @property
    def _s_three_decibels(self) -> float:
        return math.sin(math.radians(self.width) / 2.0)

    def half_width(self, conditions: BeamConditions) -> float:
        """Angle at which the sensitivity is `EDGE`, in radians."""
        times = math.sqrt(math.log2(1.0 / EDGE) / self.passes)
        return math.asin(min(self._s_three_decibels * times, 1.0))

    def extent(self, conditions: BeamConditions) -> float:
        """Sine of the angle at which the sensitivity is `FAINT`."""
        return min(self._s_three_decibels * math.sqrt(math.log2(1.0 / FAINT) / self.passes), 1.0)

    def response(self, s: Floats, conditions: BeamConditions) -> Floats:
        """Sensitivity b = 2^(−(2φ/w)²) each way, which falls to a half at half the width."""
        return np.exp2(-self.passes * (s / self._s_three_decibels) ** 2)


class KnifeBeam(BeamKind, kind="knife", rank=10):
    """A beam without width: a vertical plane across the track at any pitch of the towfish, 1 m wide by definition."""

    top_hat = True
    has_width = False
    caption = "knife-edge beam"

    def half_width(self, conditions: BeamConditions) -> float:
        """Zero: the beam is a plane."""
        return 0.0


class FanBeam(AimedBeam, kind="fan", rank=20):
    """A top-hat beam, one-way full width; the cell widens with range."""

    top_hat = True
    caption = "fan {width:g}°"
    width: float = parameter(1.0, "one-way full beamwidth", "°", ge=1e-3, le=60.0, slider=(0.1, 10.0), log=True)

    def half_width(self, conditions: BeamConditions) -> float:
        """Half of the one-way full width, in radians."""
        return math.radians(self.width) / 2.0
