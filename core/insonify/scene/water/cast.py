"""Water measured by an instrument."""

from __future__ import annotations

from typing import Literal

import numpy as np

from insonify.errors import SceneError
from insonify.io.sound_speed_casts import Cast, read_cast
from insonify.scene.base import FilePath, parameter
from insonify.scene.water import SoundSpeeds, Values, WaterKind, speeds_by_depth
from insonify.scene.water.layered import Equation, Interpolation, interpolation
from insonify.scene.water.polyline import approximate_pchip, thin_polyline
from insonify.scene.water.sound_speed import EQUATIONS

CAST_TOLERANCE = 0.02  # m/s, greatest error of the segments: the accuracy of a measured speed


class CastWater(WaterKind):
    """Water measured by an instrument cast."""

    rank = 40
    kind: Literal["cast"] = "cast"
    path: FilePath = parameter(description="measured cast: Sea-Bird .cnv, .asvp, .svp or CSV", min_length=1)
    interpolation: Interpolation = interpolation()
    equation: Equation | None = parameter(
        None,
        "equation of sound speed from temperature and salinity (when left out, the cast's own speed if it "
        "has one, otherwise teos10)",
        rare=True,
    )

    def sound_speeds(self) -> SoundSpeeds:
        """Measured speed, reduced to few points."""
        cast = read_cast(self.path)
        speed = self._speeds_of(cast)
        if self.interpolation == "pchip" and cast.depth.size > 1:
            return speeds_by_depth(*approximate_pchip(cast.depth, speed, CAST_TOLERANCE))
        kept = thin_polyline(cast.depth, speed, CAST_TOLERANCE)
        return speeds_by_depth(cast.depth[kept], speed[kept])

    def _speeds_of(self, cast: Cast) -> Values:
        """Sound speed of a cast, or by an equation from its temperature and salinity."""
        if cast.sound_speed is not None and self.equation is None:
            speed = cast.sound_speed
        elif cast.temperature is None or cast.salinity is None:
            raise SceneError(
                f"water.equation: {self.equation!r} needs temperature and salinity, which {self.path!r} lacks; "
                "leave it out to take the cast's own speed"
            )
        else:
            speed = EQUATIONS[self.equation or "teos10"](cast.temperature, cast.salinity, cast.depth)
        wrong = np.flatnonzero(~((speed >= 1300.0) & (speed <= 1700.0)))
        if wrong.size:
            raise SceneError(
                f"water.path: {self.path!r} gives {speed[wrong[0]]:.6g} m/s at {cast.depth[wrong[0]]:.4g} m, no "
                "possible speed of sound in water (1300 to 1700 m/s); correct or remove that row"
            )
        return np.asarray(speed)
