"""The water between the sonar and the bed."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Discriminator, Tag, model_validator

from insonify.scene.base import Choice, Declaration, kind_of, parameter


class NoAbsorption(Choice):
    """Water that swallows nothing."""

    kind: Literal["none"] = "none"


class ConstantAbsorption(Declaration):
    """A given absorption; a bare number of dB/km stands for it."""

    kind: Literal["constant"] = "constant"
    coefficient: float = parameter(
        30.0, unit="dB/km", description="absorption, one way", ge=0.0, le=1e5, slider=(0.0, 500.0)
    )

    @model_validator(mode="before")
    @classmethod
    def _number_alone(cls, value: Any) -> Any:
        return {"coefficient": value} if isinstance(value, (int, float)) else value


class FrancoisGarrison(Choice):
    """Absorption of sea water by frequency, after Francois and Garrison (1982)."""

    kind: Literal["francois_garrison"] = "francois_garrison"
    temperature: float = parameter(10.0, unit="°C", description="temperature", ge=-2.0, le=40.0, slider=(0.0, 30.0))
    salinity: float = parameter(35.0, unit="g/kg", description="salinity", ge=0.0, le=45.0, slider=(0.0, 40.0))
    acidity: float = parameter(8.0, unit="pH", description="pH", ge=7.0, le=9.0, slider=(7.5, 8.5))


def _absorption_kind(value: Any) -> str:
    return "constant" if isinstance(value, (int, float)) else kind_of(value, "none")


Absorption = Annotated[
    Annotated[NoAbsorption, Tag("none")]
    | Annotated[ConstantAbsorption, Tag("constant")]
    | Annotated[FrancoisGarrison, Tag("francois_garrison")],
    Discriminator(_absorption_kind),
]


class Water(Choice):
    """Still water of one sound speed."""

    kind: Literal["uniform"] = "uniform"
    sound_speed: float = parameter(
        1500.0, unit="m/s", description="speed of sound", ge=1300.0, le=1700.0, slider=(1400.0, 1600.0)
    )
    reference_speed: float | None = parameter(
        None,
        unit="m/s",
        description="speed by which the receiver turns time into slant range (the speed at the sonar when left out)",
        ge=1300.0,
        le=1700.0,
        slider=(1400.0, 1600.0),
    )
    absorption: Absorption = parameter(NoAbsorption(), description="what the water swallows")
    surface: Literal["none"] = parameter("none", description="echoes of the sea surface")

    @property
    def range_scale(self) -> float:
        """Recorded slant range over true slant range, c_ref / c."""
        return 1.0 if self.reference_speed is None else self.reference_speed / self.sound_speed
