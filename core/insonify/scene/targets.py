"""What lies on, in or over the bed."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import Field, field_validator, model_validator

from insonify.scene.base import Declaration, FilePath, Place, parameter
from insonify.scene.kinds import Family, KindOf
from insonify.scene.materials import Material

Height = Annotated[float, Field(ge=-2e4, le=2e4)]
Position = tuple[Place, Place] | tuple[Place, Place, Height]
Gap = float | tuple[tuple[float, float], ...]
TARGETS = Family("targets")
LEAST = 0.001  # m, of whatever measures a target
Side = Annotated[float, Field(ge=LEAST, le=1000.0)]
LOWEST_GAP, HIGHEST_GAP = -100.0, 1000.0


def _angle(description: str) -> Any:
    return parameter(0.0, unit="°", description=description, ge=-360.0, le=360.0, slider=(-180.0, 180.0))


class Target(Declaration):
    """What every target has: a place and a material."""

    family = TARGETS
    position: Position = parameter(
        unit="m", description="[x, y] of its centre when its height follows the bed, or [x, y, z] (z up, surface 0)"
    )
    material: Material = parameter(Material(name="steel"), description="what the target is made of")

    @model_validator(mode="after")
    def _one_height(self) -> Target:
        if len(self.position) == 3 and getattr(self, "gap", 0.0) != 0.0:
            raise ValueError("a position with z sets the centre's height, and gap the underside; give one of the two")
        return self


class Pipe(Target):
    """A straight pipe that may rest on the bed here and span above it there."""

    kind: Literal["pipe"] = "pipe"
    radius: float = parameter(
        0.5, unit="m", description="outer radius", ge=LEAST, le=100.0, slider=(0.05, 2.0), log=True
    )
    length: float = parameter(
        20.0, unit="m", description="length along the axis", ge=LEAST, le=1e5, slider=(1.0, 200.0), log=True
    )
    heading: float = _angle("direction of the axis, counter-clockwise from +x")
    pitch: float | None = parameter(
        None,
        unit="°",
        description="rise of the axis towards its heading; when left out the pipe follows the slope of the bed",
        ge=-360.0,
        le=360.0,
        slider=(-90.0, 90.0),
    )
    gap: Gap = parameter(
        0.0,
        unit="m",
        description="underside above the bed, negative to sink it: a number, or [[along, gap], ...] from its centre",
        slider=(-1.0, 5.0),
    )

    @field_validator("gap")
    @classmethod
    def _gap_in_order(cls, gap: Gap) -> Gap:
        stations = [(0.0, gap)] if isinstance(gap, float) else list(gap)
        if not stations:
            raise ValueError("is empty; give a number or at least two [along, gap] pairs")
        if any(height < LOWEST_GAP or height > HIGHEST_GAP for _, height in stations):
            raise ValueError(f"must lie between {LOWEST_GAP:g} and {HIGHEST_GAP:g} m; check its unit")
        if any(b[0] <= a[0] for a, b in pairwise(stations)):
            raise ValueError("must run in order of increasing along; sort the pairs and drop doubles")
        return gap

    @model_validator(mode="after")
    def _straight_if_pitched(self) -> Pipe:
        if self.pitch is not None and not isinstance(self.gap, float):
            raise ValueError("a pipe with a pitch is straight; give its gap as one number or leave pitch out")
        return self


class Body(Target):
    """A target that moves as a whole."""

    gap: float = parameter(
        0.0,
        unit="m",
        description="lowest point above the bed at the position; negative sinks it",
        ge=LOWEST_GAP,
        le=HIGHEST_GAP,
        slider=(-1.0, 5.0),
    )


class Sphere(Body):
    """A ball."""

    kind: Literal["sphere"] = "sphere"
    radius: float = parameter(0.5, unit="m", description="radius", ge=LEAST, le=100.0, slider=(0.05, 2.0), log=True)


class Posed(Body):
    """A target that can be turned: first by heading, then by pitch, then by roll, about its centre."""

    heading: float = _angle("direction of its bow, counter-clockwise from +x")
    pitch: float = _angle("bow up")
    roll: float = _angle("port side up")


class Box(Posed):
    """A block; its centre is at half its length, width and height."""

    kind: Literal["box"] = "box"
    size: tuple[Side, Side, Side] = parameter(
        (2.0, 1.0, 1.0),
        unit="m",
        description="[length, width, height], each from 1 mm to 1000 m; the length runs along the heading",
        slider=(0.05, 10.0),
        log=True,
    )


class Cone(Posed):
    """A cone, apex up when level; its centre is at half its height."""

    kind: Literal["cone"] = "cone"
    radius: float = parameter(
        0.5, unit="m", description="radius of the base", ge=LEAST, le=100.0, slider=(0.05, 2.0), log=True
    )
    height: float = parameter(
        1.0, unit="m", description="from the base to the apex", ge=LEAST, le=1000.0, slider=(0.05, 5.0), log=True
    )


class MeshFile(Posed):
    """A shape from a file of triangles; its centre is that of the shape's bounding box, unturned."""

    kind: Literal["mesh"] = "mesh"
    path: FilePath = parameter(
        description="OBJ, STL, PLY, glTF or GLB file, x ahead and z up (glTF: y up), or the name of a bundled mesh",
        min_length=1,
    )
    scale: float = parameter(
        1.0, description="metres per unit of the file", ge=1e-6, le=1e6, slider=(0.01, 100.0), log=True
    )


if TYPE_CHECKING:
    AnyTarget = Pipe | Sphere | Box | Cone | MeshFile
else:
    AnyTarget = Annotated[Target, KindOf(TARGETS)]
