"""What the receiver does to the echo."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Discriminator, Tag

from insonify.scene.base import Choice, Declaration, kind_of, parameter


class NoSpeckle(Choice):
    """The mean echo."""

    kind: Literal["none"] = "none"


class Rayleigh(Choice):
    """Fully developed speckle: the intensity of every bin is exponential about its mean."""

    kind: Literal["rayleigh"] = "rayleigh"


Speckle = Annotated[
    Annotated[NoSpeckle, Tag("none")] | Annotated[Rayleigh, Tag("rayleigh")],
    Discriminator(lambda value: kind_of(value, "none")),
]


class Receiver(Declaration):
    """Noise of the echo itself."""

    speckle: Speckle = parameter(NoSpeckle(), description="interference of scatterers within a cell")
