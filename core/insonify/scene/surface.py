"""The sea surface: a mirror over the sonar, flat or tilted by waves, and the ways of the sound that it opens."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Discriminator, Tag

from insonify.scene.base import Choice, kind_of, parameter

WAYS = ("surface_bottom", "surface_bottom_surface", "second_bottom", "surface_echo")


class NoSurface(Choice):
    """Water without end above the sonar."""

    kind: Literal["none"] = "none"


class _Mirror(Choice):
    """The ways of the sound by a surface that reflects all of it; each is a switch of its own."""

    surface_bottom: bool = parameter(
        True, description="what comes by the surface and goes straight, or the other way round: out by one, back by one"
    )
    surface_bottom_surface: bool = parameter(True, description="what goes out and comes back by the surface")
    second_bottom: bool = parameter(
        True, description="what the bed beneath the sonar and then the surface send to the bed once more, either way"
    )
    surface_echo: bool = parameter(True, description="the echo of the surface straight above the sonar")


class FlatSurface(_Mirror):
    """A perfect mirror: a calm sea."""

    kind: Literal["flat"] = "flat"


class RoughSurface(_Mirror):
    """A sea raised by the wind: its ghosts keep their energy and are smeared in range."""

    kind: Literal["rough"] = "rough"
    wind_speed: float = parameter(
        5.0,
        unit="m/s",
        description="wind that has raised the sea, 19.5 m above it",
        ge=0.0,
        le=30.0,
        slider=(0.0, 15.0),
    )


Surface = Annotated[
    Annotated[NoSurface, Tag("none")] | Annotated[FlatSurface, Tag("flat")] | Annotated[RoughSurface, Tag("rough")],
    Discriminator(lambda value: kind_of(value, "none")),
]
