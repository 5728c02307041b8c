"""Base of all targets, with the defaults of all that the rest of the program uses of a target."""

from __future__ import annotations

import math
from functools import lru_cache
from typing import Annotated, Any, Protocol

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator

from insonify.errors import SceneError
from insonify.files import file_version
from insonify.scene.base import Declaration, Place, parameter
from insonify.scene.kinds import Family, KindOf
from insonify.scene.rotation import rotation_matrix
from insonify.scene.seabed.materials import Material
from insonify.scene.targets.shape import Outline, Shape

Height = Annotated[float, Field(ge=-2e4, le=2e4)]
Position = tuple[Place, Place] | tuple[Place, Place, Height]
TARGETS = Family("targets", "insonify.scene.targets")
LEAST = 0.001  # m, greatest dimension of a target
LOWEST_GAP, HIGHEST_GAP = -100.0, 1000.0


def angle(description: str, *, rare: bool = False) -> Any:
    """Declare an angle of a target's attitude."""
    return parameter(0.0, unit="°", description=description, ge=-360.0, le=360.0, slider=(-180.0, 180.0), rare=rare)


class BedSurface(Protocol):
    """Ground on which a target is placed."""

    @property
    def spacing(self) -> float:
        """Metres between nodes."""

    @property
    def datum(self) -> float:
        """Height of the zero of heights in the world, in metres."""

    def height_at(self, x: NDArray[np.float64], y: NDArray[np.float64]) -> NDArray[np.float64]:
        """Heights above the datum at places, NaN where there is no bed."""


class Target(Declaration):
    """Something on, in or over the bed: a place, a material and a shape.

    A kind derives from `Body` or `Posed` and declares its ``kind``, its measures and its `shape`; the other methods
    have defaults that hold for any shape.
    """

    family = TARGETS
    kind: str = parameter(description="shape of the target")
    position: Position = parameter(
        unit="m", description="[x, y] of its centre when its height follows the bed, or [x, y, z] (z up, surface 0)"
    )
    material: Material = parameter(Material(name="steel"), description="material of the target")
    locked: bool = parameter(False, description="whether the viewer leaves it as it is", rare=True)

    @model_validator(mode="after")
    def _one_height(self) -> Target:
        if len(self.position) == 3 and getattr(self, "gap", 0.0) != 0.0:
            raise ValueError("a position with z sets the centre's height, and gap the underside; give one of the two")
        return self

    def shape(self) -> Shape:
        """Shape about the target's own centre: bow towards +x, port side towards +y, upright.

        Raises
        ------
        SceneError
            If a file cannot be read: one sentence that begins with the name of the field.
        """
        raise NotImplementedError(f"the target {self.kind!r} declares no shape")

    @property
    def attitude(self) -> tuple[float, float, float]:
        """Heading, pitch and roll, in degrees."""
        return 0.0, 0.0, 0.0

    @property
    def underside(self) -> float:
        """Mean height of the lowest point above the bed, in metres."""
        return 0.0

    def placed(self, bed: BedSurface) -> Shape:
        """Shape where it lies.

        Raises
        ------
        SceneError
            If there is no bed to carry it; begins with the name of the field.
        """
        shape = self.shape().turned(rotation_matrix(*self.attitude))
        x, y = self.position[:2]
        if len(self.position) == 3:
            return shape.moved(np.array([x, y, self.position[2] - bed.datum]))
        height = float(self.heights_of(bed, np.array([x]), np.array([y]))[0])
        return shape.moved(np.array([x, y, height + self.underside - shape.lowest]))

    def heights_of(self, bed: BedSurface, x: NDArray[np.float64], y: NDArray[np.float64]) -> NDArray[np.float64]:
        """Heights of the bed that carries the target.

        Raises
        ------
        SceneError
            If it is missing at any of the places.
        """
        heights = bed.height_at(x, y)
        if math.isnan(float(heights.sum())):
            raise SceneError(
                f"position: {list(self.position)} lies where there is no bed; "
                "move the target onto the grid or give its height as [x, y, z]"
            )
        return heights

    @property
    def outline(self) -> Outline:
        """Measures of the shape."""
        path = getattr(self, "path", None)
        return _kept_outline(self, None if path is None else file_version(path))

    @classmethod
    def suited_to(cls, reach: float, path: str) -> dict[str, Any]:
        """Fields of a new target whose size suits a slant range, in metres.

        Parameters
        ----------
        reach : float
            Slant range that the sonar records, in metres.
        path : str
            File of a kind that has one.
        """
        return {}

    @property
    def idle_fields(self) -> frozenset[str]:
        """The gap, where z is given."""
        return frozenset({"gap"} if len(self.position) == 3 else ())


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

    @property
    def underside(self) -> float:
        """Height of the lowest point above the bed, in metres."""
        return self.gap


class Posed(Body):
    """A target that can be turned: first by heading, then by pitch, then by roll, about its centre."""

    heading: float = angle("direction of its bow, counter-clockwise from +x")
    pitch: float = angle("angle of the bow upwards", rare=True)
    roll: float = angle("port side up", rare=True)

    @property
    def attitude(self) -> tuple[float, float, float]:
        """Heading, pitch and roll, in degrees."""
        return self.heading, self.pitch, self.roll


AnyTarget = Annotated[Target, KindOf(TARGETS)]


@lru_cache(maxsize=256)
def _kept_outline(target: Target, version: tuple[int, int] | None) -> Outline:
    del version  # part of the key alone: a changed file is measured again
    return target.shape().outline
