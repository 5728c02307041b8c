"""Waters, one file a kind."""

from __future__ import annotations

from typing import Annotated

from insonify.scene.absorptions import ABSORPTIONS, AbsorptionKind
from insonify.scene.absorptions.none import NoAbsorption
from insonify.scene.base import Choice, parameter
from insonify.scene.kinds import Family, KindOf
from insonify.scene.surfaces import SURFACES, SurfaceKind
from insonify.scene.surfaces.none import NoSurface

WATERS = Family("waters", "insonify.scene.waters")


class WaterKind(Choice):
    """What every kind of water has beside its speed of sound."""

    family = WATERS
    reference_speed: float | None = parameter(
        None,
        unit="m/s",
        description="speed by which the receiver turns time into slant range (the speed at the sonar when left out)",
        ge=1300.0,
        le=1700.0,
        slider=(1400.0, 1600.0),
    )
    absorption: Annotated[AbsorptionKind, KindOf(ABSORPTIONS, default="none", number="constant")] = parameter(
        NoAbsorption(), description="what the water swallows"
    )
    surface: Annotated[SurfaceKind, KindOf(SURFACES, default="none")] = parameter(
        NoSurface(), description="the sea surface as a mirror, and the ghosts that it makes"
    )


AnyWater = Annotated[WaterKind, KindOf(WATERS, default="uniform")]
