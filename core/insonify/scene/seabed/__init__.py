"""Seabed of a scene: mean depth, relief and material."""

from typing import Annotated, Self

from pydantic import model_validator

from insonify.scene.base import Declaration, KindOf, metres, parameter
from insonify.scene.seabed.materials import AnyMaterialMap, Material
from insonify.scene.seabed.reliefs import RELIEFS, Flat, ReliefKind
from insonify.scene.seabed.reliefs.random_relief import RandomRelief


class Seabed(Declaration):
    """Mean depth, relief and material of the bed."""

    depth: float = parameter(
        30.0, "depth of the mean bed (a measured bed has its own)", "m", gt=0.0, le=11000.0, slider=(5.0, 200.0)
    )
    spacing: float = metres(0.1, "spacing of the relief grid", (0.05, 1.0), most=1e4)
    relief: Annotated[ReliefKind, KindOf(RELIEFS, default="flat")] = parameter(Flat, "shape of the bed")
    material: AnyMaterialMap = parameter(Material, "material of the bed")

    @model_validator(mode="after")
    def _relief_fits_the_grid(self) -> Self:
        self.relief.check(self.spacing, self.material)
        return self

    @property
    def random_reliefs(self) -> tuple[RandomRelief, ...]:
        """The random reliefs that add up to the bed; empty for a bed that is not random."""
        return self.relief.parts

    @property
    def endless(self) -> bool:
        """Whether the bed is endless, without a period."""
        return any(part.endless for part in self.random_reliefs)
