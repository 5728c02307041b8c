"""The water between the sonar and the bed."""

from __future__ import annotations

import itertools
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Discriminator, Field, Tag, field_validator, model_validator

from insonify.scene.base import Choice, Declaration, FilePath, kind_of, parameter
from insonify.scene.surface import NoSurface, Surface

Depth = Annotated[float, Field(ge=0.0, le=12000.0)]
Speed = Annotated[float, Field(ge=1300.0, le=1700.0)]
Temperature = Annotated[float, Field(ge=-2.0, le=40.0)]
Salinity = Annotated[float, Field(ge=0.0, le=45.0)]
Interpolation = Literal["linear", "pchip"]
Equation = Literal["paper", "mackenzie", "teos10"]

# A summer thermocline, for waters that are chosen before their numbers are known.
DEPTHS = (0.0, 8.0, 16.0, 60.0)
SPEEDS = (1520.0, 1519.0, 1501.0, 1500.0)
MOST = 10_000  # points of a profile


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


class AnyWater(Choice):
    """What every kind of water has beside its speed of sound."""

    reference_speed: float | None = parameter(
        None,
        unit="m/s",
        description="speed by which the receiver turns time into slant range (the speed at the sonar when left out)",
        ge=1300.0,
        le=1700.0,
        slider=(1400.0, 1600.0),
    )
    absorption: Absorption = parameter(NoAbsorption(), description="what the water swallows")
    surface: Surface = parameter(NoSurface(), description="the sea surface as a mirror, and the ghosts that it makes")


class UniformWater(AnyWater):
    """Still water of one sound speed."""

    kind: Literal["uniform"] = "uniform"
    sound_speed: float = parameter(
        1500.0, unit="m/s", description="speed of sound", ge=1300.0, le=1700.0, slider=(1400.0, 1600.0)
    )


class LayeredWater(AnyWater):
    """Water whose speed is told at depths; above the first and below the last it stays what it is there."""

    depth: tuple[Depth, ...] = parameter(
        DEPTHS, unit="m", description="depths at which the water is known, downwards", slider=(0.0, 100.0)
    )

    @field_validator("depth")
    @classmethod
    def _goes_downwards(cls, depth: tuple[float, ...]) -> tuple[float, ...]:
        _check_order("depth", depth, "water of one speed is kind 'uniform'")
        return depth


class ProfileWater(LayeredWater):
    """Water of given speeds at given depths."""

    table: ClassVar[frozenset[str]] = frozenset({"depth", "sound_speed"})
    kind: Literal["profile"] = "profile"
    sound_speed: tuple[Speed, ...] = parameter(
        SPEEDS, unit="m/s", description="speed of sound at those depths", slider=(1400.0, 1600.0)
    )
    interpolation: Interpolation = parameter(
        "linear", description="between the depths: straight, or a smooth curve that never overshoots"
    )

    @model_validator(mode="after")
    def _one_speed_each(self) -> ProfileWater:
        _check_length("sound_speed", len(self.sound_speed), self.depth)
        return self


class HydrographyWater(LayeredWater):
    """Water of given temperature and salinity, straight between the depths; the speed follows from an equation."""

    table: ClassVar[frozenset[str]] = frozenset({"depth", "temperature", "salinity"})
    kind: Literal["hydrography"] = "hydrography"
    temperature: tuple[Temperature, ...] = parameter(
        (18.0, 17.6, 11.6, 11.0), unit="°C", description="temperature at those depths", slider=(0.0, 30.0)
    )
    salinity: Salinity | tuple[Salinity, ...] = parameter(
        35.0, description="practical salinity at those depths, or one number for all", slider=(0.0, 40.0)
    )
    equation: Equation = parameter("teos10", description="how the speed of sound follows from them")

    @model_validator(mode="after")
    def _one_of_each(self) -> HydrographyWater:
        _check_length("temperature", len(self.temperature), self.depth)
        if isinstance(self.salinity, tuple):
            _check_length("salinity", len(self.salinity), self.depth)
        return self


class CastWater(AnyWater):
    """Water as an instrument measured it on its way down."""

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


class SectionWater(LayeredWater):
    """Water that differs from place to place: profiles along a level line through the scene's (0, 0)."""

    table: ClassVar[frozenset[str]] = frozenset({"distance", "depth", "sound_speed"})
    kind: Literal["section"] = "section"
    distance: tuple[Annotated[float, Field(ge=-1e6, le=1e6)], ...] = parameter(
        (0.0, 200.0), unit="m", description="places of the profiles along the line", slider=(-100.0, 100.0)
    )
    sound_speed: tuple[tuple[Speed, ...], ...] = parameter(
        (SPEEDS, (1520.0, 1520.0, 1515.0, 1500.0)),
        unit="m/s",
        description="speed of sound at every distance, one list of the depths each",
        slider=(1400.0, 1600.0),
    )
    heading: float = parameter(
        0.0,
        unit="°",
        description="direction of the line, counter-clockwise from +x",
        ge=-360.0,
        le=360.0,
        slider=(-180.0, 180.0),
    )

    @field_validator("distance")
    @classmethod
    def _goes_onwards(cls, distance: tuple[float, ...]) -> tuple[float, ...]:
        _check_order("distance", distance, "water that is the same everywhere is kind 'profile'")
        return distance

    @model_validator(mode="after")
    def _a_profile_each(self) -> SectionWater:
        if len(self.sound_speed) != len(self.distance):
            raise ValueError(
                f"sound_speed has {len(self.sound_speed)} profiles for {len(self.distance)} distances; give one each"
            )
        for number, profile in enumerate(self.sound_speed):
            _check_length(f"sound_speed.{number}", len(profile), self.depth)
        return self


def _check_order(what: str, places: tuple[float, ...], instead: str) -> None:
    """Refuse places between which nothing can be interpolated."""
    if not 2 <= len(places) <= MOST:
        raise ValueError(f"must have from 2 to {MOST} points, not {len(places)}; {instead}")
    for before, after in itertools.pairwise(places):
        if after <= before:
            fault = f"has {before:g} m twice" if after == before else f"goes from {before:g} back to {after:g} m"
            raise ValueError(f"is no {what} to go along: it {fault}; sort it upwards, each number once")


def _check_length(what: str, count: int, depth: tuple[float, ...]) -> None:
    if count != len(depth):
        numbers = f"{count} number{'s' * (count != 1)}"
        raise ValueError(f"{what} has {numbers} for {len(depth)} depths; give one for each depth")


Water = Annotated[
    Annotated[UniformWater, Tag("uniform")]
    | Annotated[ProfileWater, Tag("profile")]
    | Annotated[HydrographyWater, Tag("hydrography")]
    | Annotated[CastWater, Tag("cast")]
    | Annotated[SectionWater, Tag("section")],
    Discriminator(lambda value: kind_of(value, "uniform")),
]
