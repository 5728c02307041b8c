"""Speckle models, one file a kind."""

from __future__ import annotations

from typing import ClassVar, NamedTuple

from insonify.scene.base import Choice
from insonify.scene.kinds import Family

SPECKLES = Family("speckles", "insonify.scene.receiver.speckles")


class Texture(NamedTuple):
    """Strength of the bed about its mean: shape ν of its gamma distribution, and the area (m²) that ν refers to.

    Without an area the shape is the same in every cell.
    """

    shape: float
    cell: float | None


class SpeckleKind(Choice):
    """Interference of scatterers within a cell.

    Attributes
    ----------
    speckled : bool
        Whether there is any.
    interferes : bool
        Whether scatterers are traced one by one, by the sweep, rather than drawn bin by bin.
    """

    family = SPECKLES

    speckled: ClassVar[bool] = True
    interferes: ClassVar[bool] = False

    @property
    def independent_records(self) -> int:
        """Number of independent records that are averaged."""
        return 1

    @property
    def texture(self) -> Texture | None:
        """Gamma-distributed strength of the bed; None where it is even."""
        return None

    @property
    def scatterer_density(self) -> float | None:
        """Scatterers per square metre, of speckle that interferes; None for as many as the tracer takes."""
        return None
