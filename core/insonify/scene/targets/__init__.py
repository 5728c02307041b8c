"""Targets on, in or over the bed: their base classes."""

import math
from typing import Annotated, Any, NamedTuple, Protocol, Self

import numpy as np
from pydantic import Field, model_validator
from pydantic.fields import FieldInfo

from insonify.arrays import Floats
from insonify.errors import SceneError
from insonify.files import kept_until_changed
from insonify.scene.base import Coordinate, Declaration, Family, KindOf, angle, parameter
from insonify.scene.seabed.materials import Material
from insonify.scene.targets.shape import Outline, Shape, exact_cos, rotation_matrix

Height = Annotated[float, Field(ge=-2e4, le=2e4)]
Position = tuple[Coordinate, Coordinate] | tuple[Coordinate, Coordinate, Height]
TARGETS = Family("targets", "insonify.scene.targets")
LEAST = 0.001  # m, of a target's dimensions
RIM = 0.6  # of a pit: height of its rim is 0.11 of its depth
LEE, RIDGE = 0.5, 0.35  # of a pit's depth: what a current digs more before it than behind; height of its ridge
LOWEST_GAP, HIGHEST_GAP = -100.0, 1000.0


class Pit(NamedTuple):
    """Scour around a target, with a low rim."""

    x: float  # of its middle, in metres
    y: float
    heading: float  # of its long axis, counter-clockwise from +x, in degrees
    half: tuple[float, float]  # m, from the middle along and across the axis to where the bed is little changed
    depth: float  # m, of the middle; a negative one is a mound
    current: float | None = None  # direction of the flow, which digs before the middle and leaves a ridge behind, °

    def heights(self, x: Floats, y: Floats) -> Floats:
        """Change of the height of the bed at places, in metres."""
        ahead = np.array([exact_cos(self.heading), exact_cos(self.heading - 90.0)])
        dx, dy = x - self.x, y - self.y
        along, across = dx * ahead[0] + dy * ahead[1], dy * ahead[0] - dx * ahead[1]
        squared = (along / self.half[0]) ** 2 + (across / self.half[1]) ** 2
        even = (1.0 - RIM * squared) * np.exp(-squared)
        if self.current is None:
            return np.asarray(-self.depth * even)
        flow = math.radians(self.current - self.heading)
        u, v = along / self.half[0], across / self.half[1]
        behind, beside = u * math.cos(flow) + v * math.sin(flow), v * math.cos(flow) - u * math.sin(flow)
        ridge = np.exp(-(((behind - 1.7) / 1.1) ** 2) - (beside / 0.45) ** 2)
        return np.asarray(-self.depth * (even * (1.0 - LEE * np.tanh(2.0 * behind)) - RIDGE * ridge))


class BedSurface(Protocol):
    """Bed on which a target is placed."""

    @property
    def spacing(self) -> float:
        """Metres between nodes."""

    @property
    def datum(self) -> float:
        """Height of the zero of heights in the world, in metres."""

    def height_at(self, x: Floats, y: Floats) -> Floats:
        """Heights above the datum at places, NaN where there is no bed."""


class Target(Declaration):
    """A target on, in or over the bed: a position, a material and a shape.

    A kind derives from `Body` or `Posed` and declares its ``kind``, its dimensions and its `shape`; the other methods
    have defaults for any shape.
    """

    family = TARGETS
    kind: str = parameter(description="shape of the target")
    position: Position = parameter(
        description="[x, y] of the centre for a target on the bed, or [x, y, z] with z up from the sea surface",
        unit="m",
    )
    material: Material = parameter(Material(name="steel"), "material of the target")
    locked: bool = parameter(False, "whether the viewer protects it against changes", rare=True)

    @model_validator(mode="after")
    def _one_height(self) -> Self:
        if len(self.position) == 3 and getattr(self, "gap", 0.0) != 0.0:
            raise ValueError(
                "position with z sets the height of the centre, and gap that of the underside; give one of the two"
            )
        return self

    def shape(self) -> Shape:
        """Shape about the target's own centre: bow towards +x, port side towards +y.

        Raises
        ------
        SceneError
            If a file cannot be read; the message begins with the name of the field.
        """
        raise NotImplementedError(f"the target {self.kind!r} declares no shape")

    @property
    def attitude(self) -> tuple[float, float, float]:
        """Heading, pitch and roll, in degrees."""
        return 0.0, 0.0, 0.0

    @property
    def underside(self) -> float:
        """Mean height of the lowest point above the bed, in metres."""
        return getattr(self, "gap", 0.0)

    def placed(self, bed: BedSurface) -> Shape:
        """Shape where it lies on a bed.

        Raises
        ------
        SceneError
            If there is no bed under it; the message begins with the name of the field.
        """
        shape = self.shape().turned(rotation_matrix(*self.attitude))
        x, y = self.position[:2]
        if len(self.position) == 3:
            return shape.moved(np.array([x, y, self.position[2] - bed.datum]))
        height = float(self.heights_of(bed, np.array([x]), np.array([y]))[0])
        return shape.moved(np.array([x, y, height + self.underside - shape.lowest]))

    def heights_of(self, bed: BedSurface, x: Floats, y: Floats) -> Floats:
        """Heights of the bed under the target.

        Raises
        ------
        SceneError
            If there is no bed at one of the places.
        """
        heights = bed.height_at(x, y)
        if math.isnan(float(heights.sum())):
            raise SceneError(
                f"position: {list(self.position)} lies where there is no bed; "
                "move the target onto the grid or give its height as [x, y, z]"
            )
        return heights

    @property
    def sizes(self) -> dict[str, tuple[str, ...]]:
        """Paths of the numbers that a drag scales to ``resize`` the target, ``thicken`` it across or ``raise`` its top.

        By default a drag resizes all lengths in metres that the kind declares and that must be positive.
        """
        own = type(self).model_fields.items()
        return {"resize": tuple(name for name, field in own if name not in Posed.model_fields and _is_length(field))}

    @property
    def pit(self) -> Pit | None:
        """What the target does to the bed around it."""
        return None

    @property
    @kept_until_changed(maxsize=256)
    def outline(self) -> Outline:
        """Measures of the shape."""
        return self.shape().outline

    @classmethod
    def suited_to(cls, reach: float, path: str) -> dict[str, Any]:
        """Fields of a new target that set a size in proportion to the range.

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
        """The gap, if z is given."""
        return frozenset({"gap"} if len(self.position) == 3 else ())


class Body(Target):
    """A rigid target."""

    gap: float = parameter(
        0.0,
        "height of the lowest point above the bed at the position; negative buries it",
        "m",
        ge=LOWEST_GAP,
        le=HIGHEST_GAP,
        slider=(-1.0, 5.0),
    )


class Posed(Body):
    """A target that can be turned: first by heading, then by pitch, then by roll, about its centre."""

    heading: float = angle("direction of the bow, counter-clockwise from east; 45T is 45° by the compass")
    pitch: float = angle("angle of the bow upwards", rare=True)
    roll: float = angle("angle of the port side upwards", rare=True)

    @property
    def attitude(self) -> tuple[float, float, float]:
        """Heading, pitch and roll, in degrees."""
        return self.heading, self.pitch, self.roll


def _is_length(field: FieldInfo) -> bool:
    """Whether a field is in metres and must be positive."""
    positive = any(getattr(bound, "gt", -1.0) >= 0.0 or getattr(bound, "ge", 0.0) > 0.0 for bound in field.metadata)
    return positive and isinstance(field.json_schema_extra, dict) and field.json_schema_extra.get("unit") == "m"


AnyTarget = Annotated[Target, KindOf(TARGETS)]
