"""Relief made from random numbers: what all its kinds share, and where a mask lets it be."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Discriminator, Tag

from insonify.scene.base import Choice, kind_of, parameter


class Everywhere(Choice):
    """No mask: the relief covers the whole bed."""

    kind: Literal["none"] = "none"


class Patchy(Choice):
    """Smooth patches, strewn at random, outside which the relief fades out."""

    kind: Literal["patches"] = "patches"
    share: float = parameter(
        0.5, description="share of the bed that the patches cover", gt=0.0, lt=1.0, slider=(0.05, 0.95)
    )
    size: float = parameter(
        10.0, unit="m", description="typical width of a patch", ge=1e-3, le=1e5, slider=(1.0, 50.0), log=True
    )
    softness: float = parameter(
        0.3,
        description="width over which the relief fades at their borders, as a share of their size",
        gt=0.0,
        le=2.0,
        slider=(0.05, 1.0),
    )


Mask = Annotated[
    Annotated[Everywhere, Tag("none")] | Annotated[Patchy, Tag("patches")],
    Discriminator(lambda value: kind_of(value, "patches")),
]


class Made(Choice):
    """Relief that repeats after a period, and what may mask it."""

    period: float = parameter(
        102.4,
        unit="m",
        description="length after which the bed repeats",
        gt=0.0,
        le=1e6,
        slider=(12.8, 409.6),
        log=True,
    )
    mask: Mask = parameter(Everywhere(), description="where the relief is, of a bed that is level elsewhere")

    @property
    def endless(self) -> bool:
        """Whether the bed never repeats."""
        return False


class MadeAnywhere(Made):
    """Relief that can also go on for ever without repeating."""

    extent: Literal["periodic", "endless"] = parameter(
        "periodic",
        description="whether the bed repeats after its period, or never; it is then smooth at waves longer than that",
    )

    @property
    def endless(self) -> bool:
        """Whether the bed never repeats."""
        return self.extent == "endless"


def rms_height(default: float = 0.05) -> float:
    """Declare the rms of a relief's heights."""
    height: float = parameter(
        default,
        unit="m",
        description="rms height over a period, before any mask; that expected of endless ground",
        ge=0.0,
        le=1e4,
        slider=(0.001, 1.0),
        log=True,
    )
    return height


def crest_heading(default: float = 0.0) -> float:
    """Declare the direction along which crests lie."""
    heading: float = parameter(
        default,
        unit="°",
        description="direction along the crests, counter-clockwise from +x",
        ge=-360.0,
        le=360.0,
        slider=(-180.0, 180.0),
    )
    return heading
