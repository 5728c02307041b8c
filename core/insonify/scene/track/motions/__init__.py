"""Motions of the towfish: their base classes, straight lines and turns, and several motions at once."""

from __future__ import annotations

from abc import abstractmethod
from typing import TYPE_CHECKING, Annotated, ClassVar, Literal

from insonify.arrays import Floats
from insonify.scene.base import Family, Kind, KindOf, parameter

if TYPE_CHECKING:
    from insonify.io.navigation import RecordedNavigation

MOTIONS = Family("motions", "insonify.scene.track.motions")
Axis = Literal["surge", "sway", "heave", "yaw", "pitch", "roll"]
Turning = tuple[float, float, float]


class MotionKind(Kind):
    """Motion of the towfish about its line."""

    family = MOTIONS

    @property
    @abstractmethod
    def parts(self) -> tuple[SingleMotion, ...]:
        """The motions of the towfish, one or several."""


class SingleMotion(MotionKind):
    """One motion, which can be combined with others.

    Attributes
    ----------
    moves : bool
        Whether the towfish leaves a straight, level line.
    keeps_line : bool
        Whether it stays within `greatest_sway` of the track's line.
    tilts : bool
        Whether it may pitch or roll.
    """

    moves: ClassVar[bool] = True
    keeps_line: ClassVar[bool] = False
    tilts: ClassVar[bool] = False

    @property
    def parts(self) -> tuple[SingleMotion, ...]:
        """The motion alone."""
        return (self,)

    @property
    def greatest_sway(self) -> float:
        """Greatest distance from its place on the line, in metres, of a motion with `keeps_line`."""
        return 0.0

    @property
    def greatest_heave(self) -> float:
        """Greatest rise above and fall below the track's own height, in metres."""
        return 0.0

    def displacement(self, time: Floats) -> dict[Axis, Floats]:
        """Displacement of the towfish at times (s) after the first ping: metres ahead, to port, up; degrees."""
        return {}

    @property
    def turning(self) -> Turning | None:
        """Begin and duration (s) of a bend of the line, and its rate of turn (°/s, to port)."""
        return None

    def recording(self) -> tuple[str, RecordedNavigation] | None:
        """Read the motion of the towfish from a file, and return it with the file's path."""
        return None


class SumOfMotions(MotionKind, kind="sum", rank=90):
    """Several motions at once."""

    of: tuple[Annotated[SingleMotion, KindOf(MOTIONS, SingleMotion, default="straight")], ...] = parameter(
        description="the motions, in any order", min_length=1, max_length=32
    )

    @property
    def parts(self) -> tuple[SingleMotion, ...]:
        """The motions in declared order."""
        return self.of


class Straight(SingleMotion, kind="straight", rank=10):
    """A level tow at constant speed."""

    moves = False
    keeps_line = True


class Turn(SingleMotion, kind="turn", rank=70):
    """A turn: the line bends into an arc of a circle and then continues straight."""

    rate: float = parameter(3.0, "rate of turn, to port if positive", "°/s", ge=-90.0, le=90.0, slider=(-10.0, 10.0))
    begin: float = parameter(
        10.0, "time from the first ping to the beginning of the turn", "s", ge=0.0, le=1e8, slider=(0.0, 60.0)
    )
    duration: float = parameter(30.0, "duration of the turn", "s", ge=0.0, le=1e8, slider=(0.0, 120.0))

    @property
    def turning(self) -> Turning:
        """Begin and duration (s) of the bend, and its rate (°/s, to port)."""
        return self.begin, self.duration, self.rate
