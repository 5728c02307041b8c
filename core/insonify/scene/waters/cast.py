"""Water as an instrument measured it."""

from __future__ import annotations

from typing import Literal

from insonify.scene.base import FilePath, parameter
from insonify.scene.waters import WaterKind
from insonify.scene.waters.layered import (
    Equation,
    Interpolation,
)


class CastWater(WaterKind):
    """Water as an instrument measured it on its way down."""

    rank = 40
    kind: Literal["cast"] = "cast"
    path: FilePath = parameter(description="measured cast: Sea-Bird .cnv, .asvp, .svp or CSV", min_length=1)
    interpolation: Interpolation = parameter(
        "linear", description="between the depths: straight, or a smooth curve that never overshoots"
    )
    equation: Equation | None = parameter(
        None,
        description="how the speed follows from temperature and salinity (when left out, the cast's own speed if it "
        "has one, otherwise teos10)",
    )
