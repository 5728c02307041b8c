"""What lies on, in or over the bed."""

from __future__ import annotations

from itertools import pairwise
from typing import Annotated, Any, Literal

from pydantic import Discriminator, Tag, field_validator, model_validator

from insonify.scene.base import Declaration, kind_of, parameter
from insonify.scene.materials import Material

Position = tuple[float, float] | tuple[float, float, float]
Gap = float | tuple[tuple[float, float], ...]


class Target(Declaration):
    """What every target has: a place and a material."""

    position: Position = parameter(
        unit="m", description="[x, y] of a target that lies on the bed, or [x, y, z] of its centre (z up, surface 0)"
    )
    material: Material = parameter(Material(name="steel"), description="what the target is made of")


class Pipe(Target):
    """A straight pipe that may rest on the bed here and span above it there."""

    kind: Literal["pipe"] = "pipe"
    radius: float = parameter(0.5, unit="m", description="outer radius", gt=0.0, le=100.0, slider=(0.05, 2.0), log=True)
    length: float = parameter(
        20.0, unit="m", description="length along the axis", gt=0.0, le=1e5, slider=(1.0, 200.0), log=True
    )
    heading: float = parameter(
        0.0,
        unit="°",
        description="direction of the axis, counter-clockwise from +x",
        ge=-360.0,
        le=360.0,
        slider=(-180.0, 180.0),
    )
    gap: Gap = parameter(
        0.0,
        unit="m",
        description="underside above the bed: a number, or [[along, gap], ...] from its centre",
        slider=(0.0, 5.0),
    )

    @field_validator("gap")
    @classmethod
    def _gap_in_order(cls, gap: Gap) -> Gap:
        stations = [(0.0, gap)] if isinstance(gap, float) else list(gap)
        if not stations:
            raise ValueError("is empty; give a number or at least two [along, gap] pairs")
        if any(height < -100.0 or height > 1000.0 for _, height in stations):
            raise ValueError("must lie between -100 and 1000 m; check its unit")
        if any(b[0] <= a[0] for a, b in pairwise(stations)):
            raise ValueError("must run in order of increasing along; sort the pairs and drop doubles")
        return gap

    @model_validator(mode="after")
    def _one_height(self) -> Pipe:
        if len(self.position) == 3 and self.gap != 0.0:
            raise ValueError("a position with z sets the axis, and gap the underside; give one of the two")
        return self


class Sphere(Target):
    """A ball."""

    kind: Literal["sphere"] = "sphere"
    radius: float = parameter(0.5, unit="m", description="radius", gt=0.0, le=100.0, slider=(0.05, 2.0), log=True)


def _target_kind(value: Any) -> str:
    return kind_of(value, "missing")


AnyTarget = Annotated[Annotated[Pipe, Tag("pipe")] | Annotated[Sphere, Tag("sphere")], Discriminator(_target_kind)]
