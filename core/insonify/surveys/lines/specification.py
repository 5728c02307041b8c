"""Specification of a survey: a scene, and the lines along which it is towed over."""

import math
from typing import Annotated, Any, Literal, Self

from pydantic import Field, model_validator

from insonify.io.records import RECORDS
from insonify.scene import PLAIN_SCENE
from insonify.scene.base import Coordinate, Declaration, FilePath, Words, parameter
from insonify.surveys import OVERLAPS

Point = tuple[Coordinate, Coordinate]
SHORTEST = 0.01  # m, of a line


class Area(Declaration):
    """An area that parallel lines cover, to and fro."""

    corners: tuple[Point, ...] = parameter(unit="m", description="corners of the area, in order", min_length=3)
    spacing: float = parameter(unit="m", description="distance between lines", gt=0.0, le=1e5)
    heading: float = parameter(0.0, "direction of the first line, counter-clockwise from +x", "°", ge=-360.0, le=360.0)
    turns: Literal["out", "in"] = parameter("out", "whether the turns between lines are recorded")


class GivenLine(Declaration):
    """A line from one point to another."""

    start: Point = parameter(unit="m", description="position of the first ping")
    end: Point = parameter(unit="m", description="where the line ends")

    @model_validator(mode="after")
    def _has_a_length(self) -> Self:
        if math.dist(self.start, self.end) < SHORTEST:
            raise ValueError(f"start and end {list(self.start)} are the same place; move one of them")
        return self


class MosaicOptions(Declaration):
    """How the records are put on the map."""

    cell: float | None = parameter(
        None, "side of a cell; about the distance between pings when left out", "m", gt=0.0, le=1e4
    )
    overlap: Annotated[str, Field(pattern="|".join(OVERLAPS))] = parameter(
        OVERLAPS[0], f"what counts where records overlap: {', '.join(OVERLAPS)}"
    )


class SurveySpecification(Declaration):
    """Everything that a survey depends on."""

    title: Words = parameter("Untitled", "what is surveyed", max_length=200)
    description: Words = parameter("", "a paragraph about it", max_length=5000)
    base: FilePath = parameter(PLAIN_SCENE, "bundled scene, or TOML file; its track is replaced")
    set: dict[str, Any] = parameter({}, "fields of the scene by their paths")
    area: Area | None = parameter(None, "area that lines cover")
    lines: tuple[GivenLine, ...] = parameter((), "lines, instead of an area")
    suffix: str = parameter(".nc", "format of the records")
    mosaic: MosaicOptions = parameter(MosaicOptions, "how the records are put on the map")

    @model_validator(mode="after")
    def _has_lines_and_a_format(self) -> Self:
        if (self.area is None) == (not self.lines):
            raise ValueError("area, lines: give one of the two, an area to cover or a list of lines")
        known = [suffix for suffix in RECORDS.writable() if suffix in RECORDS.readable()]
        if self.suffix not in known:
            raise ValueError(f"suffix: {self.suffix!r} is not a format of records; give one of {', '.join(known)}")
        return self
