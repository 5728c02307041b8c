"""What all reliefs made from random numbers share."""

from __future__ import annotations

from typing import Annotated, Literal

from insonify.scene.base import parameter
from insonify.scene.kinds import KindOf
from insonify.scene.masks import MASKS, MaskKind
from insonify.scene.masks.none import Everywhere
from insonify.scene.reliefs import ReliefKind


class RandomRelief(ReliefKind):
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
    mask: Annotated[MaskKind, KindOf(MASKS, default="patches")] = parameter(
        Everywhere(), description="where the relief is, of a bed that is level elsewhere"
    )

    @property
    def endless(self) -> bool:
        """Whether the bed never repeats."""
        return False


class ExtendableRelief(RandomRelief):
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
