"""Waters, one file a kind."""

from __future__ import annotations

from typing import Annotated, ClassVar, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from insonify.scene.base import Choice, parameter
from insonify.scene.kinds import Family, KindOf
from insonify.scene.water.absorptions import ABSORPTIONS, AbsorptionKind
from insonify.scene.water.absorptions.none import NoAbsorption
from insonify.scene.water.surfaces import SURFACES, SurfaceKind
from insonify.scene.water.surfaces.none import NoSurface

Values = NDArray[np.float64]
WATERS = Family("waters", "insonify.scene.water")


class SoundSpeeds(NamedTuple):
    """Speed of sound at depths and at distances along a level line, straight between."""

    depth: Values  # (n,) metres, increasing
    speed: Values  # (m, n) m/s
    # (m,) metres along a line through the scene's (0, 0), increasing; one for water that is everywhere the same.
    distance: Values = np.zeros(1)
    heading: float = 0.0  # heading of that line, radians counter-clockwise from +x


class WaterKind(Choice):
    """Base of all kinds of water: sound speed, absorption and sea surface.

    Attributes
    ----------
    varies_along : bool
        Whether its speed differs from place to place.
    """

    family = WATERS

    varies_along: ClassVar[bool] = False
    reference_speed: float | None = parameter(
        None,
        unit="m/s",
        description="speed with which the receiver converts time to slant range (the speed at the sonar when left out)",
        ge=1300.0,
        le=1700.0,
        slider=(1400.0, 1600.0),
        rare=True,
    )
    absorption: Annotated[AbsorptionKind, KindOf(ABSORPTIONS, default="none", number="constant")] = parameter(
        NoAbsorption(), description="absorption of sound by the water"
    )
    surface: Annotated[SurfaceKind, KindOf(SURFACES, default="none")] = parameter(
        NoSurface(), description="the sea surface as a mirror, and its multipath"
    )

    @property
    def only_speed(self) -> float | None:
        """Speed of sound of water that has one, in m/s."""
        return None

    @property
    def version(self) -> tuple[int, int] | None:
        """Version of the file that it is read from, None if there is none."""
        return None

    def sound_speeds(self) -> SoundSpeeds:
        """Speed of sound by depth, and by distance where it differs from place to place.

        Raises
        ------
        SceneError
            If a cast cannot be read or holds an impossible sound speed.
        """
        raise NotImplementedError


def speeds_by_depth(depth: ArrayLike, speed: ArrayLike) -> SoundSpeeds:
    """Speeds (m/s) at depths (m) of water that is everywhere the same."""
    return SoundSpeeds(np.asarray(depth, dtype=np.float64), np.asarray(speed, dtype=np.float64)[None, :])


AnyWater = Annotated[WaterKind, KindOf(WATERS, default="uniform")]
