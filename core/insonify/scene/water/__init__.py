"""Waters: their base class, with sound speed, absorption and sea surface, and water of one sound speed."""

from typing import Annotated, ClassVar, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from insonify.arrays import Floats
from insonify.scene.base import Family, Kind, KindOf, parameter
from insonify.scene.water.absorptions import ABSORPTIONS, AbsorptionKind, NoAbsorption
from insonify.scene.water.surfaces import SURFACES, NoSurface, SurfaceKind

WATERS = Family("waters", "insonify.scene.water")


class SoundSpeeds(NamedTuple):
    """Speed of sound at depths and at distances along a horizontal line, interpolated linearly."""

    depth: Floats  # (n,) metres, increasing
    speed: Floats  # (m, n) m/s
    # (m,) metres along a line through the scene's (0, 0), increasing; a single one for horizontally uniform water.
    distance: Floats = np.zeros(1)
    heading: float = 0.0  # heading of that line, radians counter-clockwise from +x


class WaterKind(Kind):
    """Base of all kinds of water: sound speed, absorption and sea surface.

    Attributes
    ----------
    varies_along : bool
        Whether the sound speed varies horizontally.
    """

    family = WATERS

    varies_along: ClassVar[bool] = False
    reference_speed: float | None = parameter(
        None,
        "sound speed by which the receiver converts time to slant range (that at the sonar when left out)",
        "m/s",
        ge=1300.0,
        le=1700.0,
        slider=(1400.0, 1600.0),
        rare=True,
    )
    absorption: Annotated[AbsorptionKind, KindOf(ABSORPTIONS, default="none", number="constant")] = parameter(
        NoAbsorption, "absorption of sound by the water"
    )
    surface: Annotated[SurfaceKind, KindOf(SURFACES, default="none")] = parameter(
        NoSurface, "sea surface, which reflects sound and causes multipath"
    )

    @property
    def only_speed(self) -> float | None:
        """Speed of sound in m/s where it is the same everywhere, else None."""
        return None

    def sound_speeds(self) -> SoundSpeeds:
        """Speed of sound by depth, and by distance where it varies horizontally.

        Raises
        ------
        SceneError
            If a cast cannot be read or contains an impossible sound speed.
        """
        raise NotImplementedError

    def remarks(self) -> tuple[str, ...]:
        """Describe in a sentence each what is left out of a measured file, and why."""
        return ()


def speeds_by_depth(depth: ArrayLike, speed: ArrayLike) -> SoundSpeeds:
    """Speeds (m/s) at depths (m) of horizontally uniform water."""
    return SoundSpeeds(np.asarray(depth, dtype=np.float64), np.asarray(speed, dtype=np.float64)[None, :])


class UniformWater(WaterKind, kind="uniform", rank=10):
    """Still water of one sound speed."""

    sound_speed: float = parameter(1500.0, "speed of sound", "m/s", ge=1300.0, le=1700.0, slider=(1400.0, 1600.0))

    @property
    def only_speed(self) -> float:
        """Speed of sound, in m/s."""
        return self.sound_speed

    def sound_speeds(self) -> SoundSpeeds:
        """Return one speed for every depth."""
        return speeds_by_depth([0.0], [self.sound_speed])


AnyWater = Annotated[WaterKind, KindOf(WATERS, default="uniform")]
